// The decision of a step: which rung each body should have, from what a policy says and what dwell, caps and room allow. Pure: no simulation here.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include "lod/body.h"
#include "lod/policy.h"

namespace lodestone {

/// Why a body has its rung.
enum class LevelReason : std::uint8_t { forced, near, far, within_hysteresis, dwell, queued, over_budget, in_budget, most_reached, overlap_put_off, static_ground, signature_pending };
std::string_view text_of(LevelReason reason);

/// Rungs that are open to a body; never none of them.
class RungSet {
 public:
  constexpr RungSet(std::initializer_list<Rung> rungs) {
    for (const Rung rung : rungs) bits_ = std::uint8_t(bits_ | bit(rung));
  }
  constexpr bool has(Rung rung) const { return bits_ & bit(rung); }
  constexpr bool one() const { return (bits_ & (bits_ - 1)) == 0; }
  constexpr Rung lowest() const { return has(Rung::tables) ? Rung::tables : has(Rung::support) ? Rung::support : Rung::full; }
  /// The highest that is no higher than `rung`; the lowest of all where there is none.
  constexpr Rung at_most(Rung rung) const {
    for (int i = int(rung); i >= 0; --i)
      if (has(Rung(i))) return Rung(i);
    return lowest();
  }
  friend constexpr bool operator==(RungSet, RungSet) = default;

 private:
  static constexpr std::uint8_t bit(Rung rung) { return std::uint8_t(1u << unsigned(rung)); }
  std::uint8_t bits_ = 0;
};
inline constexpr RungSet kEveryRung{Rung::tables, Rung::support, Rung::full};

/// What the policy looks at, one per body.
struct LevelCandidate {
  Vec3 position = Vec3::Zero();
  double radius = 0.0;            ///< m, distance is measured to the nearest point of the bounding sphere
  double importance = 1.0;
  std::array<float, kRungs> cost{};  ///< predicted for a step at each rung, in the unit of the budget; at the full level without pairs
  float mesh = 0.0f;              ///< weight of its mesh in pairs of full bodies (full_pairs.h)
  bool asleep = false;
  Vec3 motion = Vec3::Zero();     ///< m, of a full body in the next frame
  std::int32_t frames_since_change = 1 << 30;
  Rung rung = Rung::support;
  RungSet open = kEveryRung;
  LevelReason decided_by = LevelReason::forced;  ///< why only one rung is open, where that is so
  bool newcomer = false;          ///< at no level yet: takes its rung now, whatever the dwell and the cap
  bool put_off = false;           ///< its promotion was put off lately: it waits as it is

  /// Whether the policy has no say.
  bool decided() const { return open.one(); }
  /// What it goes up or down from: a newcomer from the lowest.
  Rung present() const { return newcomer ? open.lowest() : rung; }
  double cost_at(Rung at) const { return double(cost[std::size_t(at)]); }
};

/// What a budget has to bear besides the candidates, in the same unit.
struct StepOverhead {
  double others = 0.0;                    ///< whatever is no candidate's
  double margin = 0.0;                    ///< over the prediction: that it is likely to err by, as a part of it
  std::array<double, kRungs> change{};    ///< once, of a change to each rung
  double pair = 0.0;                      ///< of full bodies that may meet, of weight 1; half of it where both sleep: all that wakes at once may take twice the budget
  double spike = 0.0;                     ///< once, where there is such a pair that is awake, for what the dearest of them may take in a bad step
};

struct LevelDecision {
  struct Change {
    std::int32_t candidate = 0;
    Rung to = Rung::support;
    friend bool operator==(const Change&, const Change&) = default;
  };
  /// Forced ones, newcomers and demotions that bring the cost back within the budget come first and are not limited;
  /// of the rest at most max_transitions_per_frame, promotions (nearest first) and demotions (farthest first) by turns.
  std::vector<Change> promote, demote;
  std::vector<LevelReason> reasons;  ///< one per candidate
};

/// The distance of a body is its distance from the nearest viewpoint, less its radius, over its importance; without viewpoints it is infinite, and no body is full
/// that need not be.
LevelDecision choose_levels(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints, const PolicySettings& settings, const StepOverhead& overhead = {});

// Which bodies may be left out of the candidates without any change to the decision. Under a DistancePolicy: statistical ones that stay_put. Under a budget: those that
// sleep at a greater rank_distance than reach_of_full.

/// Whether a statistical body surely has the rung that the policy wants for it.
bool stays_put(const LevelCandidate& candidate, std::span<const Vec3> viewpoints, const DistancePolicy& policy);
/// Why a statistical body that has the rung that the policy wants for it does so.
LevelReason reason_for_rung(const DistancePolicy& policy, Rung rung);
/// m: how far the viewpoints can travel until the policy may want another rung for a statistical body that has the one it wants; 0 or less: at once.
double travel_until_change(const LevelCandidate& candidate, std::span<const Vec3> viewpoints, const DistancePolicy& policy, double hysteresis);

/// m: those on a higher rung count as nearer by the hysteresis.
double rank_distance(const LevelCandidate& candidate, std::span<const Vec3> viewpoints, double hysteresis);
/// The rank distance up to which a budget has room for full bodies, infinite where it has room for all. Every body that is full or must be is among the candidates.
double reach_of_full(std::span<const LevelCandidate> candidates, std::span<const Vec3> viewpoints, const PolicySettings& settings, const StepOverhead& overhead);

}  // namespace lodestone
