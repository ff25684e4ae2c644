#include "scenes/scatter.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

double least_distance(const std::vector<Vec3>& centers) {
  double least = 1e9;
  for (std::size_t i = 0; i < centers.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, (centers[i] - centers[j]).norm());
  return least;
}

const Scatter kBox{.count = 300, .region = ScatterBox{{-1, -1, 0}, {1, 1, 3}}, .seed = 3};

TEST(Scatter, KeepsBoundingSpheresApart) {
  PlacedSpheres placed(0.12);
  const std::vector<Vec3> centers = place_scatter(kBox, 0.12, {}, placed);
  ASSERT_EQ(centers.size(), 300u);
  EXPECT_GE(least_distance(centers), 0.24);
  EXPECT_LT(least_distance(centers), 0.26);  // or the region would not be used well
  for (const Vec3& c : centers)
    EXPECT_TRUE((c.array() >= Vec3(-1, -1, 0).array()).all() && (c.array() <= Vec3(1, 1, 3).array()).all());
}

TEST(Scatter, KeepsSpacingAndStaysAboveGround) {
  PlacedSpheres placed(0.1);
  Scatter scatter = kBox;
  scatter.count = 60;
  scatter.spacing_m = 0.4;
  const KeepAbove ground{Vec3(0, 0, 1), 0.5};
  const std::vector<Vec3> centers = place_scatter(scatter, 0.1, std::span(&ground, 1), placed);
  ASSERT_EQ(centers.size(), 60u);
  EXPECT_GE(least_distance(centers), 0.4);
  for (const Vec3& c : centers) EXPECT_GE(c.z(), 0.6);
}

TEST(Scatter, KeepsClearOfWhatIsThere) {
  PlacedSpheres placed(1.0);
  placed.add(Vec3(0, 0, 1.5), 1.0);
  for (const Vec3& c : place_scatter(kBox, 0.1, {}, placed)) EXPECT_GE((c - Vec3(0, 0, 1.5)).norm(), 1.1);
}

TEST(Scatter, SameSeedSamePlaces) {
  PlacedSpheres a(0.1), b(0.1), c(0.1);
  Scatter moved = kBox, other = kBox;
  moved.region = ScatterBox{{99, -1, 0}, {101, 1, 3}};
  other.seed = 4;
  const std::vector<Vec3> first = place_scatter(kBox, 0.1, {}, a), second = place_scatter(moved, 0.1, {}, b);
  EXPECT_NE(first, place_scatter(other, 0.1, {}, c));
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_LT((second[i] - first[i] - Vec3(100, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(scatter_orientation(kBox, 7).coeffs(), scatter_orientation(moved, 7).coeffs());
  EXPECT_NE(scatter_orientation(kBox, 7).coeffs(), scatter_orientation(kBox, 8).coeffs());
}

TEST(Scatter, FillsACylinderEvenly) {
  PlacedSpheres placed(0.01);
  const std::vector<Vec3> centers =
      place_scatter({.count = 4000, .region = ScatterCylinder{{5, 0, 1}, 2, 3}, .seed = 1}, 0.01, {}, placed);
  ASSERT_EQ(centers.size(), 4000u);
  int inner = 0;
  for (const Vec3& c : centers) {
    const double r = (c - Vec3(5, 0, 1)).head<2>().norm();
    EXPECT_LE(r, 2.0);
    EXPECT_TRUE(c.z() >= 1 && c.z() <= 4);
    inner += r < 1.0;
  }
  EXPECT_NEAR(inner / 4000.0, 0.25, 0.03);
}

TEST(Scatter, StopsWhereNoRoomIsLeft) {
  PlacedSpheres placed(0.5);
  const std::vector<Vec3> centers =
      place_scatter({.count = 100, .region = ScatterBox{{0, 0, 0}, {1, 1, 1}}, .seed = 1}, 0.5, {}, placed);
  EXPECT_GE(centers.size(), 1u);
  EXPECT_LE(centers.size(), 8u);
}

}  // namespace
}  // namespace lodestone
