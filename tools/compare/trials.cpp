#include "tools/compare/trials.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <mutex>

#include "reference/allowed_threads.h"
#include "tools/interrupt.h"

namespace lodestone {

void run_trials(int count, int threads, const std::function<void(int)>& run,
                const std::function<void(double)>& progress) {
  std::mutex mutex;
  int done = 0;
  const auto run_one = [&](int trial) {
    throw_if_interrupted();
    run(trial);
    const std::scoped_lock lock(mutex);
    if (progress) progress(double(++done) / count);
  };
  tbb::task_arena arena(allowed_threads(threads));
  arena.execute([&] { tbb::parallel_for(0, count, run_one, tbb::simple_partitioner()); });
}

}  // namespace lodestone
