// The pairs of near balls as Bullet's dynamic bounding-volume tree finds them (btDbvtBroadphase). Where
// Lodestone is built without Bullet, nothing of this may be called but bullet_available
// (tools/methods/bullet_world.h).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace lodestone {

class BulletPairs {
 public:
  /// A box about each ball, m; all at the origin until they are placed.
  explicit BulletPairs(std::span<const float> radii);
  ~BulletPairs();
  BulletPairs(const BulletPairs&) = delete;
  BulletPairs& operator=(const BulletPairs&) = delete;

  /// One position a ball, m.
  void place(std::span<const double> x, std::span<const double> y, std::span<const double> z);
  /// Adds the pairs whose balls meet, each once: those that Bullet keeps and that overlap indeed.
  void find(std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
