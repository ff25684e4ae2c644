// A caller's jobs function that throws out of a step leaves work of the step undone, on which the next one
// would stumble. What it left is done here, and what it threw is thrown again once the step has been taken.
#pragma once

#include <exception>
#include <vector>

#include "lod/jobs.h"

namespace lodestone {

class CallersJobs {
 public:
  explicit CallersJobs(JobRunner runner) : runner_(std::move(runner)) {}

  /// As a JobRunner. What a task throws passes through.
  void operator()(std::int64_t count, TaskRef task);
  /// What the caller's function has thrown first since the last call, if it has.
  void rethrow();

 private:
  JobRunner runner_;
  std::exception_ptr thrown_;
  std::vector<char> begun_;  // of each task; kept, so that a warm step allocates nothing
};

}  // namespace lodestone
