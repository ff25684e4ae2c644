// How a body comes to rest, sleeps and wakes.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "lod/statistical/parting.h"
#include "lod/support/hull_motion.h"
#include "lod/support/support_level.h"

namespace lodestone {
namespace {

// J/kg: with less kinetic energy no body moves or spins too fast for a level to hold it.
constexpr double kSurelySound = 1e3;

/// Its speed of motion and spin, m/s, and how long it has risen in each step of the `time`, s.
void follow_speed(StatisticalBody& body, double speed, double time) {
  const bool rises = body.quiet_time > 0.0f && float(speed) > body.speed;
  body.rising_time = rises ? body.rising_time + float(time) : 0.0f;
  if (!rises) body.rising_from = float(speed);
  body.speed = float(speed);
}

}  // namespace

void SupportLevel::wake(int slot) {
  StatisticalBody& body = bodies_[std::size_t(slot)];
  if (body.motion != Motion::asleep) return;
  body.motion = Motion::dynamic;
  body.quiet_time = 0.0f;
  if (!is_guest(slot)) {
    if (!lies_still(slot)) return;  // put to sleep in this very step, and still among the awake
    take_from_still(slot);
    woke_.push_back(body.owner);
    add_awake(slot);
  } else {
    awake_.push_back(slot);
  }
}

void SupportLevel::put_to_sleep(int slot) {
  if (asleep(slot)) return;
  put_to_sleep(bodies_[std::size_t(slot)]);
  angular_velocity_given_[std::size_t(slot)].reset();
  std::erase_if(pushes_, [&](const Push& push) { return push.slot == slot; });
  drop_awake(slot);
  lay_still(slot);
}

void SupportLevel::set_gravity(const Vec3& gravity) {
  settings_.gravity = gravity;
  for (const std::int32_t slot : awake_)
    if (StatisticalBody& body = bodies_[std::size_t(slot)]; body.motion == Motion::settling)
      body.motion = Motion::dynamic;
}

void SupportLevel::take_woke(std::vector<std::uint32_t>& owners) {
  owners.insert(owners.end(), woke_.begin(), woke_.end());
  woke_.clear();
}

void SupportLevel::lay_still(std::int32_t slot) {
  const StatisticalBody& b = body(slot);
  sleepers_.of(StatisticalModel::support).insert(std::uint32_t(slot), b.position, kind_of(b).shape->radius);
}

void SupportLevel::take_from_still(std::int32_t slot) {
  const StatisticalBody& b = body(slot);
  sleepers_.of(StatisticalModel::support).remove(std::uint32_t(slot), b.position, kind_of(b).shape->radius);
}

void SupportLevel::put_to_sleep(StatisticalBody& body) const {
  body.motion = Motion::asleep;
  body.velocity.setZero();
  body.spin.setZero();
  body.on_solid = body.alone_on_solid = false;
}

void SupportLevel::end_step() {
  const auto first_asleep = std::stable_partition(awake_.begin(), awake_.end(),
                                                  [this](std::int32_t slot) { return !asleep(slot); });
  std::for_each(first_asleep, awake_.end(), [this](std::int32_t slot) {
    place_awake_[std::size_t(slot)] = -1;
    lay_still(slot);
    fell_asleep_.push_back(body(slot).owner);
  });
  awake_.erase(first_asleep, awake_.end());
  awake_in_order_ = false;
  put_awake_in_order();
}

/// `energy`: kinetic over mass, J/kg.
bool SupportLevel::is_sound(const StatisticalBody& body, double energy) const {
  if (!is_within_limit(body.position)) return false;
  if (energy < kSurelySound) return true;  // not so for NaN
  return is_within_limit(body.velocity) &&
         is_within_limit(angular_velocity(body.orientation, body.spin, *kind_of(body).shape));
}

// Put to rest at the nearest place that can be held, or, where the place is no number, the last one known:
// what is not sound must neither spread nor reach ODE, which would end the process.
void SupportLevel::recover(StatisticalBody& body, const Vec3& last_place, ContactTally& tally) const {
  if (!body.position.allFinite()) body.position = last_place;
  body.position = body.position.cwiseMax(-kStateLimit).cwiseMin(kStateLimit);
  if (!(std::abs(body.orientation.squaredNorm() - 1.0) < 1e-6)) body.orientation = Quat::Identity();
  body.velocity.setZero();
  body.spin.setZero();
  ++tally.states_recovered;
}

// Sound and not still, whatever it turns like: from bounds of its energy, so that what flies need not be
// asked for that itself. Half of v² is the least that it may be, and the spin L of a body turns with at most
// its length over the least moment of inertia.
bool SupportLevel::surely_moves_on(const StatisticalBody& body, const BodyKind& kind,
                                   double still_energy) const {
  constexpr double kRounding = 1e-6;
  const double of_motion = 0.5 * body.velocity.squaredNorm(),
               of_spin = 0.5 * kind.inverse_moments[2] * body.spin.squaredNorm();
  const double length = body.orientation.squaredNorm();  // NaN spreads, too
  return of_motion > (1.0 + kRounding) * still_energy &&
         (1.0 + kRounding) * (of_motion + of_spin) < kSurelySound && is_within_limit(body.position) &&
         length > 0.9 && length < 1.1;
}

void SupportLevel::update_quiet(std::int32_t slot, std::span<const HalfSpace> faces, double time,
                                ContactTally& tally) {
  StatisticalBody& body = bodies_[std::size_t(slot)];
  const BodyKind& kind = kind_of(body);
  const bool among_others = body.crowded || double(body.since_crowded) < RestLaw::kLeaningTime;
  body.since_crowded = body.crowded ? 0.0f : body.since_crowded + float(time);
  // From what it overlaps since it came: it is not at rest, though it has no velocity, unless what moves it
  // out is kept up by what moves it in.
  constexpr double kStuck = 0.05;
  const bool parts = body.eased == kEasedTime &&
                     (body.position - last_places_[std::size_t(slot)]).norm() >
                         kStuck * parting_speed(kind.shape->radius, settings_.gravity.norm()) * time;
  body.eased = std::max(0.0f, body.eased - float(time));
  const BodyProperties& own = properties_of(body);
  govern(body, own, time);
  const double gravity = settings_.gravity.norm(),
               still_energy = rest_law_.still_energy(among_others, kind.shape->radius, gravity);
  const float still_time = rest_law_.still_time(among_others && !body.on_edge, kind.shape->radius, gravity);
  if (!own.kinematic && still_time > 0.0f && surely_moves_on(body, kind, still_energy)) {
    body.quiet_time = 0.0f;
    return;
  }
  const double energy = kinetic_energy(body, *kind.shape);
  if (!is_sound(body, energy)) recover(body, last_places_[std::size_t(slot)], tally);
  const bool still = !parts && energy < still_energy;
  follow_speed(body, std::sqrt(2.0 * energy), time);
  body.quiet_time = still ? body.quiet_time + float(time) : 0.0f;
  if (own.kinematic) {  // moved by nothing else: without a velocity it is at rest
    if (settings_.sleeping && own.allow_sleep && energy == 0.0) put_to_sleep(body);
    return;
  }
  if (!settings_.sleeping || !own.allow_sleep || body.quiet_time < still_time) return;
  if (rest_law_.sets_out(body.speed - body.rising_from, body.rising_time, still_time, gravity)) {
    body.quiet_time = 0.0f;
    return;
  }
  if (among_others || body.on_solid || stands_firmly(body, *kind.shape, join_planes(ground_.planes(), faces)))
    put_to_sleep(body);
}

void SupportLevel::govern(StatisticalBody& body, const BodyProperties& own, double time) const {
  if (own.kinematic) return;
  if (own.linear_damping > 0.0) body.velocity *= std::exp(-own.linear_damping * time);
  if (own.angular_damping > 0.0) body.spin *= std::exp(-own.angular_damping * time);
  if (own.max_angular_speed == std::numeric_limits<double>::infinity()) return;
  const double speed = angular_velocity(body.orientation, body.spin, *kind_of(body).shape).norm();
  if (speed > own.max_angular_speed) body.spin *= own.max_angular_speed / speed;
}

}  // namespace lodestone
