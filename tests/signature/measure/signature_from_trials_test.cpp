#include "signature/measure/signature_from_trials.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "reference/error.h"
#include "reference/random.h"
#include "signature/measure/collision_vectors.h"
#include "signature/measure/response_grid.h"
#include "signature/signature_file.h"

namespace lodestone::signature_from_trials_test {
namespace {

SignatureSettings quick_settings() {
  SignatureSettings settings;
  settings.n_theta = 2, settings.n_phi = 2, settings.n_alpha = 3, settings.trials_per_cell = 8;
  settings.held_out_conditions = 4, settings.height_trials = 20, settings.settling_trials = 12,
  settings.clips = 3;
  return settings;
}

Shape make_test_box() { return make_shape("box", make_box({0.2, 0.3, 0.4})); }

std::filesystem::path file_for_test() {
  return std::filesystem::temp_directory_path() /
         (std::string("lodestone-") + ::testing::UnitTest::GetInstance()->current_test_info()->name() +
          ".csv");
}

TEST(FindCell, IsTheInverseOfCenter) {
  SignatureSettings settings;
  settings.n_psi = 8;
  const ResponseTable grid = make_response_grid(settings);
  for (std::int64_t cell = 0; cell < grid.size(); ++cell) ASSERT_EQ(grid.find_cell(grid.center(cell)), cell);
  const SpeedTable speeds = make_speed_grid(settings);
  for (std::int64_t cell = 0; cell < speeds.size(); ++cell)
    ASSERT_EQ(speeds.find_cell(speeds.center(cell)), cell);
}

TEST(CollisionVectors, ThereAndBackInAnyFrame) {
  for (std::uint32_t i = 0; i < 200; ++i) {
    RandomStream random(1, i, 0);
    const CollisionConfiguration c{.theta = random.uniform(0.01, 1.5),
                                   .phi = random.uniform(0.1, 3.0),
                                   .psi = random.uniform(0.0, 6.28),
                                   .speed = random.uniform(0.1, 5.0),
                                   .spin = random.uniform(0.1, 5.0)};
    const Response response = Response::NullaryExpr([&] { return float(random.uniform(-1.0, 1.0)); });
    MeasuredCollision collision = collision_with(c, response, 0.3, 0.4);
    const Quat turn = random.orientation();
    for (Vec3* v : {&collision.velocity_before, &collision.angular_velocity_before, &collision.normal,
                    &collision.velocity_after, &collision.angular_velocity_after})
      *v = turn * *v;
    const CollisionConfiguration back = configuration_of(collision, 0.3);
    EXPECT_NEAR(back.theta, c.theta, 1e-9);
    EXPECT_NEAR(back.phi, c.phi, 1e-9);
    EXPECT_NEAR(back.psi, c.psi, 1e-9);
    EXPECT_NEAR(back.speed, c.speed, 1e-9);
    EXPECT_NEAR(back.spin, c.spin, 1e-9);
    EXPECT_LT((response_of(collision, 0.3, 0.4) - response).norm(), 1e-5f);
  }
}

double greatest_difference(const ResponseCells& a, const ResponseCells& b) {
  double greatest = 0.0;
  EXPECT_EQ(a.trials, b.trials);
  for (std::size_t i = 0; i < a.mean.size(); ++i)
    greatest = std::max({greatest, double((a.mean[i] - b.mean[i]).cwiseAbs().maxCoeff()),
                         double((a.deviation[i] - b.deviation[i]).cwiseAbs().maxCoeff())});
  return greatest;
}

// At another size than the one that is measured at, so that no number is copied unchanged.
TEST(SignatureFromTrials, ExportedTrialsGiveTheSameTables) {
  const Shape box = make_test_box();
  for (const bool paper_grid : {false, true}) {
    SignatureSettings settings = quick_settings();
    settings.paper_grid = paper_grid;
    if (paper_grid) settings.n_theta = settings.n_phi = 1;
    const Measurement measurement = measure_units(box, settings, {});
    const Signature ode = make_signature(box, settings, measurement);
    save_trials(list_trials(box, settings, measurement), file_for_test());
    // Other seed: whatever is not taken from the rows differs.
    SignatureSettings other = settings;
    other.seed = 77;
    TrialCoverage coverage;
    const Signature again =
        make_signature_from_trials(box, other, load_trials(file_for_test()), {}, &coverage);
    EXPECT_EQ(coverage.measured_cells, coverage.cells);
    EXPECT_EQ(coverage.left_out, 0);
    EXPECT_TRUE((paper_grid ? ode.by_speed_certificate : ode.bouncing_certificate).knows_first_impulse());
    EXPECT_FALSE(
        (paper_grid ? again.by_speed_certificate : again.bouncing_certificate).knows_first_impulse());
    EXPECT_LT(greatest_difference(ode.bouncing.cells, again.bouncing.cells), 2e-6);
    EXPECT_LT(greatest_difference(ode.non_bouncing.cells, again.non_bouncing.cells), 2e-6);
    EXPECT_LT(greatest_difference(ode.by_speed.cells, again.by_speed.cells), 2e-6);
    const Signature unlike = make_signature(box, other, measure_units(box, other, {}));
    const auto& [a, b] = paper_grid ? std::tie(ode.by_speed.cells, unlike.by_speed.cells)
                                    : std::tie(ode.bouncing.cells, unlike.bouncing.cells);
    EXPECT_GT(greatest_difference(a, b), 0.01);
    ASSERT_EQ(ode.rest_poses.size(), again.rest_poses.size());
    for (std::size_t i = 0; i < ode.rest_poses.size(); ++i) {
      EXPECT_NEAR(ode.rest_poses[i].frequency, again.rest_poses[i].frequency, 1e-12);
      EXPECT_LT((ode.rest_poses[i].normal - again.rest_poses[i].normal).norm(), 1e-6);
      EXPECT_NEAR(ode.rest_poses[i].height, again.rest_poses[i].height,
                  2e-3);  // of a body that ODE lets sink a little
    }
  }
  std::filesystem::remove(file_for_test());
}

TEST(SignatureFromTrials, RowsThatDifferGiveOtherTables) {
  const Shape box = make_test_box();
  MeasuredTrials trials;
  for (int i = 0; i < 5; ++i)
    trials.collisions.push_back(
        {{0.5, 0.0, -1.0}, {0.0, 4.0, 0.1 * i}, Vec3::UnitZ(), {0.4, 0.0, 0.1 * i}, {0.0, 1.0, 0.0}});
  trials.collisions.push_back({{0.5, 0.0, 1.0},
                               {0.0, 4.0, 0.0},
                               Vec3::UnitZ(),
                               {0.4, 0.0, 0.1},
                               {0.0, 1.0, 0.0}});  // away from the plane
  trials.rest_normals = {Vec3::UnitX(), Vec3::UnitX(), -Vec3::UnitZ()};
  TrialCoverage coverage;
  const Signature signature = make_signature_from_trials(box, quick_settings(), trials, {}, &coverage);
  EXPECT_EQ(coverage.collisions, 5);
  EXPECT_EQ(coverage.left_out, 1);
  EXPECT_EQ(coverage.measured_cells, 1);
  const std::int64_t cell = signature.bouncing.find_cell(configuration_of(trials.collisions[2], box.radius));
  EXPECT_EQ(signature.bouncing.cells.trials[std::size_t(cell)], 5U);
  Response mean = Response::Zero();
  for (int i = 0; i < 5; ++i)
    mean +=
        response_of(trials.collisions[std::size_t(i)], box.radius, signature.settings.law.restitution) / 5.0f;
  EXPECT_LT((signature.bouncing.cells.mean[std::size_t(cell)] - mean).norm(), 1e-6f);
  ASSERT_EQ(signature.rest_poses.size(), 2U);
  EXPECT_NEAR(signature.rest_poses[0].frequency, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(signature.rest_poses[0].height, 0.1 / box.radius, 1e-7);
}

// Finite numbers that no float holds over the speed, or that no spread of a cell survives. Compared with what
// is drawn from them, the first were compared for ever.
TEST(SignatureFromTrials, RowsBeyondAllMeasureAreLeftOut) {
  const Vec3 still = Vec3::Zero(), up = Vec3::UnitZ();
  const MeasuredTrials trials{.collisions = {{-1e-30 * up, still, up, 1e20 * up, still},
                                             {-up, still, up, 1e30 * up, still},
                                             {-up, still, up, 0.4 * up, 1e5 * up},
                                             {-1e200 * up, still, up, 1e200 * up, still},
                                             {-up, still, up, 0.4 * up, still}},
                              .rest_normals = {}};
  for (const bool paper_grid : {false, true}) {
    SignatureSettings settings = quick_settings();
    settings.draw = ResponseDraw::empirical;
    settings.paper_grid = paper_grid;
    TrialCoverage coverage;
    const Signature signature = make_signature_from_trials(make_test_box(), settings, trials, {}, &coverage);
    EXPECT_EQ(coverage.left_out, 4);
    EXPECT_EQ(coverage.measured_cells, 1);
    EXPECT_NO_THROW(load_signature(encode_signature(signature)));
  }
}

TEST(MeasuredTrials, WhatIsWrongIsNamedWithItsLine) {
  const auto file = file_for_test();
  save_trials({.collisions = {{}}, .rest_normals = {Vec3::UnitY()}}, file);
  std::string text;
  std::getline(std::ifstream(file), text, '\0');
  const std::string heading = text.substr(0, text.find('\n') + 1);
  EXPECT_EQ(load_trials(file).rest_normals.size(), 1U);
  const auto expect_error = [&](const std::string& content, const std::string& message) {
    std::ofstream(file) << content;
    try {
      load_trials(file);
      ADD_FAILURE() << message;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  };
  expect_error("", ":1: found ''");
  expect_error("kind,x\n", "expected the heading");
  expect_error(heading, "found no row");
  expect_error(heading + "rest,,,,,,,0,0,1,,,,,,\ncollision,1,2\n",
               ":3: found a row of another length, expected 16 columns");
  expect_error(heading + "rest,,,,,,,0,0,2,,,,,,\n", ":2: found a normal of length 2");
  expect_error(heading + "rest,1,,,,,,0,0,1,,,,,,\n", "nothing but a normal");
  expect_error(heading + "drop,,,,,,,0,0,1,,,,,,\n", "found 'drop' in column 1");
  expect_error(heading + "collision,0,0,nan,0,0,0,0,0,1,0,0,0,0,0,0\n",
               "found 'nan' in column 4, expected a finite number");
  expect_error(heading + "collision,0,0,,0,0,0,0,0,1,0,0,0,0,0,0\n", "found '' in column 4");
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace lodestone::signature_from_trials_test
