#include "lod/support/hull_impacts.h"

#include <algorithm>
#include <array>

#include "lod/contact/contact_impulse.h"

namespace lodestone {

Vec3 arm_of(const HullContact& contact, const Shape& shape, const Vec3& normal_in_body) {
  if (shape.sphere_radius) return -*shape.sphere_radius * normal_in_body;
  return shape.hull.vertices[std::size_t(contact.vertex)];
}

void take_impulses(StatisticalBody& body, const OnGround& on, std::span<const GroundContact> contacts) {
  Vec3 impulse = Vec3::Zero(), turning = Vec3::Zero();
  for (const GroundContact& c : contacts) {
    impulse += c.impulse();
    turning += c.arm.cross(c.impulse());
  }
  body.velocity += on.rotation * impulse;
  body.spin += on.rotation * turning;
}

// With s of the impulse the energy is E₀ + s (ΔE − C) + s² C, C being that of the change alone.
void clamp_energy(const Vec3& velocity_before, const Vec3& spin_before, StatisticalBody& body,
                  const Shape& shape, ContactTally& tally) {
  const Vec3 omega_before = angular_velocity(body.orientation, spin_before, shape);
  const double energy = 0.5 * (velocity_before.squaredNorm() + spin_before.dot(omega_before));
  const double gain = kinetic_energy(body, shape) - energy;
  if (gain <= 1e-12 * energy) return;
  const Vec3 velocity = body.velocity - velocity_before, spin = body.spin - spin_before;
  const double of_change =
      0.5 * (velocity.squaredNorm() + spin.dot(angular_velocity(body.orientation, spin, shape)));
  const double share = std::clamp(1.0 - gain / of_change, 0.0, 1.0);
  body.velocity = velocity_before + share * velocity;
  body.spin = spin_before + share * spin;
  ++tally.energy_clamps;
}

namespace {

void solve_at_once(StatisticalBody& body, const Shape& shape, OnGround& on, std::span<GroundContact> contacts,
                   const ContactSolverSettings& solver) {
  constexpr double kInstant = 1e-9;  // s: no gap is closed meanwhile
  solve_ground_contacts(on.motion, shape.inverse_inertia_per_mass, contacts, kInstant, solver);
  take_impulses(body, on, contacts);
}

}  // namespace

void hold_together(StatisticalBody& body, const Shape& shape, OnGround& on, std::span<GroundContact> contacts,
                   const SupportSettings& settings) {
  ContactSolverSettings solver = settings.solver;
  solver.tolerance = std::min(solver.tolerance, 1e-3);  // what is left is the velocity of a body at rest
  solver.bounce_velocity = kUnbounded;
  solve_at_once(body, shape, on, contacts, solver);
}

void respond_together(StatisticalBody& body, const Shape& shape, const StepWorld& world, OnGround& on,
                      std::span<GroundContact> contacts, const SupportSettings& settings,
                      ContactTally& tally) {
  ContactSolverSettings solver = settings.impact_solver;
  solver.bounce_velocity = world.bounce_velocity;
  const Vec3 velocity = body.velocity, spin = body.spin;
  solve_at_once(body, shape, on, contacts, solver);
  clamp_energy(velocity, spin, body, shape, tally);
}

namespace {

// One vertex strikes, all in body axes: respond_contact's impulse, less of it where that would add energy. Of
// the share s the energy is that of a parabola, s J·u + s² J·K J / 2.
void respond_alone(StatisticalBody& body, const Shape& shape, const LowestPoint& lowest,
                   const ContactLaw& law, ContactTally& tally) {
  const Quat to_body = body.orientation.conjugate();
  const Vec3 spin = to_body * body.spin;
  const Vec3 velocity = to_body * body.velocity + (shape.inverse_inertia_per_mass * spin).cross(lowest.arm);
  const Mat3 response = contact_response_matrix(1.0, shape.inverse_inertia_per_mass, lowest.arm);
  Vec3 impulse = respond_contact(response, lowest.normal, velocity, law);
  const double linear = impulse.dot(velocity), square = impulse.dot(response * impulse);
  if (linear + 0.5 * square > 1e-12 * square) {
    impulse *= std::clamp(-2.0 * linear / square, 0.0, 1.0);
    ++tally.energy_clamps;
  }
  body.velocity += body.orientation * impulse;
  body.spin += body.orientation * lowest.arm.cross(impulse);
}

}  // namespace

void respond(StatisticalBody& body, const BodyKind& kind, const LowestPoint& lowest, double approach,
             const StepWorld& world, const SupportSettings& settings, ContactTally& tally) {
  const HalfSpace& plane = world.planes[std::size_t(lowest.plane)];
  const double height = plane.height_of(body.position), radius = kind.shape->radius;
  const double sunk =
      settings.impact_lag * std::sqrt(radius / std::max(1e-9, world.gravity_strength())) * approach;
  const double margin =
      std::clamp(sunk, settings.impact_margin * radius, settings.greatest_impact_margin * radius);
  const HullContacts together = find_hull_contacts(*kind.shape, body.orientation, plane.normal, height,
                                                   lowest.gap + margin, body.support_hint);
  ++body.events;
  const ContactLaw law = world.law(kind, plane);
  if (together.count == 1) return respond_alone(body, *kind.shape, lowest, law, tally);
  OnGround on(body, *kind.shape);
  const Vec3 normal_in_body = on.rotation.transpose() * plane.normal;
  std::array<GroundContact, kMaxGroundContacts> all;
  const auto contacts = std::span(all).first(std::size_t(together.count));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts[i].normal = normal_in_body;
    contacts[i].arm = arm_of(together.contact[i], *kind.shape, normal_in_body);
    contacts[i].law = law;
  }
  respond_together(body, *kind.shape, world, on, contacts, settings, tally);
}

void write_touch(const StatisticalBody& body, const StepWorld& world, const HalfSpace& ground,
                 const Vec3& arm, double approach, double impulse) {
  world.log->add({.first = body.owner,
                  .ground = ground.id,
                  .ground_material = ground.material,
                  .point = body.position + arm,
                  .normal = ground.normal,
                  .impulse = body.mass * impulse,
                  .approach = std::max(0.0, approach)});
}

}  // namespace lodestone
