// Contact events of bodies that sleep, wake, change rung and are removed: said once, and nothing said of what
// did not change.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <map>
#include <tuple>

#include "tests/allocations.h"
#include "tests/lod/callers/callers_scene.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::contact_events_test {
namespace {

using namespace testing;

const Vec3 kSides{0.3, 0.3, 0.3};

ManagerSettings telling(const PolicySettings& policy = {}) {
  ManagerSettings settings = unmeasured(policy);
  settings.events.all_bodies = true;
  return settings;
}

// Who touches whom, as the events say; and that they say nothing twice.
class Touching {
 public:
  void take(const Manager& manager) {
    for (const ContactEvent& event : manager.contact_events()) {
      const auto key = std::tuple(event.first.body.index, event.second.kind, event.second.body.index,
                                  event.second.ground.index);
      bool& touches = touching_[key];
      EXPECT_EQ(touches, event.phase != ContactPhase::begin)
          << "begins twice, or ends or hits without a beginning";
      touches = event.phase != ContactPhase::end;
      begins_ += event.phase == ContactPhase::begin, ends_ += event.phase == ContactPhase::end;
    }
  }
  void run(Manager& manager, double seconds) {
    for (int i = 0; i < int(std::lround(seconds / kFrame)); ++i) {
      manager.step(kFrame);
      take(manager);
    }
  }
  int pairs() const {
    return int(std::ranges::count_if(touching_, [](const auto& pair) { return pair.second; }));
  }
  int begins() const { return begins_; }
  int ends() const { return ends_; }

 private:
  std::map<std::tuple<std::uint32_t, ContactSide::Kind, std::uint32_t, std::uint32_t>, bool> touching_;
  int begins_ = 0, ends_ = 0;
};

// Twenty that stay awake, on two rungs by distance: whose events are told and who is looked at is kept in
// place.
TEST(ContactEvents, AWarmStepWithAPolicyAllocatesNothing) {
  ManagerSettings settings = telling({.policy = DistancePolicy{.full_within = 0.0, .support_within = 3.0}});
  settings.sleeping = false, settings.signatures = coarse_signature;
  Manager manager = on_floor(settings);
  const auto box = box_shape(kSides);
  for (int i = 0; i < 20; ++i) add(manager, box, testing::at({0.31 * i, 0, 0.2}));
  view_from(manager, {0, -1, 1});
  run(manager, 2.0);
  const std::int64_t before = allocations();
  for (int i = 0; i < 60; ++i) manager.step(kFrame);
  EXPECT_EQ(allocations() - before, 0);
  EXPECT_GT(manager.report().support, 0);
  EXPECT_GT(manager.report().tables, 0);
}

class ContactEventsOnRungs : public ::testing::TestWithParam<LevelChoice> {};

// A pile of three, asleep: three pairs. Its top is thrown off, then its middle one is removed.
TEST_P(ContactEventsOnRungs, PileSleepsWakesAndIsTakenApart) {
  Manager manager = on_floor(telling());
  const auto box = box_shape(kSides);
  std::vector<BodyId> pile;
  for (int i = 0; i < 3; ++i) pile.push_back(add(manager, box, at({0, 0, 0.15 + 0.3005 * i}), GetParam()));
  Touching touching;
  touching.run(manager, 6.0);
  ASSERT_EQ(manager.report().asleep, 3);
  EXPECT_EQ(touching.pairs(), 3);
  EXPECT_EQ(touching.ends(), touching.begins() - 3);
  const int told = touching.begins() + touching.ends();
  touching.run(manager, 1.0);
  for (const BodyId body : pile) manager.wake(body);
  touching.run(manager, 3.0);
  EXPECT_EQ(touching.begins() + touching.ends(), told) << "asleep or awake, they touch";
  RigidState thrown = at({5, 0, 2});
  manager.set_state(pile[2], thrown);
  touching.run(manager, 0.3);
  EXPECT_EQ(touching.pairs(), 2);
  manager.remove_body(pile[1]);
  touching.run(manager, 3.0);
  EXPECT_EQ(touching.pairs(), 2);  // two lie on the ground
  EXPECT_EQ(touching.ends(), touching.begins() - 2);
}

INSTANTIATE_TEST_SUITE_P(Rungs, ContactEventsOnRungs,
                         ::testing::Values(LevelChoice::full, LevelChoice::support));

// A crate that tumbles and settles, from its first touch until it sleeps: in impacts, contact steps and
// clips.
TEST(ContactEvents, ImpulsesAreWhatChangesItsMotion) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables}) {
    ManagerSettings settings{.signatures = coarse_signature};
    settings.events = {.all_bodies = true, .least_speed = 0.0};
    Manager manager = on_floor(settings);
    const BodyId crate = add(manager, box_shape({0.2, 0.3, 0.4}),
                             {.position = {0, 0, 0.6},
                              .orientation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 0).normalized())),
                              .angular_velocity = {1, 3, 2}},
                             level);
    double given = 0.0, fallen = 0.0;  // N s
    for (int i = 0; i < 600 && !manager.asleep(crate); ++i) {
      const double before = manager.state(crate).velocity.z();
      manager.step(kFrame);
      if (manager.asleep(crate)) break;
      fallen += manager.mass(crate) * (manager.state(crate).velocity.z() - before + kGravity * kFrame);
      for (const ContactEvent& event : manager.contact_events())
        if (event.phase == ContactPhase::hit) given += event.impulse;
    }
    ASSERT_TRUE(manager.asleep(crate)) << int(level);
    EXPECT_NEAR(given, fallen, 0.02 * fallen) << int(level);
  }
}

// The camera comes and goes: nobody begins to touch what he lay on all along.
TEST(ContactEvents, ChangesOfRungAreNoEvents) {
  Manager manager = on_floor(telling({.policy = DistancePolicy{.full_within = 2.0}, .min_dwell_frames = 5}));
  const BodyId body = add(manager, box_shape(kSides), at({0, 0, 0.151}));
  Touching touching;
  view_from(manager, {50, 0, 1});
  touching.run(manager, 2.0);
  ASSERT_EQ(touching.pairs(), 1);
  for (int visit = 0; visit < 3; ++visit) {
    view_from(manager, {0, 0, 1});
    touching.run(manager, 1.0);
    EXPECT_EQ(manager.rung(body), Rung::full);
    manager.wake(body);
    touching.run(manager, 1.0);
    view_from(manager, {50, 0, 1});
    touching.run(manager, 1.0);
    EXPECT_EQ(manager.rung(body), Rung::support);
    manager.wake(body);
    touching.run(manager, 1.0);
  }
  EXPECT_EQ(touching.begins(), 1);
  EXPECT_EQ(touching.ends(), 0);
}

TEST(ContactEvents, NothingIsSaidUnlessAskedFor) {
  Manager manager = on_floor(unmeasured());
  const BodyId body = add(manager, box_shape(kSides), at({0, 0, 0.5}));
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    EXPECT_TRUE(manager.contact_events().empty());
  }
  manager.set_events(body, true);
  manager.set_state(body, at({0, 0, 0.5}));
  std::size_t told = 0;
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    told += manager.contact_events().size();
  }
  EXPECT_GT(told, 0u);
}

// Where sparks would fly: not in the air beside long bodies that meet as spheres.
TEST(ContactEvents, OfBodiesAtTablesAreOnBothBodies) {
  ManagerSettings settings = telling();
  settings.signatures = coarse_signature;
  Manager manager = on_floor(settings);
  const Vec3 sides(0.2, 0.3, 0.4);
  for (int i = 0; i < 18; ++i) {
    RigidState state = testing::at({0.25 * (i % 3), 0.3 * (i / 3 % 2), 0.4 + 0.5 * (i / 6)});
    state.orientation = rotation_from_vector(Vec3(0.5 * i, 0.3 * i, 0.0));
    add(manager, box_shape(sides), state, LevelChoice::tables);
  }
  const auto beside = [&](BodyId body, const Vec3& point) {  // m
    const RigidState state = manager.state(body);
    const Vec3 own = state.orientation.conjugate() * (point - state.position);
    return (own.cwiseAbs() - 0.5 * sides).cwiseMax(0.0).norm();
  };
  int begun = 0;
  for (int i = 0; i < 120; ++i) {
    manager.step(kFrame);
    for (const ContactEvent& event : manager.contact_events()) {
      if (event.phase != ContactPhase::begin || event.second.kind != ContactSide::Kind::body) continue;
      ++begun;
      EXPECT_LT(beside(event.first.body, event.point), 0.1);
      EXPECT_LT(beside(event.second.body, event.point), 0.1);
    }
  }
  EXPECT_GT(begun, 20);
}

// It presses on a crate until that sleeps, and goes without waking it, or is destroyed.
TEST(ContactEvents, ABodyOfHisThatLeavesASleeperTouchesItNoMore) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const bool is_destroyed : {false, true}) {
      ManagerSettings settings = telling();
      settings.signatures = coarse_signature;
      CallersScene his;
      Manager manager(his.world, his.space, settings);
      dWorldSetGravity(his.world, 0, 0, -9.81);
      dCreatePlane(his.space, 0, 0, 1, 0);
      const BodyId crate = add(manager, box_shape(kSides), testing::at({0, 0, 0.15}), level);
      const dBodyID pusher = his.body(20.0, {-0.352, 0, 0.2});
      dBodySetGravityMode(pusher, 0);
      int begins = 0, ends = 0;
      const auto step = [&] {
        manager.step(kFrame);
        for (const ContactEvent& event : manager.contact_events()) {
          if (!event.second.callers) continue;
          begins += event.phase == ContactPhase::begin, ends += event.phase == ContactPhase::end;
        }
      };
      for (int i = 0; i < 300; ++i) {
        dBodyEnable(pusher), dBodyAddForce(pusher, 5, 0, 0);
        step();
      }
      EXPECT_EQ(begins, 1) << int(level);
      EXPECT_EQ(ends, 0) << int(level);
      if (is_destroyed) dGeomDestroy(dBodyGetFirstGeom(pusher)), dBodyDestroy(pusher);
      for (int i = 0; i < 60; ++i) {
        if (!is_destroyed) dBodySetLinearVel(pusher, -0.2, 0, 0);
        step();
      }
      EXPECT_EQ(begins, 1) << int(level);
      EXPECT_EQ(ends, 1) << int(level) << (is_destroyed ? ", destroyed" : "");
      EXPECT_TRUE(manager.asleep(crate)) << int(level);
    }
}

TEST(ContactEvents, AskedForAgainTheyBeginAnew) {
  Manager manager = on_floor();
  const auto box = box_shape(kSides);
  const BodyId body = add(manager, box, testing::at({0, 0, 0.2}), LevelChoice::support);
  manager.set_events(body, true);
  run(manager, 3.0);
  ASSERT_EQ(manager.report().asleep, 1);
  manager.set_events(body, false);
  run(manager, 0.5);
  manager.set_events(body, true);
  manager.wake(body);
  manager.step(kFrame);
  ASSERT_EQ(manager.contact_events().size(), 1U);
  EXPECT_EQ(manager.contact_events()[0].phase, ContactPhase::begin);
}

}  // namespace
}  // namespace lodestone::contact_events_test
