// What the trials of a signature gave, unit by unit: raw, so that units measured on different machines can be put together before a signature is
// made of them.
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
  std::uint32_t trials = 0, missed = 0;                         ///< `missed`: never touched the plane
  std::uint32_t into_plane_first = 0, into_plane = 0;           ///< trials that move into the plane after the first impulse, and at the end
  std::uint64_t impulses = 0;
  double energy_ratio_first = 0.0, energy_ratio = 0.0;          ///< summed over the trials
  std::vector<Response> responses;                              ///< of each trial, for empirical draws only,
  std::vector<float> approaches;                                ///< with the approach of its contact point over s
};

/// Trials at one random condition, kept out of the tables.
struct HeldOutUnit {
  CollisionConfiguration configuration;
  std::vector<Response> responses;  ///< of those that touched the plane
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

/// Puts the shares of one measurement together, given in any order.
Measurement merge_measurements(std::span<const Measurement> shares);

}  // namespace lodestone
