// Questions of bodies, against a look at every triangle of every body.
#include <gtest/gtest.h>

#include <algorithm>

#include "lod/manager/query_ground.h"
#include "lod/queries.h"
#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

/// m, of a ray of unit direction, to the outside of a triangle.
std::optional<double> meet_triangle(const Vec3& from, const Vec3& along, const Vec3& a, const Vec3& b,
                                    const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  if (along.dot(normal) >= 0.0) return {};
  const double distance = (a - from).dot(normal) / along.dot(normal);
  if (distance < 0.0) return {};
  const Vec3 p = from + distance * along;
  for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
    if ((v - u).cross(p - u).dot(normal) < 0.0) return {};
  return distance;
}

Mesh l_mesh() { return make_l(0.5, 0.4, 0.15, 0.2); }

class QueryBodies : public ::testing::Test {
 protected:
  QueryBodies() {
    const auto box = box_shape({0.3, 0.4, 0.5});
    const auto l = std::make_shared<const Shape>(make_shape("l", l_mesh()));
    const auto ball = sphere_shape(0.3);
    RandomStream random(71, 0, 0);
    for (int i = 0; i < 40; ++i) {
      const Vec3 place(random.uniform(-1.7, 1.7), random.uniform(-1.7, 1.7), random.uniform(-1.7, 1.7));
      const auto& shape = i % 3 == 0 ? box : i % 3 == 1 ? l : ball;
      bodies_.push_back(add(manager_, shape, at(place, {0, 0, 0}, {0, 0, 0}, random.orientation()),
                            i % 4 == 0 ? LevelChoice::full : LevelChoice::statistical));
    }
  }
  /// m, to the nearest point where a ray enters the body; none: it misses, or begins inside.
  std::optional<double> ray_to(BodyId body, const Ray& ray) const {
    const Shape& shape = manager_.shape(body);
    const RigidState state = manager_.state(body);
    const Vec3 along = ray.direction.normalized();
    if (shape.sphere_radius) {
      const Vec3 to = state.position - ray.from;
      const double middle = to.dot(along), r = *shape.sphere_radius,
                   square = r * r - (to.squaredNorm() - middle * middle);
      if (square < 0.0) return {};
      const double first = middle - std::sqrt(square);
      return first >= 0.0 && first <= ray.length ? std::optional(first) : std::nullopt;
    }
    std::optional<double> nearest;
    for (const auto& [a, b, c] : shape.mesh.faces) {
      const auto corner = [&](int i) -> Vec3 {
        return state.position + state.orientation * shape.mesh.vertices[std::size_t(i)];
      };
      const auto hit = meet_triangle(ray.from, along, corner(a), corner(b), corner(c));
      if (hit && *hit <= ray.length && (!nearest || *hit < *nearest)) nearest = hit;
    }
    return nearest;
  }
  static Ray draw_ray(RandomStream& random) {
    Ray ray;
    ray.from = 5.0 * random.direction();
    ray.direction = random.uniform(0.1, 3.0) *
                    (1.5 * random.direction() - ray.from).normalized();  // of any length, and mostly inward
    ray.length = random.uniform() < 0.5 ? random.uniform(1.0, 8.0) : 1e9;
    return ray;
  }
  Manager manager_{unmeasured()};
  std::vector<BodyId> bodies_;
};

TEST_F(QueryBodies, RaysMeetTheNearestAndAllOfThem) {
  RandomStream random(72, 0, 0);
  int met = 0, through = 0;
  for (int i = 0; i < 400; ++i) {
    const Ray ray = draw_ray(random);
    std::vector<std::pair<double, BodyId>> expected;
    for (const BodyId body : bodies_)
      if (const auto distance = ray_to(body, ray)) expected.emplace_back(*distance, body);
    std::ranges::sort(expected, {}, [](const auto& hit) { return hit.first; });
    const auto first = manager_.cast_ray(ray);
    ASSERT_EQ(first.has_value(), !expected.empty()) << i;
    std::vector<QueryHit> all;
    manager_.cast_rays_through({&ray, 1}, {&all, 1});
    ASSERT_EQ(all.size(), expected.size()) << i;
    for (std::size_t k = 0; k < all.size(); ++k) {
      EXPECT_NEAR(all[k].distance, expected[k].first, 1e-9);
      EXPECT_EQ(all[k].who.body, expected[k].second);
      EXPECT_EQ(all[k].who.kind, ContactSide::Kind::body);
    }
    if (!first) continue;
    ++met, through += all.size() > 1;
    EXPECT_NEAR(first->distance, expected[0].first, 1e-9);
    EXPECT_LT((first->point - (ray.from + first->distance * ray.direction.normalized())).norm(), 1e-8);
    EXPECT_NEAR(first->normal.norm(), 1.0, 1e-9);
    EXPECT_LE(first->normal.dot(ray.direction), 0.0);  // met from outside
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(through, 30);
}

TEST_F(QueryBodies, ManyAtOnceAreAsOneByOne) {
  RandomStream random(73, 0, 0);
  std::vector<Ray> rays;
  for (int i = 0; i < 100; ++i) rays.push_back(draw_ray(random));
  std::vector<std::optional<QueryHit>> hits(rays.size());
  manager_.set_threads(2);
  manager_.cast_rays(rays, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto one = manager_.cast_ray(rays[i]);
    ASSERT_EQ(one.has_value(), hits[i].has_value());
    if (one) {
      EXPECT_EQ(one->distance, hits[i]->distance);
      EXPECT_EQ(one->who.body, hits[i]->who.body);
    }
  }
}

// A sphere that moves meets a body no later than a ray through its middle would, and where it stops it
// touches: its middle is as far from the point met as its radius.
TEST_F(QueryBodies, ASweptSphereStopsWhereItTouches) {
  RandomStream random(74, 0, 0);
  int met = 0;
  for (int i = 0; i < 200; ++i) {
    const Ray ray = draw_ray(random);
    const SphereSweep sweep{ray, random.uniform(0.02, 0.5)};
    const auto hit = manager_.sweep_sphere(sweep);
    for (const BodyId body : bodies_)
      if (const auto distance = ray_to(body, ray)) {
        ASSERT_TRUE(hit.has_value());
        EXPECT_LE(hit->distance, *distance + 1e-9);
      }
    if (!hit || hit->distance == 0.0) continue;
    ++met;
    const Vec3 middle = ray.from + hit->distance * ray.direction.normalized();
    EXPECT_NEAR((middle - hit->point).norm(), sweep.radius, 1e-7);
    // It touches nothing before.
    const SphereVolume before{ray.from + (hit->distance - 1e-4) * ray.direction.normalized(),
                              sweep.radius - 1e-6};
    std::vector<QueryHit> there;
    manager_.overlap_spheres({&before, 1}, {&there, 1});
    EXPECT_TRUE(there.empty());
    const SphereVolume after{middle, sweep.radius + 1e-6};
    manager_.overlap_spheres({&after, 1}, {&there, 1});
    EXPECT_TRUE(
        std::ranges::any_of(there, [&](const QueryHit& other) { return other.who.body == hit->who.body; }));
  }
  EXPECT_GT(met, 60);
}

// Balls have closed forms: which of them a sphere or a box touches.
TEST_F(QueryBodies, VolumesTouchTheBallsThatTheyShould) {
  RandomStream random(75, 0, 0);
  int touched = 0;
  for (int i = 0; i < 200; ++i) {
    const SphereVolume sphere{random.uniform(0.0, 3.0) * random.direction(), random.uniform(0.05, 1.5)};
    const BoxVolume box{Vec3(random.uniform(0.1, 2), random.uniform(0.1, 2), random.uniform(0.1, 2)),
                        random.uniform(0.0, 3.0) * random.direction(), random.orientation()};
    std::vector<QueryHit> in_sphere, in_box;
    manager_.overlap_spheres({&sphere, 1}, {&in_sphere, 1});
    manager_.overlap_boxes({&box, 1}, {&in_box, 1});
    const auto has = [](const std::vector<QueryHit>& hits, BodyId body) {
      return std::ranges::any_of(hits, [&](const QueryHit& hit) { return hit.who.body == body; });
    };
    for (const BodyId body : bodies_) {
      if (!manager_.shape(body).sphere_radius) continue;
      const double r = *manager_.shape(body).sphere_radius;
      const Vec3 center = manager_.state(body).position;
      const double gap = (center - sphere.center).norm() - r - sphere.radius;
      if (std::abs(gap) > 1e-9) {
        EXPECT_EQ(has(in_sphere, body), gap < 0.0);
      }
      const Vec3 local = box.orientation.conjugate() * (center - box.position);
      const double box_gap = (local.cwiseAbs() - 0.5 * box.sides).cwiseMax(0.0).norm() - r;
      if (std::abs(box_gap) > 1e-9) {
        EXPECT_EQ(has(in_box, body), box_gap < 0.0);
        touched += box_gap < 0.0;
      }
    }
    EXPECT_TRUE(std::ranges::is_sorted(in_box, {}, [](const QueryHit& hit) { return hit.who.body.index; }));
  }
  EXPECT_GT(touched, 50);
}

// A box that contains a body, and one within a body, touch it though no surfaces meet.
TEST_F(QueryBodies, ContainedIsTouched) {
  const BodyId body = bodies_[0];
  const Vec3 place = manager_.state(body).position;
  for (const double side : {20.0, 0.01}) {
    const BoxVolume box{Vec3::Constant(side), place, Quat::Identity()};
    std::vector<QueryHit> hits;
    manager_.overlap_boxes({&box, 1}, {&hits, 1});
    EXPECT_TRUE(std::ranges::any_of(hits, [&](const QueryHit& hit) { return hit.who.body == body; })) << side;
    const SphereVolume sphere{place, side};
    manager_.overlap_spheres({&sphere, 1}, {&hits, 1});
    EXPECT_TRUE(std::ranges::any_of(hits, [&](const QueryHit& hit) { return hit.who.body == body; })) << side;
  }
}

TEST_F(QueryBodies, FiltersLeaveOut) {
  const Vec3 place = manager_.state(bodies_[0]).position;
  const Ray ray{place + Vec3(0, 0, 10), {0, 0, -1}};
  ASSERT_TRUE(manager_.cast_ray(ray));
  EXPECT_FALSE(manager_.cast_ray(ray, {.bodies = false}));
  std::vector<QueryHit> all, others;
  manager_.cast_rays_through({&ray, 1}, {&all, 1});
  manager_.cast_rays_through({&ray, 1}, {&others, 1}, {.except = bodies_[0]});
  EXPECT_EQ(others.size() + 1, all.size());
  BodyProperties own;
  own.category = 2u;
  manager_.set_properties(bodies_[0], own);
  std::vector<QueryHit> by_bits;
  manager_.cast_rays_through({&ray, 1}, {&by_bits, 1}, {.categories = 2u});
  EXPECT_EQ(by_bits.size(), all.size());  // the others have all bits
  manager_.cast_rays_through({&ray, 1}, {&by_bits, 1}, {.categories = 1u});
  EXPECT_EQ(by_bits.size() + 1, all.size());
}

// As they move, come and go: at any time the answer is that of a look at each.
TEST_F(QueryBodies, AnswersFollowTheBodies) {
  RandomStream random(76, 0, 0);
  manager_.set_gravity({0, 0, -3});
  for (int step = 0; step < 15; ++step) {
    manager_.step(kFrame);
    if (step == 4) manager_.remove_body(bodies_[5]), bodies_.erase(bodies_.begin() + 5);
    if (step == 6) manager_.set_state(bodies_[3], at({0, 0, 2.5}));
    if (step == 8) manager_.set_level(bodies_[1], LevelChoice::full);
    if (step == 9) bodies_.push_back(add(manager_, sphere_shape(0.5), at({1, 1, 3})));
    for (int i = 0; i < 10; ++i) {
      const Ray ray = draw_ray(random);
      std::optional<double> nearest;
      for (const BodyId body : bodies_)
        if (const auto distance = ray_to(body, ray)) nearest = std::min(nearest.value_or(1e300), *distance);
      const auto hit = manager_.cast_ray(ray);
      ASSERT_EQ(hit.has_value(), nearest.has_value()) << step << ' ' << i;
      if (hit) {
        EXPECT_NEAR(hit->distance, *nearest, 1e-6) << step << ' ' << i;
      }
    }
  }
}

// However many of its triangles are met.
TEST(QueryScene, AMeshOfTheGroundIsMetOnce) {
  constexpr int kTiles = 6;  // each way from the middle, of 1 m
  Mesh floor;
  for (int x = -kTiles; x <= kTiles; ++x)
    for (int y = -kTiles; y <= kTiles; ++y) floor.vertices.push_back(Vec3(x, y, 0.1 * (x == y)));
  const int row = 2 * kTiles + 1;
  for (int x = 0; x + 1 < row; ++x)
    for (int y = 0; y + 1 < row; ++y) {
      const int a = x * row + y, b = a + row;
      floor.faces.push_back({a, b, b + 1}), floor.faces.push_back({a, b + 1, a + 1});
    }
  Manager manager(testing::unmeasured());
  manager.add_static_mesh(floor);
  manager.add_static_box({0.5, 0.5, 0.5}, {0, 0.6, 0.25}, Quat::Identity());
  std::vector<std::vector<QueryHit>> hits(1);
  const SphereVolume sphere{Vec3(0, 0, 0.1), 0.5};
  manager.overlap_spheres({&sphere, 1}, hits);
  EXPECT_EQ(hits[0].size(), 2U);
  const SphereSweep sweep{.ray = {.from = Vec3(0, 0, 3), .direction = -Vec3::UnitZ(), .length = 5.0},
                          .radius = 0.5};
  manager.sweep_spheres_through({&sweep, 1}, hits);
  ASSERT_EQ(hits[0].size(), 2U);
  EXPECT_LE(hits[0][0].distance, hits[0][1].distance);
}

// It lies where it was put, though no step saw it go there.
TEST(QueryScene, FindsWhatWasPutElsewhereAndLaidToSleep) {
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support}) {
    Manager manager = on_floor();
    const BodyId box = add(manager, box_shape({0.4, 0.4, 0.4}), testing::at({0, 0, 0.2}), level);
    run(manager, 0.1);
    const auto down_at = [&](double x) {
      const auto hit = manager.cast_ray({.from = {x, 0, 5}, .direction = {0, 0, -1}, .length = 10});
      return hit && hit->who.kind == ContactSide::Kind::body;
    };
    EXPECT_TRUE(down_at(0));
    manager.set_state(box, testing::at({7, 0, 0.2}));
    manager.sleep(box);
    EXPECT_TRUE(down_at(7));
    manager.set_state(box, testing::at({-7, 0, 0.2}));
    manager.sleep(box);
    manager.step(kFrame);
    EXPECT_TRUE(down_at(-7));
    EXPECT_FALSE(down_at(7));
  }
}

// What the step has moved so far, and what the caller's world step moves.
TEST(QueryScene, BetweenTheHalvesOfAStepBodiesAreFoundWhereTheyAre) {
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  {
    Manager manager(world, space, unmeasured());
    const auto cube = box_shape({0.3, 0.3, 0.3});
    const auto fast = [](double y) { return testing::at({0, y, 0}, {100, 0, 0}); };
    const BodyId bodies[] = {add(manager, cube, fast(0), LevelChoice::support),
                             add(manager, cube, fast(5), LevelChoice::full)};
    const auto is_found = [&](BodyId body) {
      const Vec3 place = manager.state(body).position;
      const auto hit =
          manager.cast_ray({.from = place + Vec3(0, 0, 2), .direction = {0, 0, -1}, .length = 4});
      return hit && hit->who.body == body;
    };
    for (int i = 0; i < 3; ++i) {
      for (const BodyId body : bodies) EXPECT_TRUE(is_found(body));
      manager.before_world_step(kFrame);
      for (const BodyId body : bodies) EXPECT_TRUE(is_found(body));
      dWorldStep(world, kFrame);
      for (const BodyId body : bodies) EXPECT_TRUE(is_found(body));
      manager.after_world_step();
    }
  }
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

// The rows of tiles of a world that is streamed.
TEST(QueryScene, KeepsNoTreesOfGroundThatIsGone) {
  std::weak_ptr<const Shape> first;
  ShapeTrees trees;
  for (int i = 0; i < 200; ++i) {
    const auto tile = std::make_shared<const Shape>(make_shape("tile", l_mesh()));
    trees.of(tile);
    if (i == 0) first = tile;
  }
  EXPECT_TRUE(first.expired());
}

}  // namespace
}  // namespace lodestone
