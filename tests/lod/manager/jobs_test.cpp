#include "lod/jobs.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <thread>

namespace lodestone {
namespace {

TEST(Jobs, EachIndexIsDoneOnceOnAnyNumberOfThreads) {
  for (const int threads : {0, 1, 2, 4}) {
    const JobRunner jobs = make_job_runner(threads);
    for (const std::int64_t count : {0, 1, 2, 17, 1000}) {
      std::vector<std::atomic<int>> times(static_cast<std::size_t>(count));
      jobs(count, [&](std::int64_t i) { ++times[std::size_t(i)]; });
      for (const auto& done : times) EXPECT_EQ(done, 1) << threads << ' ' << count;
    }
  }
}

TEST(Jobs, OneThreadIsTheCallersOwnAndInOrder) {
  const auto self = std::this_thread::get_id();
  std::vector<std::int64_t> order;
  make_job_runner(1)(5, [&](std::int64_t i) {
    EXPECT_EQ(std::this_thread::get_id(), self);
    order.push_back(i);
  });
  EXPECT_EQ(order, (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
}

TEST(Jobs, NeverOnMoreThreadsThanAsked) {
  for (const int threads : {2, 3}) {
    const JobRunner jobs = make_job_runner(threads);
    std::atomic<int> now = 0, most = 0;
    jobs(200, [&](std::int64_t) {
      const int here = ++now;
      for (int seen = most; seen < here && !most.compare_exchange_weak(seen, here);) {
      }
      --now;
    });
    EXPECT_LE(most, threads);
  }
}

TEST(Jobs, WhenItReturnsAllIsDone) {
  const JobRunner jobs = make_job_runner(4);
  for (int round = 0; round < 50; ++round) {
    std::vector<int> plain(100, 0);  // seen without a lock
    jobs(100, [&](std::int64_t i) { plain[std::size_t(i)] = int(i) + round; });
    for (int i = 0; i < 100; ++i) ASSERT_EQ(plain[std::size_t(i)], i + round);
  }
}

TEST(RunInPieces, CoversTheRangeOnceWhateverTheGrain) {
  const JobRunner one = make_job_runner(1);
  for (const std::int64_t count : {0, 1, 9, 10, 11, 100})
    for (const std::int64_t grain : {1, 3, 10, 1000}) {
      std::vector<int> times(std::size_t(count), 0);
      int pieces = 0;
      run_in_pieces(one, count, grain, [&](std::int64_t begin, std::int64_t end) {
        ++pieces;
        EXPECT_LT(begin, end);
        EXPECT_LE(end - begin, grain);
        for (std::int64_t i = begin; i < end; ++i) ++times[std::size_t(i)];
      });
      EXPECT_EQ(pieces, (count + grain - 1) / grain);
      for (const int done : times) EXPECT_EQ(done, 1);
    }
}

}  // namespace
}  // namespace lodestone
