// Where a body meets static boxes and meshes.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lod/contact/pair_contacts.h"
#include "lod/ground/met_ground.h"
#include "lod/statistical/statistical_body.h"

namespace lodestone {

struct SolidContact {
  std::int32_t slot = 0;     ///< of the body
  std::uint32_t number = 0;  ///< of the solid, for as long as its part is there
  MaterialId material = 0;
  const GroundPart* part = nullptr;
  PairContact contact;  ///< the normal points into the body
};

/// Which contacts are looked for: all, or one of each part, which tells whether the body may meet it,
/// whichever way it turns.
enum class SolidSearch : std::uint8_t { all, one_of_a_part };

/// Contacts of the body in `slot` that may close within `time` seconds, `after` so many of the step, appended
/// to `found`. Where the body lies over faces only, away from their edges and not wedged in between them, or
/// over very gentle ground of triangles, there are none but the planes that these are, appended to `planes`.
void find_solid_contacts(const StatisticalBody& body, const BodyKind& kind, std::int32_t slot,
                         const MetGround& ground, double after, double time, std::vector<SolidContact>& found,
                         std::vector<HalfSpace>& planes, SolidSearch search = SolidSearch::all);

/// Of the contacts, those of the body of the first one: they stand together.
std::span<const SolidContact> first_run_of(std::span<const SolidContact> contacts);

/// m/s: what all parts that one body may meet go on with for the whole step of `dt` seconds, none of them
/// turning; zero where they stand still. None where they move otherwise: to a body that moves along with them
/// they do not stand still.
std::optional<Vec3> find_velocity_of_ground(std::span<const SolidContact> of_body, double dt);

/// Of a body that is seen from parts that go on with `velocity` (m/s), without turning: appends the faces of
/// these that it may meet within `time` seconds. False, and none, where there is more: their edges, or ground
/// that does not go along.
bool find_faces_going_along(const StatisticalBody& body, const BodyKind& kind, const MetGround& ground,
                            const Vec3& velocity, double time, std::vector<HalfSpace>& faces);

/// Appends the planes that stand for what the body may meet of the ground's parts within `time` seconds:
/// faces, and for gentle ground of triangles one of its mean slope. False, and none, where there is more,
/// less than `slack` m beyond what it reaches: edges, or what moves.
bool find_planes_below(const StatisticalBody& body, const BodyKind& kind, const MetGround& ground,
                       double slack, double time, std::vector<HalfSpace>& planes);

/// What a ball meets of a solid of the ground's parts: the plane across the way to its nearest point.
struct GroundNear {
  Vec3 normal = Vec3::UnitZ();  ///< towards the ball
  double height = 0.0;          ///< m, of the ball's centre
  const GroundPart* part = nullptr;
  std::uint32_t number = 0;  ///< as SolidContact's
  bool at_edge = false;      ///< no face is straight below
  HalfSpace plane(const Vec3& center) const {
    return {normal, normal.dot(center) - height, part->material, part->id};
  }
};

/// Whether edges count over which, at a seam, a face that is nearer goes on: they hold nobody, but end a way.
enum class Seams : std::uint8_t { left_out, there };

/// Appends what a ball of radius `reach` about `center` meets of the ground's parts, `after` so many seconds
/// of the step. With a `hull` in it, the planes that stand for the ground to this.
void find_ground_near(const MetGround& ground, const Vec3& center, double reach, double after,
                      std::vector<GroundNear>& found, const PairBody* hull = nullptr,
                      Seams seams = Seams::left_out);

/// Whether, of the ground within `reach` of `center`, two faces look different ways: a corner or a wedge.
bool is_held_several_ways(std::span<const GroundNear> near, std::span<const HalfSpace> planes,
                          const Vec3& center, double reach);

/// As find_solid_contacts, of a sphere: what holds it one way is a plane to it, appended to `planes`; what
/// moves or holds it several ways, contacts.
void find_sphere_contacts(const StatisticalBody& body, const BodyKind& kind, std::int32_t slot,
                          const MetGround& ground, double after, double time,
                          std::vector<SolidContact>& found, std::vector<HalfSpace>& planes);

/// The planes that a body may meet: the ground's and the faces of its parts that it is near. A thread has one
/// at a time.
std::span<const HalfSpace> join_planes(std::span<const HalfSpace> planes, std::span<const HalfSpace> faces);

/// The faces of solids that a body moves over which touches no other.
struct FacesUnder {
  std::span<const HalfSpace> faces;
  bool go_along = false;  ///< as of find_faces_going_along(): the solids themselves are not to be met
};

/// The faces of the ground's parts that bodies lie over: planes, as far as these bodies are concerned.
struct FacesBelow {
  std::vector<HalfSpace> faces;
  /// Of each slot, in `faces`; empty where there are no solids.
  std::vector<std::pair<std::int32_t, std::int32_t>> run;
  std::span<const HalfSpace> of(std::int32_t slot) const {
    if (run.empty()) return {};
    const auto& [begin, end] = run[std::size_t(slot)];
    return std::span(faces).subspan(std::size_t(begin), std::size_t(end - begin));
  }
};

}  // namespace lodestone
