#include "signature/measure/measure.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "signature/response_lookup.h"
#include "signature/signature_file.h"

namespace lodestone {
namespace {

SignatureSettings quick_settings() {
  SignatureSettings settings;
  settings.n_theta = 3, settings.n_phi = 3, settings.n_alpha = 8, settings.trials_per_cell = 24;
  settings.held_out_conditions = 40, settings.height_trials = 50, settings.settling_trials = 24,
  settings.clips = 8;
  return settings;
}

Shape make_test_box() { return make_shape("box", make_box({0.2, 0.3, 0.4})); }

std::vector<std::byte> bytes_of(Signature signature) {
  signature.measuring_seconds = 0.0;
  return encode_signature(signature);
}

TEST(Measure, TheSameForEveryThreadCountAndScale) {
  const Signature one = measure_signature(make_test_box(), quick_settings(), 1),
                  two = measure_signature(make_test_box(), quick_settings(), 2);
  EXPECT_EQ(bytes_of(one), bytes_of(two));
  const Signature larger =
      measure_signature(make_shape("box", make_box({2.0, 3.0, 4.0})), quick_settings(), 2);
  for (std::size_t cell = 0; cell < one.bouncing.cells.mean.size();
       ++cell)  // scaled copies differ by rounding only
    EXPECT_LT((one.bouncing.cells.mean[cell] - larger.bouncing.cells.mean[cell]).norm(), 0.05) << cell;
}

TEST(Measure, SharesPutTogetherGiveTheSameBytes) {
  for (const bool paper_grid : {false, true}) {
    SignatureSettings settings = quick_settings();
    settings.n_theta = settings.n_phi = 1, settings.paper_grid = paper_grid,
    settings.draw = ResponseDraw::empirical;
    const Shape box = make_test_box();
    std::vector<Measurement> shares;
    for (const int i : {2, 0, 1}) shares.push_back(measure_units(box, settings, {i, 3}, {.threads = 1}));
    EXPECT_EQ(bytes_of(make_signature(box, settings, merge_measurements(shares))),
              bytes_of(measure_signature(box, settings, 2)));
  }
}

TEST(Measure, SphereHasOneHeight) {
  const Signature sphere = measure_signature(make_sphere_shape(0.1), quick_settings(), 2);
  for (std::size_t i = 0; i < sphere.collision_heights.mean.size(); ++i) {
    EXPECT_NEAR(sphere.collision_heights.mean[i], 1.0, 1e-5);
    EXPECT_LT(sphere.collision_heights.deviation[i], 1e-3);
  }
}

TEST(Measure, SphereHasNoSpreadWhereTheAzimuthIsKnown) {
  SignatureSettings settings = quick_settings();
  settings.n_psi = 4, settings.trials_per_cell = 3;
  const Signature sphere = measure_signature(make_sphere_shape(0.1), settings, 2);
  for (const ResponseTable& table : {sphere.bouncing, sphere.non_bouncing})
    for (const Response& deviation : table.cells.deviation) EXPECT_LT(deviation.maxCoeff(), 1e-4f);
}

TEST(Measure, CollisionHeightGrowsWithSpin) {
  const CollisionHeights heights = measure_signature(make_test_box(), quick_settings(), 2).collision_heights;
  EXPECT_GT(heights.mean.back(), heights.mean.front());
  for (const float h : heights.mean) {
    EXPECT_GT(h, 0.1 / std::sqrt(0.01 + 0.0225 + 0.04) - 1e-3);  // the shortest half side over R
    EXPECT_LE(h, 1.0f + 1e-5f);
  }
}

// How far the scale-free tables are from the paper's own, at the cells of the latter between two speeds: the
// mean square of the difference over what sampling explains, and the root of what it does not explain, over
// s.
struct Disagreement {
  double over_sampling = 0.0, unexplained = 0.0;
};

Disagreement compare_tables(const Signature& scale_free, const Signature& by_speed, double slowest,
                            double fastest, double bounce_velocity) {
  double over_sampling = 0.0, unexplained = 0.0;
  int count = 0;
  const SpeedTable& table = by_speed.by_speed;
  for (std::int64_t cell = 0; cell < table.size(); ++cell) {
    const CollisionConfiguration c = table.center(cell);
    if (c.speed < slowest || c.speed > fastest) continue;
    const FoundResponse found = find_response(scale_free, c, bounce_velocity);
    Response mean = found.mean;  // relative to a V_particle that bounces in part; the paper's always does
    mean[0] -= float((1.0 - found.bouncing_part) * by_speed.settings.law.restitution * c.speed /
                     c.speed_unit() * std::cos(c.theta));
    const Response difference = mean - table.cells.mean[cell];
    const Response variance = (table.cells.deviation[cell].cwiseAbs2() / float(table.cells.trials[cell])) +
                              (found.deviation.cwiseAbs2() / float(scale_free.settings.trials_per_cell));
    for (int i = 0; i < 6; ++i) {
      if (variance[i] < 1e-7f) continue;
      over_sampling += difference[i] * difference[i] / variance[i];
      unexplained += difference[i] * difference[i] - variance[i];
      ++count;
    }
  }
  return {over_sampling / count, std::sqrt(std::max(0.0, unexplained / count))};
}

TEST(Measure, ScaleFreeTablesAgreeWithThePapersOnBothSidesOfBounceVel) {
  SignatureSettings settings = quick_settings();
  settings.n_alpha = 16, settings.trials_per_cell = 100, settings.trial_end = TrialEnd::first_impulse;
  const Signature scale_free = measure_signature(make_test_box(), settings);
  settings.paper_grid = true;
  const Signature by_speed = measure_signature(make_test_box(), settings);

  const Disagreement above = compare_tables(scale_free, by_speed, 0.2, 100.0, 0.05);
  EXPECT_NEAR(above.over_sampling, 1.0, 0.15);
  EXPECT_LT(above.unexplained, 0.01);
  const Disagreement across = compare_tables(scale_free, by_speed, 0.0, 0.2, 0.05);
  const Disagreement without_companion = compare_tables(scale_free, by_speed, 0.0, 0.2, 0.0);
  EXPECT_LT(across.over_sampling, 1.7);
  EXPECT_LT(across.unexplained, 0.02);
  EXPECT_GT(without_companion.unexplained, 2.0 * across.unexplained)
      << without_companion.over_sampling << " " << across.over_sampling;
}

TEST(Measure, TableErrorIsMetWithFewerTrialsThanAUniformGridTakes) {
  SignatureSettings settings = quick_settings();
  settings.table_error = 0.03;
  const Signature signature = measure_signature(make_test_box(), settings);
  for (const TableCertificate& c : {signature.bouncing_certificate, signature.non_bouncing_certificate}) {
    EXPECT_LE(c.greatest_standard_error, 0.03 * 1.0001);
    EXPECT_LT(c.fewest_trials, c.most_trials);
    EXPECT_LT(double(c.trials), 0.8 * c.uniform_trials);
  }
}

TEST(Measure, CertificateSaysHowDrawsDifferFromTrialsOutsideTheTable) {
  SignatureSettings settings = quick_settings();
  settings.held_out_conditions = 200, settings.trials_per_cell = 60;
  std::array<double, 3> ks{};
  for (const ResponseDraw draw :
       {ResponseDraw::independent, ResponseDraw::correlated, ResponseDraw::empirical}) {
    settings.draw = draw;
    const TableCertificate c = measure_signature(make_test_box(), settings).bouncing_certificate;
    EXPECT_EQ(c.held_out, 200u * 16u);
    EXPECT_GT(c.held_out_error, 0.0);
    EXPECT_LT(c.held_out_error, 0.1);
    EXPECT_LE(c.energy_ratio, c.energy_ratio_first);
    EXPECT_LT(c.into_plane, 0.01);
    EXPECT_GT(c.into_plane_first, 0.2);
    ks[std::size_t(draw)] = c.held_out_ks;
  }
  EXPECT_LT(ks[2], 0.5 * ks[0]);  // the trials themselves against Gaussians
  EXPECT_LT(ks[2], 0.06);
}

}  // namespace
}  // namespace lodestone
