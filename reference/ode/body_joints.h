// The joints that a caller has put on an ODE body, and those of a scene.
#pragma once

#include <vector>

#include "reference/geometry.h"

struct dxBody;

namespace lodestone {

/// The bodies that `body` is joined to, one for each joint; null for the world. Contact joints are left out.
/// To be asked outside of a step.
std::vector<dxBody*> joined_bodies(dxBody* body);
/// Whether there are any.
bool has_joints(dxBody* body);

enum class JointKind { ball, hinge };

/// Joins `first` to `second`, or to the world where that is null, as they are now, at `anchor` (m, world);
/// `axis` (unit, world) is a hinge's. The joint is the world's, which destroys it.
void join_bodies(dxBody* first, dxBody* second, JointKind kind, const Vec3& anchor,
                 const Vec3& axis = Vec3::UnitZ());

}  // namespace lodestone
