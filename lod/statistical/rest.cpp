// Stage 5, and who wakes whom.
#include "lod/statistical/statistical_level_internal.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

// Sleeping (3.4's second threshold). Among other bodies: slower than .05 m/s at R = .2 m, scaled with √R, for .1 s. Alone a body may still rock
// slowly, so it must be nearly still for longer: kinetic energy over m g R below 2.5e-4 for .5 s.
constexpr double kSleepSpeed = 0.05, kSleepSpeedRadius = 0.2;
constexpr float kSleepTime = 0.1f;
constexpr double kAloneSleepEnergy = 2.5e-4;
constexpr float kAloneSleepTime = 0.5f;
constexpr double kLeaningTime = 0.2, kLeaningUnit = 0.004;  // s: a body that touched another so lately still leans on it, though a hair apart
constexpr double kWakeFactor = 2.0;  // a sleeper wakes when touched faster than this times the sleeping speed

// J/kg: with less kinetic energy no body moves or spins too fast for a level to hold it.
constexpr double kSurelySound = 1e3;

double sleep_speed(double radius) { return kSleepSpeed * std::sqrt(radius / kSleepSpeedRadius); }

}  // namespace

void StatisticalLevel::Impl::wake(int slot) {
  StatisticalBody& body = bodies[slot];
  if (body.motion != Motion::asleep) return;
  body.motion = Motion::dynamic;
  body.quiet_time = 0.0f;
  if (!lies_still[std::size_t(slot)]) return;  // put to sleep in this very step, and still among the awake
  take_from_still(slot);
  awake.push_back(slot);
  woken = true;
}

void StatisticalLevel::Impl::lay_still(std::int32_t slot) {
  still.insert(std::uint32_t(slot), bodies[std::size_t(slot)].position, kind_of(bodies[std::size_t(slot)]).shape->radius);
  lies_still[std::size_t(slot)] = 1;
  near_another[std::size_t(slot)] = 0;
  turning[std::size_t(slot)] = {};
  ++asleep_count;
}

void StatisticalLevel::Impl::take_from_still(std::int32_t slot) {
  still.remove(std::uint32_t(slot), bodies[std::size_t(slot)].position, kind_of(bodies[std::size_t(slot)]).shape->radius);
  lies_still[std::size_t(slot)] = 0;
  --asleep_count;
}

void StatisticalLevel::Impl::put_to_sleep(StatisticalBody& body) {
  body.motion = Motion::asleep;
  body.velocity.setZero();
  body.spin.setZero();
}

// Awake slots stay in order, so that the result of a step does not depend on the history of sleeping.
void StatisticalLevel::Impl::sort_by_motion() {
  const auto sleeps = [&](std::int32_t slot) { return bodies[slot].motion == Motion::asleep; };
  const auto first_asleep = std::stable_partition(awake.begin(), awake.end(), std::not_fn(sleeps));
  std::for_each(first_asleep, awake.end(), [&](std::int32_t slot) { lay_still(slot); });
  awake.erase(first_asleep, awake.end());
  if (!std::is_sorted(awake.begin(), awake.end())) std::sort(awake.begin(), awake.end());
}

/// `energy`: kinetic over mass, J/kg.
bool StatisticalLevel::Impl::is_sound(const StatisticalBody& body, double energy) const {
  if (!is_within_limit(body.position)) return false;
  if (energy < kSurelySound) return true;  // not so for NaN
  return is_within_limit(body.velocity) && is_within_limit(angular_velocity(body.orientation, body.spin, *kind_of(body).shape));
}

// Put to rest at the nearest place that can be held, or, where the place is no number, the last one known: what is not sound must neither spread nor
// reach ODE, which would end the process.
void StatisticalLevel::Impl::recover(StatisticalBody& body, ContactTally& tally) {
  if (!body.position.allFinite()) body.position = last_places[std::size_t(&body - bodies.data())];
  body.position = body.position.cwiseMax(-kStateLimit).cwiseMin(kStateLimit);
  if (!(std::abs(body.orientation.squaredNorm() - 1.0) < 1e-6)) body.orientation = Quat::Identity();
  body.velocity.setZero();
  body.spin.setZero();
  ++tally.states_recovered;
}

void StatisticalLevel::Impl::update_quiet(StatisticalBody& body, double dt, ContactTally& tally) {
  const BodyKind& kind = kind_of(body);
  const double speed = sleep_speed(kind.shape->radius);
  const bool among_others = body.crowded || body.since_crowded * kLeaningUnit < kLeaningTime;
  const double limit = among_others ? 0.5 * speed * speed : kAloneSleepEnergy * settings.gravity.norm() * kind.shape->radius;
  body.since_crowded = body.crowded ? 0 : std::uint8_t(std::min(255.0, body.since_crowded + std::max(1.0, std::round(dt / kLeaningUnit))));
  const double energy = kinetic_energy(body, *kind.shape);
  if (!is_sound(body, energy)) recover(body, tally);
  body.quiet_time = energy < limit ? body.quiet_time + float(dt) : 0.0f;
  if (!settings.sleeping || body.quiet_time < (among_others ? kSleepTime : kAloneSleepTime)) return;
  if (among_others || stands_firmly(body)) put_to_sleep(body);
}

// On three vertices at least: on an edge a body may balance for a while, but not for good.
bool StatisticalLevel::Impl::stands_firmly(const StatisticalBody& body) const {
  constexpr double kFlat = 0.02;  // over R
  const Shape& shape = *kind_of(body).shape;
  if (shape.sphere_radius) return true;
  int vertices = 0;
  const auto count_on = [&](const HalfSpace& plane) {
    const double height = plane.height_of(body.position), margin = kFlat * shape.radius;
    if (height > shape.radius + margin) return;
    std::int32_t hint = body.support_hint;
    const HullContacts low = find_hull_contacts(shape, body.orientation, plane.normal, height, margin, hint);
    for (int i = 0; i < low.count; ++i) vertices += low.contact[std::size_t(i)].gap < margin;
  };
  for (const HalfSpace& plane : ground.planes) count_on(plane);
  for (const HalfSpace& face : faces_below.of(std::int32_t(&body - bodies.data()))) count_on(face);
  return vertices >= 3;
}

void StatisticalLevel::Impl::wake_touched(std::span<FullNeighbor> neighbors) {
  for (const CrowdContact& c : contacts)
    for (const auto& [sleeper, other] : {std::pair{c.first, c.second}, std::pair{c.second, c.first}}) {
      if (!is_asleep(sleeper, neighbors)) continue;
      const double radius = sleeper < 0 ? neighbors[-1 - sleeper].shape->radius : kind_of(bodies[sleeper]).shape->radius;
      const double speed = point_velocity(other, c.contact.manifold.points[0].point, neighbors).norm();
      if (speed <= kWakeFactor * sleep_speed(radius)) continue;
      if (sleeper < 0) neighbors[-1 - sleeper].asleep = false;
      else wake(sleeper);
    }
}

}  // namespace lodestone
