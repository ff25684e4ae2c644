// Columns of flat boxes that fall onto each other at `support`: they end as high as they are thick together.
#include <gtest/gtest.h>

#include <vector>

#include "reference/shape.h"
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

}  // namespace
}  // namespace lodestone
