// Bodies that change rung together; joints are tested from outside (tests/install/groups.cpp).
#include <gtest/gtest.h>

#include "reference/error.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::testing {
namespace {

PolicySettings by_distance() {
  return {
      .policy = DistancePolicy{.full_within = 5.0}, .min_dwell_frames = 0, .max_transitions_per_frame = 100};
}

TEST(Groups, OneThatOverlapsKeepsAllWhereTheyAre) {
  Manager manager = on_floor(unmeasured(by_distance()));
  const auto box = box_shape({0.2, 0.2, 0.2});
  const std::vector<BodyId> pair{add(manager, box, at({0, 0, 0.1})), add(manager, box, at({2, 0, 0.1}))};
  manager.make_group(pair);
  run(manager, 1.0);
  ASSERT_TRUE(manager.asleep(pair[0]) && manager.asleep(pair[1]));
  const BodyId other = add(manager, box, at({2.05, 0, 0.1}), LevelChoice::full);
  view_from(manager, Vec3::Zero());
  manager.step(kFrame);
  EXPECT_EQ(manager.rung(pair[0]), manager.rung(pair[1]));
  EXPECT_NE(manager.rung(pair[0]), Rung::full);
  EXPECT_EQ(manager.explain(pair[0]).rule, Rule::overlap_put_off);
  manager.remove_body(other);
  run(manager, 3.0);
  EXPECT_EQ(manager.rung(pair[0]), Rung::full);
  EXPECT_EQ(manager.rung(pair[1]), Rung::full);
}

TEST(Groups, MembersMayOverlapEachOther) {
  Manager manager = on_floor(unmeasured(by_distance()));
  const auto box = box_shape({0.2, 0.2, 0.2});
  const std::vector<BodyId> pair{add(manager, box, at({0, 0, 0.5})), add(manager, box, at({0.1, 0, 0.5}))};
  manager.make_group(pair);
  view_from(manager, Vec3::Zero());
  manager.step(kFrame);
  EXPECT_EQ(manager.rung(pair[0]), Rung::full);
  EXPECT_EQ(manager.rung(pair[1]), Rung::full);
}

TEST(Groups, WhatWakesOneWakesAll) {
  Manager manager = on_floor(unmeasured(by_distance()));
  const auto box = box_shape({0.2, 0.2, 0.2});
  std::vector<BodyId> row;
  for (int i = 0; i < 5; ++i) row.push_back(add(manager, box, at({1.0 * i, 0, 0.1})));
  manager.make_group(row);
  const BodyId other = add(manager, box, at({7, 0, 0.1}));
  run(manager, 2.0);
  for (const BodyId body : row) ASSERT_TRUE(manager.asleep(body));
  manager.add_force(row[4], Vec3(0, 0, 30));
  manager.step(kFrame);
  for (const BodyId body : row) EXPECT_FALSE(manager.asleep(body));
  EXPECT_TRUE(manager.asleep(other));
}

TEST(Groups, ARemovedMemberLeaves) {
  Manager manager = on_floor(unmeasured(by_distance()));
  const auto box = box_shape({0.2, 0.2, 0.2});
  const std::vector<BodyId> pair{add(manager, box, at({0, 0, 0.1})), add(manager, box, at({20, 0, 0.1}))};
  const GroupId group = manager.make_group(pair);
  view_from(manager, Vec3::Zero());
  manager.step(kFrame);
  EXPECT_EQ(manager.rung(pair[1]), Rung::full);
  manager.remove_body(pair[0]);
  run(manager, 0.1);
  EXPECT_NE(manager.rung(pair[1]), Rung::full);
  manager.dissolve_group(group);
  EXPECT_THROW(manager.dissolve_group(group), InputError);
}

TEST(Groups, WrongMembersAreRefused) {
  Manager manager = on_floor(unmeasured());
  const BodyId body = add(manager, box_shape({0.2, 0.2, 0.2}), at({0, 0, 0.1}));
  EXPECT_THROW(manager.make_group({}), InputError);
  EXPECT_THROW(manager.make_group(std::vector{body, body}), InputError);
  EXPECT_THROW(manager.make_group(std::vector{body}, {.before_demotion = [](GroupId) {}}), InputError);
}

// Under the option a stack is one: the top goes up with the foot.
TEST(ContactGroups, ChangeTogether) {
  for (const bool together : {false, true}) {
    PolicySettings policy = by_distance();
    policy.policy = DistancePolicy{.full_within = 0.2};
    policy.contact_groups_together = together;
    Manager manager = on_floor(unmeasured(policy));
    const auto box = box_shape({0.4, 0.4, 0.4});
    std::vector<BodyId> row;
    for (int i = 0; i < 4; ++i) row.push_back(add(manager, box, at({0, 0, 0.2 + 0.4 * i})));
    run(manager, 0.05);
    view_from(manager, Vec3(-0.5, 0, 0.2));
    int mixed = 0, up = 0;
    for (int frame = 0; frame < 30; ++frame) {
      manager.step(kFrame);
      int full = 0;
      for (const BodyId body : row) full += manager.rung(body) == Rung::full;
      mixed += full > 0 && full < 4, up += full == 4;
    }
    if (together)
      EXPECT_GT(up, 0);
    else
      EXPECT_GT(mixed, 0);
  }
}

}  // namespace
}  // namespace lodestone::testing
