// Blows that go on through bodies that touch: a row that is struck loses its last one and does not throw the
// striker back; momentum is kept, energy never gained.
#include "lod/contact/impact_waves.h"

#include <gtest/gtest.h>

#include "lod/contact/crowd_solver.h"

namespace lodestone {
namespace {

constexpr double kWaveStep = 1.0 / 180.0, kSpeed = 4.0, kWaveRadius = 0.1;

// Equal balls along x without a gap, the first of which comes at the others.
struct Row {
  explicit Row(int count, double restitution, double load = 0.0) {
    for (int i = 0; i < count; ++i) {
      SolverBody& body = bodies.emplace_back();
      body.inverse_mass = 1.0;
      body.inverse_inertia = 2.5 / (kWaveRadius * kWaveRadius) * Mat3::Identity();
    }
    bodies[0].velocity = Vec3(kSpeed, 0, 0);
    for (int i = 0; i + 1 < count; ++i) {
      manifolds.push_back({.first = i + 1,
                           .second = i,
                           .normal = Vec3::UnitX(),
                           .law = {.restitution = restitution, .friction = 0.5},
                           .begin = std::uint32_t(i),
                           .count = 1});
      CrowdPoint& point = points.emplace_back();
      point.arm_first = Vec3(-kWaveRadius, 0, 0), point.arm_second = Vec3(kWaveRadius, 0, 0);
      if (i > 0) point.guess = Vec3(load, 0, 0);
    }
  }
  void solve() {
    CrowdSolver(Simd::portable)
        .solve(bodies, manifolds, points, kWaveStep, {.sweeps = 40}, [](std::int64_t tasks, TaskRef task) {
          for (std::int64_t i = 0; i < tasks; ++i) task(i);
        });
  }
  double momentum() const {
    double sum = 0.0;
    for (const SolverBody& body : bodies) sum += body.velocity.x();
    return sum;
  }
  double energy() const {
    double sum = 0.0;
    for (const SolverBody& body : bodies) sum += 0.5 * body.velocity.squaredNorm();
    return sum;
  }

  std::vector<SolverBody> bodies;
  std::vector<CrowdManifold> manifolds;
  std::vector<CrowdPoint> points;
};

TEST(ImpactWaves, ARowThatIsStruckHandsTheBlowOn) {
  for (const double e : {0.3, 0.5, 0.8, 1.0}) {
    Row row(6, e);
    row.solve();
    EXPECT_GE(row.bodies.front().velocity.x(), -1e-6) << e;
    EXPECT_GE(row.bodies.back().velocity.x(), kSpeed * std::pow(0.5 * (1.0 + e), 5) - 1e-6) << e;
    EXPECT_NEAR(row.momentum(), kSpeed, 1e-6) << e;
    EXPECT_LE(row.energy(), 0.5 * kSpeed * kSpeed + 1e-6) << e;
  }
}

// However many there are: after 32 of them what was left bounced off all the others at once, with energy from
// nowhere.
TEST(ImpactWaves, OfARowThatBouncesWhollyTheLastOneAloneGoesOn) {
  for (const int count : {6, 60}) {
    Row row(count, 1.0);
    row.solve();
    for (std::size_t i = 0; i + 1 < row.bodies.size(); ++i)
      EXPECT_NEAR(row.bodies[i].velocity.x(), 0.0, 1e-6) << count << ", " << i;
    EXPECT_NEAR(row.bodies.back().velocity.x(), kSpeed, 1e-6) << count;
  }
}

TEST(ImpactWaves, PointsAreToldWhatWentThroughThem) {
  Row row(4, 1.0);
  row.solve();
  for (const CrowdPoint& point : row.points) {
    EXPECT_NEAR(point.impulse.x(), kSpeed, 1e-5);
    EXPECT_TRUE(point.bounces);
  }
}

// Two alone, and what bears weights, are the solvers' matter.
TEST(ImpactWaves, LeaveAloneWhatNothingPassesOn) {
  for (Row row : {Row(2, 0.5), Row(4, 0.5, 1.0)}) {
    const std::vector<SolverBody> before = row.bodies;
    ImpactWaves waves;
    waves.pass_on(row.bodies, row.manifolds, row.points, kWaveStep, {});
    EXPECT_TRUE(waves.struck().empty());
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(row.bodies[i].velocity, before[i].velocity);
  }
}

}  // namespace
}  // namespace lodestone
