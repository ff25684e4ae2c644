// What nothing stops, a platform or a kinematic body, moves sleepers and all that they carry, however slowly
// it goes.
#include "lod/rungs/carried_bodies.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

constexpr double kCrate = 0.3, kHalfWall = 0.1;  // m
constexpr double kSpeeds[] = {0.01, 0.05, 0.3};  // m/s: sleepers wake by themselves from .1 m/s on
constexpr double kLiftedFor = 2.0;               // s

std::shared_ptr<const Shape> crate() { return box_shape({kCrate, kCrate, kCrate}); }

struct OnLift {
  Manager manager{{.signatures = coarse_signature}};
  GroundId lift = manager.add_static_box({2, 2, 0.2}, Vec3(0, 0, -0.1), Quat::Identity());
  std::vector<BodyId> stack;

  OnLift(LevelChoice level, int crates) {
    for (int i = 0; i < crates; ++i)
      stack.push_back(add(manager, crate(), testing::at({0, 0, kCrate * (i + 0.5) + 1e-4 * i}), level));
    run(manager, 2.0);
    for (const BodyId body : stack) EXPECT_TRUE(manager.asleep(body));
  }
  /// m: by how much the stack became lower at most.
  double move(const Vec3& velocity) {
    double most = 0.0;
    for (int i = 1; i <= int(kLiftedFor / kFrame); ++i) {
      RigidState state = testing::at(Vec3(0, 0, -0.1) + velocity * (i * kFrame));
      state.velocity = velocity;
      manager.move_ground(lift, state);
      manager.step(kFrame);
      const double top = state.position.z() + 0.1;
      most = std::max(most, top + kCrate * (double(stack.size()) - 0.5) - z(stack.back()));
    }
    return most;
  }
  double z(BodyId body) const { return manager.state(body).position.z(); }
};

TEST(CarriedBodies, ALiftCarriesAStack) {
  for (const auto& [level, shrinks] :
       {std::pair{LevelChoice::full, 0.002},
        {LevelChoice::support, 0.002},
        {LevelChoice::tables, 0.02}})  // m: among others its bodies give way a little
    for (const double speed : kSpeeds)
      EXPECT_LT(OnLift(level, 3).move({0, 0, speed}), shrinks) << int(level) << " at " << speed << " m/s";
}

// Ground goes on through a step from where it was put: else what lies on it hovers and sinks by what it goes
// in a step, 13 mm here.
TEST(CarriedBodies, WhoLiesOnAShakenTrayStaysOnIt) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const double pulse : {2.0 * M_PI, 12.0 * M_PI}) {  // 1/s
      OnLift on(level, 1);
      const double amplitude = 0.5 * 9.81 / (pulse * pulse);  // m: half of gravity at most
      const auto height = [&](int frame) { return amplitude * (1.0 - std::cos(pulse * frame * kFrame)); };
      for (int i = 0; i < 120; ++i) {
        RigidState state = testing::at({0, 0, height(i) - 0.1});
        state.velocity.z() = (height(i + 1) - height(i)) / kFrame;
        on.manager.move_ground(on.lift, state);
        on.manager.step(kFrame);
        ASSERT_NEAR(on.z(on.stack.front()) - height(i + 1), 0.5 * kCrate, 1e-3)
            << int(level) << ", " << pulse << "/s, frame " << i;
      }
    }
}

TEST(CarriedBodies, APlatformCarriesAStackAlong) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support})
    for (const double speed : kSpeeds) {
      OnLift on(level, 3);
      on.move({speed, 0, 0});
      for (const BodyId body : on.stack)
        EXPECT_NEAR(on.manager.state(body).position.x(), speed * kLiftedFor, 0.02)
            << int(level) << " at " << speed << " m/s";
    }
}

TEST(CarriedBodies, TheySleepAgainWhereItStands) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support}) {
    OnLift on(level, 3);
    on.move({0, 0, 0.05});
    RigidState stands = testing::at({0, 0, -0.1 + 0.05 * kLiftedFor});
    on.manager.move_ground(on.lift, stands);
    run(on.manager, 2.0);
    for (const BodyId body : on.stack) EXPECT_TRUE(on.manager.asleep(body)) << int(level);
  }
}

// A platform that is there at once slides under them until friction has set them in motion.
TEST(CarriedBodies, APlatformCarriesAStackOfTables) {
  for (const double speed : kSpeeds) {
    OnLift on(LevelChoice::tables, 3);
    on.move({speed, 0, 0});
    for (const BodyId body : on.stack)
      EXPECT_NEAR(on.manager.state(body).position.x(), speed * kLiftedFor, 0.1 * kCrate) << speed << " m/s";
  }
}

// m: how far crates of `tables` slip, at most, in four seconds on a platform of `parts` boxes that starts off
// at 1 m/s², goes on at 1 m/s and takes them up and down by .2 m meanwhile.
double slip_on_platform(int parts, const std::vector<Vec3>& places) {
  Manager manager({.signatures = coarse_signature});
  constexpr double kWidth = 6.0;
  std::vector<GroundId> platform;
  const auto middle_of = [&](int part) { return Vec3(0, kWidth / parts * (part - 0.5 * (parts - 1)), -0.1); };
  for (int part = 0; part < parts; ++part)
    platform.push_back(manager.add_static_box({6, kWidth / parts, 0.2}, middle_of(part), Quat::Identity()));
  std::vector<BodyId> crates;
  for (const Vec3& place : places)
    crates.push_back(add(manager, crate(), testing::at(place), LevelChoice::tables));
  const auto way = [](double t) {
    return Vec3(t < 1.0 ? 0.5 * t * t : t - 0.5, 0, 0.2 * (1.0 - std::cos(1.5 * t)));
  };
  constexpr int kFrames = 240;
  for (int i = 0; i < kFrames; ++i) {
    const Vec3 from = way(i * kFrame), velocity = (way((i + 1) * kFrame) - from) / kFrame;
    for (int part = 0; part < parts; ++part) {
      RigidState state = testing::at(middle_of(part) + from);
      state.velocity = velocity;
      manager.move_ground(platform[std::size_t(part)], state);
    }
    manager.step(kFrame);
  }
  double most = 0.0;
  for (std::size_t i = 0; i < crates.size(); ++i)
    most = std::max(most, (manager.state(crates[i]).position - way(kFrames * kFrame) - places[i]).norm());
  return most;
}

TEST(CarriedBodies, CratesOfTablesThatTouchAreCarriedAlong) {
  const double low = kCrate / 2, side = kCrate;
  for (const int parts : {1, 2}) {  // of two, they lie on the seam
    EXPECT_LT(slip_on_platform(parts, {{0, 0, low}}), 0.02) << parts;
    EXPECT_LT(slip_on_platform(parts, {{0, 0, low}, {side, 0, low}, {0, side, low}, {side, side, low}}), 0.02)
        << parts;
    EXPECT_LT(slip_on_platform(parts, {{0, 0, low}, {0, 0, low + side}}), 0.15 * side) << parts;
  }
}

/// Kinematic; its face is 2 cm before a crate that stands at the origin.
BodyId add_wall(Manager& manager, LevelChoice level) {
  BodyProperties kinematic;
  kinematic.kinematic = true;
  return manager.add_body({.shape = box_shape({2 * kHalfWall, 2, 0.8}),
                           .state = testing::at({-0.02 - kCrate / 2 - kHalfWall, 0, 0.5}),
                           .level = level,
                           .properties = kinematic});
}

void drive(Manager& manager, BodyId wall, double speed) {
  RigidState state = manager.state(wall);
  state.velocity = Vec3(speed, 0, 0);
  manager.set_state(wall, state);
}

double face_of(const Manager& manager, BodyId wall) { return manager.state(wall).position.x() + kHalfWall; }

// On a table of 4 x 4 m that comes to turn about its middle, as ground or as a kinematic body.
struct OnTurntable {
  Manager manager{{.signatures = coarse_signature}};
  const RigidState table_at = testing::at({0, 0, -0.1});
  std::optional<GroundId> ground;
  BodyId table;
  double angle = 0.0;

  OnTurntable(LevelChoice level, bool is_ground) {
    if (is_ground)
      ground = manager.add_static_box({4, 4, 0.2}, table_at.position, Quat::Identity());
    else
      table = manager.add_body({.shape = box_shape({4, 4, 0.2}),
                                .state = table_at,
                                .level = level,
                                .properties = {.kinematic = true}});
  }
  /// rad/s, reached at `faster` rad/s².
  void turn(double turning, double faster, double seconds) {
    for (int i = 0; i < int(seconds / kFrame); ++i) {
      RigidState now = table_at;
      now.angular_velocity = {0, 0, std::min(turning, faster * i * kFrame)};
      now.orientation = Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()));
      if (ground)
        manager.move_ground(*ground, now);
      else
        manager.set_state(table, now);
      manager.step(kFrame);
      angle += now.angular_velocity.z() * kFrame;
    }
  }
};

// Friction holds it on its circle, round after round: the ground turns on while it goes. A crate whose
// contacts alone went along their arcs left the quick one's in three seconds.
TEST(CarriedBodies, ARiderOfATurntableStaysWhereItIs) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    for (const bool is_ground : {false, true})
      for (const auto& [radius, turning, faster, strays] :
           {std::tuple{1.5, 0.9, 0.3, 0.006}, {0.1, 6.0, 3.0, 0.003}}) {  // m, rad/s, rad/s², m
        OnTurntable on(level, is_ground);
        const BodyId rider = add(on.manager, crate(), testing::at({radius, 0, 0.5 * kCrate + 1e-4}), level);
        run(on.manager, 1.0);
        on.turn(turning, faster, 15.0);
        const Vec3 place = on.manager.state(rider).position;
        EXPECT_NEAR(place.head<2>().norm(), radius, strays) << int(level) << is_ground << turning;
        EXPECT_NEAR(std::remainder(std::atan2(place.y(), place.x()) - on.angle, 2.0 * M_PI), 0.0, 0.03)
            << int(level) << is_ground << turning;
      }
}

// The full one goes along the chord of its arc, in ODE; who lies on it went along the tangent, and .1 m
// outward.
TEST(CarriedBodies, WhoLiesOnAFullRiderOfATurntableStaysOnIt) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const bool is_ground : {false, true}) {
      OnTurntable on(LevelChoice::full, is_ground);
      const auto add_rider = [&](double layer, LevelChoice rung) {
        return add(on.manager, crate(), testing::at({1.5, 0, (layer + 0.5) * kCrate + 1e-4}), rung);
      };
      const BodyId below = add_rider(0, LevelChoice::full), above = add_rider(1, level);
      run(on.manager, 1.0);
      on.turn(1.0, 0.5, 8.0);
      const Vec3 apart = on.manager.state(above).position - on.manager.state(below).position;
      EXPECT_LT(apart.head<2>().norm(), 0.012) << int(level) << is_ground;
    }
}

// A wall, kinematic, of either rung, that pushes a row. At `tables` among others its bodies give way a
// little, and as nothing turns them back they leave it sideways after a while.
TEST(CarriedBodies, AKinematicBodyPushesARow) {
  for (const LevelChoice wall_level : {LevelChoice::full, LevelChoice::support})
    for (const auto& [level, overlaps, farthest] : {std::tuple{LevelChoice::full, 0.005, 0.5},
                                                    {LevelChoice::support, 0.005, 0.5},
                                                    {LevelChoice::tables, 0.05, 0.25}})  // m
      for (const double speed : {0.02, 0.05, 0.3}) {
        Manager manager = on_floor({.signatures = coarse_signature});
        const BodyId wall = add_wall(manager, wall_level);
        std::vector<BodyId> row;
        for (int i = 0; i < 3; ++i)
          row.push_back(add(manager, crate(), testing::at({(kCrate + 1e-3) * i, 0, kCrate / 2}), level));
        run(manager, 2.0);
        drive(manager, wall, speed);
        for (double way = 0.0; way < farthest; way += speed * kFrame) {
          manager.step(kFrame);
          double face = face_of(manager, wall);
          for (const BodyId body : row) {
            const double x = manager.state(body).position.x();
            ASSERT_LT(face - (x - kCrate / 2), overlaps) << int(wall_level) << " on " << int(level) << " at "
                                                         << speed << " m/s, after " << way << " m";
            face = x + kCrate / 2;
          }
        }
      }
}

// What touches none of its own rung meets another's bodies on its hull: it does not roll before them.
TEST(CarriedBodies, ACrateOfTablesStaysFlatBeforeAKinematicBody) {
  for (const LevelChoice wall_level : {LevelChoice::full, LevelChoice::support})
    for (const double speed : kSpeeds) {
      Manager manager = on_floor({.signatures = coarse_signature});
      const BodyId wall = add_wall(manager, wall_level),
                   pushed = add(manager, crate(), testing::at({0, 0, kCrate / 2}), LevelChoice::tables);
      run(manager, 2.0);
      drive(manager, wall, speed);
      run(manager, 0.2 / speed);
      const RigidState end = manager.state(pushed);
      EXPECT_NEAR(end.position.x() - face_of(manager, wall), kCrate / 2, 0.002);
      EXPECT_NEAR(end.position.z(), kCrate / 2, 0.001);
      EXPECT_GT((end.orientation * Vec3::UnitZ()).z(), 0.9999);
    }
}

// Through full bodies, too, whose contacts are ODE's.
TEST(CarriedBodies, WhatLiesOnAFullOneOnASlowLiftGoesAlong) {
  constexpr double kLift = 1.0, kSinking = 0.05;  // m, m/s
  for (const LevelChoice above : {LevelChoice::support, LevelChoice::tables})
    for (const bool is_ground : {false, true}) {
      Manager manager = on_floor({.signatures = coarse_signature});
      const Vec3 at(0, 0, 2);
      BodyId body;
      GroundId ground;
      if (is_ground)
        ground = manager.add_static_box({kLift, kLift, kLift}, at, Quat::Identity());
      else
        body = manager.add_body({.shape = box_shape({kLift, kLift, kLift}),
                                 .state = testing::at(at),
                                 .properties = {.kinematic = true}});
      std::vector<BodyId> stack;
      for (int i = 0; i < 3; ++i)
        stack.push_back(add(manager, crate(), testing::at(at + Vec3(0, 0, 0.5 * kLift + kCrate * (i + 0.5))),
                            i == 0 ? LevelChoice::full : above));
      run(manager, 2.0);
      const RigidState sinks = testing::at(at, {0, 0, -kSinking});
      if (!is_ground) manager.set_state(body, sinks);
      for (int i = 0; i < 200; ++i) {
        if (is_ground)
          manager.move_ground(ground, testing::at(at - Vec3(0, 0, kSinking * kFrame * i), {0, 0, -kSinking}));
        manager.step(kFrame);
        for (std::size_t k = 0; k < stack.size(); ++k)
          ASSERT_NEAR(manager.state(stack[k]).position.z(),
                      at.z() - kSinking * kFrame * (i + 1) + 0.5 * kLift + kCrate * (double(k) + 0.5),
                      above == LevelChoice::support ? 0.001 : 0.01)
              << int(above) << ' ' << is_ground << ' ' << k << " at step " << i;
      }
    }
}

// Ground that is put elsewhere step by step, without a velocity: its riders stand on it, not a step's way
// off.
TEST(CarriedBodies, WhatIsPutOnStepByStepHasItsRidersOnIt) {
  constexpr double kGathers = 3.0;  // m/s²
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const bool callers : {false, true})
      for (const double greatest : {-3.0, 3.0}) {
        dInitODE2(0);
        dAllocateODEDataForThread(dAllocateMaskAll);
        const dWorldID world = dWorldCreate();
        const dSpaceID space = dHashSpaceCreate(nullptr);
        dWorldSetGravity(world, 0, 0, -kGravity);
        {
          Manager manager(world, space, {.signatures = coarse_signature});
          manager.materials().replace(0, {.restitution = 0.0, .friction = 0.5});
          const Vec3 sides(20, 20, 1), start(0, 0, -0.5);
          const dGeomID geom = callers ? dCreateBox(space, sides.x(), sides.y(), sides.z()) : nullptr;
          const GroundId ground =
              callers ? GroundId() : manager.add_static_box(sides, start, Quat::Identity());
          if (geom) dGeomSetPosition(geom, start.x(), start.y(), start.z());
          const BodyId rider = add(manager, crate(), testing::at({0, 0, 0.5 * kCrate}), level);
          double speed = 0.0, height = 0.0;  // m/s, m
          for (int step = 0; step < 120; ++step) {
            speed = std::clamp(greatest, speed - kGathers * kFrame, speed + kGathers * kFrame);
            height += speed * kFrame;
            if (geom)
              dGeomSetPosition(geom, start.x(), start.y(), start.z() + height);
            else
              manager.move_ground(ground, testing::at(start + Vec3(0, 0, height)));
            manager.step(kFrame);
            if (step <= 3) continue;
            EXPECT_NEAR(manager.state(rider).position.z() - height, 0.5 * kCrate, 2e-3)
                << int(level) << ' ' << callers << ' ' << greatest << ' ' << step;
          }
        }
        dSpaceDestroy(space);
        dWorldDestroy(world);
      }
}

// By Galilei as on one that stands: where it touches is where it is now.
TEST(CarriedBodies, AFullStackOnAFastKinematicBodyStaysWhereItIs) {
  constexpr double kFast = 12.0;  // m/s
  Manager manager({.signatures = no_signature});
  manager.materials().replace(0, {.restitution = 0.0, .friction = 0.5});
  const BodyId slab = manager.add_body({.shape = box_shape({20, 20, 1}),
                                        .state = testing::at({0, 0, -0.5}, {kFast, 0, 0}),
                                        .mass = 1000,
                                        .level = LevelChoice::support,
                                        .properties = {.kinematic = true}});
  std::vector<BodyId> stack;
  for (int i = 0; i < 3; ++i)
    stack.push_back(
        add(manager, crate(), testing::at({0, 0, kCrate * (i + 0.5)}, {kFast, 0, 0}), LevelChoice::full));
  run(manager, 5.0);
  for (const BodyId body : stack)
    EXPECT_NEAR(manager.state(body).position.x(), manager.state(slab).position.x(), 0.02);
}

}  // namespace
}  // namespace lodestone
