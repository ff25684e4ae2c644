// The crowd's solver: one result for every instruction set and number of threads, that of the plain solver
// once converged, momentum kept, no more manifolds side by side than may be.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored \
    "-Wpsabi"  // all is inlined: no such vector is handed from function to function
#endif
#include "lod/contact/crowd_solver.h"

#include <gtest/gtest.h>

#include <numeric>

#include "lod/contact/crowd_lanes.h"
#include "reference/random.h"
#include "tests/lod/contact/plain_solver.h"

namespace lodestone {
namespace {

struct SolverCrowd {
  std::vector<SolverBody> bodies;
  std::vector<CrowdManifold> manifolds;
  std::vector<CrowdPoint> points;

  void add_manifold(std::int32_t first, std::int32_t second, const Vec3& normal, int count,
                    RandomStream& random) {
    manifolds.push_back({first,
                         second,
                         normal,
                         {.restitution = 0.4, .friction = 0.5},
                         std::uint32_t(points.size()),
                         std::uint32_t(count)});
    for (int i = 0; i < count; ++i) {
      CrowdPoint point;
      point.arm_first =
          Vec3(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)) -
          0.1 * normal;
      point.arm_second = point.arm_first + 0.2 * normal;
      point.gap = random.uniform(-1e-3, 1e-3);
      point.guess = random.uniform(0.0, 0.2) * normal;
      points.push_back(point);
    }
  }
};

// Bodies thrown at each other at random, some fixed and some on the ground.
SolverCrowd make_crowd(int bodies, int manifolds, bool ground) {
  RandomStream random(5, 1, 0);
  const auto vector = [&](double size) {
    return Vec3(random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
  };
  SolverCrowd crowd;
  for (int i = 0; i < bodies; ++i) {
    SolverBody body;
    body.velocity = vector(2.0);
    body.angular_velocity = vector(5.0);
    if (i % 9 != 3 || !ground) {
      body.inverse_mass = random.uniform(0.1, 1.0);
      const Vec3 inverse_moments = body.inverse_mass * Vec3(random.uniform(60, 100), random.uniform(60, 100),
                                                            random.uniform(100, 130));
      const Mat3 axes = random.orientation().toRotationMatrix();
      body.inverse_inertia = axes * inverse_moments.asDiagonal() * axes.transpose();
    } else {
      body.velocity.setZero(), body.angular_velocity.setZero();
    }
    crowd.bodies.push_back(body);
  }
  for (int i = 0; i < manifolds; ++i) {
    const auto first = std::int32_t(random.uniform(0, bodies)),
               second = std::int32_t((first + 1 + std::int32_t(random.uniform(0, bodies - 1))) % bodies);
    crowd.add_manifold(first, ground && i % 4 == 0 ? -1 : second, random.orientation() * Vec3::UnitZ(),
                       1 + i % 4, random);
  }
  return crowd;
}

constexpr double kStep = 1.0 / 180.0;

void solve(SolverCrowd& crowd, Simd simd, int threads, const ContactSolverSettings& settings) {
  CrowdSolver(simd).solve(crowd.bodies, crowd.manifolds, crowd.points, kStep, settings,
                          make_job_runner(threads));
}

bool same(const SolverCrowd& a, const SolverCrowd& b) {
  for (std::size_t i = 0; i < a.bodies.size(); ++i)
    if (a.bodies[i].velocity != b.bodies[i].velocity ||
        a.bodies[i].angular_velocity != b.bodies[i].angular_velocity)
      return false;
  for (std::size_t i = 0; i < a.points.size(); ++i)
    if (a.points[i].impulse != b.points[i].impulse || a.points[i].bounces != b.points[i].bounces)
      return false;
  return true;
}

TEST(CrowdSolver, HasOneResultForEveryInstructionSetAndNumberOfThreads) {
  const ContactSolverSettings settings{.sweeps = 10, .tolerance = 1e-3, .fall = {0, 0, -9.81 * kStep}};
  SolverCrowd portable = make_crowd(4'000, 9'000, true);
  const SolverCrowd start = portable;
  solve(portable, Simd::portable, 1, settings);
  EXPECT_FALSE(same(portable, start));
  for (const Simd simd : {Simd::portable, Simd::avx2, Simd::avx512}) {
    if (simd > find_simd()) continue;
    for (const int threads : {1, 2, 3}) {
      SolverCrowd crowd = make_crowd(4'000, 9'000, true);
      solve(crowd, simd, threads, settings);
      EXPECT_TRUE(same(crowd, portable)) << int(simd) << ' ' << threads;
    }
  }
}

// The same contacts for the plain solver.
std::vector<PlainContact> plain_contacts(const SolverCrowd& crowd) {
  std::vector<PlainContact> contacts;
  for (const CrowdManifold& m : crowd.manifolds)
    for (const CrowdPoint& point : std::span(crowd.points).subspan(m.begin, m.count)) {
      PlainContact& c = contacts.emplace_back();
      c.first = m.first, c.second = m.second, c.normal = m.normal, c.law = m.law;
      c.arm_first = point.arm_first, c.arm_second = point.arm_second, c.gap = point.gap,
      c.guess = point.guess;
    }
  return contacts;
}

// A chain has one answer, whatever the order: bodies in a row, the first on the ground.
TEST(CrowdSolver, FindsWhatThePlainSolverFinds) {
  RandomStream random(5, 2, 0);
  SolverCrowd crowd = make_crowd(60, 0, false);
  for (int i = 0; i < 60; ++i) crowd.add_manifold(i, i - 1, random.orientation() * Vec3::UnitZ(), 3, random);
  for (CrowdManifold& m : crowd.manifolds) m.law.friction = 0.0;
  std::vector<PlainContact> contacts = plain_contacts(crowd);
  std::vector<SolverBody> bodies = crowd.bodies;
  const ContactSolverSettings settings{.sweeps = 3'000, .tolerance = 1e-13};
  solve_plainly(bodies, contacts, kStep, settings);
  const auto expect_same = [&](const SolverCrowd& solved, double most) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      EXPECT_LT((solved.bodies[i].velocity - bodies[i].velocity).norm(), most) << i;
      EXPECT_LT((solved.bodies[i].angular_velocity - bodies[i].angular_velocity).norm(), 10 * most) << i;
    }
  };
  SolverCrowd of_floats = crowd;
  solve(of_floats, find_simd(), 1, settings);
  expect_same(of_floats, 2e-3);  // of 2 m/s: 2e-4 as g++ orders the sums, 1.2e-3 as clang does
  std::vector<std::uint32_t> all(crowd.manifolds.size());
  std::iota(all.begin(), all.end(), 0U);
  const CrowdContacts given{crowd.bodies, crowd.manifolds, crowd.points, kStep, settings};
  const JobRunner jobs = make_job_runner(1);
  lane::CrowdLanes<lane::D4> of_doubles(find_simd());
  of_doubles.take(given, all, jobs);
  of_doubles.sweep(lane::GuessesGiven<lane::D4>{}, jobs);
  for (int i = 0; i < settings.sweeps; ++i) of_doubles.sweep(lane::Relaxation<lane::D4>{}, jobs);
  of_doubles.hand_out(given, jobs);
  expect_same(crowd, 1e-9);
}

TEST(CrowdSolver, KeepsMomentumAndBoundsFriction) {
  SolverCrowd crowd = make_crowd(60, 150, false);
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (const SolverBody& body : crowd.bodies) sum += body.velocity / body.inverse_mass;
    return sum;
  };
  const Vec3 before = momentum();
  solve(crowd, find_simd(), 1, {});
  EXPECT_LT((momentum() - before).norm(), 1e-11);
  int pressing = 0;
  for (const CrowdManifold& m : crowd.manifolds)
    for (const CrowdPoint& point : std::span(crowd.points).subspan(m.begin, m.count)) {
      const double normal = point.impulse.dot(m.normal);
      EXPECT_GE(normal, 0.0);
      EXPECT_LE((point.impulse - normal * m.normal).norm(),
                std::sqrt(2.0) * m.law.friction * normal * (1.0 + 1e-6) +
                    1e-12);  // a bound along each of two axes, of floats
      pressing += normal > 0.0;
    }
  EXPECT_GT(pressing, 20);
}

// Dust and planets: floats hold neither of their masses.
TEST(CrowdSolver, SolvesMassesThatFloatsDoNotHold) {
  const auto solved = [](double mass) {
    SolverCrowd crowd = make_crowd(60, 150, true);
    for (SolverBody& body : crowd.bodies) body.inverse_mass /= mass, body.inverse_inertia /= mass;
    for (CrowdPoint& point : crowd.points) point.guess *= mass;
    solve(crowd, find_simd(), 1, {});
    return crowd;
  };
  const SolverCrowd usual = solved(1.0);
  for (const double mass : {1e-60, 1e60}) {
    const SolverCrowd crowd = solved(mass);
    for (std::size_t i = 0; i < usual.bodies.size(); ++i)
      EXPECT_LT((crowd.bodies[i].velocity - usual.bodies[i].velocity).norm(), 1e-3) << mass;
  }
}

// As a material may say.
TEST(CrowdSolver, SolvesFrictionThatFloatsDoNotHold) {
  const auto solved = [](double friction) {
    SolverCrowd crowd = make_crowd(60, 150, true);
    for (CrowdManifold& m : crowd.manifolds) m.law.friction = friction;
    solve(crowd, find_simd(), 1, {});
    return crowd;
  };
  const SolverCrowd endless = solved(1e100), great = solved(1e12);
  for (std::size_t i = 0; i < great.bodies.size(); ++i)
    EXPECT_EQ(endless.bodies[i].velocity, great.bodies[i].velocity) << i;
}

// Whose impulses, known from the step before, hardly change any more.
TEST(CrowdSolver, AHeavyCrowdElsewhereEndsNoSweeps) {
  const ContactSolverSettings settings{.sweeps = 200, .tolerance = 1e-3, .fall = {0, 0, -9.81 * kStep}};
  SolverCrowd light = make_crowd(40, 90, true), heavy = light;
  for (SolverBody& body : heavy.bodies) body.inverse_mass *= 1e-6, body.inverse_inertia *= 1e-6;
  for (CrowdManifold& m : heavy.manifolds) m.law.restitution = 0.0;
  SolverCrowd solved = heavy;
  solve(solved, find_simd(), 1, {.sweeps = 3'000, .tolerance = 0.0, .bounce_velocity = 100.0});
  for (std::size_t i = 0; i < heavy.points.size(); ++i) heavy.points[i].guess = solved.points[i].impulse;
  SolverCrowd both = light;
  for (CrowdManifold m : heavy.manifolds) {
    const auto bodies = std::int32_t(light.bodies.size());
    m.first += bodies, m.second += m.second < 0 ? 0 : bodies;
    m.begin += std::uint32_t(light.points.size());
    both.manifolds.push_back(m);
  }
  both.bodies.insert(both.bodies.end(), heavy.bodies.begin(), heavy.bodies.end());
  both.points.insert(both.points.end(), heavy.points.begin(), heavy.points.end());
  ContactSolverSettings without_bounces = settings;
  without_bounces.bounce_velocity = 100.0;
  solve(light, find_simd(), 1, without_bounces);
  solve(both, find_simd(), 1, without_bounces);
  for (std::size_t i = 0; i < light.bodies.size(); ++i)
    EXPECT_LT((both.bodies[i].velocity - light.bodies[i].velocity).norm(), 0.01) << i;
}

// More contacts of one body than there are colours.
TEST(CrowdSolver, HoldsUpABodyOnTwoHundredContacts) {
  RandomStream random(5, 3, 0);
  SolverCrowd crowd = make_crowd(2, 0, false);
  crowd.bodies[0].velocity = {0, 0, -1};
  crowd.bodies[1].velocity = {0, 0, 1};  // leaves it
  for (SolverBody& body : crowd.bodies) body.angular_velocity.setZero();
  for (int i = 0; i < 200; ++i) crowd.add_manifold(0, -1, Vec3::UnitZ(), 1, random);
  crowd.add_manifold(1, 0, Vec3::UnitZ(), 1, random);
  for (CrowdManifold& m : crowd.manifolds) m.law.restitution = 0.0;
  for (CrowdPoint& point : crowd.points) point.guess.setZero(), point.gap = 0.0;
  solve(crowd, find_simd(), 2, {.sweeps = 2'000, .tolerance = 1e-12});
  EXPECT_NEAR(crowd.bodies[0].velocity.z(), 0.0, 1e-6);
}

// On the ground, with nothing known from a step before.
TEST(CrowdSolver, CarriesAWeightThroughALightBody) {
  for (const double ratio : {100.0, 1e3, 1e4}) {
    SolverCrowd crowd;
    for (const double mass : {1.0, ratio}) {
      SolverBody body;
      body.inverse_mass = 1.0 / mass;
      body.inverse_inertia = Mat3::Identity() * (10.0 / mass);
      body.velocity = Vec3(0, 0, -9.81 * kStep);
      crowd.bodies.push_back(body);
    }
    crowd.manifolds.push_back({0, -1, Vec3::UnitZ(), {.restitution = 0.0, .friction = 0.5}, 0, 1});
    crowd.manifolds.push_back({1, 0, Vec3::UnitZ(), {.restitution = 0.0, .friction = 0.5}, 1, 1});
    crowd.points.resize(2);
    crowd.points[0].arm_first = crowd.points[1].arm_first = Vec3(0, 0, -0.1);
    crowd.points[1].arm_second = Vec3(0, 0, 0.1);
    solve(crowd, find_simd(), 1, {.fall = Vec3(0, 0, -9.81 * kStep)});
    const double left = -crowd.bodies[1].velocity.z() / (9.81 * kStep);
    EXPECT_LT(left, 0.02) << "of the weight's fall in a step, ratio " << ratio;
    EXPECT_GT(left, -0.02) << "ratio " << ratio;
  }
}

// Of two points of one pair, on a line that is askew to their normals, no motion closes the one and not the
// other as they ask: sweeps went on to press them against each other until friction gave way.
TEST(CrowdSolver, PointsThatNoMotionSatisfiesDoNotPressEachOther) {
  SolverCrowd crowd;
  for (const double mass : {1.0, 100.0}) {
    SolverBody body;
    body.inverse_mass = 1.0 / mass;
    body.inverse_inertia = Mat3::Identity() * (100.0 / mass);
    crowd.bodies.push_back(body);
  }
  crowd.bodies[1].velocity = {0, 0, -0.05};
  crowd.manifolds.push_back({1, 0, Vec3::UnitZ(), {.restitution = 0.0, .friction = 2.0}, 0, 2});
  crowd.points.resize(2);
  const Vec3 along(0.1, 0, 0.05);
  for (int i = 0; i < 2; ++i) {
    CrowdPoint& point = crowd.points[std::size_t(i)];
    point.arm_first = (i - 0.5) * along - 0.1 * Vec3::UnitZ();
    point.arm_second = point.arm_first + 0.2 * Vec3::UnitZ();
    point.gap = 1e-6 * i;
  }
  solve(crowd, find_simd(), 1, {.fall = Vec3(0, 0, -9.81 * kStep)});
  const Vec3 sum = crowd.points[0].impulse + crowd.points[1].impulse;
  EXPECT_NEAR(sum.z(), 0.05, 0.001);  // N s
  for (const CrowdPoint& point : crowd.points)
    EXPECT_LT(std::abs(point.impulse.x()), 0.4 * sum.z()) << point.impulse.transpose();
}

// What does not hang together with a weight is solved as without it.
TEST(CrowdSolver, AWeightChangesNothingElsewhere) {
  SolverCrowd plain = make_crowd(40, 90, true);
  SolverCrowd beside = plain;
  SolverBody light, heavy;
  light.inverse_mass = 1.0, heavy.inverse_mass = 1e-3;
  light.inverse_inertia = heavy.inverse_inertia = Mat3::Identity();
  heavy.velocity = Vec3(0, 0, -1);
  const auto number = std::int32_t(beside.bodies.size());
  beside.bodies.push_back(light), beside.bodies.push_back(heavy);
  beside.manifolds.push_back({number + 1,
                              number,
                              Vec3::UnitZ(),
                              {.restitution = 0.0, .friction = 0.5},
                              std::uint32_t(beside.points.size()),
                              1});
  beside.points.emplace_back();
  const ContactSolverSettings settings{.sweeps = 10, .tolerance = 0.0};
  solve(plain, find_simd(), 1, settings);
  solve(beside, find_simd(), 1, settings);
  for (std::size_t i = 0; i < plain.bodies.size(); ++i)
    EXPECT_EQ(plain.bodies[i].velocity, beside.bodies[i].velocity) << i;
  EXPECT_GT(beside.bodies[std::size_t(number) + 1].velocity.z(), -1.0);
}

}  // namespace
}  // namespace lodestone
