// Signatures had by threads of their own, of the lowest priority, while the bodies that need them are
// simulated without.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "reference/material.h"
#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

using FutureSignature = std::shared_future<std::shared_ptr<const Signature>>;

class BackgroundSignatures {
 public:
  /// Given to a thread; what it throws comes out of the future. It returns soon once the token is stopped.
  using Source =
      std::function<std::shared_ptr<const Signature>(const Shape&, const ContactLaw&, std::stop_token)>;
  /// So many threads at most; each begins with the first request that finds the others busy.
  BackgroundSignatures(int most_threads, Source source);
  /// Stops the source and waits for it.
  ~BackgroundSignatures();

  FutureSignature request(const Shape& shape, const ContactLaw& law);

 private:
  using Task = std::packaged_task<std::shared_ptr<const Signature>(std::stop_token)>;
  void work(const std::stop_token& stop);

  Source source_;
  std::mutex mutex_;
  std::condition_variable_any more_;
  std::deque<Task> tasks_;
  std::size_t most_threads_;
  std::size_t idle_ = 0;               // threads that wait for a task
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace lodestone
