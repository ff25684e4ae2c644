// One collision of a body with a plane, found exactly and answered by ODE: the trials behind the tables of
// section 3.2.2. No gravity, as in the paper.
#pragma once

#include <memory>
#include <optional>

#include "reference/ode/ode_world.h"
#include "signature/measure/contact_time.h"
#include "signature/signature.h"

namespace lodestone {

/// How a body has moved after an impulse.
struct CollisionEnd {
  Response response = Response::Zero();  ///< (V_rigid − V_particle)/s and RΩ⁺/s in (e1, e2, e3)
  double energy_ratio = 1.0;             ///< kinetic, after over before
  bool moves_into_plane = false;         ///< its centre of mass still does
};

/// What a trial gave.
struct CollisionOutcome {
  CollisionEnd first;     ///< after the first impulse
  CollisionEnd end;       ///< where the trial ends
  double approach = 0.0;  ///< of the contact point towards the plane before the first impulse, over s
  int impulses = 1;
};

/// A world with one body and the plane z = 0, used again for every trial of a thread.
class CollisionTrial {
 public:
  /// `bounce_velocity`: ODE's, m/s; an approach slower than that has restitution 0.
  CollisionTrial(std::shared_ptr<const Shape> shape, const ContactLaw& law, TrialEnd end,
                 double bounce_velocity);

  /// A body of this orientation, its bounding sphere touching the plane, and what comes of it. None where it
  /// never touches the plane.
  std::optional<CollisionOutcome> run(const CollisionConfiguration& configuration, const Quat& orientation);

  /// The same from any state above the plane; `state` ends as the trial does.
  std::optional<CollisionOutcome> collide(RigidState& state);

 private:
  struct Before {
    double speed_unit, energy;  // s, m/s; J/kg
    Vec3 particle;              // V_particle
  };
  void answer_contact(RigidState& state, double speed_unit);
  CollisionEnd describe(const RigidState& state, const Before& before) const;

  std::shared_ptr<const Shape> shape_;
  ContactLaw law_;
  TrialEnd end_;
  std::unique_ptr<MaterialTable> materials_;
  ContactTime contact_time_;
  OdeWorld world_;
  OdeBodyId body_;
};

}  // namespace lodestone
