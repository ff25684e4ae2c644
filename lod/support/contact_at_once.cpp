#include "lod/support/contact_at_once.h"

#include <algorithm>
#include <array>
#include <span>

#include "lod/statistical/flight.h"
#include "lod/support/step_contacts.h"

namespace lodestone {
namespace {

/// What may touch within the step, and which plane.
struct PointsOnPlanes {
  static constexpr std::size_t kCapacity = 2 * kMaxGroundContacts;  // of two planes
  std::array<GroundContact, kCapacity> contact;
  std::array<int, kCapacity> plane;
  std::size_t count = 0;
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

}  // namespace

void move_on_planes_at_once(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                            const SupportSettings& settings, ContactTally& tally) {
  const Shape& shape = *kind.shape;
  const Vec3 velocity = body.velocity, spin = body.spin;
  body.velocity += world.gravity * time;
  body.spin += world.turning * time;
  OnGround on(body, shape);
  thread_local PointsOnPlanes found;  // since to make all of them takes longer than to solve a few
  find_points_on_planes(body, kind, world, on, time, settings.contact_margin * shape.radius, found);
  if (const auto contacts = std::span(found.contact).first(found.count); !contacts.empty()) {
    ContactSolverSettings solver = settings.solver;
    solver.along_chords = true;
    // What gravity gives it in a step is no impact.
    solver.bounce_velocity = world.bounce_velocity + world.gravity_strength() * time;
    solver.fall = on.rotation.transpose() * (time * world.gravity);
    // Most of the contacts lie under its weight: each begins with its share.
    const double weight = time * world.gravity_strength() / double(contacts.size());
    for (GroundContact& c : contacts) c.guess = weight * c.normal;
    const GroundMotion before = on.motion;
    solve_ground_contacts(on.motion, shape.inverse_inertia_per_mass, contacts, time, solver);
    take_impulses(body, on, contacts);
    if (std::ranges::any_of(contacts, &GroundContact::bounces))
      clamp_energy(velocity, spin, body, shape, tally);
    for (std::size_t i = 0; world.log && i < contacts.size(); ++i)
      if (const GroundContact& c = contacts[i]; c.rows[0].impulse > 0.0)
        write_touch(body, world, world.planes[std::size_t(found.plane[i])], on.rotation * c.arm,
                    -before.velocity_at(c.arm).dot(c.normal), c.rows[0].impulse);
    tally.touched_plane = found.plane[found.count - 1];
    tally.contacts += std::int64_t(found.count);
  }
  body.position += body.velocity * time;
  body.orientation =
      turned_shortly(body.orientation, find_own_turning(body.orientation, body.spin, shape), time)
          .normalized();
  if (tally.touched_plane >= 0)  // the ground has the last word
    lift_out(body, shape, world.planes[std::size_t(tally.touched_plane)], world.gravity,
             lift_of(body, shape, world.gravity_strength(), time));
}

}  // namespace lodestone
