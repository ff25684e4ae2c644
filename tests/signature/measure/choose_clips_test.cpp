#include "signature/measure/choose_clips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/random.h"
#include "signature/measure/settling_trial.h"

namespace lodestone {
namespace {

// Of 400 records a fifth end upright, the others on their side; they last 2 to 80 frames and go the farther
// the longer they last.
std::vector<SettlingRecord> two_poses() {
  RandomStream random(7, 0, 0);
  std::vector<SettlingRecord> records(400);
  for (SettlingRecord& r : records) {
    r.rests = true;
    r.normal = random.uniform() < 0.2 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
    r.states.resize(std::size_t(2.0 + 78.0 * std::pow(random.uniform(), 3.0)));
    r.states.back().position.x() = 0.01 * double(r.states.size()) * random.uniform();
  }
  return records;
}

const std::vector<RestPose> kPoses = {{{1, 0, 0}, 0.5, 0.8, 0.0}, {{0, 0, 1}, 0.5, 0.2, 0.0}};

double mean_of(const std::vector<SettlingRecord>& records, const std::vector<std::size_t>& of, auto what) {
  double sum = 0.0;
  for (const std::size_t i : of) sum += what(records[i]);
  return sum / double(of.size());
}

TEST(ChooseClips, FewStandForMany) {
  const auto records = two_poses();
  std::vector<std::size_t> all(records.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  const auto chosen = choose_clips(records, kPoses, 40);
  ASSERT_EQ(chosen.size(), 40u);
  EXPECT_TRUE(std::ranges::is_sorted(chosen));
  EXPECT_EQ(std::ranges::adjacent_find(chosen), chosen.end());
  const auto upright = [](const SettlingRecord& r) { return r.normal.z(); };
  const auto duration = [](const SettlingRecord& r) { return double(r.states.size()); };
  const auto travel = [](const SettlingRecord& r) { return r.states.back().position.x(); };
  EXPECT_DOUBLE_EQ(mean_of(records, chosen, upright), 0.2);
  // Forty at random would be off by 15 % in each.
  EXPECT_NEAR(mean_of(records, chosen, duration) / mean_of(records, all, duration), 1.0, 0.06);
  EXPECT_NEAR(mean_of(records, chosen, travel) / mean_of(records, all, travel), 1.0, 0.06);
}

TEST(ChooseClips, NeverMoreThanThereAre) {
  auto records = two_poses();
  for (std::size_t i = 10; i < records.size(); ++i) records[i].states.clear();  // only their pose is known
  const auto chosen = choose_clips(records, kPoses, 40);
  EXPECT_EQ(chosen.size(), 10u);
  EXPECT_TRUE(choose_clips(records, kPoses, 0).empty());
  EXPECT_TRUE(choose_clips({}, kPoses, 40).empty());
}

}  // namespace
}  // namespace lodestone
