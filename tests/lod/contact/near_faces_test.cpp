#include "lod/contact/near_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace lodestone::near_faces_test {
namespace {

constexpr double kRadius = 0.2;  // m, of the body

Quat about_y(double degrees) {
  return Quat(Eigen::AngleAxisd(degrees * 3.14159265358979 / 180.0, Vec3::UnitY()));
}

/// A box of the ground whose face along -x, at x = 0, is looked at: 1 m long and wide, .4 high, its top at z
/// = 0.
class NearFacesTest : public ::testing::Test {
 protected:
  NearFacesTest() { ground_.add_box({1, 1, 0.4}, {0.5, 0, -0.2}, Quat::Identity(), 0); }
  void add_box(const Vec3& sides, const Vec3& position, const Quat& turn = Quat::Identity()) {
    ground_.add_box(sides, position, turn, 0);
  }
  void take(const Vec3& body) {
    std::vector<const GroundPart*> parts;
    ground_.find_parts(body, 2.0, parts);
    near_.clear();
    for (const GroundPart* part : parts) find_solids(*part, body, 2.0, 0.0, near_);
    faces_.take(near_, body, kRadius);
  }
  const PlacedSolid& tile() const {
    const auto is_it = [](const PlacedSolid& s) { return s.position.isApprox(Vec3(0.5, 0, -0.2)); };
    return *std::ranges::find_if(near_, is_it);
  }
  bool is_side_covered(double z) { return faces_.is_covered(tile(), {-Vec3::UnitX(), 0.0}, {0, 0, z}); }

  Ground ground_;
  std::vector<PlacedSolid> near_;
  NearFaces faces_;
};

TEST_F(NearFacesTest, OneAloneIsSeen) {
  take({-0.3, 0, 0.2});
  EXPECT_FALSE(is_side_covered(-0.01));
  EXPECT_EQ(faces_.find_uncovered(tile(), Vec3::Zero(), Vec3(-0.6, 0, 0.8)), Vec3(-0.6, 0, 0.8));
}

// Whose top comes down to the tile's edge.
TEST_F(NearFacesTest, ARampCoversTheSideOfTheTileAtItsFoot) {
  for (const double degrees : {5.0, 20.0, 45.0}) {
    SCOPED_TRACE(degrees);
    Ground fresh;
    std::swap(ground_, fresh);
    ground_.add_box({1, 1, 0.4}, {0.5, 0, -0.2}, Quat::Identity(), 0);
    const Quat turn = about_y(degrees);
    add_box({2, 1, 0.4}, turn * Vec3(-1, 0, -0.2), turn);
    take(turn * Vec3(-0.3, 0, 0.1));
    EXPECT_TRUE(is_side_covered(0.0));
    EXPECT_TRUE(is_side_covered(1e-5));
    const auto along = faces_.find_uncovered(tile(), Vec3::Zero(), Vec3(-0.6, 0, 0.8));
    ASSERT_TRUE(along.has_value());
    EXPECT_TRUE(along->isApprox(Vec3::UnitZ()));
    EXPECT_FALSE(faces_.find_uncovered(tile(), Vec3::Zero(), -Vec3::UnitX()));
  }
}

TEST_F(NearFacesTest, AFlushTileCoversItAndOneALittleLowerTooButNotAStep) {
  for (const auto& [lower, covered] : {std::pair{0.0, true}, {1e-3, true}, {3e-3, false}}) {
    Ground fresh;
    std::swap(ground_, fresh);
    ground_.add_box({1, 1, 0.4}, {0.5, 0, -0.2}, Quat::Identity(), 0);
    add_box({1, 1, 0.4}, {-0.5, 0, -0.2 - lower});
    take({-0.3, 0, 0.1});
    EXPECT_EQ(is_side_covered(-0.5 * lower), covered) << lower;
  }
}

// A body that the floor bears by sinking in a little meets the wall all the same.
TEST_F(NearFacesTest, AWallIsSeenOverTheFloorThatItStandsOn) {
  add_box({4, 1, 0.4}, {0, 0, -0.5});  // up to z = -.3
  take({-0.3, 0, -0.2});
  for (const double z : {-0.29, -0.3, -0.3001, -0.305}) EXPECT_FALSE(is_side_covered(z)) << z;
}

TEST_F(NearFacesTest, OverARidgeTheEdgeIsSeen) {
  const Quat turn = about_y(-30.0);  // falls away to the left
  add_box({2, 1, 0.4}, turn * Vec3(-1, 0, -0.2), turn);
  take({0.0, 0, 0.2});
  const Vec3 upright = about_y(-15.0) * Vec3::UnitZ();
  EXPECT_EQ(faces_.find_uncovered(tile(), Vec3::Zero(), upright), upright);
}

TEST_F(NearFacesTest, InACornerBothWallsAreSeen) {
  add_box({1, 1, 0.4}, {-0.5, 1.0, -0.2});  // from y = .5
  take({-0.1, 0.3, -0.2});
  for (const double y : {0.49, 0.5, 0.501})
    EXPECT_FALSE(faces_.is_covered(tile(), {-Vec3::UnitX(), 0.0}, {0, y, -0.2})) << y;
}

}  // namespace
}  // namespace lodestone::near_faces_test
