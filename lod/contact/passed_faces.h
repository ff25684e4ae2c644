// Two bodies of which one passes over a face of the other: it meets that face, or nothing, and never an edge
// beside it.
#pragma once

#include <optional>

#include "lod/contact/pair_body.h"

namespace lodestone {

/// How two bodies go on, and over what they pass: who lies over a face of the other's hull, but for `hair`,
/// and will at the end, meets that face, or nothing. No edge beside it can be in the way: who is as little
/// below the face of a flush neighbour would trip over the seam.
struct PairWay {
  Vec3 first = Vec3::Zero();                                   ///< m, the first one's, seen from the second
  Vec3 first_turn = Vec3::Zero(), second_turn = Vec3::Zero();  ///< rad
  double hair = 0.0;                                           ///< m
};

/// What becomes of a contact of two hulls across a face along which one passes the other: the contact with
/// that face, where they lie over each other, none where they do not. Any other contact stays as it is.
/// `axis`, the contact's, is then the one along which they pass, where the next search is to begin.
std::optional<PairContact> pass_over(const PairBody& first, const PairBody& second, const PairWay& way,
                                     const PairContact& contact, HullGap& axis);

}  // namespace lodestone
