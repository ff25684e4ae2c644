// What of the ground's parts a body may meet in a step: planes, where it lies over faces only; else the
// solids that are near.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lod/contact/solid_contacts.h"
#include "lod/contact/triangle_sieve.h"

namespace lodestone {

/// A body that looks for ground.
struct GroundSeeker {
  const StatisticalBody& body;
  const Shape& shape;
  Vec3 omega;                        ///< rad/s
  double touching = 0.0, way = 0.0;  ///< m: as near as what carries; as far as a point of it may move
  std::int32_t slot = 0;
  double reach() const { return shape.radius + touching + way; }  // m
  /// m, where it will be in the middle of a step of `time` seconds: over curved ground one plane stands for
  /// the whole step, and that of its beginning would give what rolls in a hollow energy by lifting it.
  Vec3 half_way(double time) const { return 0.5 * time * body.velocity; }
  /// m/s, world.
  Vec3 velocity_at(const Vec3& point) const { return body.velocity + omega.cross(point - body.position); }
  /// Whether it may come to a plane that goes with `velocity` within `time` seconds, however it turns: that
  /// takes no point of it out of the ball about its centre, as a tangent at the rim of what spins fast does.
  bool may_turn_into(const HalfSpace& plane, const Vec3& velocity, double time) const;
};

/// For a step of `time` seconds.
GroundSeeker seeker_of(const StatisticalBody& body, const Shape& shape, std::int32_t slot, double time);

/// find_mean_plane() where the body will be half way of its step.
std::optional<HalfSpace> find_plane_half_way(const GroundSeeker& seeker, std::span<const PlacedSolid> near,
                                             double reach, double least_cosine, double time);

/// Whether the contact closes within `time` seconds.
bool closes(const PairContact& contact, const GroundPart& part, const GroundSeeker& seeker, double time);

/// Of a part that is known by rays alone: a contact by one from above for each of the body's vertices that
/// may carry it, or, where they all meet one plane, that plane.
void find_probed_contacts(const GroundSeeker& seeker, const GroundPart& part, double time,
                          std::vector<SolidContact>& found, std::vector<HalfSpace>& planes);

/// Whether two of them look against each other, so that what is between them is wedged in. A body that is
/// moved over planes is lifted off one of them: there, into the other.
bool are_wedge(std::span<const HalfSpace> planes);

/// Appends the solids that are near, `after` so many seconds of the step, to `near`, and what is known by
/// rays alone to `found` and `planes`. False, and planes appended, where these are all that the body may
/// meet.
bool find_uneven_ground(const GroundSeeker& seeker, const MetGround& ground, double after, double time,
                        std::vector<PlacedSolid>& near, std::vector<SolidContact>& found,
                        std::vector<HalfSpace>& planes);

/// None for a sphere.
std::optional<TriangleSieve> sieve_of(const GroundSeeker& seeker, double time);

/// m: how far below the centre of a ball the nearest triangle is of those that it lies over.
double find_height_over_triangles(std::span<const PlacedSolid> near, const Vec3& center);

}  // namespace lodestone
