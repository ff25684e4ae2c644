// What touches and does not bounce gains nothing by being solved, however great its friction.
#include <gtest/gtest.h>

#include "lod/contact/crowd_solver.h"
#include "reference/random.h"

namespace lodestone::crowd_energy_test {
namespace {

struct Touching {
  std::vector<SolverBody> bodies;
  std::vector<CrowdManifold> manifolds;
  std::vector<CrowdPoint> points;

  void add_body(double mass, const Vec3& inverse_moments, double speed, double spin, RandomStream& random) {
    SolverBody& body = bodies.emplace_back();
    const Vec3 way = random.direction(), axis = random.direction();
    body.velocity = random.uniform(0, speed) * way;
    body.angular_velocity = random.uniform(0, spin) * axis;
    body.inverse_mass = 1.0 / mass;
    const Mat3 axes = random.orientation().toRotationMatrix();
    body.inverse_inertia = axes * (inverse_moments / mass).asDiagonal() * axes.transpose();
  }
  void touch(std::int32_t first, std::int32_t second, const Vec3& normal, double friction,
             const CrowdPoint& point) {
    manifolds.push_back({.first = first,
                         .second = second,
                         .normal = normal,
                         .law = {.restitution = 0.0, .friction = friction},
                         .begin = std::uint32_t(points.size()),
                         .count = 1});
    points.push_back(point);
  }
  double energy() const {
    double sum = 0.0;
    for (const SolverBody& body : bodies)
      sum += 0.5 * (body.velocity.squaredNorm() / body.inverse_mass +
                    body.angular_velocity.dot(body.inverse_inertia.inverse() * body.angular_velocity));
    return sum;
  }
  /// Over what it was.
  double energy_once_solved(const Vec3& fall) {
    const double before = energy();
    CrowdSolver().solve(bodies, manifolds, points, 1.0 / 180.0,
                        {.sweeps = 10, .tolerance = 1e-3, .fall = fall}, make_job_runner(1));
    return energy() / before;
  }
};

// A slender body turns so easily about its own axis that an impulse along one way moves the point nearly as
// much along the two others. Its energy grew threefold at a friction of 1, at great ones without a bound.
TEST(CrowdEnergy, APointOfASlenderBodyGainsNothing) {
  for (const double ratio : {1.0, 100.0})
    for (const double friction : {0.5, 1.0, 1e6})
      for (std::uint32_t i = 0; i < 300; ++i) {
        RandomStream random(3, i, 0);
        Touching pair;
        pair.add_body(1.0, {100, 120, 3000}, 2.0, 5.0, random);
        pair.add_body(ratio, {100, 120, 150}, 2.0, 5.0, random);
        const Vec3 normal = random.direction(), arm = 0.1 * random.direction();
        pair.touch(0, 1, normal, friction, {.arm_first = arm, .arm_second = 0.1 * random.direction()});
        EXPECT_LT(pair.energy_once_solved({0, 0, -0.05}), 1.001) << ratio << ' ' << friction << ' ' << i;
      }
}

}  // namespace
}  // namespace lodestone::crowd_energy_test
