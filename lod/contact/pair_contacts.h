// Where two statistical bodies meet: a shared normal and shared points. Bodies are hulls, or convex pieces.
#pragma once

#include <optional>
#include <vector>

#include "lod/contact/pair_body.h"
#include "lod/contact/pair_coherence.h"
#include "lod/contact/passed_faces.h"

namespace lodestone {

struct HullContactSearch {
  bool exact = true;           ///< in: see find_hull_gap
  std::optional<PairWay> way;  ///< in; none: they pass over nothing
  double gap = 0.0;            ///< m: the true distance is at least this
  /// Those with a gap of at most the margin: one for hulls, one for each two convex pieces that meet.
  std::vector<PairContact> contacts;
};

/// How bodies of `support` meet. Concave ones that have convex pieces (Shape::pieces) meet in these, so that
/// they may reach into each other; others as their hulls. `whole`, of the hulls (at first with a normal of
/// zero), and `of_pieces`, of every two pieces (at first empty), are what earlier searches found, and then
/// what this one found. Overwrites what `search` held.
void find_pair_contacts(const PairBody& first, const PairBody& second, HullGap& whole,
                        std::vector<KnownGap>& of_pieces, const Enough& margin, HullContactSearch& search);

/// The contact of the two hulls, whatever pieces they have; none where the gap is above `margin`, m. Vertices
/// of the first body count that are up to `ahead` m farther than the nearest: they may touch next. The search
/// begins at `axis` (from the second to the first; zero: the line of centres).
std::optional<PairContact> find_hull_contact(const PairBody& first, const PairBody& second, double margin,
                                             double ahead = 0.0, const Vec3& axis = Vec3::Zero());

/// As find_hull_contact, along a given axis (unit, from `second` into `first`); none, too, where the touching
/// features do not overlap across it.
std::optional<PairContact> find_contact_along(const PairBody& first, const PairBody& second,
                                              const Vec3& normal, double margin, double ahead = 0.0);

}  // namespace lodestone
