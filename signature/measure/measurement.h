// What the trials of a signature gave, unit by unit: raw, so that units measured on different machines can be
// put together before a signature is made of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "signature/measure/settling_trial.h"
#include "signature/signature.h"

namespace lodestone {

/// One sample of the collision height (3.2.1).
struct HeightUnit {
  float mean = 0.0f, deviation = 0.0f;  ///< over R
};

/// One cell of a table of responses (3.2.2).
struct CellUnit {
  Response mean = Response::Zero(), deviation = Response::Zero();
  ResponseFactor factor{};
  Approach approach;
  std::uint32_t trials = 0, missed = 0;  ///< `missed`: never touched the plane
  std::uint32_t into_plane_first = 0,
                into_plane = 0;  ///< trials that move into the plane after the first impulse, and at the end
  std::uint64_t impulses = 0;
  double energy_ratio_first = 0.0, energy_ratio = 0.0;  ///< summed over the trials
  std::vector<Response> responses;                      ///< of each trial, for empirical draws only,
  std::vector<float> approaches;                        ///< with the approach of its contact point over s
};

/// Trials at one random condition, kept out of the tables.
struct HeldOutUnit {
  CollisionConfiguration configuration;
  std::vector<Response> responses;  ///< of those that touched the plane
};

/// What a unit is of; its number counts within its kind.
enum class UnitKind : std::uint32_t {
  height,
  bouncing,
  bouncing_held_out,
  non_bouncing,
  non_bouncing_held_out,
  by_speed,
  by_speed_held_out,
  settling,
  end
};

/// The units of one table.
struct TableUnits {
  std::vector<CellUnit> cells;
  std::vector<HeldOutUnit> held_out;
};

/// Which units one machine measures: of every kind those whose number leaves `index` when divided by `count`.
struct Share {
  int index = 0, count = 1;
  bool holds(std::int64_t unit) const { return unit % count == index; }
};

/// Every unit has its place; those outside of the share are left as they are made.
struct Measurement {
  Share share;
  std::vector<HeightUnit> heights;
  TableUnits bouncing, non_bouncing, by_speed;
  std::vector<SettlingRecord> settlings;
};

/// A measurement of nothing yet, with a place for every unit that the settings ask for.
Measurement make_empty_measurement(const SignatureSettings& settings, const Share& share = {});

/// Trials behind a unit.
inline std::uint64_t trials_of(const HeightUnit&, const SignatureSettings& settings) {
  return std::uint64_t(settings.height_trials);
}
inline std::uint64_t trials_of(const CellUnit& unit, const SignatureSettings&) {
  return std::uint64_t(unit.trials) + unit.missed;
}
std::uint64_t trials_of(const HeldOutUnit& unit, const SignatureSettings& settings);
inline std::uint64_t trials_of(const SettlingRecord&, const SignatureSettings&) { return 1; }

/// Puts the shares of one measurement together, given in any order.
Measurement merge_measurements(std::span<const Measurement> shares);

}  // namespace lodestone
