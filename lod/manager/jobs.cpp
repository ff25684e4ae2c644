#include "lod/jobs.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <memory>

namespace lodestone {

JobRunner make_job_runner(int threads) {
  if (threads <= 1)
    return [](std::int64_t count, TaskRef task) {
      for (std::int64_t i = 0; i < count; ++i) task(i);
    };
  return [arena = std::make_shared<tbb::task_arena>(threads)](std::int64_t count, TaskRef task) {
    if (count == 1) return task(0);
    arena->execute([&] { tbb::parallel_for(std::int64_t(0), count, task); });
  };
}

}  // namespace lodestone
