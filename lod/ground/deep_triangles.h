// Which of the triangles of a surface are near a ball, each solid to a depth below its face.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "reference/mesh/box_hierarchy.h"

namespace lodestone {

/// Of a surface that looks nearly one way, as a landscape does.
struct OneWay {
  Vec3 up = Vec3::UnitZ();    ///< unit
  double least_cosine = 1.0;  ///< > 0, between it and the normal of any triangle
};

class DeepTriangles {
 public:
  using Corners = std::array<Vec3, 3>;

  DeepTriangles() = default;  ///< of none
  /// Corners counter-clockwise from outside, m; none without area. `depth`, m: below each, along its normal.
  DeepTriangles(std::span<const Corners> triangles, double depth, const std::optional<OneWay>& one_way);

  const Eigen::AlignedBox3d& bounds() const { return bounds_; }  ///< m: of all that is solid
  /// Appends `first` and the number of each that is solid within `reach` m of `center`, in no order. By
  /// floats: some are a little farther.
  void find_near(const Vec3& center, double reach, int first, std::vector<int>& found) const;
  /// Of a surface that looks one way: the numbers of those that stand, without what lies below them, in boxes
  /// (AlignedBox3d, m) which `enters`.
  template <class Enters, class Visit>
  void visit_bare(const Enters& enters, const Visit& visit) const {
    const double rounding =
        1e-12 * (middle_.cwiseAbs() + bounds_.sizes()).sum();  // of moving a box by middle_
    tree_.visit_places(
        [&](const FloatBox& small) {
          const Eigen::AlignedBox3d box = small;
          return enters(Eigen::AlignedBox3d(box.min() + middle_ - Vec3::Constant(rounding),
                                            box.max() + middle_ + Vec3::Constant(rounding)));
        },
        [&](std::int32_t place) { visit(tree_.number_at(place)); });
  }

 private:
  using Floats = std::array<float, 3>;
  struct Flat {
    Floats normal;  // unit
    float offset;   // m
    FloatBox box;   // of the triangle itself
  };
  bool is_near(const Flat& triangle, const Floats& center, float reach) const;
  bool may_be_near(const FloatBox& bare, const Floats& center, float reach) const;

  Vec3 middle_ = Vec3::Zero();  // m, of all: floats are from there
  float depth_ = 0.0f;          // m
  bool one_way_ = false;
  Floats up_ = {};
  float deepest_over_height_ = 1.0f;
  Eigen::AlignedBox3d bounds_;
  BoxHierarchy tree_;        // one way: of the triangles themselves, else of all that is solid
  std::vector<Flat> flats_;  // by their places there
};

}  // namespace lodestone
