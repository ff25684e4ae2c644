// The maps of one hull.
#pragma once

#include <vector>

#include "lod/tables/hull_heights.h"

namespace lodestone::testing {

struct Maps {
  explicit Maps(const Shape& shape) {
    sample_hull(shape, {heights, pair_heights, patches, faces});
    const RestingFaces stands(shape.hull);
    find_unsteady(shape.sphere_radius ? nullptr : &stands, faces, unsteady);
  }
  static double read(const std::vector<float>& map, const Vec3& direction) {
    return double(
        read_hull_height(map.data(), 0, {float(direction.x()), float(direction.y()), float(direction.z())}));
  }
  std::vector<float> heights = std::vector<float>(kHullHeights), pair_heights = heights;
  std::vector<float> unsteady = heights;
  std::vector<SupportPatch> patches = std::vector<SupportPatch>(kHullHeights);
  std::vector<lane::Row> faces = std::vector<lane::Row>(kHullHeights);
};

}  // namespace lodestone::testing
