// What bodies cost that fall far from each other, as a user pays: whole steps, broad phase and sleepers
// counted.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/methods/method.h"

namespace lodestone {

inline constexpr double kDropsStep = 1.0 / 60;  // s
inline constexpr int kDropsSteps = 600;

struct DropsSettings {
  int bodies = 1'000;
  std::vector<std::string> methods = {"full_plain", "full", "bullet_hull40", "statistical"};
  /// Of the statistical level: "tables", "tables_published" or "support"; empty: all.
  std::string model = {};
  int threads = 1;  ///< of the statistical level; the others run on one
  SignatureSettings measuring = {};
  std::uint64_t seed = 1;
  Progress progress = {};
};

/// Drops 0 … bodies − 1 of `compare drop`, in one world, too far apart to touch, until ten seconds have
/// passed. Whoever has come to rest sleeps, by every method.
struct DropsRow {
  std::string method = {}, model = {};
  std::optional<double> ns_per_body_step = {};  ///< of processor time: all steps over `awake_body_steps`
  std::optional<double> seconds = {};           ///< of processor time, of all steps
  std::optional<double> awake = {};             ///< bodies at the start of a step, mean
  std::int64_t awake_body_steps = 0;
  std::string left_out = {};
};

/// A row for each method, in one run. Throws InputError for an unknown one.
std::vector<DropsRow> bench_drops(const DropJob& job, const DropsSettings& settings);

}  // namespace lodestone
