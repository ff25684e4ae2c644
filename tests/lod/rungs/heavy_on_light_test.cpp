// Great weights on light bodies at `support`, beside what the full level makes of them, and at `tables`.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::heavy_on_light_test {
namespace {

using namespace testing;

struct Weighed {
  std::shared_ptr<const Shape> shape;
  double mass;  // kg
  Vec3 position;
};

std::vector<RigidState> settle(std::span<const Weighed> bodies, LevelChoice level) {
  Manager manager = on_floor();
  std::vector<BodyId> ids;
  for (const Weighed& body : bodies)
    ids.push_back(manager.add_body(
        {.shape = body.shape, .state = at(body.position), .mass = body.mass, .level = level}));
  run(manager, 3.0);
  std::vector<RigidState> ends;
  for (const BodyId id : ids) ends.push_back(manager.state(id));
  return ends;
}

// m, the farthest that a body ends from where it ends at the full level.
double farthest_from_full(std::span<const Weighed> bodies) {
  const std::vector<RigidState> full = settle(bodies, LevelChoice::full),
                                statistical = settle(bodies, LevelChoice::statistical);
  double farthest = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    farthest = std::max(farthest, (full[i].position - statistical[i].position).norm());
  return farthest;
}

TEST(HeavyOnLight, TenTonsOnAHundredKilogramsAreCarried) {
  const auto light = box_shape({0.464, 0.464, 0.464}), heavy = box_shape({2.154, 2.154, 2.154});
  const Weighed bodies[] = {{light, 100, {0.02, 0.01, 0.232}}, {heavy, 1e4, {0, 0, 0.464 + 1.077 + 0.01}}};
  EXPECT_LT(farthest_from_full(bodies), 0.01);
}

// The impact comes out of nothing: no impulses of the last step to begin with.
TEST(HeavyOnLight, TenTonsLetFallOntoAHundredKilogramsStayAboveThem) {
  const auto light = box_shape({0.464, 0.464, 0.464}), heavy = box_shape({2.154, 2.154, 2.154});
  const Weighed bodies[] = {{light, 100, {0.02, 0.01, 0.232}}, {heavy, 1e4, {0, 0, 0.464 + 1.077 + 0.5}}};
  EXPECT_LT(farthest_from_full(bodies), 0.01);
}

// Falls that differ by hardly anything end millimetres apart (the middle half of sixty-one 6 to 12 mm from
// where the full level has them), a column now and then centimetres aside; none is pressed into the ground or
// squeezed out.
TEST(HeavyOnLight, ASlabOfAHundredTonsOnColumnsOfTenKilograms) {
  constexpr int kFalls = 21;
  const auto column = box_shape({0.2, 0.2, 0.5}), slab = box_shape({4, 4, 0.4});
  std::vector<double> farthest;
  for (int fall = 0; fall < kFalls; ++fall) {
    std::vector<Weighed> bodies;
    for (const double x : {-1.5, 1.5})
      for (const double y : {-1.5, 1.5}) bodies.push_back({column, 10, {x, y, 0.25}});
    bodies.push_back({slab, 1e5, {0, 0, 0.71 + 1e-5 * fall}});
    farthest.push_back(farthest_from_full(bodies));
  }
  std::ranges::sort(farthest);
  EXPECT_LT(farthest[kFalls / 2], 0.012);
  EXPECT_LT(farthest.back(), 0.03);
}

// Three cubes and one of fifty times their mass on top, which sank through two of them.
TEST(HeavyOnLight, AColumnOfTablesBearsAHeavyTop) {
  constexpr int kCubes = 4;
  constexpr double kSide = 0.3, kMass = 10.0, kHeavy = 50.0;  // m, kg, times that
  ManagerSettings settings = unmeasured();
  settings.signatures = coarse_signature;
  settings.signature_timing = SignatureTiming::in_step;
  Manager manager = on_floor(settings);
  BodyId top;
  for (int i = 0; i < kCubes; ++i)
    top = manager.add_body({.shape = box_shape({kSide, kSide, kSide}),
                            .state = at({0, 0, kSide * (i + 0.5) + 1e-3 * i}),
                            .mass = i + 1 < kCubes ? kMass : kHeavy * kMass,
                            .level = LevelChoice::tables});
  run(manager, 4.0);
  EXPECT_NEAR(manager.state(top).position.z(), kSide * (kCubes - 0.5), 0.1 * kSide);
}

// Pushed into the floor as far as out of the boulder, it is not to be moved: both sleep all the same, the
// boulder at most where it lies on the pebble, to a hundredth of a millimetre.
TEST(HeavyOnLight, APebbleThatIsCaughtUnderABoulderSleepsAndSoDoesThat) {
  constexpr double kBoulder = 0.6, kPebble = 0.03, kCaught = 0.004;  // m
  Manager manager = on_floor();
  for (const double x : {-0.25, 0.25})
    manager.add_static_box({0.05, 0.5, kPebble - kCaught}, {x, 0.0, 0.5 * (kPebble - kCaught)},
                           Quat::Identity());
  const auto add_cube = [&](double size, double bottom) {
    return manager.add_body({.shape = box_shape({size, size, size}),
                             .state = at({0.0, 0.0, bottom + 0.5 * size}),
                             .level = LevelChoice::support});
  };
  const BodyId pebble = add_cube(kPebble, 0.0), boulder = add_cube(kBoulder, kPebble - kCaught);
  run(manager, 3.0);
  EXPECT_TRUE(manager.asleep(pebble));
  EXPECT_TRUE(manager.asleep(boulder));
  EXPECT_NEAR(manager.state(boulder).position.z(), kPebble - kCaught + 0.5 * kBoulder, kCaught + 1e-5);
}

}  // namespace
}  // namespace lodestone::heavy_on_light_test
