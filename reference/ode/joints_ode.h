// Contact joints: what ODE's solver is told about a contact.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "reference/ode/contact_filter.h"
#include "reference/ode/contact_graph.h"
#include "reference/ode/ode_world.h"
#include "reference/ode/runtime_ode.h"
#include "reference/state_archive.h"

namespace lodestone::ode {

class Touches;

/// Part of the constraint force mixing that a body of `mass` (kg) is given: of much more than the inverse of
/// its mass over the step, its contacts would be soft.
inline double cfm_share(double mass) { return std::min(1.0, 100.0 / mass); }

/// The same upwards: of a body below a kilogram as much for its mass as one of a kilogram has. Less would be
/// lost in rounding, and the solver would give up (five boxes of 10 mg: in 128 of 150 piles; so in 2).
inline double light_share(double mass) { return std::max(1.0, 1.0 / mass); }

/// How a surface that nothing can push moves.
struct SurfaceMotion {
  Vec3 center = Vec3::Zero(), velocity = Vec3::Zero(),
       angular_velocity = Vec3::Zero();  ///< m, m/s and rad/s, world
  Vec3 velocity_at(const Vec3& point) const { return velocity + angular_velocity.cross(point - center); }
};

/// One of the two bodies at a contact; `body` null for static ground, and for ground or a kinematic body that
/// moves.
struct ContactSide {
  dBodyID body = nullptr;
  MaterialId material = 0;
  OdeBodyId id{};  ///< null where the body is not this world's
  std::optional<SurfaceMotion> motion = {};
  bool moves = false;  ///< does so, or was moved before this step
  dGeomID callers_geom = nullptr;
  OdeGroundId ground = {};
  dBodyID kinematic = nullptr;     ///< the body, where it is one
  std::int32_t callers_slot = -1;  ///< in the mirror, of a geom of a dynamic body of the caller's
  /// m, by which what has no motion is put on in each step: so deep it may be in others for a moment, and
  /// pushes them as fast as it goes.
  double way_on = 0.0;
};

/// `body` as a side: one that is kinematic is a surface that moves. ODE would else make one island of all
/// that lies on it.
ContactSide side_of(dBodyID body, MaterialId material, OdeBodyId id, dGeomID callers_geom = nullptr);

/// How fast what overlaps is pushed apart.
struct Pushing {
  double per_depth;  ///< 1/s
  double most;       ///< m/s, but by ground that is put on
  double speed_of(const OdeContact& contact) const {
    const double speed = per_depth * contact.depth;
    return contact.moves ? speed : std::min(speed, most);
  }
};

/// The contact joints of one substep.
class ContactJoints {
 public:
  ContactJoints(dWorldID world, const OdeSettings& settings, const MaterialTable& materials);
  ~ContactJoints();
  ContactJoints(const ContactJoints&) = delete;
  ContactJoints& operator=(const ContactJoints&) = delete;

  static constexpr int kMostAttempts = 6;
  /// Forgets the last substep's contacts; the next are for a step of `h` seconds. From one attempt at a step
  /// to the next (0 … kMostAttempts − 1) the contacts are a little softer and their depths a little more
  /// uneven. `surface_layer`, of g h²: overlap that is not pushed apart.
  void begin(double h, int attempt, double surface_layer);
  /// Depths may be negative by what bodies at rest are left to overlap (kRestingDepth).
  void add(const ContactSide& first, const ContactSide& second, std::span<const ContactPoint> points);
  /// Destroys the joints; contacts() stays.
  void end() { dJointGroupEmpty(group_), graph_.clear(); }

  /// Who is told of every contact; null: nobody.
  void tell(Touches* touches) { touches_ = touches; }

  const Vec3& gravity() const { return gravity_; }
  Pushing pushing() const { return {joint_.surface.soft_erp / h_, max_correcting_velocity_}; }
  ContactLaw law(MaterialId first, MaterialId second) const { return materials_->law(first, second); }
  void check_known(MaterialId material) const { materials_->check_known(material); }  ///< throws InputError
  std::span<const OdeContact> contacts() const { return contacts_; }
  /// Bodies that touch a surface that moves, in no order.
  std::span<const dBodyID> carried() const { return carried_; }
  const ContactGraph& graph() const { return graph_; }
  /// Whether bodies that touch differ twelvefold and more in mass.
  bool is_uneven() const { return is_uneven_; }
  std::int64_t made() const { return made_; }
  void archive(StateArchive& a) { a(contacts_); }
  void forget() { contacts_.clear(); }

 private:
  void add_joint(const ContactSide& first, const ContactSide& second, const ContactPoint& point);
  double depth_of(const ContactPoint& point) const;
  Vec3 carrying_velocity(const SurfaceMotion& carrier, dBodyID rider, const Vec3& point) const;
  void move_surface(const Vec3& velocity, const ContactPoint& point, bool turned);
  double approach_of(const ContactSide& first, const ContactSide& second, const ContactPoint& point) const;
  Vec3 slip_direction(const ContactSide& first, const ContactSide& second, const ContactPoint& point) const;
  Vec3 unhindered_velocity(const ContactSide& side, const Vec3& point) const;
  double share_across(const ContactSide& first, const ContactSide& second, const ContactPoint& point) const;

  dWorldID world_;
  dJointGroupID group_;
  const MaterialTable* materials_;
  dContact joint_{};  // what every contact has in common is filled in once
  int mode_;          // of every contact
  bool slides_straight_;
  double erp_, cfm_, max_correcting_velocity_, correcting_time_, attempt_cfm_ = 0.0;
  double h_ = 0.0, deepest_ = 0.0, unevenness_ = 0.0, unpushed_ = 0.0;
  Vec3 gravity_ = Vec3::Zero();
  Touches* touches_ = nullptr;
  std::vector<OdeContact> contacts_;
  std::vector<dBodyID> carried_;
  ContactGraph graph_;
  bool is_uneven_ = false;
  std::int64_t made_ = 0;
};

}  // namespace lodestone::ode
