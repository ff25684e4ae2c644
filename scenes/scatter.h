// Places many bodies at random in a box or an upright cylinder, no nearer to each other than their bounding
// spheres allow.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <unordered_map>
#include <variant>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

/// Where centres of mass may lie, m.
struct ScatterBox {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
};
struct ScatterCylinder {
  Vec3 base = Vec3::Zero();
  double radius = 1, height = 1;
};  ///< `base`: middle of its lower disc; axis along z
using ScatterRegion = std::variant<ScatterBox, ScatterCylinder>;

struct Scatter {
  int count = 0;
  ScatterRegion region;
  std::uint64_t seed = 0;
  /// Between centres of this scatter, where that is more than the bounding spheres ask for.
  double spacing_m = 0;
};

/// A half-space that bodies must stay out of: normal·x ≥ offset for every point of them.
struct KeepAbove {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0;
};

/// Bounding spheres that were placed so far, and a search for those near a point.
class PlacedSpheres {
 public:
  /// `largest_radius` of any sphere that will be added or asked about.
  explicit PlacedSpheres(double largest_radius) : cell_(2.0 * largest_radius) {}
  void add(const Vec3& center, double radius);
  bool overlaps(const Vec3& center, double radius) const;

 private:
  struct Sphere {
    Vec3 center;
    double radius;
  };
  std::uint64_t key_of(const Vec3& point, int dx, int dy, int dz) const;
  double cell_;
  std::unordered_multimap<std::uint64_t, Sphere> cells_;
};

/// Where body `index` of a scatter, drawn at `center`, starts on the ground; none: not there.
using PutOnGround = std::function<std::optional<Vec3>(int index, const Vec3& center)>;

/// Places `scatter.count` spheres of `radius` and adds them to `placed`. Body i's place is drawn from (seed,
/// i), relative to the region, so two scatters with the same seed in regions of the same size look the same.
/// Returns fewer where no room was found in 2,000 draws. With `put`, bodies are where that puts them, and the
/// grounds are its matter.
std::vector<Vec3> place_scatter(const Scatter& scatter, double radius, std::span<const KeepAbove> grounds,
                                PlacedSpheres& placed, const PutOnGround& put = {});

/// The orientation of body `index` of a scatter: uniform over rotations.
Quat scatter_orientation(const Scatter& scatter, int index);

/// How far it is turned about the vertical where it lies: 0 … 2π.
double scatter_turn(const Scatter& scatter, int index);

}  // namespace lodestone
