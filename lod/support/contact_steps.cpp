// The sequence of contact steps.
#include "lod/support/contact_steps.h"

#include <algorithm>
#include <cmath>

#include "lod/support/contact_stepper.h"

namespace lodestone {
namespace {

constexpr double kShortest = 0.25;  // over a step's time: of one that ends where an edge may be struck

// What rolls over many corners would lose energy by each that stops it a little too soon, and by what the
// solver leaves over of an edge that it turns about, which rocks it from end to end. On the few corners of a
// box solving more finely saves nothing that counts.
constexpr std::size_t kFew = 24;  // corners
constexpr double kSlow = 0.1;     // over bounce_velocity
constexpr int kSweepsOfMany = 20;
constexpr double kToleranceOfMany = 1e-3;

// At the end of all steps what has sunk into the plane that it touched last is lifted out of it.
void lift_off(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, const HalfSpace& plane,
              double time, bool rolls, const SupportSettings& settings) {
  const Shape& shape = *kind.shape;
  EnergyBound energy(body, shape, world.gravity, settings.energy_bounded && rolls);
  lift_out(body, shape, plane, world.gravity, lift_of(body, shape, world.gravity_strength(), time));
  energy.keep(world.law(kind, plane).friction == 0.0 ? std::optional(plane.normal) : std::nullopt);
}

}  // namespace

ContactStepper::ContactStepper(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                               const SupportSettings& settings, ContactTally& tally)
    : body_(body),
      kind_(kind),
      shape_(*kind.shape),
      world_(world),
      settings_(settings),
      tally_(tally),
      fall_time_(std::sqrt(shape_.radius / std::max(1e-9, world.gravity_strength()))),
      touching_(kTouching * shape_.radius),
      has_many_(shape_.hull.vertices.size() > kFew),
      slowest_((has_many_ ? kSlow : 1.0) * world.bounce_velocity) {}

void ContactStepper::run(double time) {
  constexpr int kMostSteps = 32;
  const double longest = (world_.solids ? settings_.uneven_step : settings_.contact_step) * fall_time_;
  const int steps = std::clamp(int(std::ceil(time / longest)), 1, kMostSteps);
  const double usual = time / steps;
  int divisions = 4 * steps;
  begin_bound();
  for (double left = time; left > 1e-6 * time;)
    left -= step(left / std::ceil(left / usual - 1e-9), divisions-- > 0);
  catch_up();
  keep_bound();
}

// On planes, some steps gain the energy that others lose: all of them from one strike to the next gain
// nothing but a torque's work, so they are bounded together. Over ground that is no plane each step is
// bounded, too.
void ContactStepper::begin_bound() {
  bound_.reset(), rolled_ = false;
  if (world_.turning.isZero(0.0)) bound_.emplace(body_, shape_, world_.gravity, settings_.energy_bounded);
}

void ContactStepper::keep_bound() {
  if (!bound_) return;
  if (world_.solids) return bound_->keep();
  if (rolled_) bound_->keep(frictionless_normal());
}

// Returns how long the step was, s. If `divided`, it ends where something strikes, which the next step
// answers; else it takes all of `time`, and what strikes within it bounces at once.
double ContactStepper::step(double time, bool divided) {
  const bool is_bounded = world_.solids || !bound_;
  std::optional<EnergyBound> energy;  // of this step
  const auto begin = [&] {
    if (is_bounded) energy.emplace(body_, shape_, world_.gravity, settings_.energy_bounded);
  };
  begin();
  // gravity, to the middle of this step
  kick_to(behind_ + 0.5 * time);
  OnGround on(body_, shape_);
  // what may touch; where the step ends sooner, with less of gravity
  find_contacts(on, time);
  if (divided && found_.until < time) {
    time = std::max(found_.until, kShortest * time);
    kick_to(behind_ + 0.5 * time);
    on = OnGround(body_, shape_);
  }
  if (found_.count > 0) {
    note_touched(*found_.plane[found_.count - 1]);
    // an impact where the step begins: at it positions and velocities are of the same time
    if (divided && is_struck(unkicked(on.rotation, on.motion))) {
      kick_to(0.0);
      strike(OnGround(body_, shape_));
      begin();
      kick_to(0.5 * time);
      on = OnGround(body_, shape_);
    }
    // what holds the body
    time = hold(on, time, divided);
  }
  behind_ = 0.5 * time;
  kicked_ = 0.0;
  held_.count = int(found_.count);
  held_.wedged = false;
  for (std::size_t k = 1; k < found_.count; ++k)
    held_.wedged |= found_.contact[k].normal.dot(found_.contact[0].normal) < 0.0;
  // motion
  body_.position += body_.velocity * time;
  rolled_ |= held_.rolls;
  if (held_.rolls && energy) energy->keep(frictionless_normal());
  push_out(time);
  body_.orientation = advance_orientation(body_.orientation, body_.spin, kind_, time).normalized();
  return time;
}

// Gravity and torques have acted on the velocity for `time` seconds of this step, whatever they did before:
// it may be less.
void ContactStepper::kick_to(double time) {
  body_.velocity += world_.gravity * (time - kicked_);
  body_.spin += world_.turning * (time - kicked_);
  kicked_ = time;
}

// For lift_off().
void ContactStepper::note_touched(const HalfSpace& plane) {
  const auto& planes = world_.planes;
  if (!planes.empty() && &plane >= planes.data() && &plane < planes.data() + planes.size())
    tally_.touched_plane = int(&plane - planes.data());
}

// What lies in the ground rises by a part of its depth, no faster than it may.
void ContactStepper::push_out(double time) {
  if (found_.deepest >= 0.0 || (body_.eased > 0.0f && !found_.uneven)) return;
  body_.position += std::min(push_out_overlap(found_.deepest, shape_.radius),
                             lift_of(body_, shape_, world_.gravity_strength(), time)) *
                    found_.deepest_plane->normal;
}

// The motion without what gravity and torques gave it in this step.
GroundMotion ContactStepper::unkicked(const Mat3& rotation, const GroundMotion& kicked) const {
  return {kicked.velocity - rotation.transpose() * (kicked_ * world_.gravity),
          kicked.angular_velocity -
              shape_.inverse_inertia_per_mass * (rotation.transpose() * (kicked_ * world_.turning))};
}

// The velocity catches up with the position, as far as what held the body last lets it.
void ContactStepper::catch_up() {
  const GroundMotion lagging = OnGround(body_, shape_).motion;
  kick_to(behind_);
  OnGround on(body_, shape_);
  ContactList holding;
  for (std::size_t i = 0; i < found_.count; ++i) {
    const GroundContact& c = found_.contact[i];
    if (c.rows[0].impulse <= 0.0) continue;
    const Vec3 normal = on.rotation.transpose() * found_.plane[i]->normal;
    holding.add({.normal = normal,
                 .arm = shape_.sphere_radius ? Vec3(-*shape_.sphere_radius * normal) : c.arm,
                 .law = c.law,
                 .guess = 0.5 * c.impulse()},
                found_.plane[i]);
  }
  if (holding.count == 0) return;
  hold_together(body_, shape_, on, holding.get(), settings_);
  log(on, holding.get(), holding.plane, lagging);
}

// Of the ground, if it has no friction.
std::optional<Vec3> ContactStepper::frictionless_normal() const {
  if (found_.count == 0 || found_.contact[0].law.friction != 0.0) return std::nullopt;
  return found_.plane[found_.count - 1]->normal;
}

// Writes what each contact has carried into the world's log; `before`: how the body moved against it.
void ContactStepper::log(const OnGround& on, std::span<const GroundContact> contacts,
                         std::span<const HalfSpace* const> planes, const GroundMotion& before) const {
  for (std::size_t i = 0; world_.log && i < contacts.size(); ++i)
    if (const GroundContact& c = contacts[i]; c.rows[0].impulse > 0.0)
      write_touch(body_, world_, *planes[i], on.rotation * c.arm, approach_of(before, c), c.rows[0].impulse);
}

// In a step that is divided at strikes nothing bounces. In another, what strikes within it leaves as fast as
// if it had been answered when it struck.
ContactSolverSettings ContactStepper::solver(const Mat3& rotation, double time, bool divided) const {
  ContactSolverSettings solver = settings_.solver;
  if (has_many_) solver.sweeps = kSweepsOfMany, solver.tolerance = kToleranceOfMany;
  solver.along_chords = !shape_.sphere_radius;  // whose lowest point is never the same
  solver.sliding_speed = settings_.sliding_speed * shape_.radius / fall_time_;
  solver.driven = world_.turning.isZero(0.0) ? 0.0 : kicked_ * world_.gravity_strength();
  if (divided) {
    solver.bounce_velocity = kUnbounded;
    return solver;
  }
  // What gravity adds in a step is no impact.
  solver.bounce_velocity = world_.bounce_velocity + world_.gravity_strength() * time;
  solver.fall = rotation.transpose() * (kicked_ * world_.gravity);
  solver.turned = shape_.inverse_inertia_per_mass * (rotation.transpose() * (kicked_ * world_.turning));
  return solver;
}

// The contacts give what keeps the body out of the ground for `time` seconds, or until a vertex strikes.
// Returns how long that is, s.
double ContactStepper::hold(OnGround& on, double time, bool divided) {
  GroundMotion kicked = on.motion;
  const auto solve = [&] {
    on.motion = kicked;
    solve_ground_contacts(on.motion, shape_.inverse_inertia_per_mass, found_.contacts(), time,
                          solver(on.rotation, time, divided));
  };
  solve();
  int sinks = add_sinking(body_, kind_, world_, on, time, found_);
  if (divided) {
    if (const double until = find_strike(on.rotation, kicked, sinks, time); until < time) {
      time = until;
      kick_to(behind_ + 0.5 * time);
      kicked = OnGround(body_, shape_).motion;
      solve();
      sinks = add_sinking(body_, kind_, world_, on, time, found_);
    }
  }
  if (sinks > 0) {
    held_.rolls = true;
    solve();
  }
  note_held(on, unkicked(on.rotation, kicked));
  return time;
}

// Gives the body the contacts' impulses, and keeps them for the next step.
void ContactStepper::note_held(const OnGround& on, const GroundMotion& unkicked) {
  const Vec3 velocity = body_.velocity, spin = body_.spin;
  take_impulses(body_, on, found_.contacts());
  stood_on_.count = 0;
  for (std::size_t k = 0; k < found_.count; ++k) {
    const GroundContact& c = found_.contact[k];
    if (c.rows[0].impulse > 0.0 && found_.point[k].vertex != TouchingPoint::kNoVertex)
      stood_on_.add(found_.point[k], *found_.plane[k]);
    held_.impulse[k] = {found_.point[k], c.bounces ? Vec3(Vec3::Zero()) : Vec3(on.rotation * c.impulse())};
  }
  log(on, found_.contacts(), found_.plane, unkicked);
  if (std::ranges::any_of(found_.contacts(), &GroundContact::bounces))
    clamp_energy(velocity, spin, body_, shape_, tally_);
  tally_.contacts += std::int64_t(found_.count);
}

void move_on_ground(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                    const SupportSettings& settings, ContactTally& tally) {
  ContactStepper stepper(body, kind, world, settings, tally);
  stepper.run(time);
  // Off one of two walls that lean against each other it would be lifted into the other.
  if (tally.touched_plane >= 0 && !stepper.held().wedged)
    lift_off(body, kind, world, world.planes[tally.touched_plane], time, stepper.held().rolls, settings);
}

}  // namespace lodestone
