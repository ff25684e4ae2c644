#include "lod/statistical/blow_reach.h"

#include <algorithm>
#include <cmath>

namespace lodestone {

std::int32_t BlowReach::add_body(const Body& body) {
  bodies_.push_back(body);
  return std::int32_t(bodies_.size()) - 1;
}

void BlowReach::add_contact(std::int32_t first, std::int32_t second, const Vec3& normal, double closing,
                            double restitution) {
  contacts_.push_back({first, second, normal, closing, restitution});
}

// A counting sort; a contact is an end of two bodies.
void BlowReach::sort_ends() {
  first_end_.assign(bodies_.size() + 2, 0);
  for (const Contact& c : contacts_)
    for (const std::int32_t body : {c.first, c.second}) ++first_end_[std::size_t(body) + 2];
  for (std::size_t i = 2; i < first_end_.size(); ++i) first_end_[i] += first_end_[i - 1];
  ends_.resize(2 * contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& c = contacts_[i];
    const auto add = [&](std::int32_t body, std::int32_t other, double sign) {
      ends_[std::size_t(first_end_[std::size_t(body) + 1]++)] = {other, std::int32_t(i), sign};
    };
    add(c.first, c.second, -1.0), add(c.second, c.first, 1.0);
  }
  first_end_.pop_back();
}

// By a ram of so much mass, at a velocity along the normal.
void BlowReach::strike(std::int32_t struck, const Vec3& velocity, double mass) {
  const Body& body = bodies_[std::size_t(struck)];
  if (!std::isfinite(body.mass)) return;
  const double share = std::isfinite(mass) ? mass / (mass + body.mass) : 1.0;
  const Vec3 together = share * velocity;
  const double speed = together.norm();
  double& fastest = fastest_[std::size_t(struck)];
  if (speed <= body.wake_speed || speed <= fastest) return;
  if (body.asleep && fastest == 0.0) set_moving_.push_back(struck);
  fastest = speed;
  if (body.asleep) return;
  rams_.push_back({struck, speed, together, mass + body.mass});
  std::ranges::push_heap(rams_, {}, &Ram::speed);
}

void BlowReach::pass_on(const Ram& ram) {
  const Vec3& ground = bodies_[std::size_t(ram.body)].ground;
  const Vec3 velocity = ram.velocity - std::min(0.0, ram.velocity.dot(ground)) * ground;
  const auto speed_along = [&](const End& end) {
    return std::max(0.0, end.sign * velocity.dot(contacts_[std::size_t(end.contact)].normal));
  };
  double all = 0.0;
  for (const End& end : ends_of(ram.body)) all += speed_along(end);
  for (const End& end : ends_of(ram.body))
    if (const double speed = speed_along(end); speed > 0.0)
      strike(end.other, speed * end.sign * contacts_[std::size_t(end.contact)].normal,
             speed / all * ram.mass);
}

std::span<const std::int32_t> BlowReach::find() {
  set_moving_.clear(), rams_.clear();
  sort_ends();
  fastest_.assign(bodies_.size(), 0.0);
  for (const Contact& c : contacts_) {
    if (c.closing <= 0.0) continue;
    const Vec3 velocity = (1.0 + c.restitution) * c.closing * c.normal;
    const Body &first = bodies_[std::size_t(c.first)], &second = bodies_[std::size_t(c.second)];
    if (!second.asleep) strike(c.first, velocity, second.mass);
    if (!first.asleep) strike(c.second, -velocity, first.mass);
  }
  while (!rams_.empty()) {  // the fastest first: none that follows from it is faster
    std::ranges::pop_heap(rams_, {}, &Ram::speed);
    const Ram ram = rams_.back();
    rams_.pop_back();
    if (ram.speed == fastest_[std::size_t(ram.body)]) pass_on(ram);
  }
  std::ranges::sort(set_moving_);
  return set_moving_;
}

}  // namespace lodestone
