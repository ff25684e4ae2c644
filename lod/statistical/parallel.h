// A loop over indices on a number of threads. Each index must write only what is its own: then the thread count changes nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace lodestone {

class ParallelFor {
 public:
  explicit ParallelFor(int threads);
  ~ParallelFor();
  /// Calls body(begin, end) on disjoint ranges that cover [0, count), of at least `grain` indices where there are that many.
  void operator()(std::int64_t count, std::int64_t grain, const std::function<void(std::int64_t, std::int64_t)>& body) const;

 private:
  struct Arena;
  std::unique_ptr<Arena> arena_;  // null: one thread
};

}  // namespace lodestone
