#include <fmt/format.h>

#include "reference/random.h"
#include "tools/bench/case_parts.h"
#include "tools/bench/engine_cases.h"
#include "tools/bench/resident_memory.h"

namespace lodestone {
namespace {

constexpr int kBodies = 20;
constexpr double kStep = 1.0 / 60, kMostSeconds = 60.0;

/// Boxes dropped on each other and stepped until all sleep.
Manager make_sleeping_pile(LevelChoice level) {
  Manager manager = make_unmeasured_manager();
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto box = box_of({0.2, 0.3, 0.2});
  for (int i = 0; i < kBodies; ++i) {
    RandomStream random(16, i, 0);
    const Vec3 place(0.3 * (i % 2) + random.uniform(-0.05, 0.05), 0.35 * (i / 2 % 2) + random.uniform(-0.05, 0.05), 0.15 + 0.25 * (i / 4));
    manager.add_body({.shape = box, .state = {.position = place}, .level = level});
  }
  for (int i = 0; i * kStep < kMostSeconds && manager.report().asleep < kBodies; ++i) manager.step(kStep);
  return manager;
}

void add_rows(std::vector<HardCaseRow>& rows, LevelChoice level, const std::string& name, std::int64_t steps) {
  Manager manager = make_sleeping_pile(level);
  const std::string what = fmt::format("{:.0e} steps of a sleeping {} pile: ", double(steps), name);
  rows.push_back({.what = what + "awake at the start", .value = double(kBodies - manager.report().asleep), .bound = 0.0, .unit = "bodies"});
  const std::uint64_t hash = manager.state_hash();
  const double before = resident_bytes();
  for (std::int64_t i = 0; i < steps; ++i) manager.step(kStep);
  rows.push_back({.what = what + "state hash changed", .value = manager.state_hash() == hash ? 0.0 : 1.0, .bound = 0.0});
  rows.push_back({.what = what + "growth of memory", .value = resident_bytes() - before, .bound = 1e6, .unit = "bytes"});
}

}  // namespace

std::vector<HardCaseRow> measure_sleeping_pile(const HardCaseSettings& settings) {
  const std::int64_t steps = settings.quick ? 100'000 : 10'000'000;
  std::vector<HardCaseRow> rows;
  add_rows(rows, LevelChoice::full, "full", steps);
  add_rows(rows, LevelChoice::statistical, "statistical", steps);
  return rows;
}

}  // namespace lodestone
