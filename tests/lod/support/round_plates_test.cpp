// What stands on faces of more than four corners stays there, wherever it stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/prism.h"

namespace lodestone {
namespace {

TEST(RoundPlates, HoldWhatStandsOnThem) {
  constexpr double kRadius = 2.0, kThickness = 0.2, kCrate = 0.3;  // m
  const auto crate = testing::box_shape({kCrate, kCrate, kCrate});
  for (const int sides : {5, 8, 24, 100}) {
    const auto plate = testing::make_prism(sides, kRadius, kThickness);
    Manager manager = testing::on_floor();
    RigidState lies;
    lies.position = {0.0, 0.0, 0.5 * kThickness};
    testing::add(manager, plate, lies, LevelChoice::support);
    std::vector<BodyId> crates;
    std::vector<Vec3> starts;
    RandomStream random(3, std::uint64_t(sides), 0);
    const double rim = kRadius * std::cos(std::numbers::pi / sides) - 0.75 * kCrate;
    for (int i = 0; i < 40; ++i) {
      const double angle = random.uniform(0.0, 2.0 * std::numbers::pi),
                   out = rim * std::sqrt(random.uniform(0.2, 1.0));
      RigidState state;
      state.position = {out * std::cos(angle), out * std::sin(angle), kThickness + 0.5 * kCrate + 0.005};
      state.orientation = Quat(Eigen::AngleAxisd(random.uniform(0.0, 6.0), Vec3::UnitZ()));
      const bool has_room = std::ranges::none_of(
          starts, [&](const Vec3& other) { return (other - state.position).norm() < 1.6 * kCrate; });
      if (!has_room) continue;
      starts.push_back(state.position);
      crates.push_back(testing::add(manager, crate, state, LevelChoice::support));
    }
    testing::run(manager, 3.0);
    for (std::size_t i = 0; i < crates.size(); ++i)
      EXPECT_LT((manager.state(crates[i]).position - starts[i]).norm(), 0.012) << sides << ' ' << i;
  }
}

}  // namespace
}  // namespace lodestone
