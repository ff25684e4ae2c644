#include <gtest/gtest.h>

#include "scenes/scene_file.h"
#include "tools/bench/endurance_bench.h"

namespace lodestone {
namespace {

TEST(Endurance, ASmallWorldKeepsItsMemoryAndItsEnergy) {
  const EnduranceFigures figures = bench_endurance({.steps = 20 * kEnduranceRound, .bodies = 6});
  EXPECT_EQ(figures.steps, 20 * kEnduranceRound);
  EXPECT_TRUE(figures.finite);
  EXPECT_GT(figures.changes, 100);  // up and down the rungs
  EXPECT_EQ(figures.states_recovered, 0);
  EXPECT_LE(figures.heap_growth_bytes, kEnduranceMemory);
  EXPECT_LE(figures.energy_over_start, kEnduranceEnergy);
  EXPECT_GT(figures.last_step_us, 0.0);
}

TEST(Endurance, ASceneIsCircled) {
  const EnduranceFigures figures = bench_endurance(
      {.steps = 3 * kEnduranceRound,
       .scene = load_scene(std::filesystem::path(LODESTONE_SOURCE_DIR) / "scenes/drop.yaml")});
  EXPECT_EQ(figures.steps, 3 * kEnduranceRound);
  EXPECT_TRUE(figures.finite);
  EXPECT_LE(figures.energy_over_start, kEnduranceEnergy);
  EXPECT_GT(figures.last_step_us, 0.0);
}

TEST(Endurance, EachFigureHasItsBound) {
  const EnduranceFigures good{.steps = 1200,
                              .heap_growth_bytes = 100,
                              .resident_growth_bytes = 4096,
                              .energy_over_start = 1.0,
                              .first_step_us = 10,
                              .last_step_us = 11};
  EXPECT_TRUE(endures(good));
  EnduranceFigures bad = good;
  bad.heap_growth_bytes = 2e6;
  EXPECT_FALSE(endures(bad));
  bad = good, bad.resident_growth_bytes = 2e6;
  EXPECT_FALSE(endures(bad));
  bad = good, bad.energy_over_start = 1.02;
  EXPECT_FALSE(endures(bad));
  bad = good, bad.last_step_us = 16;
  EXPECT_FALSE(endures(bad));
  bad = good, bad.states_recovered = 1;
  EXPECT_FALSE(endures(bad));
  bad = good, bad.finite = false;
  EXPECT_FALSE(endures(bad));
}

}  // namespace
}  // namespace lodestone
