// The caller's boxes, convexes and simple meshes as shapes of ours, so that bodies meet them as they meet
// each other: exactly. Made as they are first touched.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "reference/ode/space_mirror.h"
#include "reference/shape.h"

namespace lodestone::ode {

class CallersShapes {
 public:
  /// After a refresh: forgets those of slots that another has taken.
  void forget(const SpaceMirror& mirror);
  /// Made of the geom of `slot` in its own frame; null where that is no solid of convex pieces.
  const Shape* find(const SpaceMirror& mirror, std::uint32_t slot);

 private:
  std::shared_ptr<const Shape> make(dxGeom* geom);
  std::shared_ptr<const Shape> box_of(const Vec3& sides);

  std::vector<std::shared_ptr<const Shape>> shapes_;  // by slot
  std::vector<bool> known_;                           // whether that has been made, or is none
  std::map<std::array<double, 3>, std::weak_ptr<const Shape>> boxes_;  // by their sides
};

}  // namespace lodestone::ode
