#include "lod/manager/choose_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

using Indices = std::vector<std::int32_t>;

constexpr RungSet kSupportOrFull{Rung::support, Rung::full};
const std::vector<Vec3> kAtOrigin{Vec3::Zero()};

PolicySettings by_distance(double full_within = 4.0) { return {.policy = DistancePolicy{full_within}}; }
PolicySettings by_budget(double milliseconds) {
  return {.policy = BudgetPolicy{milliseconds}, .max_transitions_per_frame = 1000};
}

LevelCandidate at(double distance, Rung rung = Rung::support, RungSet open = kSupportOrFull) {
  return {.position = {distance, 0, 0}, .cost = {0.0f, 0.0f, 1.0f}, .rung = rung, .open = open};
}
/// On any of the three rungs, which cost 0, 1/8 and 1.
LevelCandidate on_ladder(double distance, Rung rung = Rung::tables) {
  LevelCandidate c = at(distance, rung, kEveryRung);
  c.cost = {0.0f, 0.125f, 1.0f};
  return c;
}

LevelDecision choose(const std::vector<LevelCandidate>& candidates, const PolicySettings& settings,
                     double others = 0.0) {
  return choose_levels(candidates, kAtOrigin, settings, {.others = others});
}

Indices who(const std::vector<LevelDecision::Change>& changes) {
  Indices candidates;
  for (const auto& change : changes) candidates.push_back(change.candidate);
  return candidates;
}

void make_changes(const LevelDecision& decision, std::vector<LevelCandidate>& candidates,
                  int min_dwell_frames = PolicySettings{}.min_dwell_frames) {
  for (LevelCandidate& c : candidates) c.dwell_left = std::max(0, c.dwell_left - 1);
  for (const auto* changes : {&decision.demote, &decision.promote})
    for (const auto& [i, to] : *changes)
      candidates[std::size_t(i)].rung = to, candidates[std::size_t(i)].dwell_left = min_dwell_frames;
}

std::int64_t count_on(Rung rung, const std::vector<LevelCandidate>& candidates) {
  return std::ranges::count(candidates, rung, &LevelCandidate::rung);
}

TEST(DistancePolicy, PromotesNearAndDemotesFar) {
  const auto decision = choose({at(1), at(9), at(1, Rung::full), at(9, Rung::full)}, by_distance());
  EXPECT_EQ(who(decision.promote), Indices{0});
  EXPECT_EQ(who(decision.demote), Indices{3});
  EXPECT_EQ(decision.reasons, (std::vector{Rule::near, Rule::far, Rule::near, Rule::far}));
}

TEST(DistancePolicy, BodyBetweenTheTwoLimitsKeepsItsLevel) {
  const auto decision = choose({at(4.2), at(4.2, Rung::full)}, by_distance());
  EXPECT_TRUE(decision.promote.empty() && decision.demote.empty());
  EXPECT_EQ(decision.reasons[1], Rule::within_hysteresis);
}

TEST(DistancePolicy, MeasuresToTheSurfaceAndScalesByImportance) {
  std::vector<LevelCandidate> candidates{at(4.5), at(4.5), at(7), at(7)};
  candidates[1].radius = 0.6;
  candidates[3].importance = 2.0;
  EXPECT_EQ(who(choose(candidates, by_distance()).promote), (Indices{3, 1}));
}

TEST(DistancePolicy, NearestOfSeveralViewpointsCounts) {
  const std::vector<Vec3> viewpoints{{100, 0, 0}, {8, 0, 0}};
  EXPECT_EQ(who(choose_levels(std::vector{at(9)}, viewpoints, by_distance()).promote), Indices{0});
}

TEST(DistancePolicy, WithoutViewpointsEveryBodyIsStatistical) {
  const auto decision = choose_levels(std::vector{at(0), at(0, Rung::full)}, {}, by_distance());
  EXPECT_TRUE(decision.promote.empty());
  EXPECT_EQ(who(decision.demote), Indices{1});
}

TEST(Policy, DwellKeepsANewLevel) {
  std::vector<LevelCandidate> candidates{at(1), at(9, Rung::full)};
  candidates[0].dwell_left = candidates[1].dwell_left = 1;
  const auto held = choose(candidates, by_distance());
  EXPECT_TRUE(held.promote.empty() && held.demote.empty());
  EXPECT_EQ(held.reasons, (std::vector{Rule::dwell, Rule::dwell}));
  candidates[0].dwell_left = candidates[1].dwell_left = 0;
  const auto free = choose(candidates, by_distance());
  EXPECT_EQ(who(free.promote), Indices{0});
  EXPECT_EQ(who(free.demote), Indices{1});
}

TEST(Policy, T8CapTakesTheNearestFirstAndQueuesTheRest) {
  const auto decision = choose({at(3), at(1), at(2), at(2), at(0.5), at(3.5)}, by_distance());
  EXPECT_EQ(who(decision.promote), (Indices{4, 1, 2, 3}));
  EXPECT_EQ(decision.reasons[0], Rule::queued);
  EXPECT_EQ(decision.reasons[5], Rule::queued);
}

TEST(Policy, T8PromotionsAndDemotionsShareTheCapByTurns) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 5; ++i) candidates.push_back(at(1 + 0.1 * i));
  for (int i = 0; i < 5; ++i) candidates.push_back(at(9 + 0.1 * i, Rung::full));
  const auto both = choose(candidates, by_distance());
  EXPECT_EQ(who(both.promote), (Indices{0, 1}));
  EXPECT_EQ(who(both.demote), (Indices{9, 8}));
  candidates.resize(6);
  const auto rest_goes_to_promotions = choose(candidates, by_distance());
  EXPECT_EQ(who(rest_goes_to_promotions.promote), (Indices{0, 1, 2}));
  EXPECT_EQ(who(rest_goes_to_promotions.demote), Indices{5});
}

TEST(Policy, ForcedBodiesWaitForNothing) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 10; ++i) {
    candidates.push_back(at(1000));
    candidates.back().open = {Rung::full};
    candidates.back().dwell_left = 30;
  }
  candidates.push_back(at(0, Rung::full));
  candidates.back().open = {Rung::support};
  for (const PolicySettings& settings : {by_distance(), by_budget(0.0)}) {
    const auto decision = choose(candidates, settings);
    EXPECT_EQ(decision.promote.size(), 10u);
    EXPECT_EQ(who(decision.demote), Indices{10});
    EXPECT_EQ(decision.reasons[3], Rule::forced);
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
  EXPECT_EQ(who(decision.promote), (Indices{1, 2, 3, 4}));
  EXPECT_EQ(decision.reasons[0], Rule::overlap_put_off);
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
  const auto decision = choose(candidates, by_budget(7.0), 2.0);  // 5 fit; 4 leave a tenth of it free
  EXPECT_EQ(who(decision.promote), (Indices{19, 18, 17, 16}));
  EXPECT_EQ(decision.reasons[19], Rule::in_budget);
  EXPECT_EQ(decision.reasons[0], Rule::over_budget);
}

TEST(BudgetPolicy, ForcedFullBodiesUseUpTheBudgetFirst) {
  std::vector<LevelCandidate> candidates{at(50, Rung::full), at(60, Rung::full), at(1), at(2)};
  candidates[0].open = candidates[1].open = {Rung::full};
  EXPECT_EQ(who(choose(candidates, by_budget(3.4)).promote), Indices{2});
  EXPECT_TRUE(choose(candidates, by_budget(2.5)).promote.empty());
}

TEST(BudgetPolicy, ANearerBodyTakesThePlaceOfAFartherOne) {
  const auto decision = choose({at(5, Rung::full), at(6, Rung::full), at(4), at(5.8)}, by_budget(2.0));
  EXPECT_EQ(who(decision.promote), Indices{2});
  EXPECT_EQ(who(decision.demote), Indices{1});  // 5.8 is not a tenth nearer than 6
}

TEST(BudgetPolicy, NoiseOfTheMeasuredCostFlipsNothing) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 40; ++i) candidates.push_back(at(1 + i));
  const PolicySettings settings = by_budget(20.0);
  make_changes(choose(candidates, settings), candidates);
  for (int frame = 0; frame < 200; ++frame) {
    for (LevelCandidate& c : candidates) c.cost[2] = float(1.0 + 0.04 * std::sin(frame));
    const auto decision = choose(candidates, settings);
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
    make_changes(choose(candidates, by_budget(budget)), candidates);
    ASSERT_LE(count_on(Rung::full, candidates), budget) << "frame " << frame;
    most = std::max(most, int(count_on(Rung::full, candidates)));
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
    make_changes(choose_levels(candidates, viewpoint, by_budget(5.0)), candidates);
    for (int i = 0; i < kBodies; ++i) was_full[i] = was_full[i] || candidates[i].rung == Rung::full;
  }
  EXPECT_EQ(std::ranges::count(was_full, true), kBodies);
}

TEST(Policy, EveryReasonHasWords) {
  for (int reason = 0; reason <= int(Rule::paused); ++reason) EXPECT_FALSE(text_of(Rule(reason)).empty());
}

TEST(DistancePolicy, EachRungHasItsDistanceAndItsHysteresis) {
  const PolicySettings settings{.policy = DistancePolicy{.full_within = 4.0, .support_within = 12.0}};
  const auto decision = choose({on_ladder(3), on_ladder(11), on_ladder(13), on_ladder(13, Rung::support),
                                on_ladder(14, Rung::support), on_ladder(5, Rung::full)},
                               settings);
  EXPECT_EQ(decision.promote, (std::vector<LevelDecision::Change>{{0, Rung::full}, {1, Rung::support}}));
  EXPECT_EQ(decision.demote, (std::vector<LevelDecision::Change>{{4, Rung::tables}, {5, Rung::support}}));
  EXPECT_EQ(decision.reasons,
            (std::vector{Rule::near, Rule::near, Rule::far, Rule::within_hysteresis, Rule::far, Rule::near}));
}

TEST(DistancePolicy, AClosedRungIsPassedOver) {
  const PolicySettings settings{.policy = DistancePolicy{.full_within = 4.0, .support_within = 12.0}};
  const auto decision = choose({at(8, Rung::full, {Rung::tables, Rung::full}), at(20, Rung::full),
                                at(3, Rung::tables, {Rung::tables, Rung::support})},
                               settings);
  EXPECT_EQ(decision.demote, (std::vector<LevelDecision::Change>{{1, Rung::support}, {0, Rung::tables}}));
  EXPECT_EQ(decision.promote, (std::vector<LevelDecision::Change>{{2, Rung::support}}));
}

TEST(DistancePolicy, BodiesThatStayPutAreThoseForWhomNothingChanges) {
  const PolicySettings settings{.policy = DistancePolicy{.full_within = 4.0, .support_within = 12.0},
                                .min_dwell_frames = 0};
  const auto& policy = std::get<DistancePolicy>(settings.policy);
  int stay = 0;
  for (const Rung rung : {Rung::tables, Rung::support})
    for (int i = 0; i < 300; ++i) {
      const LevelCandidate c = on_ladder(0.05 * i, rung);
      const auto decision = choose({c}, settings);
      const double travel = travel_until_change(c, kAtOrigin, policy, settings.hysteresis);
      const bool changes = !decision.promote.empty() || !decision.demote.empty();
      EXPECT_FALSE(changes && stays_put(c, kAtOrigin, policy)) << i;
      EXPECT_FALSE(changes && travel > 1e-9) << i;
      if (travel > 1e-9)  // a little less than that far, in both directions, and still nothing changes
        for (const double moved : {0.999 * travel, -0.999 * travel}) {
          const auto later = choose({on_ladder(std::max(0.0, 0.05 * i + moved), rung)}, settings);
          EXPECT_TRUE(later.promote.empty() && later.demote.empty()) << i << " moved by " << moved;
        }
      stay += stays_put(c, kAtOrigin, policy);
    }
  EXPECT_GT(stay, 150);
}

/// Without these limits all would be full.
PolicySettings with_most(int full, int support, bool budget) {
  PolicySettings settings =
      budget ? by_budget(1e6)
             : PolicySettings{.policy = DistancePolicy{100.0, 200.0}, .max_transitions_per_frame = 1000};
  settings.most_full = full, settings.most_support = support, settings.min_dwell_frames = 0;
  return settings;
}

TEST(Policy, MostOnARungIsNeverExceededAndTheNearestAreThere) {
  for (const bool budget : {false, true}) {
    const PolicySettings settings = with_most(5, 7, budget);
    std::vector<LevelCandidate> candidates;
    for (int i = 0; i < 40; ++i) candidates.push_back(on_ladder(1 + i));
    for (int frame = 0; frame < 60; ++frame) {
      for (int i = 0; i < 40; ++i) candidates[std::size_t(i)].position.x() = 1 + std::abs(i - frame / 2);
      const auto decision = choose(candidates, settings);
      make_changes(decision, candidates, settings.min_dwell_frames);
      ASSERT_LE(count_on(Rung::full, candidates), 5) << budget << " frame " << frame;
      ASSERT_LE(count_on(Rung::support, candidates), 7) << budget << " frame " << frame;
    }
    EXPECT_EQ(count_on(Rung::full, candidates), 5);
    EXPECT_EQ(candidates[29].rung, Rung::full);
    EXPECT_EQ(choose(candidates, settings).reasons[0], Rule::most_reached);
  }
}

// Groups of four, under limits for as many bodies as two of them and three have.
TEST(Policy, OfGroupsTheMostOnARungAreCountedByTheirBodies) {
  for (const bool budget : {false, true}) {
    PolicySettings settings = with_most(8, 12, budget);
    std::vector<LevelCandidate> groups;
    for (int i = 0; i < 20; ++i) {
      groups.push_back(on_ladder(1 + i));
      groups.back().bodies = 4;
    }
    for (int frame = 0; frame < 30; ++frame) {
      for (int i = 0; i < 20; ++i) groups[std::size_t(i)].position.x() = 1 + std::abs(i - frame / 2);
      make_changes(choose(groups, settings), groups, settings.min_dwell_frames);
      ASSERT_LE(count_on(Rung::full, groups), 2) << budget << " frame " << frame;
      ASSERT_LE(count_on(Rung::support, groups), 3) << budget << " frame " << frame;
    }
    EXPECT_EQ(groups[14].rung, Rung::full) << budget;
    EXPECT_EQ(count_on(Rung::full, groups), 2) << budget;
    EXPECT_EQ(count_on(Rung::support, groups), 3) << budget;
    EXPECT_EQ(choose(groups, settings).reasons[0], Rule::most_reached) << budget;

    settings.most_full = 4;  // and a lower limit takes the farther one down
    make_changes(choose(groups, settings), groups, settings.min_dwell_frames);
    EXPECT_EQ(groups[14].rung, Rung::full) << budget;
    EXPECT_EQ(count_on(Rung::full, groups), 1) << budget;

    groups[14].bodies = 5;  // more than may be full: those behind it may
    for (int frame = 0; frame < 5; ++frame)
      make_changes(choose(groups, settings), groups, settings.min_dwell_frames);
    EXPECT_NE(groups[14].rung, Rung::full) << budget;
    EXPECT_EQ(count_on(Rung::full, groups), 1) << budget;
  }
}

// As many as may be are full and far, as many others `support` and near: each waits for a place that another
// has.
TEST(Policy, WhereBothRungsAreTakenTheNearTakeThePlacesOfTheFar) {
  for (const bool budget : {false, true})
    for (const int most : {1, 3})
      for (const int turns : {1, 2, 4})
        for (const bool asleep : {false, true}) {
          PolicySettings settings = with_most(most, most, budget);
          settings.max_transitions_per_frame = turns;
          std::vector<LevelCandidate> candidates;
          for (int i = 0; i < 2 * most; ++i) {
            candidates.push_back(i < most ? on_ladder(21 + i, Rung::full) : on_ladder(1 + i, Rung::support));
            candidates.back().asleep = asleep;
          }
          for (int frame = 0; frame < 20; ++frame) {
            const auto decision = choose(candidates, settings);
            ASSERT_LE(decision.promote.size() + decision.demote.size(), std::size_t(turns));
            make_changes(decision, candidates, settings.min_dwell_frames);
            ASSERT_LE(count_on(Rung::full, candidates), most);
            ASSERT_TRUE(asleep || count_on(Rung::support, candidates) <= most);
          }
          for (int i = 0; i < 2 * most; ++i)
            EXPECT_EQ(candidates[std::size_t(i)].rung, i < most ? Rung::support : Rung::full)
                << budget << ' ' << most << ' ' << turns << ' ' << asleep;
        }
}

TEST(Policy, ATakenPlaceIsExchangedInOneStep) {
  for (const bool budget : {false, true}) {
    PolicySettings settings = with_most(1, 1, budget);
    settings.max_transitions_per_frame = 2;
    const auto decision = choose({on_ladder(21, Rung::full), on_ladder(1, Rung::support)}, settings);
    EXPECT_EQ(decision.demote, (std::vector<LevelDecision::Change>{{0, Rung::support}}));
    EXPECT_EQ(decision.promote, (std::vector<LevelDecision::Change>{{1, Rung::full}}));
  }
}

// Four bodies in the place of two and two.
TEST(Policy, AGroupThatFitsInNoOtherPlaceGoesByTheLowestRung) {
  for (const bool budget : {false, true}) {
    const PolicySettings settings = with_most(4, 4, budget);
    std::vector<LevelCandidate> groups{on_ladder(21, Rung::full), on_ladder(1, Rung::support),
                                       on_ladder(2, Rung::support)};
    groups[0].bodies = 4, groups[1].bodies = groups[2].bodies = 2;
    EXPECT_EQ(choose(groups, settings).demote, (std::vector<LevelDecision::Change>{{0, Rung::tables}}));
    for (int frame = 0; frame < 5; ++frame)
      make_changes(choose(groups, settings), groups, settings.min_dwell_frames);
    EXPECT_EQ(groups[0].rung, Rung::support);
    EXPECT_EQ(groups[1].rung, Rung::full);
    EXPECT_EQ(groups[2].rung, Rung::full);
  }
}

TEST(Policy, APlaceIsWaitedForThatAnotherLeavesAfterItsDwell) {
  PolicySettings settings = with_most(1, 1, false);
  settings.min_dwell_frames = 10;
  std::vector<LevelCandidate> candidates{on_ladder(21, Rung::full), on_ladder(22, Rung::support),
                                         on_ladder(1)};
  candidates[1].dwell_left = 5;
  for (int frame = 0; frame < 5; ++frame) {
    const auto decision = choose(candidates, settings);
    EXPECT_TRUE(decision.demote.empty() && decision.promote.empty());
    EXPECT_EQ(decision.reasons, (std::vector{Rule::queued, Rule::dwell, Rule::queued}));
    make_changes(decision, candidates, settings.min_dwell_frames);
  }
  make_changes(choose(candidates, settings), candidates, settings.min_dwell_frames);
  EXPECT_EQ(candidates[0].rung, Rung::support);
  EXPECT_EQ(candidates[1].rung, Rung::tables);
  EXPECT_EQ(candidates[2].rung, Rung::full);
}

TEST(Policy, ASleeperTakesNoPlaceAtSupport) {
  PolicySettings settings = with_most(1, 1, false);
  settings.min_dwell_frames = 10;
  std::vector<LevelCandidate> candidates{on_ladder(21, Rung::full), on_ladder(22, Rung::support),
                                         on_ladder(1)};
  candidates[1].dwell_left = 5;
  candidates[1].asleep = true;
  const auto decision = choose(candidates, settings);
  EXPECT_EQ(decision.demote, (std::vector<LevelDecision::Change>{{0, Rung::support}}));
  EXPECT_EQ(decision.promote, (std::vector<LevelDecision::Change>{{2, Rung::full}}));
}

// Whatever dwell and cap, under each policy; also of bodies that it wants lower anyhow.
TEST(Policy, ALimitThatIsExceededIsKeptAtOnce) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 20; ++i) {
    candidates.push_back(at(5 + i, Rung::full));
    candidates.back().error = {30.0f, 20.0f, 10.0f};
    candidates.back().dwell_left = 30;
  }
  PolicySettings settings;
  settings.max_transitions_per_frame = 2, settings.most_full = 3;
  for (const decltype(PolicySettings::policy)& policy :
       {decltype(PolicySettings::policy)(DistancePolicy{100.0}),
        decltype(PolicySettings::policy)(DistancePolicy{4.0}),
        decltype(PolicySettings::policy)(BudgetPolicy{1e6}),
        decltype(PolicySettings::policy)(ErrorBudgetPolicy{1e6})}) {
    settings.policy = policy;
    std::vector<LevelCandidate> after = candidates;
    make_changes(choose(candidates, settings), after);
    EXPECT_EQ(count_on(Rung::full, after), 3) << policy.index();
    EXPECT_EQ(after[2].rung, Rung::full) << policy.index();
  }
}

TEST(BudgetPolicy, TheNearestAreFullTheNextSupportTheRestTables) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 200; ++i) candidates.push_back(on_ladder(1 + i));
  const PolicySettings settings = by_budget(11.0);
  make_changes(choose(candidates, settings), candidates);
  const auto full = count_on(Rung::full, candidates), support = count_on(Rung::support, candidates);
  EXPECT_EQ(full, 7);      // three quarters of 10, which leaves a tenth free
  EXPECT_EQ(support, 24);  // with the rest
  for (std::size_t i = 1; i < candidates.size(); ++i)
    EXPECT_LE(int(candidates[i].rung), int(candidates[i - 1].rung)) << i;
}

TEST(BudgetPolicy, OverItTheFarthestGoDownAtOnceWhateverDwellAndCap) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 50; ++i) candidates.push_back(on_ladder(1 + i, Rung::full));
  for (LevelCandidate& c : candidates) c.dwell_left = 30;
  PolicySettings settings = by_budget(14.0);
  settings.max_transitions_per_frame = 1;
  make_changes(choose(candidates, settings), candidates);
  double cost = 0.0;
  for (const LevelCandidate& c : candidates) cost += c.cost_at(c.rung);
  EXPECT_LE(cost, 14.0);
  EXPECT_GT(cost, 13.0);
  EXPECT_EQ(candidates.front().rung, Rung::full);
  EXPECT_EQ(candidates.back().rung, Rung::tables);
}

TEST(BudgetPolicy, WhileItPausesNoneGoesUpButWhoMust) {
  const std::vector<LevelCandidate> candidates(30, at(1));
  const auto paused = choose_levels(candidates, kAtOrigin, by_budget(22.0), {.pauses = true});
  EXPECT_TRUE(paused.promote.empty());
  EXPECT_EQ(paused.reasons.front(), Rule::paused);
  std::vector<LevelCandidate> full;
  for (int i = 0; i < 50; ++i) full.push_back(on_ladder(1 + i, Rung::full));
  EXPECT_EQ(choose_levels(full, kAtOrigin, by_budget(14.0), {.pauses = true}).demote,
            choose_levels(full, kAtOrigin, by_budget(14.0), {}).demote);
  std::vector<LevelCandidate> newcomers = candidates;
  for (LevelCandidate& c : newcomers) c.newcomer = true;
  EXPECT_EQ(choose_levels(newcomers, kAtOrigin, by_budget(22.0), {.pauses = true}).promote.size(),
            choose_levels(newcomers, kAtOrigin, by_budget(22.0), {}).promote.size());
}

TEST(BudgetPolicy, SentBackIsWhoHadJustChanged) {
  std::vector<LevelCandidate> full;
  for (int i = 0; i < 50; ++i) full.push_back(on_ladder(1 + i, Rung::full));
  EXPECT_EQ(choose_levels(full, kAtOrigin, by_budget(14.0), {}).sent_back, 0);
  for (LevelCandidate& c : full) c.dwell_left = 10;
  const auto decision = choose_levels(full, kAtOrigin, by_budget(14.0), {});
  EXPECT_GT(decision.sent_back, 0);
  EXPECT_EQ(decision.demote.size(), std::size_t(decision.sent_back));
}

TEST(BudgetPolicy, NothingIsLeftWhereOthersUseItUp) {
  const auto decision =
      choose({on_ladder(1, Rung::full), on_ladder(2, Rung::support), on_ladder(3)}, by_budget(4.0), 5.0);
  EXPECT_EQ(decision.demote, (std::vector<LevelDecision::Change>{{1, Rung::tables}, {0, Rung::tables}}));
  EXPECT_TRUE(decision.promote.empty());
}

TEST(BudgetPolicy, AMarginAndTheCostOfChangesKeepBodiesDown) {
  const std::vector<LevelCandidate> candidates(30, at(1));
  EXPECT_EQ(choose(candidates, by_budget(22.0)).promote.size(), 20u);
  EXPECT_EQ(choose_levels(candidates, kAtOrigin, by_budget(22.0), {.margin = 1.0}).promote.size(), 10u);
  EXPECT_EQ(choose_levels(candidates, kAtOrigin, by_budget(22.0), {.change = {0, 0, 1.0}}).promote.size(),
            11u);
}

/// In a row, each touching the next; all of one mesh.
std::vector<LevelCandidate> a_row(int count, bool asleep = false) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < count; ++i) {
    LevelCandidate& c = candidates.emplace_back(at(10 + i, Rung::tables, {Rung::tables, Rung::full}));
    c.radius = 1.0, c.mesh = 1.0f, c.asleep = asleep;
  }
  return candidates;
}

TEST(BudgetPolicy, APairOfFullBodiesIsChargedBesidesThem) {
  const auto promoted = [](double budget, const StepOverhead& overhead, bool asleep = false) {
    return choose_levels(a_row(9, asleep), kAtOrigin, by_budget(budget), overhead).promote.size();
  };
  EXPECT_EQ(promoted(11.0, {}), 9u);
  EXPECT_EQ(promoted(16.6, {.pair = 2.0}),
            7u);  // without the next but one it would meet the one before: 5 alone, of which 2 make pairs
  EXPECT_EQ(promoted(11.0, {.pair = 1e3}), 5u);  // every other one
  EXPECT_EQ(promoted(11.0, {.spike = 1e3}), 5u);
  EXPECT_EQ(promoted(11.0, {.spike = 1e3}, true), 9u);  // no pair of sleepers has a spike
}

// Others take up the room for the pair until their dwell is over.
TEST(BudgetPolicy, APairWithOneThatMustBeFullIsChargedToo) {
  for (const RungSet open : {kEveryRung, RungSet{Rung::full}}) {
    std::vector<LevelCandidate> candidates{on_ladder(1, Rung::full), on_ladder(1.5, Rung::support)};
    candidates[0].open = open;
    for (LevelCandidate& c : candidates) c.radius = 0.5, c.mesh = 1.0f;
    for (int i = 0; i < 6; ++i) {
      candidates.push_back(on_ladder(50 + 10 * i, Rung::full));
      candidates.back().dwell_left = 30;
    }
    const auto decision = choose_levels(candidates, kAtOrigin, by_budget(10.0), {.pair = 5.0});
    EXPECT_TRUE(decision.promote.empty());
    EXPECT_EQ(decision.reasons[1], Rule::queued);
  }
}

TEST(BudgetPolicy, OfTwoFullBodiesThatComeTooCloseTheFartherGoesDownAtOnce) {
  std::vector<LevelCandidate> candidates = a_row(3);
  for (LevelCandidate& c : candidates) c.rung = Rung::full, c.dwell_left = 30;
  candidates[2].position.x() += 5.0;
  const auto decision = choose_levels(candidates, kAtOrigin, by_budget(11.0), {.pair = 1e3});
  EXPECT_EQ(decision.demote, (std::vector<LevelDecision::Change>{{1, Rung::tables}}));
}

TEST(BudgetPolicy, OnlyAsManyGoDownAtOnceAsMust) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 20; ++i) candidates.push_back(at(30 - i, Rung::full));
  PolicySettings settings = by_budget(18.0);
  settings.max_transitions_per_frame = 0;
  for (LevelCandidate& c : candidates) c.dwell_left = 30;
  EXPECT_EQ(who(choose(candidates, settings).demote), (Indices{0, 1}));
}

TEST(BudgetPolicy, OverItThoseAwakeGoDownBeforeTheSleepers) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 20; ++i) {
    candidates.push_back(at(1 + i, Rung::full));
    candidates.back().asleep = i % 2 == 1;
    candidates.back().dwell_left = 30;
    if (candidates.back().asleep) candidates.back().cost[std::size_t(Rung::full)] = 0.5f;  // a reserve
  }
  PolicySettings settings = by_budget(12.6);
  settings.max_transitions_per_frame = 0;
  EXPECT_EQ(who(choose(candidates, settings).demote),
            (Indices{18, 16, 19}));  // of the four that do not fit, as many as must
  settings.policy = BudgetPolicy{3.3};
  EXPECT_EQ(who(choose(candidates, settings).demote),
            (Indices{18, 16, 14, 12, 10, 8, 6, 4, 19, 17, 15, 13, 11, 9, 7, 5}));
}

TEST(BudgetPolicy, ABodyThatIsPutOffGivesItsRoomToTheNext) {
  std::vector<LevelCandidate> candidates{at(1), at(2), at(3)};
  candidates[0].put_off = true;
  const auto decision = choose(candidates, by_budget(2.4));
  EXPECT_EQ(who(decision.promote), (Indices{1, 2}));
  EXPECT_EQ(decision.reasons[0], Rule::overlap_put_off);
}

// Whatever room there is.
TEST(BudgetPolicy, WhoIsOutOfEveryPictureForGoodGetsTheLowestRung) {
  std::vector<LevelCandidate> candidates{on_ladder(1, Rung::full), on_ladder(2), on_ladder(3)};
  for (LevelCandidate& c : candidates) c.view_factor = std::numeric_limits<double>::infinity();
  candidates[2].view_factor = 10.0;
  const auto decision = choose(candidates, by_budget(100.0));
  EXPECT_EQ(who(decision.demote), (Indices{0}));
  EXPECT_EQ(who(decision.promote), (Indices{2}));
  EXPECT_EQ(decision.reasons[0], Rule::out_of_view);
  EXPECT_EQ(decision.reasons[1], Rule::out_of_view);
}

TEST(BudgetPolicy, ReachOfFullIsWhereItsRoomEnds) {
  std::vector<LevelCandidate> candidates;
  for (int i = 0; i < 100; ++i) candidates.push_back(at(1 + i));
  EXPECT_EQ(reach_of_full(candidates, kAtOrigin, by_budget(11.0), {}), 11.0);  // ten fit
  EXPECT_EQ(reach_of_full(candidates, kAtOrigin, by_budget(1e3), {}),
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace lodestone
