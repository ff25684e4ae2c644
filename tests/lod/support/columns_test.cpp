// Columns of boxes that fall: at `support` they end as high as they are thick together, and on neither
// statistical rung do they sink into themselves where the lowest strikes the ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "reference/shape.h"
#include "tests/hills.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

struct Column {
  Manager manager{testing::unmeasured()};
  std::vector<BodyId> bodies;
  double thickness = 0.0;  // m

  // Plates `apart` m over each other, each a hair aside.
  Column(double width, double thickness_m, int count, double apart) : thickness(thickness_m) {
    manager.add_plane(Vec3::UnitZ(), 0.0);
    const auto plate =
        std::make_shared<const Shape>(make_shape("plate", make_box({width, width, thickness})));
    for (int i = 0; i < count; ++i) {
      BodyDefinition definition{.shape = plate, .level = LevelChoice::support};
      definition.state.position = {3e-4 * i, 0.0, (i + 0.5) * thickness + (i + 1) * apart};
      bodies.push_back(manager.add_body(definition));
    }
  }
  // Over that of the plates laid on each other.
  double height() const {
    return (manager.state(bodies.back()).position.z() + 0.5 * thickness) /
           (thickness * double(bodies.size()));
  }
};

TEST(Columns, OfPlatesThatLandAreAsHighAsThesePlates) {
  struct Case {
    double width, thickness, least_height;
  };
  for (const Case& c : {Case{0.6, 0.2, 0.98}, {0.6, 0.1, 0.97}, {0.6, 0.05, 0.95}, {0.3, 0.05, 0.97}}) {
    Column column(c.width, c.thickness, 12, 0.1);
    testing::run(column.manager, 4.0);
    EXPECT_GT(column.height(), c.least_height) << c.width << " × " << c.thickness;
    EXPECT_LT(column.height(), 1.001);
    EXPECT_EQ(column.manager.report().asleep, 12);
  }
}

// In its midst plates are pushed from both sides: what they overlap by goes up through it.
TEST(Columns, TallOnesOfThinPlatesDoNotStaySunkIn) {
  Column column(0.6, 0.05, 20, 0.1);
  testing::run(column.manager, 4.0);
  EXPECT_GT(column.height(), 0.92);
}

// Cubes close behind each other, one speed for all: on a box, on triangles and on a lift that rises as on a
// plane, who follows meets the one that was stopped.
TEST(Columns, ThatStrikeAnyGroundDoNotSinkIntoThemselves) {
  constexpr double kCube = 0.3, kBetween = 0.02, kFalling = 10.0, kRising = 1.0;  // m, m/s
  const auto cube = testing::box_shape({kCube, kCube, kCube});
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const std::string ground : {"plane", "box", "mesh", "lift"})
      for (int phase = 0; phase < 4; ++phase) {
        Manager manager({.signatures = testing::coarse_signature});
        const RigidState below{.position = {0, 0, -0.5}};
        if (ground == "plane") manager.add_plane(Vec3::UnitZ(), 0.0);
        if (ground == "mesh" && level == LevelChoice::tables)
          continue;  // at its edges it is a guest of hulls
        if (ground == "mesh") manager.add_static_mesh(testing::make_hills(20, 20));
        GroundId box;
        if (ground == "box" || ground == "lift")
          box = manager.add_static_box({4, 4, 1}, below.position, below.orientation);
        std::vector<BodyId> column;
        for (int i = 0; i < 5; ++i)
          column.push_back(manager.add_body(
              {.shape = cube,
               .state = {.position = {0.003 * i, 0, 0.65 + 0.04 * phase + i * (kCube + kBetween)},
                         .velocity = {0, 0, -kFalling}},
               .level = level}));
        double deepest = 0.0;  // m
        for (int step = 1; step <= 15; ++step) {
          if (ground == "lift")
            manager.move_ground(box,
                                {.position = below.position + Vec3(0, 0, kRising * step * testing::kFrame),
                                 .velocity = {0, 0, kRising}});
          manager.step(testing::kFrame);
          for (std::size_t i = 1; i < column.size(); ++i)
            deepest = std::max(deepest, kCube - manager.state(column[i]).position.z() +
                                            manager.state(column[i - 1]).position.z());
        }
        const double bound = ground == "mesh" || level == LevelChoice::tables ? 0.06 : 0.02;
        EXPECT_LT(deepest, bound) << ground << ' ' << phase << ' ' << int(level);
      }
}

// What strikes the ground among others does so on its hull: flat, it is not set spinning.
TEST(Columns, ThatLandFlatStayUpright) {
  constexpr double kCube = 0.3, kTilted = 0.03;  // m, 1 - cosine of 14°
  const auto cube = testing::box_shape({kCube, kCube, kCube});
  for (const double falling : {2.0, 4.0, 8.0})
    for (const bool rises : {false, true}) {
      Manager manager({.signatures = testing::coarse_signature});
      const RigidState below{.position = {0, 0, -0.5}};
      const GroundId box = manager.add_static_box({4, 4, 1}, below.position, below.orientation);
      std::vector<BodyId> column;
      for (int i = 0; i < 3; ++i)
        column.push_back(
            manager.add_body({.shape = cube,
                              .state = {.position = {0, 0, 0.8 + i * kCube}, .velocity = {0, 0, -falling}},
                              .level = LevelChoice::tables}));
      double tilt = 0.0;
      for (int step = 1; step <= 60; ++step) {
        if (rises)
          manager.move_ground(
              box, {.position = below.position + Vec3(0, 0, step * testing::kFrame), .velocity = {0, 0, 1}});
        manager.step(testing::kFrame);
        for (const BodyId body : column)
          tilt = std::max(tilt, 1.0 - (manager.state(body).orientation * Vec3::UnitZ()).z());
      }
      EXPECT_LT(tilt, kTilted) << falling << ' ' << rises;
    }
}

}  // namespace
}  // namespace lodestone
