// What a policy looks at, one per body, or one for bodies that change rung together.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "lod/manager/full_pairs.h"
#include "lod/manager/rung_set.h"
#include "lod/why.h"

namespace lodestone {

struct LevelCandidate {
  Vec3 position = Vec3::Zero();
  double radius = 0.0;  ///< m, distance is measured to the nearest point of the bounding sphere
  double importance = 1.0;
  /// Predicted for a step at each rung, in the unit of the budget; at the full level without pairs.
  std::array<float, kRungs> cost{};
  /// Of its cost on the rung that it has: of coming there, or kept for when it wakes. No measure of what it
  /// is worth to leave it there.
  float passing = 0.0f;
  float mesh = 0.0f;              ///< weight of its mesh in pairs of full bodies (full_pairs.h)
  PairWeights pairs_within = {};  ///< of one that stands for several, when they are full
  bool asleep = false;
  Vec3 motion = Vec3::Zero();  ///< m, of a full body in the next frame
  std::int32_t dwell_left = 0;  ///< steps for which it keeps its rung, unless it must leave it
  Rung rung = Rung::support;
  RungSet open = kEveryRung;
  Rule decided_by = Rule::forced;  ///< why only one rung is open, where that is so
  bool newcomer = false;           ///< at no level yet: takes its rung now, whatever the dwell and the cap
  bool put_off = false;            ///< its promotion was put off lately: it waits as it is
  bool hits_full = false;          ///< it is about to hit a full body
  std::int32_t bodies = 1;         ///< that it stands for
  double view_factor = 1.0;        ///< ≥ 1, by which it counts as farther than it is: out of view
  /// In the policy's measure: of what it is about to hit.
  double no_farther_than = std::numeric_limits<double>::infinity();
  Vec3 ahead = Vec3::Zero();          ///< m, how far it will have moved when the look-ahead ends
  std::array<float, kRungs> error{};  ///< px, predicted at each rung

  /// Whether the policy has no say.
  bool decided() const { return open.one(); }
  /// What it goes up or down from: a newcomer from the lowest.
  Rung present() const { return newcomer ? open.lowest() : rung; }
  double cost_at(Rung at) const { return double(cost[std::size_t(at)]); }
  double error_at(Rung at) const { return double(error[std::size_t(at)]); }
};

}  // namespace lodestone
