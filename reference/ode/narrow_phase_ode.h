// Contact points of two ODE geoms; those of two trimeshes made believable (contact_filter.h).
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "reference/ode/contact_filter.h"
#include "reference/ode/runtime_ode.h"

namespace lodestone::ode {

/// × size: overlap that is left to meshes at rest on each other, so that they still overlap in the next step
/// (in OPCODE's float arithmetic, too) and their contacts stay.
inline constexpr double kRestingDepth = 1e-4;

class NarrowPhase {
  struct Exit {
    double distance;
    Vec3 normal;  // of the face, outward
  };

 public:
  /// `most_measures`: of a pair of meshes, see filter_contacts.
  explicit NarrowPhase(bool filtered = true, int most_measures = std::numeric_limits<int>::max());
  ~NarrowPhase();
  NarrowPhase(const NarrowPhase&) = delete;
  NarrowPhase& operator=(const NarrowPhase&) = delete;

  /// Appends the contacts of `first` with `second`, normals into `first`, depths less what bodies at rest are
  /// left to overlap. `size`: the smaller body's radius (m). Locks where ODE needs it.
  void find(dGeomID first, dGeomID second, double size, std::vector<ContactPoint>& points);

 private:
  void find_of_meshes(dGeomID first, dGeomID second, double size, std::vector<ContactPoint>& points);
  int collide_meshes(dGeomID first, dGeomID second);
  void place(dGeomID first, dGeomID second, const Vec3& origin);
  std::optional<WayOut> measure_way_out(const Vec3& place, const Vec3& direction, double longest) const;
  std::optional<Exit> find_exit(int which, const Vec3& place, const Vec3& direction) const;
  std::optional<Exit> cast_ray(dGeomID mesh, const Vec3& point, const Vec3& direction) const;

  std::vector<dContactGeom> found_;
  std::array<dGeomID, 2> local_{};  // the two trimeshes at hand, about origin_
  dGeomID ray_;
  Vec3 origin_ = Vec3::Zero();
  double size_ = 0.0;
  bool filtered_;
  int most_measures_;
};

}  // namespace lodestone::ode
