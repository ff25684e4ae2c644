// Signatures had by a thread of their own, one after the other, while the bodies that need them are simulated full.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

#include "reference/material.h"
#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

using FutureSignature = std::shared_future<std::shared_ptr<const Signature>>;

class BackgroundSignatures {
 public:
  /// Given to the thread; what it throws comes out of the future. It returns soon once the token is stopped.
  using Source = std::function<std::shared_ptr<const Signature>(const Shape&, const ContactLaw&, std::stop_token)>;
  explicit BackgroundSignatures(Source source);
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
  std::jthread thread_;  // last: it uses the others
};

}  // namespace lodestone
