#include "lod/timing/stage_zones.h"

#include <gtest/gtest.h>

#include <thread>

#include "lod/timing/stage_timer.h"

namespace lodestone {
namespace {

struct Listener {
  std::string heard;
  ProfileHooks hooks{.begin = [this](std::string_view zone) { heard += std::string(zone) + "("; },
                     .end = [this](std::string_view zone) { heard += ")" + std::string(zone) + " "; }};
};

TEST(StageZones, TimersOfItsTimesAreZonesWithin) {
  Listener listener;
  StageTimes times;
  double other = 0.0;
  {
    const StageZones zones(listener.hooks, times);
    { const StageTimer timer(times.choose_ms); }
    {
      const StageTimer outer(times.crowd_ms);
      const StageTimer inner(times.pairs_ms);
    }
    { const StageTimer timer(other); }           // of none of those times
    { const StageTimer timer(times.total_ms); }  // the whole is the step itself
  }
  EXPECT_EQ(listener.heard, "step(choose()choose crowd(pairs()pairs )crowd )step ");
  EXPECT_GE(times.choose_ms, 0.0);
}

TEST(StageZones, EveryStageHasItsName) {
  Listener listener;
  StageTimes times;
  const StageZones zones(listener.hooks, times);
  for (double* field :
       {&times.choose_ms, &times.transfer_ms, &times.flight_ms, &times.broad_phase_ms, &times.pairs_ms,
        &times.crowd_ms, &times.rest_ms, &times.cross_level_ms, &times.full_ms})
    StageZones::begin(*field);
  EXPECT_EQ(listener.heard, "step(choose(transfer(flight(broad_phase(pairs(crowd(rest(cross_level(full(");
}

TEST(StageZones, OfAnotherThreadAreNotHeard) {
  Listener listener;
  StageTimes times;
  const StageZones zones(listener.hooks, times);
  std::thread([&] { const StageTimer timer(times.full_ms); }).join();
  EXPECT_EQ(listener.heard, "step(");
}

// A manager that is stepped within another's hook has its own zones; then the outer one's count again.
TEST(StageZones, LieWithinEachOther) {
  Listener outer, inner;
  StageTimes times, inner_times;
  {
    const StageZones zones(outer.hooks, times);
    {
      const StageZones within(inner.hooks, inner_times);
      const StageTimer timer(inner_times.rest_ms);
      const StageTimer of_outer(times.rest_ms);
    }
    const StageTimer timer(times.full_ms);
  }
  EXPECT_EQ(outer.heard, "step(full()full )step ");
  EXPECT_EQ(inner.heard, "step(rest()rest )step ");
}

TEST(StageZones, WhereNobodyListensThereAreNone) {
  const ProfileHooks none;
  StageTimes times;
  const StageZones zones(none, times);
  EXPECT_NO_THROW({ const StageTimer timer(times.full_ms); });
}

}  // namespace
}  // namespace lodestone
