// What both models need to move one body that touches no other: the world it moves in, and what happened to
// it.
#pragma once

#include <span>

#include "lod/ground/ground.h"
#include "lod/statistical/acting_forces.h"
#include "lod/statistical/contact_log.h"
#include "lod/statistical/own_properties.h"
#include "lod/statistical/statistical_body.h"

namespace lodestone {

/// Constant over a step.
struct StepWorld {
  Vec3 gravity{0, 0, -9.81};
  std::span<const HalfSpace> planes = {};
  const MaterialTable* materials = nullptr;
  std::uint64_t seed = 1;
  const OwnProperties* properties = nullptr;  ///< null: nobody has any
  ContactLog* log = nullptr;                  ///< null: nobody asked
  double bounce_velocity = 0.05;              ///< m/s, ODE's: slower contacts do not bounce
  const ActingForces* forces = nullptr;       ///< on bodies of `support`; null: none
  /// m²/s²: what a torque adds to the spin of a body that moves alone. (A force is a part of its gravity.)
  Vec3 turning = Vec3::Zero();
  const Ground* solids = nullptr;  ///< parts of which are no planes to the body that moves; null: none

  const BodyProperties& properties_of(std::uint32_t owner) const {
    static const BodyProperties usual;
    return properties ? properties->of(owner) : usual;
  }

  const ActingForce& force_on(std::int32_t slot) const {
    static const ActingForce none;
    return forces ? forces->of(slot) : none;
  }
  ContactLaw law(const BodyKind& kind, const HalfSpace& plane) const {
    return materials->law(kind.material, plane.material);
  }
  double gravity_strength() const { return gravity.norm(); }
  /// Whether resting conditions apply on `plane` (3.4): gravity presses straight onto it.
  bool is_horizontal(const HalfSpace& plane) const {
    return -plane.normal.dot(gravity) > 0.9999 * gravity.norm() && gravity.norm() > 0.0;
  }
};

/// What moving one body found, summed into the step report.
struct ContactTally {
  std::int64_t contacts = 0, energy_clamps = 0, table_extrapolations = 0, states_recovered = 0;
  int touched_plane = -1;  ///< index of the plane last touched in this step, −1 for none
  ContactTally& operator+=(const ContactTally& o) {
    contacts += o.contacts, energy_clamps += o.energy_clamps, table_extrapolations += o.table_extrapolations;
    states_recovered += o.states_recovered;
    return *this;
  }
};

}  // namespace lodestone
