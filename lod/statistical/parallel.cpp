#include "lod/statistical/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace lodestone {

struct ParallelFor::Arena {
  tbb::task_arena arena;
};

ParallelFor::ParallelFor(int threads) {
  if (threads > 1) arena_ = std::make_unique<Arena>(Arena{tbb::task_arena(threads)});
}
ParallelFor::~ParallelFor() = default;

void ParallelFor::operator()(std::int64_t count, std::int64_t grain, const std::function<void(std::int64_t, std::int64_t)>& body) const {
  if (count <= 0) return;
  if (!arena_ || count <= grain) return body(0, count);
  arena_->arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, std::size_t(grain)), [&](const auto& range) { body(range.begin(), range.end()); });
  });
}

}  // namespace lodestone
