#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/random.h"
#include "tests/lod/callers/callers_scene.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

using namespace testing;

using Bytes = std::vector<std::byte>;

struct SavedWorld {
  explicit SavedWorld(ManagerSettings settings = unmeasured({.policy = DistancePolicy{2.0}}))
      : manager(on_floor(settings)) {}
  void fill(std::uint32_t seed = 1) {
    RandomStream random(91, seed, 0);
    for (int i = 0; i < 14; ++i) {
      BodyDefinition definition{
          .shape = shapes()[i % 3 ? 0 : 1],
          .state = testing::at({0.3 * (i % 4), 0.3 * (i / 4), 0.3 + 0.1 * i}, random.direction(),
                               random.direction(), random.orientation())};
      if (i % 5 == 0) definition.level = LevelChoice::full;
      if (i % 7 == 3) definition.properties.linear_damping = 0.3;
      bodies.push_back(manager.add_body(definition));
    }
    view_from(manager, {0, 0, 1});
  }
  void step(int steps) {
    for (int i = 0; i < steps; ++i) manager.step(kFrame);
  }
  /// A box and a ball.
  static const std::vector<std::shared_ptr<const Shape>>& shapes() {
    static const std::vector<std::shared_ptr<const Shape>> shapes = {box_shape({0.2, 0.25, 0.3}),
                                                                     sphere_shape(0.12)};
    return shapes;
  }
  Manager manager;
  std::vector<BodyId> bodies;
};

// Of one of its points half of a coordinate was lost.
TEST(ManagerSnapshot, ContactsAreDrawnAsBefore) {
  const auto cube = box_shape({0.3, 0.3, 0.3});
  Manager manager = on_floor();
  for (const double z : {0.15, 0.46}) add(manager, cube, testing::at({5, 3, z}), LevelChoice::support);
  for (int i = 0; i < 8; ++i) manager.step(kFrame);
  const auto drawn = [&] {
    std::vector<Vec3> points;
    manager.draw({.point = [&](const Vec3& at, DebugColor) { points.push_back(at); }}, {.bodies = false});
    return points;
  };
  const std::vector<Vec3> before = drawn();
  ASSERT_EQ(before.size(), 4U);
  manager.restore(manager.snapshot());
  EXPECT_EQ(drawn(), before);
}

// Half of what `support` cost was lost.
TEST(ManagerSnapshot, TheReportIsThatOfItsStep) {
  SavedWorld writer(unmeasured({.policy = WorkPolicy{500.0}})),
      reader(unmeasured({.policy = WorkPolicy{500.0}}));
  writer.fill();
  writer.step(30);
  const StepReport& expected = writer.manager.report();
  ASSERT_GT(expected.cost[std::size_t(Rung::support)].work, 0.0);
  reader.manager.restore(writer.manager.snapshot(), SavedWorld::shapes());
  const StepReport& read = reader.manager.report();
  for (std::size_t i = 0; i < kRungs; ++i) EXPECT_EQ(read.cost[i].work, expected.cost[i].work) << i;
  EXPECT_EQ(read.contacts, expected.contacts);
  EXPECT_EQ(read.step, expected.step);
}

// Taken at any time, read by a manager that is new, has other bodies, or goes back in time.
TEST(ManagerSnapshot, WhoeverReadsItGoesOnToTheBit) {
  for (const int taken_after : {0, 1, 30, 200}) {
    SavedWorld writer;
    writer.fill();
    writer.step(taken_after);
    const Bytes snapshot = writer.manager.snapshot();
    writer.step(60);
    SavedWorld empty, other;
    other.fill(2);
    other.step(17);
    for (SavedWorld* reader : {&empty, &other, &writer}) {
      const std::uint64_t expected = [&] {
        SavedWorld again;
        again.fill();
        again.step(taken_after + 60);
        return again.manager.state_hash();
      }();
      reader->manager.restore(snapshot, SavedWorld::shapes());
      reader->step(60);
      EXPECT_EQ(reader->manager.state_hash(), expected) << taken_after
                                                        << (reader == &empty   ? " empty"
                                                            : reader == &other ? " other"
                                                                               : " the writer");
    }
  }
}

// By then the manager's world has had bodies, and steps whose solver draws random numbers.
TEST(ManagerSnapshot, OneFromBeforeTheFirstFullBodyIsGoneBackTo) {
  Manager manager = on_floor();
  std::vector<BodyId> bodies;
  for (int i = 0; i < 64; ++i) {  // each layer half a box aside
    const int layer = i / 16;
    const Vec3 position(0.205 * (i % 4) + 0.1 * (layer % 2), 0.255 * (i / 4 % 4) + 0.12 * (layer % 2),
                        0.152 + 0.305 * layer);
    bodies.push_back(add(manager, SavedWorld::shapes()[0], testing::at(position), LevelChoice::support));
  }
  run(manager, 0.1);
  const Bytes snapshot = manager.snapshot();
  const auto go_on = [&] {
    for (const BodyId body : bodies) manager.set_level(body, LevelChoice::full);
    run(manager, 1.5);
    return manager.state_hash();
  };
  const std::uint64_t once = go_on();
  EXPECT_GT(manager.report().counters.full_quick_steps, 0);
  manager.restore(snapshot);
  EXPECT_EQ(go_on(), once);
}

// Where ODE's substep is repeated, who fell asleep in it was missed by those that find contacts anew, unless
// it had slept near there before, of which a snapshot knows nothing.
TEST(ManagerSnapshot, AFullHeapThatFallsAsleepGoesOnToTheBit) {
  constexpr int kSide = 6;
  const auto cube = box_shape({0.3, 0.3, 0.3});
  Manager manager = on_floor(unmeasured());
  RandomStream random(1, 0, 0);
  const auto some = [&] { return random.uniform(-0.02, 0.02); };
  for (int i = 0; i < 2 * kSide * kSide; ++i)
    add(manager, cube,
        at({0.31 * (i / (2 * kSide)) + some(), 0.31 * (i / 2 % kSide) + some(), 0.3 + 0.33 * (i % 2)}),
        LevelChoice::full);
  std::optional<Manager> other;
  for (int step = 0; step < 150; ++step) {
    manager.step(kFrame);
    if (other) {
      other->step(kFrame);
      ASSERT_EQ(other->state_hash(), manager.state_hash()) << step;
    }
    if (step % 10 == 5) {
      other.emplace(on_floor(unmeasured()));
      other->restore(manager.snapshot(), {&cube, 1});
    }
  }
}

TEST(ManagerSnapshot, ThreadsOfTheReaderDoNotMatter) {
  SavedWorld writer;
  writer.fill();
  writer.step(20);
  ManagerSettings threaded = unmeasured({.policy = DistancePolicy{2.0}});
  threaded.threads = 3;
  SavedWorld reader(threaded);
  reader.manager.restore(writer.manager.snapshot(), SavedWorld::shapes());
  writer.step(40), reader.step(40);
  EXPECT_EQ(reader.manager.state_hash(), writer.manager.state_hash());
}

// Ids are the snapshot's: those given since are good no more, those removed since are again.
// Putting it back counted as having moved it: who lies on it began anew to come to rest.
TEST(ManagerSnapshot, GroundThatWasMovedOnceStandsStillForItsReader) {
  const auto set_up = [](Manager& manager) {
    const GroundId box = manager.add_static_box({4, 4, 0.4}, {0, 0, -1}, Quat::Identity());
    manager.move_ground(box, at({0, 0, -0.2}));
  };
  Manager manager(unmeasured());
  set_up(manager);
  const BodyId crate = add(manager, box_shape({0.3, 0.3, 0.3}), at({0, 0, 0.1501}), LevelChoice::full);
  for (int i = 0; i < 20; ++i) manager.step(kFrame);
  Manager reader(unmeasured());
  set_up(reader);
  reader.restore(manager.snapshot(), std::vector{box_shape({0.3, 0.3, 0.3})});
  ASSERT_FALSE(manager.asleep(crate));
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame), reader.step(kFrame);
    ASSERT_EQ(reader.asleep(crate), manager.asleep(crate)) << i;
    ASSERT_EQ(reader.state_hash(), manager.state_hash()) << i;
  }
  EXPECT_TRUE(reader.asleep(crate));
}

// Put on up to the snapshot it stands from the next step on, which wakes who was laid to sleep on it; put on
// since, and back, it does not go on.
TEST(ManagerSnapshot, GroundThatWasPutOnStandsAgainForItsReader) {
  struct World {
    World() { manager.add_plane(Vec3::UnitZ(), 0.0); }
    void put(double x) { manager.move_ground(platform, testing::at({x, 0, 0.3})); }
    void go(double from, double to) {
      for (int i = 9; i >= 0; --i) put(to - 0.1 * i * (to - from)), manager.step(testing::kFrame);
    }
    Manager manager{{.signatures = testing::coarse_signature}};
    GroundId platform = manager.add_static_box({2, 2, 0.3}, {0, 0, 0.3}, Quat::Identity());
  };
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const bool goes : {true, false}) {
      World writer, another;
      std::vector<BodyId> crates;
      for (int i = 0; i < 4; ++i)
        crates.push_back(testing::add(writer.manager, SavedWorld::shapes()[0],
                                      testing::at({-0.6 + 0.4 * i, 0, 0.601}), level));
      testing::run(writer.manager, 3.0);
      const double at = goes ? 0.01 : 0.0;
      if (goes) writer.go(0.0, at);
      for (const BodyId body : crates) writer.manager.sleep(body);
      const Bytes snapshot = writer.manager.snapshot();
      const auto go_on = [&](World& world) {
        if (!goes) world.manager.wake(crates[0]);
        testing::run(world.manager, 0.1);
        return world.manager.state_hash();
      };
      const std::uint64_t expected = go_on(writer);
      EXPECT_FALSE(writer.manager.asleep(crates[0])) << int(level);
      writer.go(at, at + 0.1), writer.go(at + 0.1, at);
      if (goes) another.put(at);
      for (World* reader : {&writer, &another}) {
        reader->manager.restore(snapshot, SavedWorld::shapes());
        EXPECT_EQ(go_on(*reader), expected)
            << int(level) << (goes ? ", goes" : "") << (reader == &another ? ", another" : "");
      }
    }
}

TEST(ManagerSnapshot, IdsAreThoseOfTheSnapshot) {
  SavedWorld world;
  world.fill();
  world.step(5);
  const Bytes snapshot = world.manager.snapshot();
  world.manager.remove_body(world.bodies[4]);
  const BodyId late =
      world.manager.add_body({.shape = SavedWorld::shapes()[0], .state = testing::at({9, 9, 9})});
  world.step(3);
  world.manager.restore(snapshot);
  EXPECT_TRUE(world.manager.valid(world.bodies[4]));
  EXPECT_FALSE(world.manager.valid(late));
  EXPECT_EQ(world.manager.bodies(), 14);
}

// What cannot be read is refused, and nothing has changed.
TEST(ManagerSnapshot, DamageAndOtherSettingsAreRefusedAndChangeNothing) {
  SavedWorld writer, reader;
  writer.fill(), reader.fill(2);
  writer.step(10), reader.step(10);
  const Bytes sound = writer.manager.snapshot();
  const std::uint64_t before = reader.manager.state_hash();
  const auto refused = [&](const Bytes& bytes) {
    const bool thrown =
        message_of([&] { reader.manager.restore(bytes, SavedWorld::shapes()); }) != kNothingThrown;
    EXPECT_EQ(reader.manager.state_hash(), before);
    return thrown;
  };
  for (std::size_t length = 0; length < sound.size(); length += 1 + sound.size() / 50)
    EXPECT_TRUE(refused({sound.begin(), sound.begin() + std::ptrdiff_t(length)})) << length;
  for (std::size_t at = 0; at < sound.size(); at += 1 + sound.size() / 50) {
    Bytes damaged = sound;
    damaged[at] ^= std::byte(0x40);
    EXPECT_TRUE(refused(damaged)) << at;
  }
  Bytes longer = sound;
  longer.push_back(std::byte(0));
  EXPECT_TRUE(refused(longer));
  EXPECT_EQ(message_of([&] { reader.manager.restore(Bytes(200)); }),
            "snapshot: found no LODESNAP at its beginning, expected what snapshot() returns");
  EXPECT_TRUE(
      message_of([&] { reader.manager.restore(Bytes(12)); }).starts_with("snapshot: found 12 bytes, "));
  SavedWorld without;
  EXPECT_NE(message_of([&] { without.manager.restore(sound); }), kNothingThrown);  // its shapes are unknown
  EXPECT_EQ(without.manager.bodies(), 0);
}

TEST(ManagerSnapshot, OfAnotherSceneIsRefused) {
  SavedWorld writer;
  writer.fill();
  const Bytes snapshot = writer.manager.snapshot();
  const auto fault = [&](ManagerSettings settings, const auto& change) {
    Manager other = on_floor(settings);
    change(other);
    return message_of([&] { other.restore(snapshot, SavedWorld::shapes()); });
  };
  const ManagerSettings plain = unmeasured({.policy = DistancePolicy{2.0}});
  EXPECT_EQ(fault(plain, [](Manager&) {}), kNothingThrown);
  ManagerSettings seeded = plain;
  seeded.seed = 99;
  EXPECT_EQ(fault(seeded, [](Manager&) {}),
            "snapshot: found one of a manager with seed 1, expected one with seed 99");
  EXPECT_EQ(fault(plain, [](Manager& m) { m.add_plane(Vec3::UnitX(), -5); }),
            "snapshot: found one of a manager with other planes, expected one with the planes here");
  EXPECT_EQ(fault(plain, [](Manager& m) { m.materials().add({.friction = 0.1}); }),
            "snapshot: found one of a manager with other materials, expected one with the materials here");
}

// Turned since, or turned when the reader knows nothing of it: it is the snapshot's again, and who slept
// sleeps.
TEST(ManagerSnapshot, GravityIsPartOfIt) {
  const ManagerSettings all_rungs = {
      .policy = {.policy = DistancePolicy{.full_within = 1.0, .support_within = 1.5}},
      .signatures = coarse_signature,
      .signature_timing = SignatureTiming::in_step};
  SavedWorld writer(all_rungs), reader(all_rungs);
  writer.fill();
  writer.manager.set_gravity({0, 1, -7});
  writer.step(30);
  const Bytes snapshot = writer.manager.snapshot();
  const auto go_on = [](SavedWorld& world) {
    world.step(200);
    return world.manager.state_hash();
  };
  const std::uint64_t expected = go_on(writer);
  writer.manager.set_gravity({0, 0, -3});
  writer.step(5);
  for (SavedWorld* world : {&writer, &reader}) {
    world->manager.restore(snapshot, SavedWorld::shapes());
    EXPECT_EQ(world->manager.gravity(), Vec3(0, 1, -7));
    EXPECT_EQ(go_on(*world), expected);
  }
}

// Forces that wait for a step, bodies that wait for their first, and sleepers are part of it.
TEST(ManagerSnapshot, WhatWaitsIsPartOfIt) {
  SavedWorld world;
  world.fill();
  world.step(5);
  world.manager.add_force(world.bodies[1], {50, 0, 100});
  world.manager.sleep(world.bodies[2]);
  world.manager.add_body({.shape = SavedWorld::shapes()[1], .state = testing::at({5, 5, 1}, {0, 0, 3})});
  const Bytes snapshot = world.manager.snapshot();
  world.step(20);
  const std::uint64_t expected = world.manager.state_hash();
  SavedWorld reader;
  reader.manager.restore(snapshot, SavedWorld::shapes());
  reader.step(20);
  EXPECT_EQ(reader.manager.state_hash(), expected);
}

// Sleepers are looked at anew where the reader's policy is another than the writer's.
TEST(ManagerSnapshot, TheReadersPolicyDecides) {
  const auto make = [](double full_within) {
    Manager manager = testing::on_floor(testing::unmeasured({.policy = DistancePolicy{full_within}}));
    testing::view_from(manager, {0, 0, 1});
    return manager;
  };
  Manager writer = make(1.0);
  const BodyId crate = add(writer, SavedWorld::shapes()[0], testing::at({5, 0, 0.2}));
  testing::run(writer, 0.5);
  writer.sleep(crate);
  testing::run(writer, 0.1);
  ASSERT_EQ(writer.rung(crate), Rung::support);
  const Bytes snapshot = writer.snapshot();

  Manager reader = make(20.0);
  reader.restore(snapshot, SavedWorld::shapes());
  testing::run(reader, 0.5);
  EXPECT_EQ(reader.rung(crate), Rung::full);
  writer.set_policy({.policy = DistancePolicy{20.0}});
  writer.restore(snapshot);
  testing::run(writer, 0.5);
  EXPECT_EQ(writer.rung(crate), Rung::full);
}

// Whose bins are ground, and whose kinematic slide moves what lies on it.
struct SavedCallersWorld {
  SavedCallersWorld() : manager(his.world, his.space, unmeasured({.policy = DistancePolicy{1.5, 6.0}})) {
    dWorldSetGravity(his.world, 0, 0, -kGravity);
    dCreatePlane(his.space, 0, 0, 1, 0);
    for (const double side : {-0.6, 0.6}) {
      his.box({0.1, 1.3, 1.2}, {side, 0, 0.6});
      his.box({1.3, 0.1, 1.2}, {0, side, 0.6});
    }
    slide = his.body(1.0, {0.4, 0.4, 0.2});
    dBodySetKinematic(slide);
    for (int i = 0; i < 10; ++i) {
      RandomStream random(17, std::uint32_t(i), 0);
      manager.add_body({.shape = SavedWorld::shapes()[0],
                        .state = testing::at({0.2 * (i % 3) - 0.2, 0.1 * (i % 2), 0.3 + 0.3 * i}, {0, 0, 0},
                                             {0, 0, 0}, random.orientation()),
                        .level = i % 4 == 1 ? LevelChoice::full : LevelChoice::support});
    }
  }
  // The slide goes to and fro.
  void run(int from, int to) {
    for (int i = from; i < to; ++i) {
      dBodySetLinearVel(slide, i / 20 % 2 ? 0.5 : -0.5, 0, 0);
      manager.step(kFrame);
    }
  }
  CallersScene his;
  Manager manager;
  dBodyID slide;
};

// Contacts with his ground are remembered by its parts, which a manager that is new has not met yet.
TEST(ManagerSnapshot, InACallersWorldANewManagerGoesOnToTheBit) {
  SavedCallersWorld writer;
  writer.run(0, 50);
  const Bytes snapshot = writer.manager.snapshot();
  const dReal* place = dBodyGetPosition(writer.slide);
  const Vec3 slide(place[0], place[1], place[2]);
  writer.run(50, 110);
  for (const int steps_before : {0, 7}) {
    SavedCallersWorld reader;
    reader.run(0, steps_before);
    dBodySetPosition(reader.slide, slide.x(), slide.y(), slide.z());
    reader.manager.restore(snapshot);
    reader.run(50, 110);
    EXPECT_EQ(reader.manager.state_hash(), writer.manager.state_hash()) << steps_before;
  }
}

// Crates in a row on a platform of his, which he puts along by `way` m before each step, or none.
struct HisPlatform {
  explicit HisPlatform(LevelChoice level)
      : manager(his.world, his.space, {.signatures = testing::coarse_signature}) {
    dWorldSetGravity(his.world, 0, 0, -kGravity);
    dCreatePlane(his.space, 0, 0, 1, 0);
    platform = his.box({2, 2, 0.3}, {0, 0, 0.3});
    for (int i = 0; i < 4; ++i)
      crates.push_back(
          testing::add(manager, SavedWorld::shapes()[0], testing::at({-0.6 + 0.4 * i, 0, 0.601}), level));
  }
  void put(double x) { dGeomSetPosition(platform, at = x, 0, 0.3); }
  void run(int steps, double way) {
    for (int i = 0; i < steps; ++i) {
      if (way != 0.0) put(at + way);
      manager.step(testing::kFrame);
    }
  }
  int asleep() const {
    return int(std::ranges::count_if(crates, [this](BodyId body) { return manager.asleep(body); }));
  }
  CallersScene his;
  Manager manager;
  dGeomID platform;
  double at = 0.0;
  std::vector<BodyId> crates;
};

constexpr LevelChoice kOfEachRung[] = {LevelChoice::full, LevelChoice::support, LevelChoice::tables};

// As manager.h asks for. It woke who slept there.
TEST(ManagerSnapshot, HisGroundThatWasPutBackHasNotMoved) {
  for (const LevelChoice level : kOfEachRung)
    for (const double away : {0.2, 5.0}) {
      HisPlatform on(level);
      on.run(300, 0.0);
      ASSERT_EQ(on.asleep(), 4) << int(level);
      const Bytes snapshot = on.manager.snapshot();
      on.run(2, 0.0);
      const std::uint64_t expected = on.manager.state_hash();
      on.put(away);
      on.run(3, 0.0);
      on.put(0.0);
      on.manager.restore(snapshot);
      on.run(2, 0.0);
      EXPECT_EQ(on.asleep(), 4) << int(level);
      EXPECT_EQ(on.manager.state_hash(), expected) << int(level) << ", " << away << " m";
    }
}

// Whether it goes on or stands from then on, which wakes who was laid to sleep on it; for another manager,
// too.
TEST(ManagerSnapshot, HisGroundThatWasPutOnGoesOnOrStandsAgain) {
  for (const LevelChoice level : kOfEachRung)
    for (const double then : {0.0, 0.01}) {
      HisPlatform writer(level);
      writer.run(60, 0.0), writer.run(20, 0.01);
      if (then == 0.0)
        for (const BodyId body : writer.crates) writer.manager.sleep(body);
      const Bytes snapshot = writer.manager.snapshot();
      const double at = writer.at;
      writer.run(10, then);
      const std::uint64_t expected = writer.manager.state_hash();
      EXPECT_EQ(writer.asleep(), 0) << int(level);
      writer.run(5, 0.02);
      HisPlatform another(level);
      for (HisPlatform* reader : {&writer, &another}) {
        reader->put(at);
        reader->manager.restore(snapshot);
        reader->run(10, then);
        EXPECT_EQ(reader->manager.state_hash(), expected)
            << int(level) << ", " << then << " m" << (reader == &another ? ", another" : "");
      }
    }
}

TEST(ManagerSnapshot, InACallersWorldGravityIsHisToPutBack) {
  SavedCallersWorld writer;
  writer.run(0, 20);
  const Bytes snapshot = writer.manager.snapshot();
  dVector3 his;
  dWorldGetGravity(writer.his.world, his);
  dWorldSetGravity(writer.his.world, 1, 0, -5);
  EXPECT_NE(message_of([&] { writer.manager.restore(snapshot); }).find("gravity"), std::string::npos);
  dWorldSetGravity(writer.his.world, his[0], his[1], his[2]);
  EXPECT_EQ(message_of([&] { writer.manager.restore(snapshot); }), kNothingThrown);
}

// Contacts with his bodies are remembered by numbers of theirs, and his shapes by how they stand to their
// bodies, wherever these are.
TEST(ManagerSnapshot, WhatTouchesACallersBodyGoesOnToTheBit) {
  struct World {
    World() : manager(his.world, his.space, unmeasured()) {
      dCreatePlane(his.space, 0, 0, 1, 0);
      for (const double y : {-2.0, 0.03}) {  // the first touches nobody
        dBodyID& body = y < 0.0 ? bystander : pusher;
        body = his.body(80.0, {-1.2, y, 0.3});
        dBodySetGravityMode(body, 0);
      }
      for (int i = 0; i < 3; ++i)
        row.push_back(manager.add_body({.shape = SavedWorld::shapes()[0],
                                        .state = testing::at({0.45 * i, 0, 0.2}),
                                        .level = LevelChoice::support}));
    }
    void run(int from, int to) {
      for (int i = from; i < to; ++i) {
        dBodyEnable(pusher), dBodySetLinearVel(pusher, 1, 0, 0), dBodySetAngularVel(pusher, 0, 0, 0);
        manager.step(kFrame);
      }
    }
    CallersScene his;
    Manager manager;
    dBodyID bystander = nullptr, pusher = nullptr;
    std::vector<BodyId> row;
  };
  World writer;
  writer.run(0, 70);
  const Bytes snapshot = writer.manager.snapshot();
  dVector3 at;
  dQuaternion turned;
  dBodyCopyPosition(writer.pusher, at);
  dBodyCopyQuaternion(writer.pusher, turned);
  World reader;
  for (World* world : {&writer, &reader}) {
    dBodySetPosition(world->pusher, at[0], at[1], at[2]);
    dBodySetQuaternion(world->pusher, turned);  // which ODE normalizes
    if (world == &reader) reader.manager.restore(snapshot);
    world->run(70, 130);
  }
  EXPECT_GT(writer.manager.state(writer.row[0]).position.x(), 0.2);  // it was pushed
  EXPECT_EQ(reader.manager.state_hash(), writer.manager.state_hash());
}

// Who sleeps at `support` or `tables` where one of his bodies goes by wakes as it leaves. Snapshots at each
// step of its way.
TEST(ManagerSnapshot, WhoSleepsWhereHisBodyGoesByGoesOnToTheBit) {
  for (const LevelChoice level : kOfEachRung) {
    CallersScene his;
    Manager manager(his.world, his.space, {.signatures = testing::coarse_signature});
    dWorldSetGravity(his.world, 0, 0, -kGravity);
    dCreatePlane(his.space, 0, 0, 1, 0);
    const dBodyID flier = his.body(80.0, {-1.5, 0, 0.51});
    dBodySetGravityMode(flier, 0);
    for (int i = 0; i < 4; ++i)
      testing::add(manager, SavedWorld::shapes()[0], testing::at({0.45 * i - 0.6, 0, 0.15}), level);
    for (int i = 0; i < 300; ++i) manager.step(kFrame);
    ASSERT_EQ(manager.report().asleep, 4) << int(level);
    struct Moment {
      Bytes snapshot;
      double at = 0.0;
      std::uint64_t next = 0;
    };
    std::vector<Moment> moments;
    const auto step = [&] {
      dBodyEnable(flier), dBodySetLinearVel(flier, 2, 0, 0), dBodySetAngularVel(flier, 0, 0, 0);
      manager.step(kFrame);
    };
    int least_asleep = 4;
    for (int i = 0; i < 60; ++i) {
      moments.push_back({manager.snapshot(), dBodyGetPosition(flier)[0]});
      step();
      moments.back().next = manager.state_hash();
      least_asleep = std::min(least_asleep, manager.report().asleep);
    }
    if (level != LevelChoice::full) {
      EXPECT_LT(least_asleep, 4) << int(level);
    }
    for (const Moment& moment : moments) {
      dBodySetPosition(flier, moment.at, 0, 0.51);
      manager.restore(moment.snapshot);
      step();
      EXPECT_EQ(manager.state_hash(), moment.next) << int(level) << ", " << moment.at << " m";
    }
  }
}

// A ring about y that turns, with four ribs: his kinematic body.
struct HisDrum {
  static constexpr int kSides = 24;
  static constexpr double kRate = 1.5;  // rad/s

  explicit HisDrum(LevelChoice level)
      : manager(his.world, his.space, {.signatures = testing::coarse_signature}) {
    dWorldSetGravity(his.world, 0, 0, -kGravity);
    for (const double side : {-1.06, 1.06}) his.box({3.2, 0.1, 3.2}, {0, side, 0});
    for (const double outward : {0.0, 0.15})
      for (const double y : {-1.0, 1.0})
        for (int i = 0; i < kSides; ++i) {
          const double angle = 2.0 * std::numbers::pi * i / kSides, radius = 1.2 + (outward > 0.0 ? outward
                                                                                    : i % 6 == 0  ? -0.3
                                                                                                  : 0.0);
          vertices.insert(vertices.end(), {radius * std::cos(angle), y, radius * std::sin(angle)});
        }
    const auto quad = [&](int a, int b, int c, int d) {
      for (const int vertex : {a, b, c, c, b, d}) faces.push_back(dTriIndex(vertex));
    };
    for (int i = 0; i < kSides; ++i) {
      const int next = (i + 1) % kSides;
      const auto at = [](int wall, int end, int side) { return (2 * wall + end) * kSides + side; };
      quad(at(0, 0, i), at(0, 0, next), at(0, 1, i), at(0, 1, next));
      quad(at(1, 0, i), at(1, 1, i), at(1, 0, next), at(1, 1, next));
      quad(at(0, 0, i), at(1, 0, i), at(0, 0, next), at(1, 0, next));
      quad(at(0, 1, i), at(0, 1, next), at(1, 1, i), at(1, 1, next));
    }
    dGeomTriMeshDataBuildDouble(data, vertices.data(), 3 * sizeof(double), int(vertices.size() / 3),
                                faces.data(), int(faces.size()), 3 * sizeof(dTriIndex));
    ring = dBodyCreate(his.world);
    dBodySetKinematic(ring);
    mesh = dCreateTriMesh(his.space, data, nullptr, nullptr, nullptr);
    dGeomSetBody(mesh, ring);
    dBodySetAngularVel(ring, 0, kRate, 0);
    for (int i = 0; i < 18; ++i)
      testing::add(manager, SavedWorld::shapes()[i % 3 ? 0 : 1],
                   testing::at({0.4 * (i % 3) - 0.4, 0.4 * (i / 3 % 4) - 0.6, 0.4 * (i / 12) - 0.5}), level);
  }
  ~HisDrum() {
    manager = Manager();
    dGeomDestroy(mesh);
    dBodyDestroy(ring);
    dGeomTriMeshDataDestroy(data);
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) manager.step(kFrame);
  }
  /// ODE normalises what it is given: the writer is put so, too.
  void turn(const dQuaternion& turned) { dBodySetQuaternion(ring, turned); }
  CallersScene his;
  Manager manager;
  dBodyID ring = nullptr;
  dGeomID mesh = nullptr;
  std::vector<double> vertices;
  std::vector<dTriIndex> faces;
  dTriMeshDataID data = dGeomTriMeshDataCreate();
};

// The writer itself, and another whose first sight of his mesh is of it turned.
TEST(ManagerSnapshot, InHisTurningDrumAllRungsGoOnToTheBit) {
  for (const LevelChoice level : kOfEachRung) {
    HisDrum writer(level);
    for (int round = 0; round < 10; ++round) {
      writer.run(25);
      dQuaternion turned;
      dBodyCopyQuaternion(writer.ring, turned);
      writer.turn(turned), dBodyCopyQuaternion(writer.ring, turned), writer.turn(turned);
      const Bytes snapshot = writer.manager.snapshot();
      writer.run(10);
      const std::uint64_t expected = writer.manager.state_hash();
      writer.turn(turned);
      writer.manager.restore(snapshot);
      writer.run(10);
      EXPECT_EQ(writer.manager.state_hash(), expected) << int(level) << ", round " << round;
      if (round % 5 != 0) continue;
      HisDrum another(level);
      another.turn(turned);
      another.manager.restore(snapshot);
      another.run(10);
      EXPECT_EQ(another.manager.state_hash(), expected) << int(level) << ", round " << round << ", another";
    }
  }
}

// A body of `tables`, which cannot be without one.
// Sleepers on a slope, too, that are woken after it.
TEST(ManagerSnapshot, WhoeverIsWokenByItsReaderGoesOnToTheBit) {
  const Quat tilt(Eigen::AngleAxisd(0.2, Vec3::UnitY()));
  const auto make = [&] {
    Manager manager({.signatures = testing::coarse_signature});
    manager.add_static_box({8, 8, 1}, tilt * Vec3(0, 0, -0.5), tilt);
    return manager;
  };
  const std::shared_ptr<const Shape> shapes[] = {testing::box_shape({0.4, 0.4, 0.2})};
  Manager writer = make();
  std::vector<BodyId> slabs;  // on each other
  for (const double height : {0.101, 0.302})
    slabs.push_back(writer.add_body({.shape = shapes[0],
                                     .state = {.position = tilt * Vec3(0, 0, height), .orientation = tilt},
                                     .level = LevelChoice::tables}));
  testing::add(writer, shapes[0], testing::at({0, 0, 90}), LevelChoice::tables);  // falls, for four seconds
  int steps = 0;
  for (; steps < 150 && !(writer.asleep(slabs[0]) && writer.asleep(slabs[1])); ++steps)
    writer.step(testing::kFrame);
  ASSERT_LT(steps, 150);
  testing::run(writer, 0.1);
  const Bytes snapshot = writer.snapshot();
  Manager reader = make();
  reader.restore(snapshot, shapes);
  for (Manager* manager : {&writer, &reader})
    testing::run(*manager, 0.1), manager->wake(slabs[0]), testing::run(*manager, 0.1);
  EXPECT_EQ(reader.state_hash(), writer.state_hash());
}

TEST(ManagerSnapshot, WithoutItsSignatureNothingChanges) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  ManagerSettings settings = unmeasured();
  settings.signatures = coarse_signature;
  Manager writer = on_floor(settings);
  add(writer, box, testing::at({0, 0, 1}), LevelChoice::tables);
  run(writer, 0.2);
  const Bytes snapshot = writer.snapshot();

  Manager reader = on_floor();
  const BodyId own = add(reader, box, testing::at({3, 0, 1}), LevelChoice::support);
  run(reader, 0.1);
  const std::uint64_t before = reader.state_hash();
  const std::string message = testing::message_of([&] { reader.restore(snapshot); });
  EXPECT_NE(message.find("signature of shape"), std::string::npos) << message;
  EXPECT_NE(message.find("found none here"), std::string::npos) << message;
  EXPECT_EQ(reader.state_hash(), before);
  EXPECT_EQ(reader.bodies(), 1);
  reader.step(kFrame);
  EXPECT_LT(reader.state(own).position.z(), 1.0);
}

// It was measured under the law of the plane that was the first one when its body came.
TEST(ManagerSnapshot, GoesOnWithTheSignatureThatItHad) {
  const auto box = box_shape({0.2, 0.3, 0.4});
  ManagerSettings settings = unmeasured();
  std::vector<double> asked;
  settings.signatures = [&](const Shape& shape, const ContactLaw& law) {
    asked.push_back(law.friction);
    return coarse_signature(shape, law);
  };
  const auto with_planes = [&] {
    Manager manager(settings);
    manager.materials().add({.restitution = 0.1, .friction = 0.9});
    manager.add_plane(Vec3::UnitX(), -50.0, 1);
    return manager;
  };
  Manager writer = with_planes();
  const GroundId floor = writer.add_plane(Vec3::UnitZ(), 0.0, 1);
  add(writer, box, testing::at({0, 0, 1}), LevelChoice::tables);
  run(writer, 0.1);
  const double first = asked.front();
  writer.materials().replace(1, {.restitution = 0.1, .friction = 0.2});
  run(writer, 0.1);
  const Bytes snapshot = writer.snapshot();
  asked.clear();
  Manager reader = with_planes();
  reader.materials().replace(1, {.restitution = 0.1, .friction = 0.2});
  EXPECT_EQ(reader.add_plane(Vec3::UnitZ(), 0.0, 1), floor);
  reader.restore(snapshot, {{box}});
  EXPECT_EQ(asked, std::vector<double>{first});
  run(writer, 1.0), run(reader, 1.0);
  EXPECT_EQ(reader.state_hash(), writer.state_hash());
}

// Bytes that only another kind of policy had, which it had before, made it another one.
TEST(ManagerSnapshot, OfAPolicyCountsWhatItIsNotWhatItWas) {
#if !__has_builtin(__builtin_clear_padding)
  GTEST_SKIP() << "this compiler does not clear what lies between members";
#endif
  PolicySettings limited;
  limited.policy = DistancePolicy{2.0, 3.5}, limited.most_full = 3, limited.most_support = 5;
  const auto after = [&](const PolicySettings& before) {
    Manager manager = on_floor(unmeasured(before));
    manager.set_policy(limited);
    return manager.snapshot();
  };
  EXPECT_EQ(after({.policy = ErrorBudgetPolicy{.budget_work = 123.0}}),
            after({.policy = ErrorBudgetPolicy{}}));
}

}  // namespace
}  // namespace lodestone
