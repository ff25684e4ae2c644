#include "lod/manager/callers_jobs.h"

#include <atomic>
#include <utility>

namespace lodestone {

void CallersJobs::operator()(std::int64_t count, TaskRef task) {
  std::vector<char> begun = std::exchange(begun_, {});
  begun.assign(std::size_t(count), 0);
  std::atomic<bool> task_threw = false;
  const auto noted = [&](std::int64_t i) {
    begun[std::size_t(i)] = 1;
    try {
      task(i);
    } catch (...) {
      task_threw = true;
      throw;
    }
  };
  try {
    runner_(count, TaskRef(noted));
  } catch (...) {
    if (task_threw) {
      thrown_ = nullptr;  // the step ends here
      throw;
    }
    if (!thrown_) thrown_ = std::current_exception();
    for (std::int64_t i = 0; i < count; ++i)
      if (begun[std::size_t(i)] == 0) task(i);
  }
  begun_ = std::move(begun);
}

void CallersJobs::rethrow() {
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

}  // namespace lodestone
