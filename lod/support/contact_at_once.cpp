#include "lod/support/contact_at_once.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "lod/statistical/flight.h"
#include "lod/support/hull_impacts.h"
#include "lod/support/step_contacts.h"

namespace lodestone {
namespace {

/// What may touch within the step, and which plane.
struct PointsOnPlanes {
  static constexpr std::size_t kCapacity = kMostPlanesAtOnce * kMaxGroundContacts;
  std::array<GroundContact, kCapacity> contact;
  std::array<int, kCapacity> plane;
  std::size_t count = 0;
  std::span<GroundContact> contacts() { return std::span(contact).first(count); }
};

// `on`: with what gravity gives it in the step.
void find_points_on_planes(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                           const OnGround& on, double time, double least_margin, PointsOnPlanes& found) {
  const Shape& shape = *kind.shape;
  found.count = 0;
  for (int i = 0; i < int(world.planes.size()); ++i) {
    if (found.count + kMaxGroundContacts > PointsOnPlanes::kCapacity) return;
    const HalfSpace& plane = world.planes[std::size_t(i)];
    visit_vertices_near(plane, body, shape, on, time, least_margin,
                        [&](const HullContact& contact, const Vec3& normal) {
                          found.plane[found.count] = i;
                          found.contact[found.count++] = {.normal = normal,
                                                          .arm = arm_of(contact, shape, normal),
                                                          .gap = contact.gap,
                                                          .law = world.law(kind, plane)};
                        });
  }
}

// What each has carried.
void log(const StatisticalBody& body, const StepWorld& world, const OnGround& on, const GroundMotion& before,
         const PointsOnPlanes& found) {
  for (std::size_t i = 0; world.log && i < found.count; ++i)
    if (const GroundContact& c = found.contact[i]; c.rows[0].impulse > 0.0)
      write_touch(body, world, world.planes[std::size_t(found.plane[i])], on.rotation * c.arm,
                  -before.velocity_at(c.arm).dot(c.normal), c.rows[0].impulse);
}

/// `kick`: s, for which gravity acts before; the velocity is then that in the middle of the step.
void step_at_once(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                  double kick, const SupportSettings& settings, PointsOnPlanes& found, ContactTally& tally) {
  const Shape& shape = *kind.shape;
  const Vec3 velocity = body.velocity, spin = body.spin;
  body.velocity += world.gravity * kick;
  body.spin += world.turning * kick;
  OnGround on(body, shape);
  find_points_on_planes(body, kind, world, on, time, settings.contact_margin * shape.radius, found);
  if (const auto contacts = found.contacts(); !contacts.empty()) {
    ContactSolverSettings solver = settings.solver;
    solver.along_chords = true;
    solver.sliding_speed = settings.sliding_speed * std::sqrt(shape.radius * world.gravity_strength());
    // What gravity gives it in a step is no impact.
    solver.bounce_velocity = world.bounce_velocity + world.gravity_strength() * time;
    solver.fall = on.rotation.transpose() * (kick * world.gravity);
    solver.driven = world.turning.isZero(0.0) ? 0.0 : kick * world.gravity_strength();
    solver.turned = shape.inverse_inertia_per_mass * (on.rotation.transpose() * (kick * world.turning));
    // Most of the contacts lie under its weight: each begins with its share.
    const double weight = kick * world.gravity_strength() / double(contacts.size());
    for (GroundContact& c : contacts) c.guess = weight * c.normal;
    const GroundMotion before = on.motion;
    solve_ground_contacts(on.motion, shape.inverse_inertia_per_mass, contacts, time, solver);
    take_impulses(body, on, contacts);
    if (std::ranges::any_of(contacts, &GroundContact::bounces))
      clamp_energy(velocity, spin, body, shape, tally);
    log(body, world, on, before, found);
    tally.touched_plane = found.plane[found.count - 1];
    tally.contacts += std::int64_t(found.count);
  }
  body.position += body.velocity * time;
  body.orientation =
      (settings.coarse
           ? turned_shortly(body.orientation, find_own_turning(body.orientation, body.spin, shape), time)
           : advance_orientation(body.orientation, body.spin, kind, time))
          .normalized();
  if (tally.touched_plane >= 0)  // the ground has the last word
    lift_out(body, shape, world.planes[std::size_t(tally.touched_plane)], world.gravity,
             lift_of(body, shape, world.gravity_strength(), time));
}

// By what has held the body last.
void catch_up(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double kick,
              const SupportSettings& settings, PointsOnPlanes& found) {
  const Shape& shape = *kind.shape;
  const GroundMotion before = OnGround(body, shape).motion;
  body.velocity += world.gravity * kick;
  body.spin += world.turning * kick;
  OnGround on(body, shape);
  std::size_t held = 0;
  for (std::size_t i = 0; i < found.count; ++i) {
    const GroundContact& c = found.contact[i];
    if (c.rows[0].impulse <= 0.0) continue;
    const Vec3 guess = 0.5 * c.impulse();
    found.plane[held] = found.plane[i];
    found.contact[held++] = {
        .normal = on.rotation.transpose() * world.planes[std::size_t(found.plane[i])].normal,
        .arm = c.arm,
        .law = c.law,
        .guess = guess};
  }
  found.count = held;
  if (found.count == 0) return;
  hold_together(body, shape, on, found.contacts(), settings);
  log(body, world, on, before, found);
}

}  // namespace

void move_on_planes_at_once(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                            const SupportSettings& settings, ContactTally& tally) {
  constexpr double kMostSteps = 32.0;
  const double fall_time = std::sqrt(kind.shape->radius / std::max(1e-9, world.gravity_strength()));  // s
  const int steps = int(std::clamp(std::ceil(time / (settings.step_at_once * fall_time)), 1.0, kMostSteps));
  const double each = time / steps;
  thread_local PointsOnPlanes found;  // since to make all of them takes longer than to solve a few
  for (int step = 0; step < steps; ++step)
    step_at_once(body, kind, world, each, step == 0 && !settings.coarse ? 0.5 * each : each, settings, found,
                 tally);
  if (!settings.coarse) catch_up(body, kind, world, 0.5 * each, settings, found);
}

}  // namespace lodestone
