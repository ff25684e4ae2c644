#include "lod/policy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

using Indices = std::vector<std::int32_t>;

constexpr double kFullBodyMs = 1.0;
const std::vector<Vec3> kAtOrigin{Vec3::Zero()};

PolicySettings by_distance(double full_within = 4.0) { return {.policy = DistancePolicy{full_within}}; }
PolicySettings by_budget(double milliseconds) { return {.policy = BudgetPolicy{milliseconds}, .max_transitions_per_frame = 1000}; }

LevelCandidate at(double distance, Level level = Level::statistical) { return {.position = {distance, 0, 0}, .level = level}; }

LevelDecision choose(const std::vector<LevelCandidate>& candidates, const PolicySettings& settings, double full_body_ms = kFullBodyMs,
                     double statistical_ms = 0.0) {
  return choose_levels(candidates, kAtOrigin, settings, full_body_ms, statistical_ms);
}

void make_changes(const LevelDecision& decision, std::vector<LevelCandidate>& candidates) {
  for (LevelCandidate& c : candidates) ++c.frames_since_change;
  for (const auto i : decision.promote) candidates[i].level = Level::full, candidates[i].frames_since_change = 0;
  for (const auto i : decision.demote) candidates[i].level = Level::statistical, candidates[i].frames_since_change = 0;
}

std::int64_t count_full(const std::vector<LevelCandidate>& candidates) {
  return std::ranges::count(candidates, Level::full, &LevelCandidate::level);
}

TEST(DistancePolicy, PromotesNearAndDemotesFar) {
  const auto decision = choose({at(1), at(9), at(1, Level::full), at(9, Level::full)}, by_distance());
  EXPECT_EQ(decision.promote, Indices{0});
  EXPECT_EQ(decision.demote, Indices{3});
  EXPECT_EQ(decision.reasons, (std::vector{LevelReason::near, LevelReason::far, LevelReason::near, LevelReason::far}));
}

TEST(DistancePolicy, BodyBetweenTheTwoLimitsKeepsItsLevel) {
  const auto decision = choose({at(4.2), at(4.2, Level::full)}, by_distance());
  EXPECT_TRUE(decision.promote.empty() && decision.demote.empty());
  EXPECT_EQ(decision.reasons[1], LevelReason::within_hysteresis);
}

TEST(DistancePolicy, MeasuresToTheSurfaceAndScalesByImportance) {
  std::vector<LevelCandidate> candidates{at(4.5), at(4.5), at(7), at(7)};
  candidates[1].radius = 0.6;
  candidates[3].importance = 2.0;
  EXPECT_EQ(choose(candidates, by_distance()).promote, (Indices{3, 1}));
}

TEST(DistancePolicy, NearestOfSeveralViewpointsCounts) {
  const std::vector<Vec3> viewpoints{{100, 0, 0}, {8, 0, 0}};
  EXPECT_EQ(choose_levels(std::vector{at(9)}, viewpoints, by_distance(), 1, 0).promote, Indices{0});
}

TEST(DistancePolicy, WithoutViewpointsEveryBodyIsStatistical) {
  const auto decision = choose_levels(std::vector{at(0), at(0, Level::full)}, {}, by_distance(), 1, 0);
  EXPECT_TRUE(decision.promote.empty());
  EXPECT_EQ(decision.demote, Indices{1});
}

TEST(Policy, DwellKeepsANewLevel) {
  std::vector<LevelCandidate> candidates{at(1), at(9, Level::full)};
  candidates[0].frames_since_change = candidates[1].frames_since_change = 29;
  const auto held = choose(candidates, by_distance());
  EXPECT_TRUE(held.promote.empty() && held.demote.empty());
  EXPECT_EQ(held.reasons, (std::vector{LevelReason::dwell, LevelReason::dwell}));
  candidates[0].frames_since_change = candidates[1].frames_since_change = 30;
  const auto free = choose(candidates, by_distance());
  EXPECT_EQ(free.promote, Indices{0});
  EXPECT_EQ(free.demote, Indices{1});
}

TEST(Policy, T8CapTakesTheNearestFirstAndQueuesTheRest) {
  const auto decision = choose({at(3), at(1), at(2), at(2), at(0.5), at(3.5)}, by_distance());
  EXPECT_EQ(decision.promote, (Indices{4, 1, 2, 3}));
  EXPECT_EQ(decision.reasons[0], LevelReason::queued);
  EXPECT_EQ(decision.reasons[5], LevelReason::queued);
}

TEST(Policy, T8PromotionsAndDemotionsShareTheCapByTurns) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 5; ++i) candidates.push_back(at(1 + 0.1 * i));
  for (int i = 0; i < 5; ++i) candidates.push_back(at(9 + 0.1 * i, Level::full));
  const auto both = choose(candidates, by_distance());
  EXPECT_EQ(both.promote, (Indices{0, 1}));
  EXPECT_EQ(both.demote, (Indices{9, 8}));
  candidates.resize(6);
  const auto rest_goes_to_promotions = choose(candidates, by_distance());
  EXPECT_EQ(rest_goes_to_promotions.promote, (Indices{0, 1, 2}));
  EXPECT_EQ(rest_goes_to_promotions.demote, Indices{5});
}

TEST(Policy, ForcedBodiesWaitForNothing) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 10; ++i) {
    candidates.push_back(at(1000));
    candidates.back().choice = LevelChoice::full;
    candidates.back().frames_since_change = 0;
  }
  candidates.push_back(at(0, Level::full));
  candidates.back().choice = LevelChoice::statistical;
  for (const PolicySettings& settings : {by_distance(), by_budget(0.0)}) {
    const auto decision = choose(candidates, settings);
    EXPECT_EQ(decision.promote.size(), 10u);
    EXPECT_EQ(decision.demote, Indices{10});
    EXPECT_EQ(decision.reasons[3], LevelReason::forced);
  }
}

TEST(Policy, NewcomersAreNotLimited) {
  std::vector<LevelCandidate> candidates(20, at(1));
  for (LevelCandidate& c : candidates) c.newcomer = true;
  EXPECT_EQ(choose(candidates, by_distance()).promote.size(), 20u);
}

TEST(Policy, PutOffBodyWaitsAndLeavesItsTurnToOthers) {
  std::vector<LevelCandidate> candidates(6, at(1));
  candidates[0].put_off = true;
  const auto decision = choose(candidates, by_distance());
  EXPECT_EQ(decision.promote, (Indices{1, 2, 3, 4}));
  EXPECT_EQ(decision.reasons[0], LevelReason::overlap_put_off);
}

TEST(Policy, T7CameraAboutTheThresholdChangesNothingOrOnceADwell) {
  for (const double hysteresis : {0.1, 0.0}) {
    PolicySettings settings = by_distance();
    settings.hysteresis = hysteresis;
    std::vector<LevelCandidate> candidates{at(4)};
    int changes = 0;
    constexpr int kFrames = 3600;
    for (int frame = 0; frame < kFrames; ++frame) {
      candidates[0].position.x() = 4.0 * (1.0 + 0.01 * ((frame / 3) % 2 ? 1 : -1));
      const auto decision = choose(candidates, settings);
      changes += int(decision.promote.size() + decision.demote.size());
      make_changes(decision, candidates);
    }
    EXPECT_LE(changes, hysteresis > 0.0 ? 1 : kFrames / settings.min_dwell_frames + 1);
    EXPECT_GE(changes, 1);
  }
}

TEST(BudgetPolicy, KeepsTheNearestThatFitBesidesTheStatisticalLevel) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 20; ++i) candidates.push_back(at(20 - i));
  const auto decision = choose(candidates, by_budget(7.0), kFullBodyMs, 2.0);  // 5 fit; 4 leave a tenth of it free
  EXPECT_EQ(decision.promote, (Indices{19, 18, 17, 16}));
  EXPECT_EQ(decision.reasons[19], LevelReason::in_budget);
  EXPECT_EQ(decision.reasons[0], LevelReason::over_budget);
}

TEST(BudgetPolicy, ForcedFullBodiesUseUpTheBudgetFirst) {
  std::vector<LevelCandidate> candidates{at(50, Level::full), at(60, Level::full), at(1), at(2)};
  candidates[0].choice = candidates[1].choice = LevelChoice::full;
  EXPECT_EQ(choose(candidates, by_budget(3.4)).promote, Indices{2});
  EXPECT_TRUE(choose(candidates, by_budget(2.5)).promote.empty());
}

TEST(BudgetPolicy, ANearerBodyTakesThePlaceOfAFartherOne) {
  const auto decision = choose({at(5, Level::full), at(6, Level::full), at(4), at(5.8)}, by_budget(2.0));
  EXPECT_EQ(decision.promote, Indices{2});
  EXPECT_EQ(decision.demote, Indices{1});  // 5.8 is not a tenth nearer than 6
}

TEST(BudgetPolicy, NoiseOfTheMeasuredCostFlipsNothing) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 40; ++i) candidates.push_back(at(1 + i));
  const PolicySettings settings = by_budget(20.0);
  make_changes(choose(candidates, settings, 1.0), candidates);
  for (int frame = 0; frame < 200; ++frame) {
    const auto decision = choose(candidates, settings, 1.0 + 0.04 * std::sin(frame));
    EXPECT_TRUE(decision.demote.empty());
    make_changes(decision, candidates);
  }
}

TEST(BudgetPolicy, T11NeverOverBudgetThoughItChangesEveryFrame) {
  constexpr int kBodies = 30;
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < kBodies; ++i) candidates.push_back(at(1 + i));
  int most = 0;
  for (int frame = 0; frame < 400; ++frame) {
    const int fits[] = {0, 1, kBodies - 1, kBodies};
    const int budget = fits[frame % 4];
    make_changes(choose(candidates, by_budget(budget * kFullBodyMs)), candidates);
    ASSERT_LE(count_full(candidates), budget) << "frame " << frame;
    most = std::max(most, int(count_full(candidates)));
  }
  EXPECT_GE(most, 1);
}

TEST(BudgetPolicy, T11EveryBodyHasItsTurnAsTheViewpointMoves) {
  constexpr int kBodies = 30;
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < kBodies; ++i) candidates.push_back(at(i));
  std::vector<bool> was_full(kBodies);
  for (int frame = 0; frame < 1200; ++frame) {
    const std::vector<Vec3> viewpoint{{frame * kBodies / 1200.0, 0, 0}};
    make_changes(choose_levels(candidates, viewpoint, by_budget(5.0), kFullBodyMs, 0), candidates);
    for (int i = 0; i < kBodies; ++i) was_full[i] = was_full[i] || candidates[i].level == Level::full;
  }
  EXPECT_EQ(std::ranges::count(was_full, true), kBodies);
}

TEST(Policy, EveryReasonHasWords) {
  for (int reason = 0; reason <= int(LevelReason::contact_group); ++reason) EXPECT_FALSE(text_of(LevelReason(reason)).empty());
}

}  // namespace
}  // namespace lodestone
