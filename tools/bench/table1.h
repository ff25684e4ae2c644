// Table 1 of Hsu and Keyser, measured here: what a step of n fallen bodies costs by each method, in one run.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/bench/bandwidth.h"
#include "tools/bench/table1_job.h"

namespace lodestone {

struct Table1Settings {
  std::vector<int> bodies = {10, 100, 1'000, 10'000};
  std::vector<std::string> methods = {"full_plain", "full",        "low",           "spheres7",
                                      "sphere",     "bullet_hull", "bullet_sphere", "statistical"};
  /// Of the statistical level: "tables", "tables_published" or "support"; empty: all.
  std::string model = {};
  int threads = 1;  ///< of the statistical level; the others run on one
  bool sleeping = false;
  double row_seconds = 120.0;  ///< rows that would take longer are left out
  SignatureSettings measuring = {};
  std::uint64_t seed = 1;
  Progress progress = {};
};

/// Medians of steps 60 to 179. Numbers are absent where they were not measured.
struct Table1Row {
  int bodies = 0;
  std::string method = {}, model = {};
  int threads = 1;
  std::optional<double> step_ms = {}, collision_ms = {}, response_ms = {}, rest_ms = {};
  std::array<int, 3> awake{};    ///< after steps 60, 120 and 179
  std::uint64_t state_hash = 0;  ///< after the last step
  double bytes_per_body = 0.0;   ///< of the heap, that the whole world holds
  /// Of that in the statistical level's arrays; 0 where nobody counts them.
  double level_bytes_per_body = 0.0;
  double bytes_moved_per_body = 0.0;  ///< in a step, by the `tables` model; 0 for others
  bool hash_space = false;            ///< ODE's: whether this space, not sweep and prune, was the faster
  std::optional<double> times_less_than_full_plain = {}, times_less_than_spheres7 = {},
                        times_less_than_sphere = {};  ///< of a step, with as many bodies
  std::optional<double> moved_gb_per_s = {}, share_of_memory = {},
                        share_of_cache = {};  ///< of the bandwidth of as many threads, where it was measured
  std::string left_out = {};
};

/// A row for each number of bodies and method, numbers in rising order.
std::vector<Table1Row> measure_table1(const Table1Settings& settings);

/// Sets beside what rows move how much the machine could.
void compare_with(const Bandwidth& bandwidth, std::span<Table1Row> rows);

}  // namespace lodestone
