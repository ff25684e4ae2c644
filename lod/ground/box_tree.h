// Boxes by a tree of them.
#pragma once

#include <unsupported/Eigen/BVH>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

struct BoxTree : Eigen::KdBVH<double, 3, int> {
  using Eigen::KdBVH<double, 3, int>::KdBVH;

  /// Those that stand in boxes of the tree within `reach` m of `center`. As Eigen::BVIntersect, which makes
  /// its list of what is still to be seen anew each time.
  template <class Visit>
  void visit_near(const Vec3& center, double reach, const Visit& visit) const {
    thread_local std::vector<Index> to_see;
    to_see.assign(1, getRootIndex());
    while (!to_see.empty()) {
      VolumeIterator volume = {}, volumes_end = {};
      ObjectIterator object = {}, objects_end = {};
      getChildren(to_see.back(), volume, volumes_end, object, objects_end);
      to_see.pop_back();
      for (; volume != volumes_end; ++volume)
        if (getVolume(*volume).squaredExteriorDistance(center) <= reach * reach) to_see.push_back(*volume);
      for (; object != objects_end; ++object) visit(*object);
    }
  }
};

}  // namespace lodestone
