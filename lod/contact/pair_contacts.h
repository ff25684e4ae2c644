// Where two statistical bodies meet: a shared normal and shared points.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "lod/body.h"
#include "lod/contact/contact_manifold.h"
#include "lod/contact/hull_gap.h"
#include "reference/state_archive.h"

namespace lodestone {

/// A body as pair contacts see it, of either level.
struct PairBody {
  const Shape* shape = nullptr;
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

/// One of its convex pieces; the body itself where it has none.
PairBody piece_of(const PairBody& body, int piece);

struct PairContact {
  Vec3 normal = Vec3::UnitZ();  ///< from the second body into the first
  double gap = 0.0;             ///< m, the least; negative where they overlap
  Manifold manifold;            ///< one to four points that both bodies share, world

  void archive(StateArchive& a) { a(normal, gap, manifold); }
};

inline constexpr double kTakenAlong = 0.02;  // over the lesser R: so far bodies take a contact along

/// A contact that its bodies take along, until they have moved so far that it must be looked for anew. Kept
/// for every pair that touches: floats, which are fine enough for arms.
struct HeldContact {
  Vec3 normal = Vec3::UnitZ();
  std::int32_t count = 0;
  std::array<Eigen::Vector3f, 4> on_first, on_second;  ///< m, its points on each body's surface, body axes

  void archive(StateArchive& a) {
    a(normal, count);
    for (std::size_t i = 0; i < std::min(std::size_t(count), on_first.size()); ++i)
      a(on_first[i], on_second[i]);
  }
};
HeldContact hold(const PairContact& contact, const PairBody& first, const PairBody& second);
/// Where its points are now, and their gaps along the normal that it was found with.
PairContact follow(const HeldContact& held, const PairBody& first, const PairBody& second);

/// How two bodies lie to each other. Kept for every pair that is near, so not aligned to vector registers.
struct PairPose {
  using Turn = Eigen::Matrix<float, 4, 1, Eigen::DontAlign>;
  Eigen::Vector3f apart = Eigen::Vector3f::Zero();  ///< m, of the first from the second
  Turn first{0, 0, 0, 1}, second{0, 0, 0, 1};       ///< orientations
};
PairPose pose_of(const PairBody& first, const PairBody& second);
/// m: no gap between them has changed by more since they lay so.
double find_motion_since(const PairPose& then, const PairBody& first, const PairBody& second);
/// m: what is left now, at least, of a gap of the two hulls that was found when they lay so.
struct GapLeft {
  double anyhow = 0.0;  ///< of their distance
  double along = 0.0;   ///< along its axis
};
GapLeft find_gap_left(const HullGap& found, const PairPose& then, const PairBody& first,
                      const PairBody& second);

/// m: the gap of the two hulls now along the axis on which it was found, which it is then.
double look_along(HullGap& found, const PairBody& first, const PairBody& second);

/// The gap of two pieces of bodies as it was found.
struct KnownGap {
  HullGap axis = {.normal = Vec3::Zero()};  ///< where the next search begins; zero: anywhere
  std::optional<PairPose> when;             ///< how they lay then; none: never looked for

  void archive(StateArchive& a) { a(axis, when); }
};

/// How two bodies go on, and over what they pass: who lies over a face of the other's hull, but for `hair`,
/// and will at the end, meets that face, or nothing. No edge beside it can be in the way: who is as little
/// below the face of a flush neighbour would trip over the seam.
struct PairWay {
  Vec3 first = Vec3::Zero();                                   ///< m, the first one's, seen from the second
  Vec3 first_turn = Vec3::Zero(), second_turn = Vec3::Zero();  ///< rad
  double hair = 0.0;                                           ///< m
};

struct HullContactSearch {
  bool exact = true;           ///< in: see find_hull_gap
  std::optional<PairWay> way;  ///< in; none: they pass over nothing
  double gap = 0.0;            ///< m: the true distance is at least this
  /// Those with a gap of at most the margin: one for hulls, one for each two convex pieces that meet.
  std::vector<PairContact> contacts;
};

/// `support`. Concave bodies that have convex pieces (Shape::pieces) meet in these, so that they may reach
/// into each other; others as their hulls. `whole`, of the hulls (at first with a normal of zero), and
/// `of_pieces`, of every two pieces (at first empty), are what earlier searches found. What `search` held
/// before is gone.
void find_pair_contacts(const PairBody& first, const PairBody& second, HullGap& whole,
                        std::vector<KnownGap>& of_pieces, const Enough& margin, HullContactSearch& search);

/// The two hulls, whatever pieces they have; none where the gap is above `margin`. Of the first body, those
/// vertices serve, too, that are up to `ahead` m farther than the nearest: they may touch next. The search
/// begins at `axis` (from the second to the first; zero: the line of centres).
std::optional<PairContact> find_hull_contact(const PairBody& first, const PairBody& second, double margin,
                                             double ahead = 0.0, const Vec3& axis = Vec3::Zero());

/// As find_hull_contact, along a given axis (unit, from `second` into `first`); none, too, where the touching
/// features do not overlap across it.
std::optional<PairContact> find_contact_along(const PairBody& first, const PairBody& second,
                                              const Vec3& normal, double margin, double ahead = 0.0);

}  // namespace lodestone
