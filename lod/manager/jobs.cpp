#include "lod/jobs.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "reference/allowed_threads.h"
#include "reference/sanitizers.h"

namespace lodestone {
namespace {

// oneTBB's library is not instrumented: the sanitizer does not see who waits for whom in it.
constexpr bool kOwnThreads = LODESTONE_THREAD_SANITIZER;

/// Threads of its own for each call.
JobRunner make_thread_runner(int threads) {
  return [threads](std::int64_t count, TaskRef task) {
    std::atomic<std::int64_t> next = 0;
    const auto work = [&] {
      for (std::int64_t i; (i = next++) < count;) task(i);
    };
    std::vector<std::jthread> others;
    for (std::int64_t i = 1; i < std::min<std::int64_t>(threads, count); ++i) others.emplace_back(work);
    work();
  };
}

}  // namespace

JobRunner make_job_runner(int threads) {
  if (threads <= 1)
    return [](std::int64_t count, TaskRef task) {
      for (std::int64_t i = 0; i < count; ++i) task(i);
    };
  if (kOwnThreads) return make_thread_runner(threads);
  return [arena = std::make_shared<tbb::task_arena>(allowed_threads(threads))](std::int64_t count,
                                                                               TaskRef task) {
    if (count == 1) return task(0);
    arena->execute([&] { tbb::parallel_for(std::int64_t(0), count, task); });
  };
}

}  // namespace lodestone
