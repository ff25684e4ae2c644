#include "signature/response_lookup.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "reference/shape.h"
#include "signature/measure/measure.h"

namespace lodestone::response_lookup_test {
namespace {

constexpr double kPi = std::numbers::pi, kNan = std::numeric_limits<double>::quiet_NaN();

SignatureSettings quick_settings() {
  SignatureSettings settings;
  settings.n_theta = 3, settings.n_phi = 3, settings.n_alpha = 4, settings.trials_per_cell = 40,
  settings.n_psi = 4;
  settings.held_out_conditions = 2, settings.height_trials = 20, settings.settling_trials = 2,
  settings.clips = 0;
  return settings;
}

Signature measure_box(const SignatureSettings& settings) {
  return measure_signature(make_shape("box", make_box({0.2, 0.3, 0.4})), settings, 2);
}

TEST(ResponseLookup, FindsCellCentresExactly) {
  const Signature box = measure_box(quick_settings());
  for (std::int64_t cell = 0; cell < box.bouncing.size(); ++cell)
    for (const bool interpolate : {true, false}) {
      const CollisionConfiguration c = box.bouncing.center(cell);
      const FoundResponse bouncing = find_response(box, c, 0.0, interpolate),
                          slow = find_response(box, c, 1e9, interpolate);
      EXPECT_LT((bouncing.mean - box.bouncing.cells.mean[cell]).norm(), 1e-4) << cell;
      EXPECT_LT((slow.mean - box.non_bouncing.cells.mean[cell]).norm(), 1e-4) << cell;
      EXPECT_EQ(bouncing.bouncing_part, 1.0f);
      EXPECT_EQ(slow.bouncing_part, 0.0f);
      EXPECT_FALSE(bouncing.extrapolated);
    }
}

TEST(ResponseLookup, WeightsSumToOneBetweenCells) {
  const Signature box = measure_box(quick_settings());
  for (std::uint32_t i = 0; i < 200; ++i) {
    RandomStream random(1, i, 0);
    const CollisionConfiguration c{random.uniform(0.0, kPi / 2), random.uniform(0.0, kPi),
                                   random.uniform(-7.0, 7.0), random.uniform(), random.uniform()};
    const FoundResponse found = find_response(box, c, 0.05);
    float sum = 0.0f;
    for (int k = 0; k < found.blend.count; ++k) sum += found.blend.weight[k];
    EXPECT_NEAR(sum, 1.0f, 1e-5f);
    CollisionConfiguration turned = c;
    turned.psi += 2.0 * kPi;
    EXPECT_LT((find_response(box, turned, 0.05).mean - found.mean).norm(), 1e-4f);
  }
}

TEST(ResponseLookup, FlagsWhatLiesOutside) {
  SignatureSettings settings = quick_settings();
  const Signature scale_free = measure_box(settings);
  settings.paper_grid = true, settings.n_theta = settings.n_phi = 2;
  const Signature by_speed = measure_box(settings);
  const CollisionConfiguration inside{0.7, 1.0, 0.0, 1.0, 1.0};
  for (const Signature& signature : {scale_free, by_speed}) {
    EXPECT_FALSE(find_response(signature, inside, 0.05).extrapolated);
    for (CollisionConfiguration c :
         {CollisionConfiguration{1.6, 1.0, 0.0, 1.0, 1.0}, CollisionConfiguration{kNan, 1.0, 0.0, 1.0, 1.0},
          CollisionConfiguration{0.7, kNan, kNan, 1.0, 1.0},
          CollisionConfiguration{0.7, 1.0, 0.0, kNan, 1.0}}) {
      const FoundResponse found = find_response(signature, c, 0.05);
      EXPECT_TRUE(found.extrapolated);
      EXPECT_TRUE(found.mean.allFinite());
    }
  }
  const CollisionConfiguration too_fast{0.7, 1.0, 0.0, 100.0, 1.0}, too_slow{0.7, 1.0, 0.0, 0.001, 0.0};
  for (const CollisionConfiguration& c : {too_fast, too_slow}) {
    EXPECT_TRUE(find_response(by_speed, c, 0.05).extrapolated);
    EXPECT_FALSE(find_response(scale_free, c, 0.05).extrapolated);
  }
}

// Moments of many draws at a cell's centre against what the signature holds. Draws into the plane are drawn
// again, so a cell is taken where there are none.
struct DrawnMoments {
  Eigen::Matrix<double, 6, 1> mean = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

DrawnMoments draw_many(const FoundResponse& found, const CollisionConfiguration& c, ResponseDraw draw,
                       int count) {
  std::vector<Eigen::Matrix<double, 6, 1>> all;
  DrawnMoments moments;
  for (int i = 0; i < count; ++i) {
    RandomStream random(2, std::uint64_t(i), 0);
    const DrawnVelocities v = draw_response(found, c, 0.0, draw, random);
    all.push_back((Eigen::Matrix<double, 6, 1>() << v.linear, v.angular).finished());
    moments.mean += all.back() / count;
  }
  for (const auto& x : all)
    moments.covariance += (x - moments.mean) * (x - moments.mean).transpose() / (count - 1);
  return moments;
}

// A table of one cell, its normal speed far from zero.
Signature one_cell(ResponseDraw draw) {
  Signature s;
  s.settings.draw = draw;
  s.bouncing = {1, 1, 1, 1, {}};
  ResponseCells& cells = s.bouncing.cells;
  cells.mean = {(Response() << 9.0f, 0.1f, -0.2f, 0.3f, 0.4f, 0.5f).finished()};
  cells.deviation = {Response::Constant(0.5f)};
  cells.trials = {100};
  cells.approach = {{1.0f, 0.1f}};
  if (draw == ResponseDraw::correlated) {
    ResponseFactor factor{};
    factor[0] = 0.5f;                    // L(0, 0)
    factor[1] = 0.4f, factor[2] = 0.3f;  // L(1, 0), L(1, 1)
    factor[20] = 0.2f;                   // L(5, 5)
    cells.factor = {factor};
  }
  s.non_bouncing = s.bouncing;
  return s;
}

TEST(ResponseDraws, IndependentOnesHaveTheMomentsOfTheTable) {
  const Signature s = one_cell(ResponseDraw::independent);
  const CollisionConfiguration c{0.5, 1.0, 0.0, 1.0, 0.0};
  const DrawnMoments m = draw_many(find_response(s, c, 0.0), c, ResponseDraw::independent, 20'000);
  const Vec3 particle(0.0, std::sin(0.5), 0.0);
  EXPECT_LT((m.mean.head<3>() - particle - s.bouncing.cells.mean[0].head<3>().cast<double>()).norm(),
            4.5 * 0.5 * std::sqrt(3.0 / 20'000));
  EXPECT_LT((m.covariance - 0.25 * Eigen::Matrix<double, 6, 6>::Identity()).cwiseAbs().maxCoeff(),
            0.25 * 0.045);
}

TEST(ResponseDraws, CorrelatedOnesHaveTheWholeCovariance) {
  const Signature s = one_cell(ResponseDraw::correlated);
  const CollisionConfiguration c{0.5, 1.0, 0.0, 1.0, 0.0};
  const DrawnMoments m = draw_many(find_response(s, c, 0.0), c, ResponseDraw::correlated, 20'000);
  EXPECT_NEAR(m.covariance(0, 0), 0.25, 0.01);
  EXPECT_NEAR(m.covariance(1, 0), 0.20, 0.01);
  EXPECT_NEAR(m.covariance(1, 1), 0.25, 0.01);
  EXPECT_NEAR(m.covariance(5, 5), 0.04, 0.002);
  EXPECT_NEAR(m.covariance(3, 3), 0.0, 1e-9);
}

TEST(ResponseDraws, EmpiricalOnesAreTrialsOfTheCell) {
  SignatureSettings settings = quick_settings();
  settings.n_psi = 1, settings.draw = ResponseDraw::empirical;
  const Signature box = measure_box(settings);
  const std::int64_t cell = 1;
  const CollisionConfiguration c = box.bouncing.center(cell);
  const FoundResponse found = find_response(box, c, 0.0, false);
  const DrawnMoments m = draw_many(found, c, ResponseDraw::empirical, 20'000);
  const Vec3 particle(0.0, c.speed * std::sin(c.theta), 0.0);
  const ResponseCells& cells = box.bouncing.cells;
  // Without restitution in V_particle some draws point into the plane and are replaced: compare along the
  // plane and the spin, loosely.
  EXPECT_LT((m.mean.tail<2>() - cells.mean[cell].tail<2>().cast<double>()).norm(), 0.2);
  EXPECT_EQ(cells.first_sample[cell + 1] - cells.first_sample[cell], cells.trials[cell]);
  for (int i = 0; i < 50; ++i) {
    RandomStream random(3, std::uint64_t(i), 0);
    const DrawnVelocities v = draw_response(found, c, 0.0, ResponseDraw::empirical, random);
    double nearest = 1e9;
    for (std::uint32_t k = cells.first_sample[cell]; k < cells.first_sample[cell + 1]; ++k) {
      double distance = 0.0;
      for (int j = 0; j < 3; ++j)
        distance =
            std::max(distance,
                     std::abs(cells.sample[k].response[3 + j] / 32767.0 * cells.sample_range - v.angular[j]));
      nearest = std::min(nearest, distance);
    }
    EXPECT_LT(nearest, 1e-4);
  }
}

TEST(ResponseDraws, NoneMovesIntoThePlane) {
  const Signature box = measure_box(quick_settings());
  for (std::uint32_t i = 0; i < 2000; ++i) {
    RandomStream random(4, i, 0);
    const CollisionConfiguration c{random.uniform(0.0, kPi / 2), random.uniform(0.0, kPi),
                                   random.uniform(0.0, 6.0), random.uniform(), random.uniform()};
    EXPECT_GE(
        draw_response(find_response(box, c, 0.05), c, 0.4, ResponseDraw::independent, random).linear.x(),
        0.0);
  }
}

}  // namespace
}  // namespace lodestone::response_lookup_test
