// Which triangles of a surface a body cannot meet, by a box around its hull: of the hundred and more around a
// body on a fine mesh, most. The axes of separation are the box's own three and the four outer faces of what
// the triangle is solid to (Gottschalk, Lin, Manocha, OBBTree, 1996, without the products of edges).
#pragma once

#include "lod/contact/pair_contacts.h"
#include "lod/ground/ground.h"

namespace lodestone {

class TriangleSieve {
 public:
  /// Both m: of what is farther than `margin` it meets nothing; what is over a triangle and up to `deepest`
  /// below its surface meets it.
  TriangleSieve(const PairBody& body, double margin, double deepest);
  /// Whether the hull is farther than the margin from all that the triangle is solid to.
  bool is_beyond(const PlacedSolid& triangle);

 private:
  void see_from(const PlacedSolid& triangle);
  double extent_along(const Vec3& axis) const { return (sides_.transpose() * axis).cwiseAbs().sum(); }

  PairBody body_;
  double margin_, deepest_;
  Vec3 middle_of_box_ = Vec3::Zero(), half_ = Vec3::Zero();  // m, body axes
  // In the frame of the part that the last triangle was of.
  const GroundPart* part_ = nullptr;
  Vec3 middle_ = Vec3::Zero();                               // m, of the box
  Mat3 axes_ = Mat3::Identity(), sides_ = Mat3::Identity();  // of the box; times its half sides, m
};

}  // namespace lodestone
