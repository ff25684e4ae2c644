// A hull strikes the ground: ODE's law at the vertex that strikes, or at all that strike together, and never
// more energy after than before. Impulses are over the body's mass.
#pragma once

#include <span>

#include "lod/contact/ground_solver.h"
#include "lod/contact/hull_contacts.h"
#include "lod/statistical/step_world.h"
#include "lod/support/hull_flight.h"
#include "lod/support/support_settings.h"

namespace lodestone {

/// A body that moves against the ground, in its own axes.
struct OnGround {
  Mat3 rotation;  ///< body axes to the world's
  GroundMotion motion;
  OnGround(const StatisticalBody& body, const Shape& shape) : rotation(body.orientation.toRotationMatrix()) {
    motion.velocity = rotation.transpose() * body.velocity;
    motion.angular_velocity = shape.inverse_inertia_per_mass * (rotation.transpose() * body.spin);
  }
};

/// m, from the centre of mass, body axes.
Vec3 arm_of(const HullContact& contact, const Shape& shape, const Vec3& normal_in_body);

/// What the contacts gave it.
void take_impulses(StatisticalBody& body, const OnGround& on, std::span<const GroundContact> contacts);

/// All of `contacts` keep `body` from moving into the ground at once, and do not bounce.
void hold_together(StatisticalBody& body, const Shape& shape, OnGround& on, std::span<GroundContact> contacts,
                   const SupportSettings& settings);

/// All of `contacts` strike at once, an edge, a face or more: what solves that acts on the body and on `on`.
void respond_together(StatisticalBody& body, const Shape& shape, const StepWorld& world, OnGround& on,
                      std::span<GroundContact> contacts, const SupportSettings& settings,
                      ContactTally& tally);

/// `lowest` strikes, and with it what is about to.
void respond(StatisticalBody& body, const BodyKind& kind, const LowestPoint& lowest, double approach,
             const StepWorld& world, const SupportSettings& settings, ContactTally& tally);

/// Scales the impulse that gave `body` its motion down until it adds no energy, as ODE's own law does in some
/// hits of high restitution.
void clamp_energy(const Vec3& velocity_before, const Vec3& spin_before, StatisticalBody& body,
                  const Shape& shape, ContactTally& tally);

/// Into the world's log.
void write_touch(const StatisticalBody& body, const StepWorld& world, const HalfSpace& ground,
                 const Vec3& arm, double approach, double impulse);

}  // namespace lodestone
