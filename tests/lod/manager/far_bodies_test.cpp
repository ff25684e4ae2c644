// Whom a policy is asked about: the same decisions as of all bodies, with few of them looked at.
#include "lod/manager/far_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "lod/manager/choose_levels.h"
#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::far_bodies_test {
namespace {

using testing::add;
using testing::kFrame;
using testing::no_signature;
using testing::on_floor;
using testing::unmeasured;
using testing::view_from;

std::vector<std::uint32_t> take_all_due(FarBodies& far, double travel) {
  std::vector<std::uint32_t> taken;
  while (far.next_due() <= travel) far.take_next(taken);
  std::ranges::sort(taken);
  return taken;
}

TEST(FarBodies, TheirTurnComesNoLaterThanIsDueAndHardlyEarlier) {
  FarBodies far;
  far.put(7, 3.1), far.put(2, 8.0), far.put(4, 3.2);
  EXPECT_TRUE(take_all_due(far, 2.7).empty());
  EXPECT_EQ(take_all_due(far, 3.1), (std::vector<std::uint32_t>{4, 7}));
  EXPECT_EQ(take_all_due(far, 8.0), (std::vector<std::uint32_t>{2}));
  EXPECT_TRUE(take_all_due(far, 1e9).empty());
}

TEST(FarBodies, OnlyTheLastTurnCounts) {
  FarBodies far;
  far.put(1, 5.0), far.put(1, 9.0), far.put(2, 5.0), far.forget(2), far.put(3, 9.0), far.put(3, 1.0);
  EXPECT_EQ(take_all_due(far, 6.0), (std::vector<std::uint32_t>{3}));
  EXPECT_EQ(take_all_due(far, 9.0), (std::vector<std::uint32_t>{1}));
}

TEST(FarBodies, StaleTurnsDoNotPileUp) {
  FarBodies far;
  for (int i = 0; i < 100'000; ++i) far.put(std::uint32_t(i % 10), 10.0 + 0.3 * i);
  std::vector<std::uint32_t> taken;
  int rounds = 0;
  for (; far.next_due() < 1e299; ++rounds) far.take_next(taken);
  EXPECT_LT(rounds, 2'000);
  EXPECT_EQ(taken.size(), 10u);
}

// Crates in rows, and a viewpoint that goes among them.
struct Scene {
  explicit Scene(const PolicySettings& policy, int bodies, bool settled = true)
      : manager(on_floor(unmeasured(policy))) {
    const auto shape = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.24})));
    for (int i = 0; i < bodies; ++i) {
      RigidState state;
      state.position = {0.6 * (i % 40), 0.6 * (i / 40), 0.12};
      ids.push_back(manager.add_body({.shape = shape, .state = state, .importance = 1.0 + 0.5 * (i % 3)}));
    }
    for (int i = 0; i < 90 && (i == 0 || (settled && manager.report().asleep < bodies)); ++i)
      manager.step(kFrame);
  }
  LevelCandidate candidate(std::size_t i) const {
    return {.position = manager.state(ids[i]).position,
            .radius = manager.shape(ids[i]).radius,
            .importance = 1.0 + 0.5 * double(i % 3),
            .rung = manager.rung(ids[i]),
            .open = {Rung::support, Rung::full}};
  }
  Manager manager;
  std::vector<BodyId> ids;
};

// Without a dwell or a cap, what the policy would say of all bodies is what they have after the step, whoever
// was looked at.
void expect_levels_as_if_asked_about_all(bool settled) {
  PolicySettings policy{
      .policy = DistancePolicy{1.5}, .min_dwell_frames = 0, .max_transitions_per_frame = 1'000'000};
  Scene scene(policy, 600, settled);
  ASSERT_EQ(scene.manager.report().asleep, settled ? 600 : 0);
  int changes = 0;
  for (int step = 0; step < 120; ++step) {
    const double along = 0.2 * step;
    const std::vector<Vec3> viewpoints{{along, 4.0 + 3.0 * std::sin(0.3 * along), 0.5},
                                       {23.0 - along, 1.0, 0.3}};
    scene.manager.set_viewpoints(viewpoints);
    std::vector<LevelCandidate> all;
    for (std::size_t i = 0; i < scene.ids.size(); ++i) all.push_back(scene.candidate(i));
    const LevelDecision wanted = choose_levels(all, viewpoints, policy);
    scene.manager.step(kFrame);
    std::set<std::int32_t> promoted, demoted;
    for (const auto& change : wanted.promote) promoted.insert(change.candidate);
    for (const auto& change : wanted.demote) demoted.insert(change.candidate);
    changes += int(promoted.size() + demoted.size());
    for (std::size_t i = 0; i < scene.ids.size(); ++i) {
      const bool was_full = all[i].rung == Rung::full,
                 full = was_full ? !demoted.contains(int(i)) : promoted.contains(int(i));
      ASSERT_EQ(scene.manager.level(scene.ids[i]) == Level::full, full)
          << "body " << i << ", step " << step << ": " << scene.manager.why(scene.ids[i]);
      ASSERT_NE(scene.manager.why(scene.ids[i]).find(text_of(wanted.reasons[i])), std::string::npos)
          << "body " << i << ", step " << step;
    }
  }
  EXPECT_GT(changes, 100);
}

TEST(LevelsOfSleepers, AreThoseThatThePolicyWouldGiveAskedAboutAll) {
  expect_levels_as_if_asked_about_all(true);
}
TEST(LevelsOfSleepers, AreSoTooWhereTheyFallAsleepUnderWay) { expect_levels_as_if_asked_about_all(false); }

// How many a budget has room for hangs on measured times, here a hundred or a few tens; which three are next
// does not.
TEST(LevelsOfSleepers, ABudgetTakesTheNearestWithoutALookAtAll) {
  PolicySettings policy{.policy = BudgetPolicy{10.0}, .min_dwell_frames = 0, .max_transitions_per_frame = 3};
  Scene scene(policy, 1'000);
  ASSERT_EQ(scene.manager.report().asleep, 1'000);
  for (int step = 0; step < 2; ++step) {
    const Vec3 eye(7.1 + step, 3.2, 0.4);
    view_from(scene.manager, eye);
    std::vector<LevelCandidate> all;
    for (std::size_t i = 0; i < scene.ids.size(); ++i)
      all.push_back(scene.candidate(i)), all.back().cost[std::size_t(Rung::full)] = 0.1f;
    const LevelDecision wanted = choose_levels(all, std::vector{eye}, policy);
    const std::int64_t before = scene.manager.report().counters.levels_considered;
    scene.manager.step(kFrame);
    ASSERT_EQ(scene.manager.report().promotions, 3);
    for (const auto& [body, to] : wanted.promote)
      EXPECT_EQ(scene.manager.rung(scene.ids[std::size_t(body)]), to) << body;
    const std::int64_t looks = scene.manager.report().counters.levels_considered - before;
    if (step == 0)
      EXPECT_EQ(looks, 1'000);  // the first viewpoint
    else
      EXPECT_LT(looks, 600);
  }
}

// After a cut all seem to be due, as the viewpoint may have come to any of them.
TEST(LevelsOfSleepers, UnderABudgetACutOfTheCameraConcernsWhoeverIsNearItNow) {
  PolicySettings policy{
      .policy = WorkPolicy{4000.0}, .min_dwell_frames = 0, .max_transitions_per_frame = 1'000'000};
  Scene scene(policy, 3'000);
  ASSERT_EQ(scene.manager.report().asleep, 3'000);
  const auto full_within = [&](const Vec3& eye) {  // m: of the farthest one that is full
    double farthest = 0.0;
    for (const BodyId body : scene.ids)
      if (scene.manager.rung(body) == Rung::full)
        farthest = std::max(farthest, (scene.manager.state(body).position - eye).norm());
    return farthest;
  };
  view_from(scene.manager, {2, 2, 0.4});
  for (int i = 0; i < 20; ++i) scene.manager.step(kFrame);
  for (const Vec3& eye : {Vec3(20, 40, 0.4), Vec3(3, 5, 0.4), Vec3(12, 30, 0.4)}) {
    view_from(scene.manager, eye);
    const std::int64_t before = scene.manager.report().counters.levels_considered;
    scene.manager.step(kFrame);
    EXPECT_LT(scene.manager.report().counters.levels_considered - before, 600) << eye.transpose();
    for (int i = 0; i < 20; ++i) scene.manager.step(kFrame);
    ASSERT_GT(scene.manager.report().full, 10);
    EXPECT_LT(full_within(eye), 0.6 * std::sqrt(scene.manager.report().full)) << eye.transpose();
  }
}

TEST(LevelsOfSleepers, NobodyIsLookedAtWhileNothingChanges) {
  Scene scene({.policy = DistancePolicy{1.0}}, 3'000);
  ASSERT_EQ(scene.manager.report().asleep, 3'000);
  const auto looks = [&] { return scene.manager.report().counters.levels_considered; };
  view_from(scene.manager, {0, 0, 30});
  scene.manager.step(kFrame);
  std::int64_t before = looks();
  for (int i = 0; i < 50; ++i) scene.manager.step(kFrame);
  EXPECT_EQ(looks(), before);
  // A viewpoint that moves: a few a step.
  for (int i = 0; i < 100; ++i) view_from(scene.manager, {0.1 * i, 0, 30}), scene.manager.step(kFrame);
  EXPECT_LT(looks() - before, 100 * 3'000 / 20);
  // A body that is full, and one that the caller moves, are looked at, and no others.
  scene.manager.set_level(scene.ids[5], LevelChoice::full);
  scene.manager.step(kFrame);
  before = looks();
  for (int i = 0; i < 20; ++i) scene.manager.step(kFrame);
  EXPECT_LE(looks() - before, 20 * 40);  // and those that it woke
  EXPECT_GE(looks() - before, 20);
}

}  // namespace
}  // namespace lodestone::far_bodies_test
