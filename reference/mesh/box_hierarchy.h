// Boxes in a tree of boxes, to be asked which of them something meets. Made once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "reference/geometry.h"
#include "reference/mesh/rays.h"

namespace lodestone {

/// m, no smaller than what it stands for.
struct FloatBox {
  std::array<float, 3> least = {}, greatest = {};
  operator Eigen::AlignedBox3d() const {
    return {Vec3(least[0], least[1], least[2]), Vec3(greatest[0], greatest[1], greatest[2])};
  }
};

class BoxHierarchy {
 public:
  using Box = Eigen::AlignedBox3d;

  BoxHierarchy() = default;  ///< of none
  explicit BoxHierarchy(std::span<const Box> boxes);

  bool empty() const { return nodes_.empty(); }

  /// The places of those boxes that stand in boxes of the tree (FloatBox) which `enters`: some of them may be
  /// beside it. Those that come one after the other lie side by side.
  template <class Enters, class Visit>
  void visit_places(const Enters& enters, const Visit& visit) const {
    std::array<std::int32_t, 64> to_see;  // of halves: no two to the 64th boxes
    std::size_t left = 0;
    if (!empty() && enters(nodes_[0].box)) to_see[left++] = 0;
    while (left > 0) {
      const Node& node = nodes_[std::size_t(to_see[--left])];
      if (node.count == 0) {
        for (std::int32_t child = node.first; child < node.first + 2; ++child)
          if (enters(nodes_[std::size_t(child)].box)) to_see[left++] = child;
        continue;
      }
      for (std::int32_t place = node.first; place < node.first + node.count; ++place) visit(place);
    }
  }
  /// Of the box at a place, among those that it was made of.
  std::int32_t number_at(std::int32_t place) const { return numbers_[std::size_t(place)]; }

  /// The numbers of those within `reach` m of `center`, and a few more, in no order.
  template <class Visit>
  void visit_near(const Vec3& center, double reach, const Visit& visited) const {
    visit_places([&](const Box& box) { return box.squaredExteriorDistance(center) <= reach * reach; },
                 [&](std::int32_t place) { visited(number_at(place)); });
  }
  /// Of those within `margin` m of which a ray of unit `direction` comes before `length` m, which may become
  /// less meanwhile.
  template <class Visit>
  void visit_along(const Vec3& from, const Vec3& direction, const double& length, double margin,
                   const Visit& visited) const {
    visit_places([&](const Box& box) { return enters_box(box, margin, from, direction, length); },
                 [&](std::int32_t place) { visited(number_at(place)); });
  }

 private:
  struct Node {
    FloatBox box = {};
    std::int32_t first = 0, count = 0;  // places; count 0: inner, its children are first and the next
  };
  void split(std::size_t node, std::span<const Box> boxes);

  std::vector<Node> nodes_;
  std::vector<std::int32_t> numbers_;  // of the boxes, by their places
};

}  // namespace lodestone
