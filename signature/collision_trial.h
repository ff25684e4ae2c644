// One collision of a body with a plane, found exactly and answered by ODE: the trials behind the tables of sections 3.2.1 and 3.2.2.
// No gravity, as in the paper.
#pragma once

#include "reference/ode/ode_world.h"
#include "signature/signature.h"

namespace lodestone {

/// Moves a body above the plane z = 0 along its free, weightless flight to where its hull first touches, by conservative advancement
/// (Mirtich, Impulse-based dynamic simulation, 1996): no step is longer than the gap over the greatest speed of any point. False where it never
/// comes near enough to touch.
bool advance_to_contact(const Shape& shape, RigidState& state);

/// Where in the table a trial starts: angles in rad.
struct CollisionConfiguration {
  double theta = 0.0, phi = 0.0, alpha = 0.0;
};

/// What a trial gave.
struct CollisionOutcome {
  Response response = Response::Zero();  ///< (V_rigid − V_particle)/s and RΩ⁺/s in (e1, e2, e3)
  bool moves_into_plane = false;         ///< the lowest point, at the end, still does
  double energy_ratio = 1.0;             ///< kinetic, after over before
};

/// A world with one body and the plane z = 0, used again for every trial of a thread. Speeds are near 1 m/s and R is the shape's own.
class CollisionTrial {
 public:
  CollisionTrial(std::shared_ptr<const Shape> shape, const ContactLaw& law, TrialEnd end);

  /// Trial `trial` of cell `cell`: orientation and azimuth ψ of Ω⁻ drawn from the key (seed, cell, trial). None where it missed the plane.
  std::optional<CollisionOutcome> run(const CollisionConfiguration& configuration, std::uint64_t seed, std::uint64_t cell, std::uint32_t trial);

 private:
  std::shared_ptr<const Shape> shape_;
  ContactLaw law_;
  TrialEnd end_;
  std::unique_ptr<MaterialTable> materials_;
  OdeWorld world_;
  OdeBodyId body_;
};

}  // namespace lodestone
