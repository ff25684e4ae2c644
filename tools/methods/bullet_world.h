// A world of Bullet's (Debian's single-precision build), to measure a peer on the same job in the same run.
// Where Lodestone is built without it, `bullet_available` says so and nothing else may be called.
#pragma once

#include <memory>

#include "reference/material.h"
#include "reference/shape.h"

namespace lodestone {

bool bullet_available();

/// `hull`: every corner of the shape's convex hull. `hull40`: at most forty of them, those farthest in forty
/// directions, as games give hulls to an engine. `sphere`: of the shape's volume. All with its mass
/// distribution.
enum class BulletGeometry { hull, hull40, sphere };

struct BulletSettings {
  Vec3 gravity{0, 0, -9.81};      ///< m/s²
  int solver_iterations = 10;     ///< Bullet's default
  double bounce_velocity = 0.05;  ///< m/s, slower contacts do not bounce
  bool sleeping = false;
};

struct BulletBodyDefinition {
  std::shared_ptr<const Shape> shape{};
  double mass = 1.0;  ///< kg
  Material material{};
  RigidState state{};
  BulletGeometry geometry = BulletGeometry::hull;
};

/// A pair takes the lower restitution and the geometric mean of the frictions, as everywhere here. One
/// thread.
class BulletWorld {
 public:
  explicit BulletWorld(const BulletSettings& settings);
  ~BulletWorld();
  BulletWorld(BulletWorld&&) noexcept;
  BulletWorld& operator=(BulletWorld&&) noexcept;

  /// normal·x = offset, normal of unit length.
  void add_plane(const Vec3& normal, double offset, const Material& material);
  /// Returns the body's number: 0, 1, …; a removed body's is not used again. Bodies of one shape share its
  /// geometry.
  int add_body(const BulletBodyDefinition& definition);
  void remove_body(int body);
  void step(double dt);  ///< s, in one step of Bullet's
  RigidState state(int body) const;
  bool asleep(int body) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
