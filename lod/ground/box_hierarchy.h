// Boxes by a tree of them.
#pragma once

#include <unsupported/Eigen/BVH>
#include <vector>

#include "reference/geometry.h"
#include "reference/mesh/rays.h"

namespace lodestone {

struct BoxHierarchy : Eigen::KdBVH<double, 3, int> {
  using Eigen::KdBVH<double, 3, int>::KdBVH;

  /// Those that stand in boxes of the tree within `reach` m of `center`.
  template <class Visit>
  void visit_near(const Vec3& center, double reach, const Visit& visit) const {
    visit_in(
        [&](const Eigen::AlignedBox3d& box) { return box.squaredExteriorDistance(center) <= reach * reach; },
        visit);
  }

  /// Those that stand in boxes of the tree that a ray of unit `direction` enters within `length` m.
  template <class Visit>
  void visit_along(const Vec3& from, const Vec3& direction, double length, const Visit& visit) const {
    visit_in([&](const Eigen::AlignedBox3d& box) { return enters_box(box, 0.0, from, direction, length); },
             visit);
  }

 private:
  // As Eigen::BVIntersect, which makes its list of what is still to be seen anew each time.
  template <class Enters, class Visit>
  void visit_in(const Enters& enters, const Visit& visit) const {
    thread_local std::vector<Index> to_see;
    to_see.assign(1, getRootIndex());
    while (!to_see.empty()) {
      VolumeIterator volume = {}, volumes_end = {};
      ObjectIterator object = {}, objects_end = {};
      getChildren(to_see.back(), volume, volumes_end, object, objects_end);
      to_see.pop_back();
      for (; volume != volumes_end; ++volume)
        if (enters(getVolume(*volume))) to_see.push_back(*volume);
      for (; object != objects_end; ++object) visit(*object);
    }
  }
};

}  // namespace lodestone
