// Contact points of two ODE geoms; those of two trimeshes without the false ones (contact_filter.h).
#pragma once

#include <vector>

#include "reference/contact_filter.h"
#include "reference/runtime_ode.h"

namespace lodestone::ode {

class NarrowPhase {
 public:
  /// Appends the contacts of `first` with `second`, normals into `first`. `size`: the smaller body's radius (m). Locks where ODE needs it.
  void find(dGeomID first, dGeomID second, double size, std::vector<ContactPoint>& points);

 private:
  std::vector<dContactGeom> found_;
};

/// Whether `point` lies inside the closed trimesh `mesh`, told by the side of the first face met along `direction` within `reach` m.
/// Not locked.
bool is_inside(dGeomID mesh, const Vec3& point, const Vec3& direction, double reach);

}  // namespace lodestone::ode
