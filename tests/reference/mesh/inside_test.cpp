#include "reference/mesh/inside.h"

#include <gtest/gtest.h>

#include "reference/mesh/mass_properties.h"
#include "reference/random.h"
#include "reference/shape.h"

namespace lodestone {
namespace {

TEST(WindingNumber, TellsInsideFromOutside) {
  const Mesh mesh = make_l(0.4, 0.4, 0.1, 0.2);
  RandomStream random(1, 0, 0);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2));
    const bool in_box = p.cwiseAbs().maxCoeff() < 0.2 && std::abs(p.z()) < 0.1;
    EXPECT_EQ(winding_number(mesh, p), in_box && (p.x() < -0.1 || p.y() < -0.1) ? 1 : 0);
  }
}

TEST(WindingNumber, HoldsOnLinesThroughVerticesAndEdges) {
  const Mesh sphere = make_sphere(1.0, 3);
  for (const Vec3& vertex : sphere.vertices) {
    EXPECT_EQ(winding_number(sphere, 0.9 * vertex), 1);
    EXPECT_EQ(winding_number(sphere, {vertex.x(), vertex.y(), -5.0}), 0);
    EXPECT_EQ(winding_number(sphere, {vertex.x(), vertex.y(), 5.0}), 0);
  }
  const Mesh box = make_box({2, 2, 2});
  for (double x : {-0.5, 0.0, 0.5})
    EXPECT_EQ(winding_number(box, {x, x, 0.0}), 1);  // on the diagonal of top and bottom
}

TEST(InsidePoints, FillTheVolume) {
  const Mesh bunny = make_bunny_shape(0.2).mesh;
  const double cell = 0.2 / 60, volume = measure_mass_properties(bunny).volume;
  const auto points = find_inside_points(bunny, cell);
  EXPECT_NEAR(double(points.size()) * cell * cell * cell, volume, 0.01 * volume);
  for (std::size_t i = 0; i < points.size(); i += 500) EXPECT_EQ(winding_number(bunny, points[i]), 1);
}

TEST(InsidePoints, KeepOutOfCavities) {
  Mesh hollow = make_box({1, 1, 1});
  const Mesh inner = make_box({0.6, 0.6, 0.6});
  for (const Vec3& vertex : inner.vertices) hollow.vertices.push_back(vertex);
  for (const auto& [a, b, c] : inner.faces) hollow.faces.push_back({a + 8, c + 8, b + 8});
  EXPECT_EQ(find_inside_points(hollow, 0.1).size(), 1000u - 216u);
}

TEST(InsidePoints, FindThinPlates) {
  EXPECT_EQ(find_inside_points(make_box({1, 1, 1e-3}), 0.1).size(), 100u);
}

}  // namespace
}  // namespace lodestone
