#include "tools/compare/trials.h"

#include <gtest/gtest.h>

#include <atomic>

namespace lodestone {
namespace {

TEST(Trials, EachIsRunOnceWhateverTheThreads) {
  for (const int threads : {1, 3}) {
    std::vector<std::atomic<int>> runs(50);
    double done = 0.0;
    run_trials(
        50, threads, [&](int trial) { ++runs[std::size_t(trial)]; },
        [&](double fraction) {
          EXPECT_GT(fraction, done);
          done = fraction;
        });
    for (const auto& count : runs) EXPECT_EQ(count, 1);
    EXPECT_EQ(done, 1.0);
  }
}

class Watched : public ::testing::Test {
 protected:
  std::vector<double> times_of(double dt, double horizon_s) {
    std::vector<double> times;
    watch(world_, dt, horizon_s, [&](double time_s) {
      times.push_back(time_s);
      return times.size() < 100;
    });
    return times;
  }

 private:
  DropJob job_{
      .shape = std::make_shared<const Shape>(make_sphere_shape(0.1)), .conditions = {}, .material = {}};
  Method method_ = make_truth(job_);
  RigidState start_;
  MethodWorld world_{job_, method_, {}, {&start_, 1}};
};

TEST_F(Watched, ShortStepsAreSeenAtEachSixtieth) {
  const std::vector<double> times = times_of(1.0 / 240.0, 0.1);
  ASSERT_EQ(times.size(), 7U);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], double(i) / 60.0, 1e-12);
}

TEST_F(Watched, LongStepsAreSeenOnceEach) {
  const std::vector<double> times = times_of(0.05, 0.2);
  ASSERT_EQ(times.size(), 5U);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], 0.05 * double(i), 1e-12);
}

TEST_F(Watched, ItEndsWhereTheLookerHasSeenEnough) { EXPECT_EQ(times_of(1.0 / 60.0, 10.0).size(), 100U); }

}  // namespace
}  // namespace lodestone
