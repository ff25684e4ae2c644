#include "lod/tables/sphere_kinds.h"

#include <gtest/gtest.h>

#include <numbers>

#include "lod/tables/tables_model.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

std::shared_ptr<const Signature> with_poses(int poses, float first_height = 1.0f) {
  auto signature = std::make_shared<Signature>();
  signature->collision_heights = {{first_height, 0.5f}, {0.0f, 0.0f}};
  for (int i = 0; i < poses; ++i)
    signature->rest_poses.push_back({.normal = Vec3::Unit(i % 3), .height = 0.1 * (i + 1)});
  return signature;
}

TEST(SphereKinds, NumbersAreThoseOfShapeAndSignature) {
  const auto box = testing::box_shape({0.2, 0.3, 0.4});
  Kinds kinds;
  SphereKinds dense;
  const std::uint32_t k = kinds.take(StatisticalModel::tables, box, 3, with_poses(2));
  dense.take(kinds, k, testing::kGravity);
  EXPECT_EQ(dense.material[k], 3);
  EXPECT_FLOAT_EQ(dense.radius[k], float(box->radius));
  EXPECT_FLOAT_EQ(dense.ixx[k], float(12 / (0.09 + 0.16)));
  EXPECT_FLOAT_EQ(dense.jzz[k], float((0.04 + 0.09) / 12));
  EXPECT_FLOAT_EQ(dense.softest[k], float(12 / (0.04 + 0.09)));  // about the longest axis
  EXPECT_FLOAT_EQ(dense.blend_time[k],
                  float(TablesSettings{}.blend_time * std::sqrt(box->radius / testing::kGravity)));
  // Resampled evenly in α, from R to half of it, and one more beyond the end.
  const float* heights = dense.height.data() + k * (kHeightSamples + 1);
  for (int i = 0; i < kHeightSamples; ++i)
    EXPECT_NEAR(heights[i], box->radius * (1.0 - 0.5 * i / (kHeightSamples - 1)), 1e-6);
  EXPECT_EQ(heights[kHeightSamples], heights[kHeightSamples - 1]);
  const auto pose = std::size_t(dense.first_pose[k]);
  EXPECT_FLOAT_EQ(dense.pose_height[pose + 1], float(0.2 * box->radius));
  EXPECT_EQ(dense.pose_x[pose], 1.0f);
  EXPECT_EQ(dense.pose_y[pose + 1], 1.0f);
}

TEST(SphereKinds, WithoutPosesItStandsAsItIs) {
  Kinds kinds;
  SphereKinds dense;
  const auto ball = testing::sphere_shape(0.3);
  const std::uint32_t k = kinds.take(StatisticalModel::tables, ball, 0, std::make_shared<const Signature>());
  dense.take(kinds, k, 0.0);  // without gravity
  EXPECT_FLOAT_EQ(dense.pose_height[std::size_t(dense.first_pose[k])], 0.3f);
  EXPECT_FLOAT_EQ(dense.height[k * (kHeightSamples + 1)], 0.3f);
  EXPECT_TRUE(std::isfinite(dense.blend_time[k]));
}

// A number that goes to another kind gets that one's figures; its poses lie where the last one's did, if they
// fit there.
TEST(SphereKinds, ANumberThatIsGivenAnewHasTheNewKindsFigures) {
  Kinds kinds;
  SphereKinds dense;
  const auto box = testing::box_shape({0.2, 0.3, 0.4}), cube = testing::box_shape({0.4, 0.4, 0.4});
  const std::uint32_t first = kinds.take(StatisticalModel::tables, box, 0, with_poses(3));
  dense.take(kinds, first, testing::kGravity);
  const std::int32_t room = dense.first_pose[first];
  kinds.give_back(first);
  const std::uint32_t second = kinds.take(StatisticalModel::tables, cube, 0, with_poses(2, 0.7f));
  ASSERT_EQ(second, first);
  dense.take(kinds, second, testing::kGravity);
  EXPECT_FLOAT_EQ(dense.radius[second], float(cube->radius));
  EXPECT_FLOAT_EQ(dense.height[second * (kHeightSamples + 1)], float(0.7f * cube->radius));
  EXPECT_EQ(dense.first_pose[second], room);
  kinds.give_back(second);
  const std::uint32_t third = kinds.take(StatisticalModel::tables, box, 0, with_poses(9));
  dense.take(kinds, third, testing::kGravity);
  EXPECT_FLOAT_EQ(dense.pose_height[std::size_t(dense.first_pose[third]) + 8], float(0.9 * box->radius));
}

TEST(SphereKinds, NeedlesAreCountedWhileTheyAreThere) {
  Kinds kinds;
  SphereKinds dense;
  const auto needle = testing::box_shape({0.01, 0.01, 0.4}), box = testing::box_shape({0.2, 0.3, 0.4});
  const std::uint32_t k = kinds.take(StatisticalModel::tables, needle, 0, with_poses(1));
  dense.take(kinds, k, testing::kGravity);
  dense.take(kinds, k, testing::kGravity);  // known: not twice
  EXPECT_TRUE(dense.any_slender());
  kinds.give_back(k);
  const std::uint32_t again = kinds.take(StatisticalModel::tables, box, 0, with_poses(1));
  dense.take(kinds, again, testing::kGravity);
  EXPECT_FALSE(dense.any_slender());
}

}  // namespace
}  // namespace lodestone
