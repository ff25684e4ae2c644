// Boxes by number, some of which move: which of them meet a box.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lodestone {

/// An R-tree. What moves is held in a box a little larger than itself, so that most moves leave the tree as
/// it is.
class BoxTree {
 public:
  BoxTree();
  ~BoxTree();
  BoxTree(const BoxTree&) = delete;
  BoxTree& operator=(const BoxTree&) = delete;

  struct Entry {
    std::uint32_t number;
    Eigen::AlignedBox3d box;  ///< m; one that is not finite is kept apart
  };

  /// Numbers that are not in the tree. At once where they are many.
  void add(std::span<const Entry> entries);
  void remove(std::uint32_t number);
  /// From `before` to `now`; the next moves are taken to be alike.
  void move(std::uint32_t number, const Eigen::AlignedBox3d& before, const Eigen::AlignedBox3d& now);

  /// Appends every number whose box meets `box`, and a few whose box nearly does, in no order.
  void find(const Eigen::AlignedBox3d& box, std::vector<std::uint32_t>& found) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
