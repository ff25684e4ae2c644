#include "lod/manager/query_ground.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

PosedSurface ball_at(const Vec3& place, double radius) { return {nullptr, radius, place, Quat::Identity()}; }

TEST(PosedSurface, ABallIsMetWhereItsSurfaceIs) {
  const PosedSurface ball = ball_at({3, 0, 0}, 1.0);
  const auto hit = meet(ball, {{0, 0, 0}, {1, 0, 0}, 10.0});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 2.0, 1e-12);
  EXPECT_LT((hit->point - Vec3(2, 0, 0)).norm(), 1e-12);
  EXPECT_LT((hit->normal - Vec3(-1, 0, 0)).norm(), 1e-12);
  EXPECT_FALSE(meet(ball, {{0, 0, 0}, {1, 0, 0}, 1.9}));
  EXPECT_FALSE(meet(ball, {{0, 0, 0}, {-1, 0, 0}, 10.0}));
  EXPECT_FALSE(meet(ball, {{3, 0.5, 0}, {1, 0, 0}, 10.0}));  // begun inside
  const auto swept = meet(ball, {{0, 0, 0}, {1, 0, 0}, 10.0, 0.5});
  EXPECT_NEAR(swept->distance, 1.5, 1e-12);
  EXPECT_EQ(meet(ball, {{3, 0.5, 0}, {1, 0, 0}, 10.0, 0.5})->distance, 0.0);
}

// A mesh, turned and moved with the ray, is met at the same distance.
TEST(PosedSurface, GoesAlongWithTheWorld) {
  const TriangleTree tree(make_l(0.5, 0.4, 0.15, 0.2));
  RandomStream random(81, 0, 0);
  int met = 0;
  for (int i = 0; i < 200; ++i) {
    const Quat turn = random.orientation();
    const Vec3 away = random.uniform(0, 5) * random.direction();
    const Vec3 from = 1.0 * random.direction(), along = (0.2 * random.direction() - from).normalized();
    const double radius = i % 2 ? 0.0 : 0.1;
    const auto here = meet({&tree, 0, Vec3::Zero(), Quat::Identity()}, {from, along, 3.0, radius}),
               there = meet({&tree, 0, away, turn}, {away + turn * from, turn * along, 3.0, radius});
    ASSERT_EQ(here.has_value(), there.has_value());
    if (!here) continue;
    ++met;
    EXPECT_NEAR(here->distance, there->distance, 1e-9);
    EXPECT_LT((away + turn * here->point - there->point).norm(), 1e-9);
    EXPECT_LT((turn * here->normal - there->normal).norm(), 1e-6);
  }
  EXPECT_GT(met, 80);
}

TEST(ShapeTrees, OneForEachShape) {
  ShapeTrees trees;
  const auto box = box_shape({1, 1, 1}), other = box_shape({1, 1, 1});
  const TriangleTree& tree = trees.of(box);
  EXPECT_EQ(&trees.of(box), &tree);
  EXPECT_NE(&trees.of(other), &tree);
  EXPECT_TRUE(tree.contains({0.4, 0.4, 0.4}));
}

class QueryGrounds : public ::testing::Test {
 protected:
  Manager manager_{unmeasured()};
};

TEST_F(QueryGrounds, PlanesAreMetFromOutsideAtTheirHeight) {
  RandomStream random(82, 0, 0);
  for (int i = 0; i < 40; ++i) {
    Manager manager(unmeasured());
    const Vec3 normal = random.direction();
    const double offset = random.uniform(-2, 2);
    const GroundId plane = manager.add_plane(normal, offset);
    const Vec3 from = random.uniform(0, 5) * random.direction(), along = random.direction();
    const double height = normal.dot(from) - offset, sinks = -normal.dot(along);
    const auto hit = manager.cast_ray({from, along});
    const bool expected = height > 0.0 && sinks > 0.0;
    ASSERT_EQ(hit.has_value(), expected);
    if (!hit) continue;
    EXPECT_EQ(hit->who.kind, ContactSide::Kind::ground);
    EXPECT_EQ(hit->who.ground, plane);
    EXPECT_NEAR(hit->distance, height / sinks, 1e-9 * height / sinks);
    EXPECT_LT((hit->normal - normal).norm(), 1e-12);
    const double radius = 0.5 * height;
    const auto swept = manager.sweep_sphere({{from, along}, radius});
    ASSERT_TRUE(swept);
    EXPECT_NEAR(swept->distance, (height - radius) / sinks, 1e-9 * height / sinks);
    EXPECT_NEAR(normal.dot(swept->point) - offset, 0.0, 1e-9 * (1 + swept->distance));
  }
}

// Static boxes against slabs by hand.
TEST_F(QueryGrounds, BoxesAreMetByTheirSlabs) {
  RandomStream random(83, 0, 0);
  struct Placed {
    Vec3 half, place;
    Quat turn;
    GroundId id;
  };
  std::vector<Placed> boxes;
  for (int i = 0; i < 25; ++i) {
    Placed box{Vec3(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)),
               random.uniform(0, 8) * random.direction(),
               random.orientation(),
               {}};
    box.id = manager_.add_static_box(2.0 * box.half, box.place, box.turn, 0);
    boxes.push_back(box);
  }
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 from = 10.0 * random.direction(), along = (4.0 * random.direction() - from).normalized();
    double nearest = 1e300;
    GroundId who;
    for (const Placed& box : boxes) {
      const Vec3 p = box.turn.conjugate() * (from - box.place), d = box.turn.conjugate() * along;
      double enter = -1e300, leave = 1e300;
      for (int axis = 0; axis < 3; ++axis) {
        const double a = (-box.half[axis] - p[axis]) / d[axis], b = (box.half[axis] - p[axis]) / d[axis];
        enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
      }
      if (enter < leave && enter >= 0.0 && enter < nearest) nearest = enter, who = box.id;
    }
    const auto hit = manager_.cast_ray({from, along});
    ASSERT_EQ(hit.has_value(), nearest < 1e300);
    if (!hit) continue;
    ++met;
    EXPECT_NEAR(hit->distance, nearest, 1e-8);
    EXPECT_EQ(hit->who.ground, who);
  }
  EXPECT_GT(met, 60);
}

TEST_F(QueryGrounds, WhatWasMovedIsMetWhereItIsAndWhatWasRemovedNoMore) {
  const GroundId box = manager_.add_static_box({1, 1, 1}, {0, 0, 0}, Quat::Identity());
  const Ray down{{0, 0, 5}, {0, 0, -1}};
  EXPECT_NEAR(manager_.cast_ray(down)->distance, 4.5, 1e-9);
  manager_.move_ground(box, at({0, 0, 1}));
  EXPECT_NEAR(manager_.cast_ray(down)->distance, 3.5, 1e-9);
  manager_.move_ground(box, at({3, 0, 1}));
  EXPECT_FALSE(manager_.cast_ray(down));
  manager_.move_ground(box, at({0, 0, 1}));
  manager_.remove_ground(box);
  EXPECT_FALSE(manager_.cast_ray(down));
}

// Of cells of half a metre, in waves, and turned by `turn`.
Mesh waves(int cells, const Quat& turn) {
  Mesh mesh;
  for (int y = 0; y <= cells; ++y)
    for (int x = 0; x <= cells; ++x)
      mesh.vertices.push_back(turn *
                              Vec3(0.5 * x, 0.5 * y, 0.3 * std::sin(0.9 * x) * std::cos(0.7 * y) + 100.0));
  const auto at = [&](int x, int y) { return y * (cells + 1) + x; };
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x) {
      mesh.faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.faces.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return mesh;
}

Triangle corners_of(const Mesh& mesh, const std::array<int, 3>& f) {
  return {mesh.vertices[std::size_t(f[0])], mesh.vertices[std::size_t(f[1])],
          mesh.vertices[std::size_t(f[2])]};
}

std::optional<double> first_of_all(const Mesh& mesh, const Vec3& from, const Vec3& along, double length) {
  std::optional<double> first;
  for (const auto& face : mesh.faces)
    if (const auto distance = meet_front(corners_of(mesh, face), from, along, first.value_or(length)))
      first = distance;
  return first;
}

// Against each of its triangles, from above and from below; a box with a lid looks all ways, waves one way.
TEST_F(QueryGrounds, AMeshOfManyTrianglesIsMetWhereTheFirstOneIs) {
  RandomStream random(84, 0, 0);
  Mesh pit = waves(12, Quat::Identity());
  const int rim = int(pit.vertices.size());
  for (const Vec3& v : make_box({9, 9, 4}).vertices) pit.vertices.push_back(v + Vec3(3, 3, 100));
  for (const auto& f : make_box({9, 9, 4}).faces) pit.faces.push_back({f[2] + rim, f[1] + rim, f[0] + rim});
  for (const Mesh& mesh : {waves(20, random.orientation()), pit}) {
    GroundSolids solids;
    solids.add_mesh(mesh);
    solids.prepare();
    ASSERT_TRUE(solids.surface());
    SolidQueries queries;
    Eigen::AlignedBox3d bounds;
    for (const Vec3& v : mesh.vertices) bounds.extend(v);
    int met = 0;
    for (int i = 0; i < 1000; ++i) {
      const Vec3 from = bounds.center() + 8.0 * random.direction(),
                 along = (bounds.sample() - from).normalized();
      const double length = random.uniform(2.0, 20.0);
      const auto expected = first_of_all(mesh, from, along, length);
      const auto hit = queries.meet(solids, Vec3::Zero(), Quat::Identity(), {from, along, length});
      ASSERT_EQ(hit.has_value(), expected.has_value()) << i;
      if (!hit) continue;
      ++met;
      EXPECT_NEAR(hit->distance, *expected, 1e-9);
      EXPECT_LT(hit->normal.dot(along), 0.0);
      // What a small ball leaves of the way.
      const auto swept = queries.meet(solids, Vec3::Zero(), Quat::Identity(), {from, along, length, 0.01});
      ASSERT_TRUE(swept);
      EXPECT_LE(swept->distance, *expected);
    }
    EXPECT_GT(met, 100);
    EXPECT_EQ(solids.surface()->made(), 0u);  // nothing needs the solids
  }
}

// A ball or a box that touches the surface overlaps it, and so does one that lies in what is solid below it.
TEST_F(QueryGrounds, VolumesOverlapAMeshAtItsSurfaceAndBelowIt) {
  const Mesh mesh = waves(20, Quat::Identity());
  GroundSolids solids;
  solids.add_mesh(mesh);
  solids.prepare();
  SolidQueries queries;
  RandomStream random(85, 0, 0);
  const auto overlaps = [&](const Volume& volume) {
    return queries.overlap(solids, Vec3::Zero(), Quat::Identity(), volume);
  };
  const auto box_about = [&](const Vec3& center, double half) {
    return Volume{center, 2.0 * half, true, random.orientation().toRotationMatrix(), Vec3::Constant(half)};
  };
  int near = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 center(random.uniform(1, 9), random.uniform(1, 9), random.uniform(100.4, 101.0));
    const double reach = random.uniform(0.02, 0.5);
    double nearest = 1e300;
    for (const auto& face : mesh.faces) {
      NearestPoint point(center, 1e300);
      point.ask(corners_of(mesh, face));
      nearest = std::min(nearest, point.hit()->distance);
    }
    const auto ball = overlaps({center, reach}), box = overlaps(box_about(center, reach));
    ASSERT_EQ(ball.has_value(), nearest <= reach);
    near += ball.has_value();
    if (ball) {
      EXPECT_NEAR((ball->point - center).norm(), nearest, 1e-9);
      EXPECT_TRUE(box);
      EXPECT_EQ(box->normal, Vec3(Vec3::UnitZ()));
    }
    if (nearest > 1.8 * reach) {
      EXPECT_FALSE(box);
    }
  }
  EXPECT_GT(near, 10);
  for (const auto& face : mesh.faces) {
    const Triangle t = corners_of(mesh, face);
    const Vec3 below = (t[0] + t[1] + t[2]) / 3.0 - 0.1 * (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    EXPECT_TRUE(overlaps({below, 0.01}));
    EXPECT_TRUE(overlaps(box_about(below, 0.01)));
    EXPECT_EQ(
        queries.meet(solids, Vec3::Zero(), Quat::Identity(), {below, Vec3::UnitX(), 1.0, 0.01})->distance,
        0.0);
  }
}

// Very far, and at a place where nothing is: no ray runs for ever.
TEST_F(QueryGrounds, EndlessRaysEnd) {
  manager_.add_static_box({1, 1, 1}, {0, 0, 0}, Quat::Identity());
  manager_.add_plane(Vec3::UnitZ(), -10.0);
  EXPECT_FALSE(manager_.cast_ray({{5, 0, 0}, {1, 0, 0}}));
  EXPECT_FALSE(manager_.cast_ray({{5, 0, 0}, {0, 0, 1}}));
  const auto low = manager_.cast_ray({{5, 0, 0}, Vec3(1, 0, -1e-6)});
  ASSERT_TRUE(low);
  EXPECT_NEAR(low->distance, 1e7, 1e7 * 1e-5);
  // From afar, what lies 2,000 km away is met, too; and 1e20 m away a step of two metres changes nothing.
  const auto far = manager_.cast_ray({{-2e6, 0, 0}, {1, 0, 0}});
  ASSERT_TRUE(far);
  EXPECT_NEAR(far->distance, 2e6 - 0.5, 1e-6);
  EXPECT_NO_THROW(manager_.cast_ray({{-1e20, 0, 0}, {1, 0, 0}}));
}

}  // namespace
}  // namespace lodestone
