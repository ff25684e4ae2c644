#include "signature/measure/measurement.h"

#include <gtest/gtest.h>

#include "signature/measure/response_grid.h"

namespace lodestone {
namespace {

SignatureSettings few_units() {
  SignatureSettings settings;
  settings.n_theta = 2, settings.n_phi = 3, settings.n_alpha = 4, settings.n_psi = 5;
  settings.height_samples = 7, settings.settling_trials = 11, settings.held_out_conditions = 3;
  return settings;
}

TEST(Measurement, HasAPlaceForEveryUnit) {
  const Measurement m = make_empty_measurement(few_units());
  EXPECT_EQ(m.heights.size(), 7U);
  EXPECT_EQ(m.bouncing.cells.size(), 120U);
  EXPECT_EQ(m.non_bouncing.cells.size(), 120U);
  EXPECT_EQ(m.bouncing.held_out.size(), 3U);
  EXPECT_EQ(m.settlings.size(), 11U);
  EXPECT_TRUE(m.by_speed.cells.empty());
  SignatureSettings paper = few_units();
  paper.paper_grid = true;
  const Measurement of_paper = make_empty_measurement(paper);
  EXPECT_TRUE(of_paper.bouncing.cells.empty());
  EXPECT_EQ(of_paper.by_speed.cells.size(), std::size_t(2 * 3 * 26 * 16));
}

TEST(Measurement, SharesHoldEveryUnitOnce) {
  for (std::int64_t unit = 0; unit < 20; ++unit) {
    int holders = 0;
    for (int i = 0; i < 3; ++i) holders += Share{i, 3}.holds(unit);
    EXPECT_EQ(holders, 1) << unit;
    EXPECT_TRUE(Share{}.holds(unit));
  }
}

TEST(Measurement, SharesPutTogetherInAnyOrderAreTheWhole) {
  std::vector<Measurement> shares;
  for (const int index : {2, 0, 1}) {
    Measurement& share = shares.emplace_back(make_empty_measurement(few_units(), {index, 3}));
    // What is outside of a share is rubbish here: it must not be taken.
    for (std::size_t i = 0; i < share.heights.size(); ++i)
      share.heights[i].mean = share.share.holds(std::int64_t(i)) ? float(i) : -1.0f;
    for (std::size_t i = 0; i < share.non_bouncing.cells.size(); ++i)
      share.non_bouncing.cells[i].trials = share.share.holds(std::int64_t(i)) ? std::uint32_t(i) : 999u;
    for (std::size_t i = 0; i < share.settlings.size(); ++i)
      share.settlings[i].height = share.share.holds(std::int64_t(i)) ? double(i) : -1.0;
  }
  const Measurement whole = merge_measurements(shares);
  ASSERT_EQ(whole.heights.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(whole.heights[i].mean, float(i));
  for (std::size_t i = 0; i < 120; ++i) EXPECT_EQ(whole.non_bouncing.cells[i].trials, i);
  for (std::size_t i = 0; i < 11; ++i) EXPECT_EQ(whole.settlings[i].height, double(i));
}

// From .02 to 10 m/s, and from 0 or .02 to 5 m/s of the surface, each the same factor apart.
TEST(ResponseGrid, ThePapersSpeedsAreEvenInTheLogarithm) {
  const SpeedTable table = make_speed_grid(few_units());
  ASSERT_EQ(table.speeds.size(), 26U);
  ASSERT_EQ(table.spins.size(), 16U);
  EXPECT_FLOAT_EQ(table.speeds.front(), 0.02f);
  EXPECT_FLOAT_EQ(table.speeds.back(), 10.0f);
  EXPECT_EQ(table.spins[0], 0.0f);
  EXPECT_FLOAT_EQ(table.spins[1], 0.02f);
  EXPECT_FLOAT_EQ(table.spins.back(), 5.0f);
  for (std::size_t i = 1; i < 26; ++i)
    EXPECT_NEAR(table.speeds[i] / table.speeds[i - 1], std::pow(500.0, 1.0 / 25), 1e-5);
}

TEST(ResponseGrid, ThePapersCellsHaveThirtyTrialsOfEveryAzimuth) {
  SignatureSettings settings = few_units();
  settings.trials_per_cell = 77;
  EXPECT_EQ(make_cell_sampling(settings).trials, 77);
  EXPECT_FALSE(make_cell_sampling(settings).every_psi);
  settings.n_psi = 1;
  EXPECT_TRUE(make_cell_sampling(settings).every_psi);
  settings.paper_grid = true, settings.n_psi = 5;
  EXPECT_EQ(make_cell_sampling(settings).trials, 30);
  EXPECT_TRUE(make_cell_sampling(settings).every_psi);
  EXPECT_FALSE(make_cell_sampling(settings).keep_responses);
  settings.draw = ResponseDraw::empirical;
  EXPECT_TRUE(make_cell_sampling(settings).keep_responses);
}

}  // namespace
}  // namespace lodestone
