// Properties over random bodies and viewpoints; views_test.cpp has the single cases.
#include "lod/manager/remoteness.h"

#include <gtest/gtest.h>

#include "lod/manager/choose_levels.h"
#include "reference/random.h"

namespace lodestone {
namespace {

LevelCandidate draw_candidate(RandomStream& random) {
  LevelCandidate c;
  c.position = random.uniform(0.0, 40.0) * random.direction();
  c.radius = random.uniform(0.05, 2.0);
  c.importance = random.uniform(0.2, 5.0);
  c.view_factor = random.uniform() < 0.3 ? random.uniform(1.0, 4.0) : 1.0;
  c.rung = Rung(int(random.uniform(0.0, 3.0)));
  return c;
}

Views draw_views(RandomStream& random, int count) {
  std::vector<Viewpoint> viewpoints;
  for (int i = 0; i < count; ++i)
    viewpoints.push_back({.position = random.uniform(0.0, 20.0) * random.direction(),
                          .height_px = random.uniform(100.0, 2000.0)});
  return Views(std::span<const Viewpoint>(viewpoints));
}

constexpr Measure kMeasures[] = {Measure::distance, Measure::size};

TEST(RemotenessProperties, TheNearestViewCounts) {
  RandomStream random(41, 0, 0);
  for (int i = 0; i < 200; ++i) {
    const LevelCandidate c = draw_candidate(random);
    std::vector<Viewpoint> viewpoints;
    for (int v = 0; v < 3; ++v)
      viewpoints.push_back({.position = random.uniform(0.0, 20.0) * random.direction()});
    for (const Measure measure : kMeasures) {
      double nearest = 1e300;
      for (const Viewpoint& one : viewpoints)
        nearest = std::min(nearest, remoteness(c, Views(std::span(&one, 1)), measure));
      EXPECT_DOUBLE_EQ(remoteness(c, Views(std::span<const Viewpoint>(viewpoints)), measure), nearest);
    }
  }
}

// In metres by hand: to the surface, over the importance, times the factor for what is out of view.
TEST(RemotenessProperties, IsTheDistanceOfTheSurfaceOverTheImportance) {
  RandomStream random(42, 0, 0);
  for (int i = 0; i < 200; ++i) {
    const LevelCandidate c = draw_candidate(random);
    const Vec3 eye = random.uniform(0.0, 20.0) * random.direction();
    const double gap = std::max(0.0, (c.position - eye).norm() - c.radius);
    EXPECT_NEAR(remoteness(c, Views(std::vector{eye})), gap * c.view_factor / c.importance,
                1e-12 * (1 + gap));
  }
}

// A scene twice as large is twice as far, and as large in the picture.
TEST(RemotenessProperties, ScalesWithTheScene) {
  RandomStream random(43, 0, 0);
  for (int i = 0; i < 200; ++i) {
    LevelCandidate c = draw_candidate(random), large = c;
    const Viewpoint eye{.position = random.uniform(0.0, 20.0) * random.direction()};
    Viewpoint large_eye = eye;
    large.position *= 2.0, large.radius *= 2.0, large_eye.position *= 2.0;
    const Views views(std::span(&eye, 1)), large_views(std::span(&large_eye, 1));
    EXPECT_NEAR(remoteness(large, large_views), 2.0 * remoteness(c, views), 1e-9);
    EXPECT_NEAR(remoteness(large, large_views, Measure::size), remoteness(c, views, Measure::size), 1e-12);
  }
}

TEST(RemotenessProperties, NoFartherThanWhatItIsAboutToHit) {
  RandomStream random(44, 0, 0);
  const Views views = draw_views(random, 2);
  LevelCandidate c = draw_candidate(random);
  c.position = {100, 0, 0}, c.no_farther_than = 3.0;
  EXPECT_EQ(remoteness(c, views), 3.0);
  EXPECT_EQ(remoteness(c, Views()), 3.0);
  c.no_farther_than = kInfinity;
  EXPECT_EQ(remoteness(c, Views()), kInfinity);
}

TEST(RemotenessProperties, ARankIsNearerByTheHysteresisOnAHigherRung) {
  RandomStream random(45, 0, 0);
  const Views views = draw_views(random, 1);
  for (int i = 0; i < 50; ++i) {
    LevelCandidate c = draw_candidate(random);
    for (const Measure measure : kMeasures) {
      const double plain = remoteness(c, views, measure);
      double last = kInfinity;
      for (const Rung rung : {Rung::tables, Rung::support, Rung::full}) {
        c.rung = rung;
        const double rank = rank_distance(c, views, 0.2, measure);
        EXPECT_LE(rank, last);
        last = rank;
        EXPECT_DOUBLE_EQ(rank_distance(c, views, 0.0, measure), plain);
      }
      c.newcomer = true;
      EXPECT_DOUBLE_EQ(rank_distance(c, views, 0.2, measure), plain);
      c.newcomer = false;
    }
  }
}

// Who stays put is decided by nobody: for any policy of distances or sizes, the decision has it where it is.
TEST(RemotenessProperties, WhoStaysPutIsNotMovedByTheDecision) {
  RandomStream random(46, 0, 0);
  int stay = 0;
  for (int i = 0; i < 1000; ++i) {
    PolicySettings settings;
    settings.hysteresis = random.uniform(0.0, 0.3), settings.min_dwell_frames = 0;
    const double full = random.uniform(0.5, 20.0);
    if (i % 2 == 0)
      settings.policy = DistancePolicy{full, i % 4 == 0 ? full * random.uniform(1.0, 3.0) : kInfinity};
    else
      settings.policy = ProjectedSizePolicy{10.0 * full, i % 4 == 1 ? 3.0 * full : 0.0};
    const Views views = draw_views(random, 1 + i % 3);
    LevelCandidate c = draw_candidate(random);
    const RungSet sets[] = {kEveryRung, {Rung::support, Rung::full}, {Rung::tables, Rung::support}};
    c.open = sets[int(random.uniform(0.0, 3.0))];
    if (!stays_put(c, views, *limits_of(settings))) continue;
    ++stay;
    const LevelDecision decision = choose_levels({&c, 1}, views, settings);
    EXPECT_TRUE(decision.promote.empty() && decision.demote.empty()) << i;
    EXPECT_EQ(decision.reasons[0], reason_for_rung(*limits_of(settings), c)) << i;
  }
  EXPECT_GT(stay, 150);
}

// Wherever the viewpoints go, as long as none has travelled that far.
TEST(RemotenessProperties, NothingChangesUntilTheyHaveTravelled) {
  RandomStream random(47, 0, 0);
  int asked = 0;
  for (int i = 0; i < 600; ++i) {
    const double full = random.uniform(0.5, 10.0), hysteresis = random.uniform(0.0, 0.3);
    PolicySettings settings{.policy = DistancePolicy{full, i % 2 ? 2.5 * full : kInfinity},
                            .hysteresis = hysteresis,
                            .min_dwell_frames = 0};
    if (i % 3 == 0) settings.policy = ProjectedSizePolicy{20.0 * full, i % 2 ? 5.0 * full : 0.0};
    const Limits limits = *limits_of(settings);
    std::vector<Viewpoint> eyes(2);
    for (Viewpoint& eye : eyes) eye.position = random.uniform(0.0, 30.0) * random.direction();
    const Views views(std::span<const Viewpoint>{eyes});
    const LevelCandidate c = draw_candidate(random);
    if (c.rung == Rung::full || !stays_put(c, views, limits)) continue;
    const double travel = travel_until_change(c, views, limits, hysteresis);
    if (!(travel > 0.0)) continue;
    ++asked;
    for (int move = 0; move < 4; ++move) {
      std::vector<Viewpoint> moved = eyes;
      for (Viewpoint& eye : moved)
        eye.position += (0.999999 * std::min(travel, 1e3) - 1e-9) *
                        (move == 0 ? Vec3((c.position - eye.position).normalized()) : random.direction());
      const LevelDecision decision =
          choose_levels({&c, 1}, Views(std::span<const Viewpoint>(moved)), settings);
      EXPECT_TRUE(decision.promote.empty() && decision.demote.empty()) << i << ' ' << travel;
    }
  }
  EXPECT_GT(asked, 100);
}

TEST(Limits, AreOfDistancesAndSizesAndOfNoBudget) {
  EXPECT_FALSE(limits_of({.policy = BudgetPolicy{}}));
  EXPECT_FALSE(limits_of({.policy = WorkPolicy{}}));
  EXPECT_FALSE(limits_of({.policy = ErrorBudgetPolicy{}}));
  const Limits distance = *limits_of({.policy = DistancePolicy{3.0}});
  EXPECT_FALSE(distance.three_rungs());
  EXPECT_EQ(distance.full_within, 3.0);
  const Limits size = *limits_of({.policy = ProjectedSizePolicy{50.0, 8.0}});
  EXPECT_TRUE(size.three_rungs());
  EXPECT_EQ(size.measure, Measure::size);
  EXPECT_LT(size.full_within, size.support_within);
  EXPECT_FALSE(limits_of({.policy = ProjectedSizePolicy{50.0, 0.0}})->three_rungs());
}

}  // namespace
}  // namespace lodestone
