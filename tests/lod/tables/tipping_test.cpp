// What is no ball tips over among others of `tables`, and by that gains no energy.
#include "lod/tables/tipping.h"

#include <gtest/gtest.h>

#include <vector>

#include "lod/tables/hull_heights.h"
#include "reference/random.h"
#include "reference/shape.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/lod/tables/hull_maps.h"

namespace lodestone::tipping_test {
namespace {

using testing::box_shape, testing::Maps;

// Things of one shape that fall into a bin of 1 m, turned anyhow.
struct Bin {
  Manager manager;
  std::vector<BodyId> bodies;

  Bin(const std::shared_ptr<const Shape>& shape, int count, LevelChoice level, std::uint64_t seed)
      : manager({.signatures = testing::coarse_signature}) {
    manager.add_plane(Vec3::UnitZ(), 0.0);
    for (const Vec3& inward :
         {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(-Vec3::UnitY())})
      manager.add_plane(inward, -0.5);
    for (int i = 0; i < count; ++i) {
      RandomStream random(seed, std::uint64_t(i), 0);
      RigidState state;
      state.position = {0.0, 0.0, 0.5 + 0.4 * i};
      state.orientation = random.orientation();
      bodies.push_back(testing::add(manager, shape, state, level));
    }
  }
  double mean_height() const {  // m
    double sum = 0.0;
    for (const BodyId body : bodies) sum += manager.state(body).position.z();
    return sum / double(bodies.size());
  }
  double energy() const {  // J
    double sum = 0.0;
    for (const BodyId body : bodies) sum += testing::energy(manager, body);
    return sum;
  }
};

// Without a torque they stay as they fell: at 1.8 to 2.7 times the height.
TEST(Tipping, HeapsOfWhatIsLongOrFlatAreAboutAsHighAsThoseOfHulls) {
  for (const Vec3& sides : {Vec3(0.8, 0.08, 0.08), Vec3(0.5, 0.3, 0.04)}) {
    const auto shape = box_shape(sides);
    const auto height = [&](LevelChoice level, int heaps) {  // m, mean
      double sum = 0.0;
      for (int seed = 1; seed <= heaps; ++seed) {
        Bin bin(shape, 30, level, std::uint64_t(seed));
        testing::run(bin.manager, 14.0);
        sum += bin.mean_height();
      }
      return sum / heaps;
    };
    const double tables = height(LevelChoice::tables, 12),  // from heap to heap they differ by a tenth
        support = height(LevelChoice::support, 3);
    EXPECT_LT(tables, 1.4 * support) << sides.transpose();
    EXPECT_GT(tables, 0.7 * support) << sides.transpose();
  }
}

// Asleep it had no fall to tip by: it sank a little on the one post that was left, and hung there.
TEST(Tipping, APlankFallsWhoseOtherPostIsTakenAway) {
  const auto post = box_shape({0.2, 0.2, 0.8});
  for (const Vec3& sides : {Vec3(1.6, 0.3, 0.1), Vec3(2.0, 0.2, 0.05)}) {
    const bool is_removed = sides.x() > 1.8;  // or put elsewhere
    Manager manager({.signatures = testing::coarse_signature});
    manager.add_plane(Vec3::UnitZ(), 0.0);
    const double from_middle = 0.375 * sides.x();
    testing::add(manager, post, testing::at({-from_middle, 0, 0.4}), LevelChoice::tables);
    const BodyId other = testing::add(manager, post, testing::at({from_middle, 0, 0.4}), LevelChoice::tables);
    const BodyId plank = testing::add(manager, box_shape(sides), testing::at({0, 0, 0.8 + 0.5 * sides.z()}),
                                      LevelChoice::tables);
    testing::run(manager, 2.0);
    ASSERT_TRUE(manager.asleep(plank));
    ASSERT_NEAR(manager.state(plank).position.z(), 0.8 + 0.5 * sides.z(), 0.03);
    if (is_removed)
      manager.remove_body(other);
    else
      manager.set_state(other, testing::at({9, 0, 0.4}));
    testing::run(manager, 5.0);
    EXPECT_LT(manager.state(plank).position.z(), 0.6) << sides.transpose();
  }
}

// It takes potential energy away, which spheres among others may gain a little of as they part. From bin to
// bin that differs tenfold.
TEST(Tipping, AddsNoEnergy) {
  constexpr int kBins = 12;
  for (const auto& [sides, bound] : {std::pair{Vec3(0.5, 0.3, 0.04), 7e-4}, {Vec3(0.2, 0.3, 0.4), 5e-4}}) {
    double mean_rise = 0.0;  // over the whole energy
    for (std::uint64_t seed = 1; seed <= kBins; ++seed) {
      Bin bin(box_shape(sides), 30, LevelChoice::tables, seed);
      const double whole = bin.energy();
      double least = whole, rise = 0.0;
      for (int i = 0; i < 600; ++i) {
        bin.manager.step(testing::kFrame);
        const double now = bin.energy();
        least = std::min(least, now), rise = std::max(rise, now - least);
      }
      mean_rise += rise / whole / kBins;
    }
    EXPECT_LT(mean_rise, bound) << sides.transpose();
  }
}

// Without gravity nothing falls, and nothing pays for a turn: who meets others there goes on as spheres do.
TEST(Tipping, LeavesMomentumAsItIsWithoutGravity) {
  Manager manager({.gravity = Vec3::Zero(), .sleeping = false, .signatures = testing::coarse_signature});
  const auto beam = box_shape({0.8, 0.08, 0.08});
  std::vector<BodyId> bodies;
  for (int i = 0; i < 12; ++i) {
    RandomStream random(7, std::uint64_t(i), 0);
    RigidState state;
    state.position = 1.5 * random.direction();
    state.velocity = -2.0 * state.position;
    state.orientation = random.orientation();
    bodies.push_back(testing::add(manager, beam, state, LevelChoice::tables));
  }
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (const BodyId body : bodies) sum += manager.mass(body) * manager.state(body).velocity;
    return sum;
  };
  const Vec3 before = momentum();
  testing::run(manager, 2.0);
  EXPECT_LT((momentum() - before).norm(), 1e-5 * 3.0 * manager.mass(bodies[0]) * 12);
  EXPECT_EQ(manager.report().counters.states_recovered, 0);
}

TEST(Tipping, IsForWhatIsNoBallAndSlowForWhatIsCompact) {
  const auto tips = [](const std::shared_ptr<const Shape>& shape) {
    Kinds kinds;
    SphereKinds dense;
    const std::uint32_t k =
        kinds.take(StatisticalModel::tables, shape, 0, std::make_shared<const Signature>());
    dense.take(kinds, k, testing::kGravity);
    return dense.tips[k];
  };
  EXPECT_EQ(tips(std::make_shared<const Shape>(make_sphere_shape(0.2))), 0.0f);
  EXPECT_EQ(tips(std::make_shared<const Shape>(make_shape("pebble", make_sphere(0.2, 2)))), 0.0f);
  for (const Vec3& sides : {Vec3(1, 1, 1), Vec3(0.2, 0.3, 0.4)}) {
    EXPECT_GT(tips(box_shape(sides)), 0.0f);
    EXPECT_LT(tips(box_shape(sides)), 0.5f);
  }
  EXPECT_EQ(tips(box_shape({0.8, 0.08, 0.08})), 1.0f);
  EXPECT_EQ(tips(box_shape({0.5, 0.3, 0.04})), 1.0f);
}

// What presses is not at the middle of the two faces, but under the centre of mass.
TEST(Tipping, WhatIsBorneByAFaceStands) {
  const auto cube = box_shape({0.3, 0.3, 0.3});
  Manager manager = testing::on_floor({.sleeping = false, .signatures = testing::coarse_signature});
  testing::add(manager, cube, testing::at({0, 0, 0.15}), LevelChoice::tables);
  const BodyId upper = testing::add(manager, cube, testing::at({0.12, 0, 0.4501}), LevelChoice::tables);
  testing::run(manager, 4.0);
  const RigidState now = manager.state(upper);
  EXPECT_GT(now.position.z(), 0.44);
  EXPECT_GT((now.orientation * Vec3::UnitZ()).z(), std::cos(0.02));
}

// Over a face its corners, at a corner that one alone.
TEST(Tipping, PatchesAreFacesEdgesAndCorners) {
  const Maps maps(*box_shape({0.4, 0.6, 1.0}));
  const auto patch_at = [&](const Vec3& n) {
    return read_patch(maps.patches.data(), lane::place_in_map({float(n.x()), float(n.y()), float(n.z())}));
  };
  const SupportPatch face = patch_at(Vec3::UnitZ());
  EXPECT_NEAR(face.mean.x, 0.0, 0.05);
  EXPECT_NEAR(face.mean.y, 0.0, 0.07);
  EXPECT_NEAR(face.mean.z, 0.5, 1e-6);
  EXPECT_NEAR(face.zz, 0.0, 1e-6);
  EXPECT_NEAR(face.xx, 0.04, 1e-3);  // corners alone: ± half a side
  EXPECT_NEAR(face.yy, 0.09, 2e-3);
  EXPECT_NEAR(face.xy, 0.0, 1e-3);
  const SupportPatch corner = patch_at(Vec3(1, 1, 1).normalized());
  EXPECT_NEAR(corner.mean.x, 0.2, 1e-6);
  EXPECT_NEAR(corner.mean.y, 0.3, 1e-6);
  EXPECT_NEAR(corner.mean.z, 0.5, 1e-6);
  EXPECT_NEAR(corner.xx + corner.yy + corner.zz, 0.0, 1e-7);
}

// A kind takes the place of one that nobody has any more.
TEST(Tipping, PatchesOfABallArePointsWhateverWasThereBefore) {
  Maps maps(*box_shape({0.4, 0.6, 1.0}));
  sample_hull(make_sphere_shape(0.3), {maps.heights, maps.pair_heights, maps.patches, maps.faces});
  for (const SupportPatch& patch : maps.patches) {
    EXPECT_FLOAT_EQ(length(patch.mean), 0.3f);
    EXPECT_EQ(patch.xx + patch.yy + patch.zz, 0.0f);
  }
}

}  // namespace
}  // namespace lodestone::tipping_test
