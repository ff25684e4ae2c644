// How the work of a step is spread over threads: by oneTBB, or by an engine's own jobs. The results do not
// depend on it.
#pragma once

#include <cstdint>
#include <functional>

namespace lodestone {

/// A reference to a function of an index: cheap to copy, without an allocation. The function must outlive it.
class TaskRef {
 public:
  template <class Function>
  TaskRef(const Function& function)  // as a string_view takes a string
      : context_(&function), call_([](const void* context, std::int64_t index) {
          (*static_cast<const Function*>(context))(index);
        }) {}
  void operator()(std::int64_t index) const { call_(context_, index); }

 private:
  const void* context_;
  void (*call_)(const void*, std::int64_t);
};

/// Must call task(0) … task(count − 1), each once, in any order and on any threads, and return when all are
/// done.
using JobRunner = std::function<void(std::int64_t count, TaskRef task)>;

/// Calls body(begin, end) for the pieces of [0, count), of `grain` indices each (> 0; the last may have
/// fewer). A single piece is done by the calling thread, without `jobs`.
template <class Body>
void run_in_pieces(const JobRunner& jobs, std::int64_t count, std::int64_t grain, const Body& body) {
  if (count <= grain) return count > 0 ? body(std::int64_t(0), count) : void();
  jobs((count + grain - 1) / grain, TaskRef([&](std::int64_t piece) {
         body(piece * grain, piece * grain + grain < count ? piece * grain + grain : count);
       }));
}

/// A runner that uses at most `threads` threads of oneTBB; for 1 or less, the calling thread alone.
JobRunner make_job_runner(int threads);

}  // namespace lodestone
