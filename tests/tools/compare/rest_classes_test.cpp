#include "tools/compare/rest_classes.h"

#include <gtest/gtest.h>

#include <vector>

#include "reference/random.h"

namespace lodestone {
namespace {

Vec3 tilted(double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  return {std::sin(angle), 0.0, std::cos(angle)};
}

TEST(RestClasses, NoneFromNoDrops) {
  EXPECT_TRUE(make_rest_classes({}).empty());
  EXPECT_EQ(find_rest_class({}, Vec3::UnitZ()), std::nullopt);
}

TEST(RestClasses, SidesOfABoxAreApart) {
  std::vector<Vec3> ups;
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())})
    for (int i = 0; i < 5; ++i) ups.insert(ups.end(), {axis, -axis});
  EXPECT_EQ(make_rest_classes(ups).size(), 6U);
}

TEST(RestClasses, MostPopulousFirst) {
  const std::vector<Vec3> ups = {tilted(90), tilted(0), tilted(1), tilted(0.5), tilted(91)};
  const RestClasses classes = make_rest_classes(ups);
  ASSERT_EQ(classes.size(), 2U);
  EXPECT_LT((classes[0] - tilted(0.5)).norm(), 0.02);
}

TEST(RestClasses, EveryDropThatMadeThemIsInOne) {
  RandomStream random(1, 2, 3);
  std::vector<Vec3> ups(300);
  for (Vec3& up : ups) up = random.direction();
  const RestClasses classes = make_rest_classes(ups);
  for (const Vec3& up : ups) EXPECT_TRUE(find_rest_class(classes, up).has_value());
}

TEST(RestClasses, FarFromEveryClassIsNone) {
  const RestClasses classes = {tilted(0), tilted(40)};
  EXPECT_EQ(find_rest_class(classes, tilted(11)), 0);
  EXPECT_EQ(find_rest_class(classes, tilted(29)), 1);
  EXPECT_EQ(find_rest_class(classes, tilted(20)), std::nullopt);
  EXPECT_EQ(find_rest_class(classes, tilted(-13)), std::nullopt);
}

TEST(RestClasses, BetweenTwoTheNearerCounts) {
  const RestClasses classes = {tilted(0), tilted(14)};
  EXPECT_EQ(find_rest_class(classes, tilted(8)), 1);
}

}  // namespace
}  // namespace lodestone
