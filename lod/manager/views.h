// The viewpoints as a policy sees them: how far a place is from the nearest, how large a ball is in the
// picture, whether it is in any.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "lod/viewpoint.h"
#include "reference/state_archive.h"

namespace lodestone {

/// What a policy goes by.
enum class Measure : std::uint8_t {
  distance,  ///< m, from the bounding sphere
  size,      ///< the reciprocal of the bounding sphere's diameter in pixels: less is nearer, too
};

class Views {
 public:
  Views() = default;
  Views(std::span<const Vec3> positions);  // NOLINT: a list of places is a list of views
  Views(const std::vector<Vec3>& positions) : Views(std::span(positions)) {}
  explicit Views(std::span<const Viewpoint> viewpoints);

  bool empty() const { return views_.empty(); }
  std::size_t size() const { return views_.size(); }
  const Vec3& position(std::size_t view) const { return views_[view].position; }
  /// Whether any has a frustum.
  bool any_frustum() const { return any_frustum_; }
  /// Whether some view has turned, or has another picture, since `before`, which had as many.
  bool turned_since(const Views& before) const;

  /// Whether some view has another picture than `before` had, which had as many.
  bool zoomed_since(const Views& before) const;

  /// m², to the nearest; for a size each view's is over its pixels per radian, squared.
  double squared(const Vec3& place, Measure measure) const;
  /// The same from where a body is to where it will be, `ahead` from there.
  double squared(const Vec3& place, const Vec3& ahead, Measure measure) const;
  /// The most that squared()'s root changes by per metre of travel.
  double per_metre(Measure measure) const { return measure == Measure::distance ? 1.0 : most_weight_; }
  /// Whether a ball meets the frustum of any view.
  bool sees(const Vec3& center, double radius) const;

  void archive(StateArchive& a) { a(views_, any_frustum_, most_weight_); }

 private:
  struct View {
    Vec3 position = Vec3::Zero();
    double weight = 0.0;  // rad/px
    bool all_around = true;
    Vec3 forward = Vec3::UnitX();
    std::array<Vec3, 4> inward{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(),
                               Vec3::Zero()};  // unit normals of the sides of its frustum
    friend bool operator==(const View&, const View&) = default;
  };
  static View view_of(const Viewpoint& viewpoint);

  std::vector<View> views_;
  bool any_frustum_ = false;
  double most_weight_ = 0.0;
};

}  // namespace lodestone
