// Full bodies whose meshes may meet: what a heap of them costs, beyond what each costs alone.
#pragma once

#include <cstdint>
#include <vector>

#include "reference/shape.h"

namespace lodestone {

/// Pairs by what their meshes cost to collide: two bunnies of 4,698 faces that touch deep count 1, those that
/// just begin to meet 0.
struct PairWeights {
  double awake = 0.0, asleep = 0.0;  ///< at least one of the two is awake; both sleep
  double dearest = 0.0;  ///< of those awake, but for two hulls or simplest meshes, which have no bad steps
  PairWeights& operator+=(const PairWeights& more);
};

/// Of a body's mesh: a pair counts the product of both.
float mesh_weight(const Shape& shape);

/// The full bodies so far, in a hash of cells.
class FullPairs {
 public:
  struct Body {
    Vec3 position = Vec3::Zero();
    double radius = 0.0;  ///< m, of the bounding sphere
    float mesh = 0.0f;    ///< mesh_weight
    bool asleep = false;
    /// m, in the next frame: a pair is as deep as it will be then, where that is deeper.
    Vec3 motion = Vec3::Zero();
    std::int64_t joined = -1;  ///< the group whose joints hold it, in which there are no pairs; −1: none
  };

  /// `most_radius`: m, of all bodies that are to come.
  explicit FullPairs(double most_radius);
  /// The pairs that a body makes with those so far.
  PairWeights meet(const Body& body) const;
  void add(const Body& body);

 private:
  static constexpr std::size_t kBuckets = 1024;
  std::size_t bucket(std::int64_t x, std::int64_t y, std::int64_t z) const;

  double cells_per_m_ = 1.0;
  std::vector<std::int32_t> first_, next_;  // of a bucket; of a body: the next one in its bucket; −1: none
  std::vector<Body> bodies_;
};

}  // namespace lodestone
