// What the geoms of a body of the caller's are together, as statistical bodies meet it. Made once for all
// bodies that have the like: the hull of what is round takes milliseconds, and games throw balls and spawn
// ragdolls in play.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lod/ground/ground_solids.h"
#include "reference/ode/geom_shape.h"

namespace lodestone {

/// Where a geom is on its body.
struct PlacedGeom {
  GeomShape shape;
  Vec3 offset = Vec3::Zero();  ///< m
  Quat turn = Quat::Identity();
};

struct BodyForm {
  std::shared_ptr<const Shape> shape;  ///< about the body's origin, without inertia; null: none is a solid
  std::vector<std::shared_ptr<const GroundSolids>> solids;  ///< of each geom; null: it has none
};

/// What contacts need of a body's shape, or of a convex piece of it, about `center`. Throws InputError where
/// the points lie in a plane.
Shape make_contact_shape(std::span<const Vec3> points, const Vec3& center);

class BodyForms {
 public:
  BodyForm form_of(std::vector<PlacedGeom> geoms);

 private:
  struct Known {
    std::vector<PlacedGeom> geoms;
    BodyForm form;
  };
  std::vector<Known> known_;  // of the last few that were asked for, the last one last
};

}  // namespace lodestone
