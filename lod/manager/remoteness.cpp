#include "lod/manager/remoteness.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

/// What a body's remoteness is measured by: (distance − offset) / scale.
struct Yardstick {
  double offset, scale;
  Yardstick(const LevelCandidate& c, Measure measure)
      : offset(measure == Measure::distance ? c.radius : 0.0),
        scale((measure == Measure::distance ? 1.0 : 2.0 * c.radius) * c.importance / c.view_factor) {}
  double of(double beyond) const {
    if (beyond == 0.0) return 0.0;
    return scale > 0.0 ? beyond / scale : kInfinity;
  }
  double reach(double within) const { return within == kInfinity ? kInfinity : within * scale + offset; }
};

}  // namespace

std::optional<Limits> limits_of(const PolicySettings& settings) {
  if (const auto* distance = std::get_if<DistancePolicy>(&settings.policy)) return Limits(*distance);
  if (const auto* size = std::get_if<ProjectedSizePolicy>(&settings.policy)) return Limits(*size);
  return {};
}

double remoteness(const LevelCandidate& c, const Views& views, Measure measure) {
  const Yardstick yardstick(c, measure);
  const double beyond =
      std::max(0.0, std::sqrt(views.squared(c.position, c.ahead, measure)) - yardstick.offset);
  return std::min(yardstick.of(beyond), c.no_farther_than);
}

double rank_distance(const LevelCandidate& c, const Views& views, double hysteresis, Measure measure) {
  const double distance = remoteness(c, views, measure);
  if (c.newcomer) return distance;
  if (c.rung == Rung::full) return distance / (1.0 + hysteresis);
  return c.rung == Rung::tables && c.open.has(Rung::support) ? distance * (1.0 + hysteresis) : distance;
}

Rule reason_for_rung(const Limits& limits, const LevelCandidate& c) {
  if (c.rung == Rung::full || (c.rung == Rung::support && limits.three_rungs())) return Rule::near;
  return c.view_factor > 1.0 ? Rule::out_of_view : Rule::far;
}

// Told without a division.
bool stays_put(const LevelCandidate& c, const Views& views, const Limits& limits) {
  if (c.rung == Rung::full || c.decided() || !c.open.has(c.rung) || c.hits_full) return false;
  const Yardstick yardstick(c, limits.measure);
  const double squared = views.squared(c.position, c.ahead, limits.measure);
  const auto beyond = [&](double within) {
    return squared > 1.001 * yardstick.reach(within) * yardstick.reach(within);
  };
  if (c.open.has(Rung::full) && !beyond(limits.full_within)) return false;
  if (!can_be_in_ring(c) || !limits.three_rungs()) return c.rung == c.open.at_most(Rung::support);
  if (c.rung == Rung::tables) return beyond(limits.support_within);
  return squared < 0.999 * yardstick.reach(limits.support_within) * yardstick.reach(limits.support_within);
}

double travel_until_change(const LevelCandidate& c, const Views& views, const Limits& limits,
                           double hysteresis) {
  const Yardstick yardstick(c, limits.measure);
  const double nearest = std::sqrt(views.squared(c.position, limits.measure)),
               per_metre = views.per_metre(limits.measure);
  double travel = kInfinity;
  if (c.open.has(Rung::full)) travel = nearest - yardstick.reach(limits.full_within);
  if (!can_be_in_ring(c) || !limits.three_rungs()) return travel / per_metre;
  if (c.rung == Rung::tables)
    travel = std::min(travel, nearest - yardstick.reach(limits.support_within));
  else
    travel = std::min(travel, yardstick.reach(limits.support_within * (1.0 + hysteresis)) - nearest);
  return travel / per_metre;
}

}  // namespace lodestone
