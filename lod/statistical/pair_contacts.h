// Where two statistical bodies meet: a shared normal and shared points.
#pragma once

#include <optional>
#include <span>

#include "lod/body.h"
#include "lod/statistical/contact_manifold.h"
#include "signature/signature.h"

namespace lodestone {

/// A body as pair contacts see it, of either level.
struct PairBody {
  const Shape* shape = nullptr;
  const Signature* signature = nullptr;  ///< its rest normals are tried as separating axes; may be null
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  double sphere_radius = 0.0;            ///< m, `tables`: of the colliding sphere
  std::span<const Vec3> face_normals = {};  ///< outward, body axes: tried as separating axes, too
};

struct PairContact {
  Vec3 normal = Vec3::UnitZ();  ///< from the second body into the first
  double gap = 0.0;             ///< m, the least; negative where they overlap
  Manifold manifold;            ///< one to four points that both bodies share, world
};

/// `tables`: the two spheres. None where the gap is above `margin`.
std::optional<PairContact> find_sphere_contact(const PairBody& first, const PairBody& second, double margin);

/// Two hulls along the axis of greatest separation that was found.
struct HullContactSearch {
  Vec3 normal = Vec3::UnitZ();         ///< from the second body to the first
  double gap = 0.0;                    ///< m along it: the true distance is at least this
  std::optional<PairContact> contact;  ///< where the gap is at most the margin
};

/// `support`: searches from the centre line and both bodies' rest normals; `start`, where not zero, is an axis that may still separate them, and refines by steps up the
/// separation's gradient (as in Gilbert, An iterative procedure for computing the minimum of a quadratic form, 1966).
HullContactSearch find_hull_contact(const PairBody& first, const PairBody& second, const Vec3& start, double margin);

/// Contact of the two hulls along a given axis (unit, from `second` into `first`); none where the gap along it is above `margin` or the touching features do not
/// overlap across it.
std::optional<PairContact> find_contact_along(const PairBody& first, const PairBody& second, const Vec3& normal, double margin);

}  // namespace lodestone
