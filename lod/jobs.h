// How a step's work is spread over threads: oneTBB, or an engine's own jobs. What is computed does not depend
// on it.
#pragma once

#include <cstdint>
#include <functional>

namespace lodestone {

/// A function of an index, by reference: cheap to pass, and nothing is allocated for it. What it refers to
/// must outlive it.
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

/// Calls task(0) … task(count − 1), each once, in any order and on any threads, and returns when all are
/// done.
using JobRunner = std::function<void(std::int64_t count, TaskRef task)>;

/// Calls body(begin, end) for pieces of [0, count), `grain` indices each; at once where there is one only.
template <class Body>
void run_in_pieces(const JobRunner& jobs, std::int64_t count, std::int64_t grain, const Body& body) {
  if (count <= grain) return count > 0 ? body(std::int64_t(0), count) : void();
  jobs((count + grain - 1) / grain, TaskRef([&](std::int64_t piece) {
         body(piece * grain, piece * grain + grain < count ? piece * grain + grain : count);
       }));
}

/// oneTBB's, on at most `threads` threads; one: the caller's own.
JobRunner make_job_runner(int threads);

}  // namespace lodestone
