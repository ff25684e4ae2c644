// Questions of the caller's dynamic bodies and ground, against closed forms.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

class QueryOfCallers : public ::testing::Test {
 protected:
  QueryOfCallers() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world_ = dWorldCreate();
    space_ = dHashSpaceCreate(nullptr);
    manager_ = std::make_unique<Manager>(world_, space_, unmeasured());
  }
  ~QueryOfCallers() override {
    manager_.reset();
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  dGeomID add(dGeomID geom, const Vec3& place, bool dynamic = true) {
    if (dynamic) {
      const dBodyID body = dBodyCreate(world_);
      dBodySetGravityMode(body, 0);
      dGeomSetBody(geom, body);
    }
    dGeomSetPosition(geom, place.x(), place.y(), place.z());
    return geom;
  }
  dWorldID world_;
  dSpaceID space_;
  std::unique_ptr<Manager> manager_;
};

// Balls have a closed form: rays meet them where they should, the nearest first.
TEST_F(QueryOfCallers, RaysMeetHisBalls) {
  RandomStream random(41, 0, 0);
  struct Ball {
    dGeomID geom;
    Vec3 at;
    double radius;
  };
  std::vector<Ball> balls;
  for (int i = 0; i < 15; ++i) {
    Ball ball{nullptr, random.uniform(0, 2.5) * random.direction(), random.uniform(0.1, 0.5)};
    ball.geom = add(dCreateSphere(space_, ball.radius), ball.at);
    balls.push_back(ball);
  }
  manager_->step(1e-9);
  int met = 0;
  for (int i = 0; i < 200; ++i) {
    const Ray ray{6.0 * random.direction(), {}, 20.0};
    const Vec3 along = (1.5 * random.direction() - ray.from).normalized();
    double nearest = 1e9;
    dGeomID who = nullptr;
    for (const Ball& ball : balls) {
      const double middle = (ball.at - ray.from).dot(along),
                   square =
                       ball.radius * ball.radius - ((ball.at - ray.from).squaredNorm() - middle * middle);
      if (square > 0 && middle - std::sqrt(square) < nearest)
        nearest = middle - std::sqrt(square), who = ball.geom;
    }
    const auto hit = manager_->cast_ray({ray.from, along, 20.0});
    ASSERT_EQ(hit.has_value(), who != nullptr) << i;
    if (!hit) continue;
    ++met;
    EXPECT_EQ(hit->who.kind, ContactSide::Kind::callers);
    EXPECT_EQ(hit->who.geom, who);
    EXPECT_EQ(hit->who.callers, dGeomGetBody(who));
    EXPECT_NEAR(hit->distance, nearest, 1e-6);
    const auto swept = manager_->sweep_sphere({{ray.from, along, 20.0}, 0.05});
    ASSERT_TRUE(swept);
    EXPECT_LE(swept->distance, nearest);
  }
  EXPECT_GT(met, 40);
}

// Where they are now, though no step was made since.
TEST_F(QueryOfCallers, AreMetWhereTheyAreNow) {
  const dGeomID box = add(dCreateBox(space_, 1, 1, 1), {0, 0, 0});
  manager_->step(kFrame);
  const Ray down{{0, 0, 5}, {0, 0, -1}, 100.0};
  EXPECT_NEAR(manager_->cast_ray(down)->distance, 4.5, 1e-6);
  dBodySetPosition(dGeomGetBody(box), 0, 0, 2);
  EXPECT_NEAR(manager_->cast_ray(down)->distance, 2.5, 1e-6);
  dBodySetPosition(dGeomGetBody(box), 9, 0, 2);
  EXPECT_FALSE(manager_->cast_ray(down));
  dBodySetPosition(dGeomGetBody(box), 0, 0, 0);
  const dBodyID body = dGeomGetBody(box);
  dGeomDestroy(box);
  dBodyDestroy(body);
  EXPECT_FALSE(manager_->cast_ray(down));
}

TEST_F(QueryOfCallers, FiltersKnowHisBitsAndHisKinds) {
  const dGeomID box = add(dCreateBox(space_, 1, 1, 1), {0, 0, 3});
  dGeomSetCategoryBits(box, 2);
  add(dCreateBox(space_, 1, 1, 1), {0, 0, 0}, false);  // ground
  manager_->step(1e-9);
  const Ray down{{0, 0, 9}, {0, 0, -1}, 100.0};
  const auto distance = [&](const QueryFilter& filter) {
    const auto hit = manager_->cast_ray(down, filter);
    return hit ? hit->distance : -1.0;
  };
  EXPECT_NEAR(distance({}), 5.5, 1e-6);
  EXPECT_NEAR(distance({.categories = 2}), 5.5, 1e-6);
  EXPECT_NEAR(distance({.categories = 4}), 8.5, 1e-6);
  EXPECT_NEAR(distance({.callers = false}), 8.5, 1e-6);
  EXPECT_NEAR(distance({.ground = false}), 5.5, 1e-6);
  EXPECT_EQ(distance({.ground = false, .callers = false}), -1.0);
}

TEST_F(QueryOfCallers, VolumesTouchEachGeomOnce) {
  std::vector<dGeomID> geoms;
  for (int i = 0; i < 6; ++i) geoms.push_back(add(dCreateBox(space_, 0.5, 0.5, 0.5), {1.0 * i, 0, 0}));
  manager_->step(1e-9);
  const SphereVolume sphere{{0, 0, 0}, 1.8};
  const BoxVolume box{{5, 0.2, 0.2}, {1.5, 0, 0}};
  for (const bool is_box : {false, true}) {
    std::vector<QueryHit> hits;
    if (is_box)
      manager_->overlap_boxes({&box, 1}, {&hits, 1});
    else
      manager_->overlap_spheres({&sphere, 1}, {&hits, 1});
    const std::size_t expected = is_box ? 5 : 3;  // from −1 to 4; up to 2.05
    ASSERT_EQ(hits.size(), expected) << is_box;
    for (std::size_t i = 0; i < expected; ++i)
      EXPECT_EQ(std::ranges::count(hits, geoms[i], [](const QueryHit& hit) { return hit.who.geom; }), 1);
  }
}

}  // namespace
}  // namespace lodestone
