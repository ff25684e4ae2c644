// How far a body counts as, in metres or in reciprocal pixels, and what a policy of distances or sizes makes
// of that. Pure.
#pragma once

#include <limits>
#include <optional>

#include "lod/manager/level_candidate.h"
#include "lod/manager/views.h"
#include "lod/policy.h"

namespace lodestone {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A policy of distances or of sizes, in its measure.
struct Limits {
  Limits(const DistancePolicy& policy)
      : full_within(policy.full_within), support_within(policy.support_within) {}  // NOLINT: the same thing
  Limits(const ProjectedSizePolicy& policy)                                        // NOLINT
      : measure(Measure::size),
        full_within(within(policy.full_above_px)),
        support_within(within(policy.support_above_px)) {}
  Measure measure = Measure::distance;
  double full_within, support_within;
  bool three_rungs() const { return support_within < kInfinity; }

 private:
  static double within(double above_px) { return above_px > 0.0 ? 1.0 / above_px : kInfinity; }
};
/// None for a budget.
std::optional<Limits> limits_of(const PolicySettings& settings);

/// The distance of a body is its distance from the nearest viewpoint, less its radius, over its importance;
/// its size its reciprocal diameter in pixels, over its importance. Either is greater by the factor for what
/// is out of view, and infinite without viewpoints.
double remoteness(const LevelCandidate& candidate, const Views& views, Measure measure = Measure::distance);
/// Those on a higher rung count as nearer by the hysteresis.
double rank_distance(const LevelCandidate& candidate, const Views& views, double hysteresis,
                     Measure measure = Measure::distance);

/// Whether a statistical body surely has the rung that the policy wants for it: it may then be left out of
/// the candidates.
bool stays_put(const LevelCandidate& candidate, const Views& views, const Limits& limits);
/// Why a statistical body that has the rung that the policy wants for it does so.
Rule reason_for_rung(const Limits& limits, const LevelCandidate& candidate);
/// m: how far the viewpoints can travel until the policy may want another rung for a statistical body that
/// has the one it wants; 0 or less: at once.
double travel_until_change(const LevelCandidate& candidate, const Views& views, const Limits& limits,
                           double hysteresis);

/// Whether it is in no viewpoint's picture, where such bodies get their lowest rung, and comes to hit nothing
/// full.
inline bool is_out_of_the_picture(const LevelCandidate& c) {
  return c.view_factor == kInfinity && c.no_farther_than == kInfinity;
}

/// Whether both statistical rungs are open to it.
inline bool can_be_in_ring(const LevelCandidate& c) {
  return !c.decided() && c.open.has(Rung::tables) && c.open.has(Rung::support);
}

}  // namespace lodestone
