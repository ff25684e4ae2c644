// Bodies that change rung together; joints are tested from outside (tests/install/groups.cpp).
#include <gtest/gtest.h>
#include <ode/ode.h>

#include "reference/error.h"
#include "reference/random.h"
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

// Properties that a sphere cannot have keep a member off `tables`, a range of rungs in it, whatever the
// others were told.
TEST(Groups, AMemberKeepsToItsOwnRungs) {
  Manager manager = on_floor({.signatures = coarse_signature});
  const auto cube = box_shape({0.3, 0.3, 0.3});
  const auto at_height = [](double x) { return testing::at({x, 0, 2}); };
  const BodyId floats =
                   manager.add_body({.shape = cube, .state = at_height(0), .properties = {.gravity = false}}),
               full = manager.add_body({.shape = cube, .state = at_height(2), .least_rung = Rung::full}),
               sphere = add(manager, cube, at_height(4), LevelChoice::tables);
  const BodyId all[] = {floats, full, sphere};
  manager.make_group(all);
  run(manager, 0.5);
  EXPECT_NE(manager.rung(floats), Rung::tables);
  EXPECT_EQ(manager.state(floats).position.z(), 2.0);
  EXPECT_EQ(manager.rung(full), Rung::full);
  EXPECT_EQ(manager.rung(sphere), Rung::tables);
}

// Two boxes on a joint, which is off while they are seen from afar.
struct JointedPair {
  Manager manager = on_floor(unmeasured(by_distance()));
  BodyId left, right;
  dJointID joint = nullptr;
  explicit JointedPair(const std::shared_ptr<const Shape>& shape)
      : left(add(manager, shape, at({0, 0, 0.25}))), right(add(manager, shape, at({0.6, 0, 0.25}))) {
    view_from(manager, Vec3::Zero());
    manager.step(kFrame);
    join();
    const BodyId both[] = {left, right};
    manager.make_group(both, {.before_demotion = [this](GroupId) { dJointDestroy(joint); },
                              .after_promotion = [this](GroupId) { join(); }});
  }
  void join() {
    const dBodyID first = manager.ode_body(left);
    joint = dJointCreateBall(dBodyGetWorld(first), nullptr);
    dJointAttach(joint, first, manager.ode_body(right));
    dJointSetBallAnchor(joint, 0.3, 0, 0.25);
  }
  void leave() {
    run(manager, 2.0);
    view_from(manager, Vec3(100, 0, 0));
    run(manager, 1.0);
  }
};

// Woken in a manager that has none it threw std::bad_function_call, and stayed without its joints.
TEST(Groups, ASnapshotOfOneWhoseJointsAreOffGoesWhereItsFunctionsAre) {
  const auto box = box_shape({0.5, 0.5, 0.5});
  JointedPair first(box), second(box);
  first.leave(), second.leave();
  ASSERT_NE(first.manager.rung(first.left), Rung::full);
  const std::vector<std::byte> snapshot = first.manager.snapshot();
  Manager without = on_floor(unmeasured(by_distance()));
  const std::uint64_t before = without.state_hash();
  EXPECT_THROW(without.restore(snapshot, {&box, 1}), InputError);
  EXPECT_EQ(without.state_hash(), before);

  second.manager.restore(snapshot, {&box, 1});
  second.manager.wake(first.left);
  second.manager.step(kFrame);
  EXPECT_EQ(second.manager.rung(first.right), Rung::full);
  EXPECT_EQ(dBodyGetNumJoints(second.manager.ode_body(first.right)), 1);
}

// The joints stayed off, and nobody was told.
TEST(Groups, JoinedInASnapshotItIsJoinedAgainThoughItsJointsAreOffNow) {
  const auto box = box_shape({0.5, 0.5, 0.5});
  JointedPair pair(box);
  run(pair.manager, 0.5);
  const std::vector<std::byte> snapshot = pair.manager.snapshot();
  pair.leave();
  ASSERT_NE(pair.manager.rung(pair.left), Rung::full);
  pair.manager.restore(snapshot, {&box, 1});
  ASSERT_EQ(pair.manager.rung(pair.right), Rung::full);
  EXPECT_EQ(dBodyGetNumJoints(pair.manager.ode_body(pair.right)), 1);
}

// What struck it next put it back to where it had slept when its joints went off.
TEST(Groups, PutElsewhereWhileItsJointsAreOffItStaysThere) {
  const auto box = box_shape({0.5, 0.5, 0.5});
  JointedPair pair(box);
  pair.leave();
  ASSERT_NE(pair.manager.rung(pair.left), Rung::full);
  for (const BodyId body : {pair.left, pair.right}) {
    RigidState state = pair.manager.state(body);
    state.position.y() += 10.0;
    pair.manager.set_state(body, state);
  }
  for (const BodyId body : {pair.left, pair.right}) pair.manager.sleep(body);
  run(pair.manager, 0.2);
  const BodyId falls = add(pair.manager, box, at({0, 10, 1.2}), LevelChoice::support);
  run(pair.manager, 1.0);
  EXPECT_EQ(pair.manager.rung(pair.left), Rung::full);
  EXPECT_NEAR(pair.manager.state(pair.left).position.y(), 10.0, 0.5);
  EXPECT_GT(pair.manager.state(falls).position.z(), 0.2);
}

// Of a group whose members are gone its snapshot asked for functions that no reader could have.
TEST(Groups, OneWhoseJointsAreOffMayBeRemovedWhole) {
  const auto box = box_shape({0.5, 0.5, 0.5});
  JointedPair pair(box);
  pair.leave();
  ASSERT_NE(pair.manager.rung(pair.left), Rung::full);
  pair.manager.remove_body(pair.left);
  pair.manager.remove_body(pair.right);
  run(pair.manager, 0.1);
  EXPECT_NO_THROW(pair.manager.restore(pair.manager.snapshot(), {&box, 1}));
}

// Without GroupJoints a joined member stays full; another one that is told to leave may.
TEST(Groups, AMemberLeavesThoughAnotherIsOnJoints) {
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  dWorldSetGravity(world, 0, 0, -9.81);
  {
    Manager manager(world, space, {.signatures = coarse_signature});
    const auto cube = box_shape({0.3, 0.3, 0.3});
    const BodyId hangs = add(manager, cube, testing::at({0, 0, 2}), LevelChoice::full),
                 other = add(manager, cube, testing::at({2, 0, 2}), LevelChoice::support);
    manager.step(kFrame);
    const dJointID joint = dJointCreateBall(world, nullptr);
    dJointAttach(joint, manager.ode_body(hangs), nullptr);
    dJointSetBallAnchor(joint, 0, 0, 2.3);
    const BodyId both[] = {hangs, other};
    manager.make_group(both);
    run(manager, 0.5);
    EXPECT_EQ(manager.rung(hangs), Rung::full);
    EXPECT_NEAR(manager.state(hangs).position.z(), 2.0, 0.01);
    EXPECT_EQ(manager.rung(other), Rung::support);
    dJointDestroy(joint);
  }
  dSpaceDestroy(space);
  dWorldDestroy(world);
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

TEST(Groups, OneEndsWithItsLastBodyOrWhenItIsDissolved) {
  Manager manager = on_floor(unmeasured());
  const auto box = box_shape({0.2, 0.2, 0.2});
  const std::vector<BodyId> pair{add(manager, box, at({0, 0, 0.1})), add(manager, box, at({2, 0, 0.1}))};
  EXPECT_FALSE(manager.valid(GroupId{}));
  const GroupId dissolved = manager.make_group(pair);
  EXPECT_TRUE(manager.valid(dissolved));
  manager.dissolve_group(dissolved);
  EXPECT_FALSE(manager.valid(dissolved));
  const GroupId group = manager.make_group(pair);
  manager.remove_body(pair[0]);
  EXPECT_TRUE(manager.valid(group));
  manager.remove_body(pair[1]);
  EXPECT_FALSE(manager.valid(group));
}

// Whoever freed them; also after a snapshot, in this manager or another.
TEST(Groups, TheLeastFreeHandleIsGivenAgain) {
  const auto box = box_shape({0.2, 0.2, 0.2});
  Manager manager = on_floor(unmeasured()), other = on_floor(unmeasured());
  std::vector<BodyId> bodies;
  std::vector<GroupId> groups;
  for (int i = 0; i < 6; ++i) {
    bodies.push_back(add(manager, box, at({1.0 * i, 0, 0.1})));
    groups.push_back(manager.make_group({&bodies.back(), 1}));
  }
  manager.dissolve_group(groups[4]);
  manager.remove_body(bodies[3]);
  manager.dissolve_group(groups[1]);
  const std::vector<std::byte> snapshot = manager.snapshot();
  const auto make_again = [&](Manager& in) {
    std::vector<GroupId> again;
    for (int i = 0; i < 4; ++i) {
      const BodyId body = add(in, box, at({1.0 * i, 5, 0.1}));
      again.push_back(in.make_group({&body, 1}));
    }
    return again;
  };
  const std::vector<GroupId> again = make_again(manager);
  for (const auto& [made, index, generation] :
       {std::tuple(0, 1U, 2U), {1, 3U, 2U}, {2, 4U, 2U}, {3, 6U, 1U}}) {
    EXPECT_EQ(again[std::size_t(made)].index, index);
    EXPECT_EQ(again[std::size_t(made)].generation, generation);
  }
  other.restore(snapshot, {&box, 1});
  EXPECT_EQ(make_again(other), again);
  manager.restore(snapshot, {&box, 1});
  EXPECT_EQ(make_again(manager), again);
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

// A heap is divided into many: which of those that touch came together first changed from step to step, and
// bodies went up and down with others each time: 13,642 changes of rung in these five seconds, now 32.
TEST(ContactGroups, OfAHeapStayTogether) {
  PolicySettings policy{.policy = WorkPolicy{8'000.0}};
  policy.contact_groups_together = true;
  Manager manager = on_floor({.policy = policy, .signatures = coarse_signature});
  const auto shape = box_shape({0.3, 0.3, 0.3});
  RandomStream random(11, 1, 0);
  for (int i = 0; i < 400; ++i)
    add(manager, shape,
        {.position = {random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 0.4 + 0.02 * i},
         .orientation = random.orientation()});
  view_from(manager, {0, -3, 1.5});
  std::size_t changes = 0;
  for (int step = 0; step < 600; ++step) {
    manager.step(kFrame);
    if (step >= 300) changes += manager.rung_changes().size();
  }
  EXPECT_LT(changes, 1'000u);
}

}  // namespace
}  // namespace lodestone::testing
