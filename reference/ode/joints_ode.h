// Contact joints: what ODE's solver is told about a contact.
#pragma once

#include <vector>

#include "reference/ode/contact_filter.h"
#include "reference/ode/ode_world.h"
#include "reference/ode/runtime_ode.h"

namespace lodestone::ode {

/// Part of the constraint force mixing that a body of `mass` (kg) is given: of much more than the inverse of its mass over the step, its contacts would be soft.
inline double cfm_share(double mass) { return std::min(1.0, 100.0 / mass); }

/// One of the two bodies at a contact; `body` null for static ground.
struct ContactSide {
  dBodyID body = nullptr;
  MaterialId material = 0;
  OdeBodyId id{};  ///< null where the body is not this world's
};

/// The contact joints of one substep.
class ContactJoints {
 public:
  ContactJoints(dWorldID world, const OdeSettings& settings, const MaterialTable& materials);
  ~ContactJoints();
  ContactJoints(const ContactJoints&) = delete;
  ContactJoints& operator=(const ContactJoints&) = delete;

  /// Forgets the last substep's contacts; the next are for a step of `h` seconds. From one attempt at a step to the next (0, 1, …) the contacts
  /// are a little softer and their depths a little more uneven.
  void begin(double h, int attempt);
  /// Depths may be negative by what bodies at rest are left to overlap (kRestingDepth).
  void add(const ContactSide& first, const ContactSide& second, std::span<const ContactPoint> points);
  /// Destroys the joints; contacts() stays.
  void end() { dJointGroupEmpty(group_); }

  const Vec3& gravity() const { return gravity_; }
  ContactLaw law(MaterialId first, MaterialId second) const { return materials_->law(first, second); }
  std::span<const OdeContact> contacts() const { return contacts_; }
  std::int64_t made() const { return made_; }

 private:
  void add_joint(const ContactSide& first, const ContactSide& second, const ContactPoint& point);
  double depth_of(const ContactPoint& point) const;
  Vec3 slip_direction(dBodyID first, dBodyID second, const ContactPoint& point) const;
  Vec3 unhindered_velocity(dBodyID body, const Vec3& point) const;

  dWorldID world_;
  dJointGroupID group_;
  const MaterialTable* materials_;
  dContact joint_{};  // what every contact has in common is filled in once
  double erp_, cfm_, max_correcting_velocity_, attempt_cfm_ = 0.0;
  double h_ = 0.0, deepest_ = 0.0, unevenness_ = 0.0;
  Vec3 gravity_ = Vec3::Zero();
  std::vector<OdeContact> contacts_;
  std::int64_t made_ = 0;
};

}  // namespace lodestone::ode
