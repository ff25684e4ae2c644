// The contacts of one body with the ground, which nothing moves: contact_solver.h's sequential impulses in
// the body's own axes, where its inertia is what its shape says.
#pragma once

#include <array>
#include <span>

#include "lod/contact/contact_solver.h"

namespace lodestone {

/// In body axes, over the body's mass.
struct GroundMotion {
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();
  Vec3 velocity_at(const Vec3& arm) const { return velocity + angular_velocity.cross(arm); }
};

struct GroundContact {
  Vec3 normal = Vec3::UnitZ();  ///< out of the ground, body axes
  Vec3 arm = Vec3::Zero();      ///< m, from the centre of mass, body axes
  double gap = 0.0;             ///< m, negative inside
  ContactLaw law = {};
  Vec3 guess = Vec3::Zero();  ///< N s over mass, body axes: what a resting contact starts from
  // Filled by the solver. Rows: the normal and two tangents.
  struct Row {
    Vec3 axis = Vec3::Zero(), lever = Vec3::Zero(), turning = Vec3::Zero();  ///< arm × axis, I⁻¹ of that
    double effective_mass = 0.0, impulse = 0.0;
    double target = 0.0;  ///< m/s, asked for along the axis
  };
  std::array<Row, 3> rows = {};
  double friction_bound = -1.0;  ///< N s over mass; negative: μ times the normal impulse as it is
  double share_across = 1.0;     ///< of that bound, across the way that the point goes
  bool bounces = false;          ///< an impact, fast enough for restitution
  Vec3 impulse() const {
    return rows[0].impulse * rows[0].axis + rows[1].impulse * rows[1].axis + rows[2].impulse * rows[2].axis;
  }
};

/// For one body of the inverse inertia `inverse_inertia` (over mass, body axes); of the
/// settings, `fall` and `turned` are in body axes.
void solve_ground_contacts(GroundMotion& motion, const Mat3& inverse_inertia,
                           std::span<GroundContact> contacts, double step,
                           const ContactSolverSettings& settings);

}  // namespace lodestone
