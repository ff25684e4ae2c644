// Which triangles of a surface a body cannot meet, by a box around its hull: of the hundred and more around a
// body on a fine mesh, most. The axes of separation are the box's own three and the four outer faces of what
// the triangle is solid to (Gottschalk, Lin, Manocha, OBBTree, 1996, without the products of edges).
#pragma once

#include "lod/contact/pair_contacts.h"
#include "lod/ground/ground.h"

namespace lodestone {

/// How a body moves, and what contact with it is to be.
struct SieveMotion {
  Vec3 velocity = Vec3::Zero(), omega = Vec3::Zero();  ///< m/s, rad/s
  double touching = 0.0;                               ///< m: nearer than that within
  double time = 0.0;                                   ///< s
  double margin = 0.0;   ///< m: of what is farther now it meets nothing, whichever way it moves
  double deepest = 0.0;  ///< m: what is over a triangle and so deep below its surface still meets it
};

class TriangleSieve {
 public:
  TriangleSieve(const PairBody& body, const SieveMotion& motion);
  /// Whether the hull is farther than the margin from all that the triangle is solid to, or does not come
  /// near its plane in time.
  bool is_beyond(const PlacedSolid& triangle);

 private:
  void see_from(const PlacedSolid& triangle);
  double least_velocity_along(const Vec3& normal) const;
  double extent_along(const Vec3& axis) const { return (sides_.transpose() * axis).cwiseAbs().sum(); }

  PairBody body_;
  SieveMotion motion_;
  Vec3 middle_of_box_ = Vec3::Zero(), half_ = Vec3::Zero();  // m, body axes
  // In the frame of the part that the last triangle was of.
  const GroundPart* part_ = nullptr;
  Vec3 arm_ = Vec3::Zero(), middle_ = Vec3::Zero();          // m, of the box, from the body's centre of mass
  Mat3 axes_ = Mat3::Identity(), sides_ = Mat3::Identity();  // of the box; times its half sides, m
  Vec3 velocity_ = Vec3::Zero(), omega_ = Vec3::Zero();      // m/s, rad/s
};

}  // namespace lodestone
