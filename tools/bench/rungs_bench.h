// What is seen of a change of rung: a settled heap, asleep or kept awake, is taken up and down the ladder,
// and every body's moves are measured.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lod/body.h"
#include "signature/signature_source.h"

namespace lodestone {

struct RungsSettings {
  std::vector<std::string> shapes = {"bunny", "l"};  ///< of .2 m with 4,698 faces; l:0.3,0.2,0.08,0.1
  std::optional<int> bodies = {};                    ///< of each heap; else 1,000 bunnies and 300 L-shapes
  int rounds = 20;
  int frames = 15;  ///< of 1/60 s, that are watched after each change
  /// Bodies that are full at a time: a heap all of whose bodies are full takes ODE a third of a second a
  /// step.
  int slice = 40;
  std::uint64_t seed = 1;
  Progress progress = {};
};

/// Changes of one kind, over all rounds. A body's move is that of the worst of its watched frames: how far it
/// went beyond what its velocity explains, |Δx − v dt| − ½ g dt² where that is above 0. `v` is the velocity
/// at the start of the frame.
struct RungsRow {
  std::string change = {};   ///< "none": as many frames without a change, for comparison
  std::int64_t changes = 0;  ///< bodies, over all rounds
  double p50_mm = 0.0, p99_mm = 0.0, p999_mm = 0.0, max_mm = 0.0;
  // The same with whatever velocity between those at the start and at the end of the frame explains it best:
  // 0 for a blow or a stop.
  double unexplained_p999_mm = 0.0, unexplained_max_mm = 0.0;
  double others_max_mm = 0.0;  ///< of bodies that did not change
  /// The most that the heap's energy rose above that before the change, over m g R of a body.
  double energy_rise = 0.0;
  std::int64_t woken = 0;    ///< bodies that slept before and did not at the end of the watched frames
  std::int64_t put_off = 0;  ///< that had not got their rung by then
};

struct RungsHeap {
  std::string shape;
  int bodies = 0;
  bool kept_awake = false;
  int asleep_before = 0, asleep_after = 0;
  double mean_height_before_m = 0.0, mean_height_after_m = 0.0;  ///< of the centres of mass
  std::vector<RungsRow> rows;
};

/// How far `moved` is from the nearest vector between `from` and `to`: what is left of a step's way (or turn)
/// where these are its velocities before and after times its length, and a blow or a stop within the step
/// leaves 0.
double distance_beyond(const Vec3& moved, const Vec3& from, const Vec3& to);

/// 99.9 % of the changes within 5 mm, all within 20 mm.
bool is_unseen(const RungsRow& row);

/// Each shape's heap asleep, then kept awake. It falls and comes to rest at `support`. Each round takes the
/// whole heap down to `tables`, a slice from there to full and back, the heap up to `support`, and all slices
/// in turn to full and back to `support`, the nearest to a place at the heap's edge first.
std::vector<RungsHeap> bench_rungs(const RungsSettings& settings);

}  // namespace lodestone
