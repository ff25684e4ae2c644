// The tables model in dense arrays: the same result for every instruction set, nothing allocated, momentum
// kept, piles that stand, sleepers that cost nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/free_rotation.h"
#include "reference/hull/hull_overlap.h"
#include "reference/random.h"
#include "tests/allocations.h"
#include "tests/lod/rungs/rung_fixture.h"

namespace lodestone::tables_level_test {
namespace {

using testing::box, testing::box_signature;

constexpr double kFrame = 1.0 / 60;

class SphereLevel : public ::testing::Test {
 protected:
  SphereLevel() { ground_.add_plane({}); }
  testing::OneRung make(Simd simd = find_simd()) const {
    StatisticalSettings settings = settings_;
    settings.simd = simd;
    return {StatisticalModel::tables, settings, ground_, materials_};
  }
  static int add(testing::OneRung& level, const RigidState& state, bool asleep = false) {
    return level.add(std::uint32_t(level.size()), box(), 24.0, 0, state, asleep, box_signature());
  }
  // A heap that falls: `side` × `side` columns. `heap`: which of those that begin otherwise.
  static void add_heap(testing::OneRung& level, int side, int layers, std::uint32_t heap = 0) {
    for (int i = 0; i < side * side * layers; ++i) {
      RandomStream random(5, std::uint64_t(i), heap);
      RigidState s;
      s.position = {0.5 * (i % side), 0.5 * (i / side % side), 0.5 + 0.6 * (i / (side * side))};
      s.orientation = random.orientation();
      s.angular_velocity = random.uniform(0.0, 5.0) * random.direction();
      add(level, s);
    }
  }
  static StepReport run(testing::OneRung& level, int steps) {
    StepReport report;
    for (int i = 0; i < steps; ++i) {
      report = {};
      level.step(kFrame, {}, report, {});
    }
    return report;
  }
  static void expect_same(const testing::OneRung& a, const testing::OneRung& b) {
    for (int slot = 0; slot < a.size(); ++slot) {
      const RigidState s = a.state(slot), t = b.state(slot);
      ASSERT_EQ(s.position, t.position) << slot;
      ASSERT_EQ(s.orientation.coeffs(), t.orientation.coeffs()) << slot;
      ASSERT_EQ(s.velocity, t.velocity) << slot;
      ASSERT_EQ(s.angular_velocity, t.angular_velocity) << slot;
    }
  }

  StatisticalSettings settings_;
  Ground ground_;
  MaterialTable materials_;
};

TEST_F(SphereLevel, EveryInstructionSetGivesTheSameBits) {
  for (const bool as_paper : {true, false}) {
    settings_.tables.published = as_paper;
    testing::OneRung portable = make(Simd::portable);
    add_heap(portable, 9, 5);
    run(portable, 150);
    for (const Simd simd : {Simd::avx2, Simd::avx512}) {
      if (simd > find_simd()) continue;  // this processor lacks it
      testing::OneRung wide = make(simd);
      add_heap(wide, 9, 5);
      run(wide, 150);
      expect_same(portable, wide);
    }
  }
}

TEST_F(SphereLevel, AnyNumberOfThreadsGivesTheSameBits) {
  for (const bool as_paper : {true, false}) {
    settings_.tables.published = as_paper;
    settings_.threads = 1;
    testing::OneRung one = make();
    add_heap(one, 40, 3);
    run(one, 90);
    settings_.threads = 3;
    testing::OneRung three = make();
    add_heap(three, 40, 3);
    run(three, 90);
    expect_same(one, three);
  }
}

TEST_F(SphereLevel, AWarmStepAllocatesNothing) {
  for (const bool as_paper : {true, false}) {
    settings_.tables.published = as_paper;
    settings_.sleeping = false;
    testing::OneRung level = make();
    add_heap(level, 12, 4);
    run(level, 400);
    // A heap that is kept awake falls into itself, to ever more contacts: with fewer bodies it has fewer.
    for (int i = 0; i < 60; ++i) level.remove(level.size() - 1);
    run(level, 1);
    const std::int64_t before = allocations();
    run(level, 50);
    EXPECT_EQ(allocations() - before, 0);
  }
}

// Of the level alone, with about a contact a body. Four bytes of the 264 are the energy that a flight began
// with.
TEST_F(SphereLevel, HoldsLittleForABody) {
  for (const bool as_paper : {true, false}) {
    settings_.tables.published = as_paper;
    settings_.sleeping = false;
    const std::int64_t before = bytes_held();
    testing::OneRung level = make();
    add_heap(level, 64, 2);
    run(level, 90);
    const auto contacts = double(run(level, 1).contacts);
    const double per_body = double(bytes_held() - before) / level.size();
    std::printf("%.0f bytes a body, %.2f contacts\n", per_body, contacts / level.size());
    EXPECT_GT(per_body, 200.0);
    EXPECT_LT(per_body, 264.0 + 120.0 * contacts / level.size());
  }
}

TEST_F(SphereLevel, ContactsKeepMomentum) {
  ground_ = Ground();
  settings_.gravity.setZero();
  testing::OneRung level = make();
  Vec3 before = Vec3::Zero();
  for (int i = 0; i < 300; ++i) {
    RandomStream random(6, std::uint64_t(i), 0);
    RigidState s;
    s.position = 2.2 * Vec3(random.uniform(), random.uniform(), random.uniform());
    s.velocity = 3.0 * random.direction();
    s.orientation = random.orientation();
    before += s.velocity;
    add(level, s);
  }
  std::int64_t contacts = 0;
  double energy = 1e30;
  for (int step = 0; step < 60; ++step) {
    contacts += run(level, 1).contacts;
    Vec3 now = Vec3::Zero();
    double kinetic = 0.0;
    for (int slot = 0; slot < level.size(); ++slot) {
      const RigidState s = level.state(slot);
      now += s.velocity;
      kinetic += 0.5 * (s.velocity.squaredNorm() +
                        s.angular_velocity.dot(spin_of(s.orientation, s.angular_velocity, *box())));
    }
    ASSERT_LT((now - before).norm(), 3e-4) << step;
    ASSERT_LE(kinetic, energy * 1.0001) << step;
    energy = kinetic;
  }
  EXPECT_GT(contacts, 500);
}

// The deepest of 96 boxes, over R, is .009 to .064 in another in two dozen heaps, as published .005 to .014.
TEST_F(SphereLevel, HeapsComeToRestWithoutSinkingIntoThemselves) {
  for (const bool as_paper : {true, false}) {
    settings_.tables.published = as_paper;
    constexpr int kHeaps = 6;
    double mean = 0.0;
    for (int heap = 0; heap < kHeaps; ++heap) {
      settings_.seed = std::uint64_t(heap);
      testing::OneRung level = make();
      add_heap(level, 4, 6, std::uint32_t(heap));
      run(level, 600);
      double worst = 0.0;
      for (int a = 0; a < level.size(); ++a) {
        EXPECT_GT(level.position(a).z(), 0.05);
        for (int b = 0; b < a; ++b)
          worst = std::max(worst, as_paper
                                      ? level.sphere_radius(a) + level.sphere_radius(b) -
                                            (level.position(a) - level.position(b)).norm()
                                      : measure_hull_overlap(*box(), level.state(a), *box(), level.state(b)));
      }
      mean += worst / box()->radius / kHeaps;
      EXPECT_LT(worst, 0.15 * box()->radius) << heap;
      EXPECT_GT(level.asleep_count(), level.size() * 9 / 10);
    }
    EXPECT_LT(mean, 0.06);
  }
}

// Of twelve bins of 96 boxes 1,077 are asleep after two and a half seconds (with clang 1,057); less than half
// where spheres roll on without resistance, are answered in three rounds, and are pressed into walls by the
// last.
TEST_F(SphereLevel, ABinComesToRestInItsTime) {
  for (const Vec3& inward :
       {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(-Vec3::UnitY())})
    ground_.add_plane({inward, inward.sum() > 0.0 ? -0.3 : -1.8});
  int asleep = 0;
  for (int heap = 0; heap < 12; ++heap) {
    testing::OneRung level = make();
    add_heap(level, 4, 6, std::uint32_t(heap));
    run(level, 150);
    asleep += int(level.asleep_count());
  }
  EXPECT_GT(asleep, 980);
}

// Of 96 boxes in eight narrow bins between boxes of the ground all are asleep after five seconds.
TEST_F(SphereLevel, WhatWallsHoldSeveralWaysComesToRest) {
  constexpr double kWide = 0.8, kThick = 0.2, kHigh = 3.0, kApart = 3.0;  // m
  testing::OneRung level = make();
  for (int bin = 0; bin < 8; ++bin) {
    const Vec3 middle(kApart * bin, 0, 0.5 * kHigh);
    for (const Vec3& out : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
      const Vec3 across = out.cwiseAbs();
      ground_.add_box(kThick * across + (kWide + 2.0 * kThick) * (Vec3(1, 1, 0) - across) + Vec3(0, 0, kHigh),
                      middle + 0.5 * (kWide + kThick) * out, Quat::Identity(), 0);
    }
    for (int i = 0; i < 12; ++i) {
      RandomStream random(7, std::uint64_t(12 * bin + i), 0);
      RigidState s;
      s.position =
          middle + Vec3(i % 2 == 0 ? 0.18 : -0.18, i / 2 % 2 == 0 ? 0.18 : -0.18, 0.6 * (i / 4) - 1.0);
      s.orientation = random.orientation();
      add(level, s);
    }
  }
  run(level, 300);
  for (int slot = 0; slot < level.size(); ++slot) {
    const Vec3 position = level.position(slot);
    EXPECT_LT(std::abs(position.x() - kApart * std::round(position.x() / kApart)), 0.5 * kWide) << slot;
    EXPECT_LT(std::abs(position.y()), 0.5 * kWide) << slot;
  }
  EXPECT_GT(level.asleep_count(), 90);
}

// On hills with valleys of half a box's reach all of 128 boxes; 79 where each turned into the rest pose of
// whatever triangle it was nearest to, and what several of them hold was moved as one sphere among hulls.
TEST_F(SphereLevel, RoughGroundLetsThemRest) {
  constexpr int kCells = 24;
  constexpr double kSide = 8.0, kTwoPi = 6.283185307179586;  // m
  Mesh hills;
  for (int y = 0; y <= kCells; ++y)
    for (int x = 0; x <= kCells; ++x) {
      const Vec3 at(kSide * x / kCells - 2.0, kSide * y / kCells - 2.0, 0.0);
      hills.vertices.push_back(
          at + Vec3(0, 0, 0.3 + 0.25 * std::sin(kTwoPi * at.x() / 1.6) * std::sin(kTwoPi * at.y() / 1.4)));
    }
  for (int y = 0; y < kCells; ++y)
    for (int x = 0; x < kCells; ++x) {
      const int a = y * (kCells + 1) + x, b = a + 1, c = a + kCells + 1, d = c + 1;
      hills.faces.push_back({a, b, d}), hills.faces.push_back({a, d, c});
    }
  ground_.add_mesh(hills, 0);
  testing::OneRung level = make();
  add_heap(level, 8, 2);
  run(level, 480);
  EXPECT_GT(level.asleep_count(), 120);
}

// Who lies beside another from the start is as high as it lies, not as its sphere is.
TEST_F(SphereLevel, TheHeightOfItsHullIsABodysFirst) {
  const auto plank = std::make_shared<const Shape>(make_shape("plank", make_box({2.0, 0.3, 0.05})));
  testing::OneRung level = make();
  const auto add_plank = [&](double y) {
    return level.add(std::uint32_t(level.size()), plank, 15.0, 0, {.position = {0.0, y, 0.025}}, false,
                     box_signature());
  };
  add_plank(0.0), add_plank(0.301);
  const int moved = add_plank(5.0);
  level.set_state(moved, {.position = {0.0, 0.602, 0.025}});
  for (int step = 0; step < 60; ++step) {
    run(level, 1);
    for (int slot = 0; slot < level.size(); ++slot)
      ASSERT_NEAR(level.position(slot).z(), 0.025, 1e-3) << step;
  }
}

// Its centre is over neither block, and nearest to their edges.
TEST_F(SphereLevel, ABarOnTwoBlocksStaysThereWhenACrateFallsOntoIt) {
  const auto bar = std::make_shared<const Shape>(make_shape("bar", make_box({3.0, 0.2, 0.1})));
  const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.3, 0.3, 0.3})));
  for (const double x : {-1.3, 1.3}) ground_.add_box({0.6, 0.6, 1.0}, {x, 0.0, 0.5}, Quat::Identity(), 0);
  testing::OneRung level = make();
  level.add(0, bar, 36.0, 0, {.position = {0.0, 0.0, 1.05}}, false, box_signature());
  level.add(1, crate, 16.0, 0, {.position = {0.0, 0.0, 1.7}}, false, box_signature());
  for (int step = 0; step < 180; ++step) {
    run(level, 1);
    ASSERT_LT((level.position(0) - Vec3(0.0, 0.0, 1.05)).norm(), 0.02) << step;
  }
  EXPECT_NEAR(level.position(1).z(), 1.25, 0.02);
}

// Along the line of centres alone they fall over. They sag, by .1, .6 and 1.6 %.
TEST_F(SphereLevel, TowersStand) {
  const auto cube = std::make_shared<const Shape>(make_shape("cube", make_box({0.2, 0.2, 0.2})));
  for (const int cubes : {3, 5, 10}) {
    testing::OneRung level = make();
    for (int i = 0; i < cubes; ++i) {
      RigidState s;
      s.position = {0.0, 0.0, 0.1 + 0.2 * i};
      level.add(std::uint32_t(i), cube, 8.0, 0, s, false, box_signature());
    }
    run(level, 600);
    const double top = 0.1 + 0.2 * (cubes - 1);
    EXPECT_NEAR(level.position(cubes - 1).z(), top, 0.08 * top) << cubes;
    EXPECT_EQ(level.asleep_count(), cubes);
  }
}

// Who falls close behind one that is stopped is stopped in the same frame, though neither gained on the
// other before: of three cubes that fall at 7 m/s onto one that lies there, the last does not sink into the
// one below (.004 of a side; where only those that gain are contacts, .42).
TEST_F(SphereLevel, WhoFollowsIsHeldInTheSameFrame) {
  const auto cube = std::make_shared<const Shape>(make_shape("cube", make_box({0.2, 0.2, 0.2})));
  testing::OneRung level = make();
  const auto add_cube = [&](double height, double speed) {
    level.add(std::uint32_t(level.size()), cube, 8.0, 0,
              {.position = {0.0, 0.0, height}, .velocity = {0.0, 0.0, -speed}}, false, box_signature());
  };
  add_cube(0.1, 0.0);
  for (int i = 0; i < 3; ++i) add_cube(0.42 + 0.21 * i, 7.0);
  double deepest = 0.0;
  for (int step = 0; step < 30; ++step) {
    run(level, 1);
    deepest = std::max(deepest, measure_hull_overlap(*cube, level.state(3), *cube, level.state(2)));
  }
  std::printf("deepest %.4f of a side\n", deepest / 0.2);
  EXPECT_LT(deepest, 0.1 * 0.2);
}

// Bodies of different sizes lie in different grids: what their contacts gave is remembered, too. Of five
// falls, each from a little higher: one in five or ten presses a corner into a small one by .01 to .03 R.
TEST_F(SphereLevel, AGreatBodyRestsOnSmallOnes) {
  settings_.sleeping = false;
  constexpr int kFalls = 15;
  std::vector<double> deepest;  // over R of a small one
  for (int fall = 0; fall < kFalls; ++fall) {
    testing::OneRung level = make();
    constexpr int kSide = 12;
    for (int i = 0; i < kSide * kSide; ++i) {
      RigidState s;
      s.position = {0.42 * (i % kSide), 0.42 * (i / kSide), 0.25};
      add(level, s);
    }
    const auto great = std::make_shared<const Shape>(make_shape("great", make_box({2.0, 3.0, 4.0})));
    RigidState above;
    above.position = {0.21 * (kSide - 1), 0.21 * (kSide - 1), 3.2 + 0.01 * fall};
    const int slot = level.add(std::uint32_t(level.size()), great, 2400.0, 0, above, false, box_signature());
    double worst = 0.0;
    for (int step = 0; step < 300; ++step) {
      run(level, 1);
      if (step < 100) continue;
      for (int a = 0; a < slot; ++a)
        worst = std::max(worst, measure_hull_overlap(*box(), level.state(a), *great, level.state(slot)));
    }
    deepest.push_back(worst / box()->radius);
  }
  std::ranges::sort(deepest);
  std::printf("deepest %.4f to %.4f R, median %.4f\n", deepest.front(), deepest.back(), deepest[kFalls / 2]);
  EXPECT_GT(deepest.back(), 0.0);  // it lies on them
  EXPECT_LT(deepest[kFalls / 2], 0.005);
  EXPECT_LT(deepest.back(), 0.05);
}

// About its long axis a needle turns hundreds of times as easily as across it: a rule that is only of second
// order gains energy.
TEST_F(SphereLevel, ANeedleInFlightKeepsItsEnergy) {
  settings_.gravity.setZero();
  testing::OneRung level = make();
  const auto needle = std::make_shared<const Shape>(make_shape("needle", make_needle(0.4, 0.01)));
  level.add(0, needle, 0.1, 0,
            {.position = Vec3(0, 0, 5),  // clear of the ground
             .orientation = Quat(0.5, 0.5, -0.5, 0.5),
             .angular_velocity = Vec3(200.0, 30.0, -20.0)},
            false, box_signature());
  const auto energy = [&] {
    const RigidState s = level.state(0);
    return s.angular_velocity.dot(spin_of(s.orientation, s.angular_velocity, *needle));
  };
  const double before = energy();
  for (int i = 0; i < 20; ++i) {
    run(level, 30);
    ASSERT_NEAR(energy() / before, 1.0, 0.01) << i;
  }
}

TEST_F(SphereLevel, OnlyWhatIsTouchedWakes) {
  testing::OneRung level = make();
  for (int i = 0; i < 400; ++i) {
    RigidState s;
    s.position = {0.8 * (i % 20), 0.8 * (i / 20), 0.15};
    add(level, s, true);
  }
  run(level, 5);
  EXPECT_EQ(level.asleep_count(), 400);
  RigidState falling;
  falling.position = {8.0, 8.0, 1.0};
  add(level, falling);
  std::vector<bool> woken(400);
  for (int step = 0; step < 240; ++step) {
    run(level, 1);
    for (int slot = 0; slot < 400; ++slot)
      if (!level.asleep(slot)) woken[std::size_t(slot)] = true;
  }
  const auto count = std::ranges::count(woken, true);
  EXPECT_GT(count, 0);
  EXPECT_LT(count, 40);
  EXPECT_GT(level.asleep_count(), 395);
}

TEST_F(SphereLevel, WhatRestedOnARemovedBodyWakesAndSlotsStayDense) {
  testing::OneRung level = make();
  for (int i = 0; i < 3; ++i) {
    RigidState s;
    s.position = {i == 2 ? 5.0 : 0.0, 0.0, 0.2 + (i == 1 ? 0.36 : 0.0)};
    add(level, s, true);
  }
  const auto moved = level.remove(0);
  ASSERT_TRUE(moved);
  EXPECT_EQ(*moved, 2u);
  EXPECT_TRUE(level.asleep(0));
  EXPECT_EQ(level.position(0).x(), 5.0);
  EXPECT_FALSE(level.asleep(1));
  EXPECT_FALSE(level.remove(1));
  EXPECT_EQ(level.size(), 1);
  level.wake(0);
  EXPECT_EQ(level.asleep_count(), 0);
}

TEST_F(SphereLevel, AStateThatWasSetIsReadBackToTheBit) {
  testing::OneRung level = make();
  RandomStream random(1, 2, 3);
  RigidState s;
  s.position = {1.0 / 3, 1e4 / 7, 2.0 / 3};
  s.orientation = random.orientation();
  s.velocity = {0.1, 0.2, 0.3};
  s.angular_velocity = {1.0 / 3, 1, 2};
  const int slot = add(level, s);
  const RigidState t = level.state(slot);
  EXPECT_EQ(s.position, t.position);
  EXPECT_EQ(s.orientation.coeffs(), t.orientation.coeffs());
  EXPECT_EQ(s.velocity, t.velocity);
  EXPECT_EQ(s.angular_velocity, t.angular_velocity);
}

// Positions are exact to .1 mm ten kilometres out: a fall there is the fall here.
TEST_F(SphereLevel, FarFromTheOriginBodiesFallAsHere) {
  testing::OneRung level = make();
  RigidState s;
  s.position = {0, 0, 3.0};
  const int here = add(level, s);
  s.position += Vec3(1e4, -1e4, 0);
  const int there = add(level, s);
  run(level, 30);
  EXPECT_LT((level.position(there) - level.position(here) - Vec3(1e4, -1e4, 0)).norm(), 1e-9);
  EXPECT_NEAR(level.position(here).z(), 3.0 - 0.5 * 9.81 * 0.25, 1e-4);
}

}  // namespace
}  // namespace lodestone::tables_level_test
