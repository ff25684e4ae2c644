// Contacts of bodies with a caller's height field. ODE's own trimeshes, and spheres too, now and then miss
// one, and then sink through it. Here each corner of the hull, and of a sphere its lowest points, asks by a
// ray from above how deep it is: what the statistical rungs do as well, so that a change of rung moves
// nothing. A peak that comes up between the corners of a face is not met until a corner is.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "reference/contact_point.h"
#include "reference/ode/bodies_ode.h"
#include "reference/ode/geom_shape.h"

namespace lodestone::ode {

class HeightFieldContacts {
 public:
  /// Appends to `points`; normals point out of the ground.
  void find(const Body& body, dGeomID field, std::vector<ContactPoint>& points);

 private:
  struct Above {
    dGeomID field;
    Vec3 up;       ///< unit, world
    double reach;  ///< m: how deep a point can be
  };
  std::optional<ContactPoint> find_depth(const Above& above, const Vec3& point);
  void find_of_corners(const Body& body, const RigidState& at, const Above& above,
                       std::vector<ContactPoint>& points);
  void find_of_sphere(const Vec3& center, double radius, const Above& above,
                      std::vector<ContactPoint>& points);

  GeomProbe probe_;
};

}  // namespace lodestone::ode
