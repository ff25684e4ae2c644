#include "lod/manager/background_signatures.h"

namespace lodestone {

BackgroundSignatures::BackgroundSignatures(Source source)
    : source_(std::move(source)), thread_([this](const std::stop_token& stop) { work(stop); }) {}

BackgroundSignatures::~BackgroundSignatures() = default;

// The thread has its own copy of the shape: the body that asked may be gone before it is done.
FutureSignature BackgroundSignatures::request(const Shape& shape, const ContactLaw& law) {
  Task task([this, shape, law](std::stop_token stop) { return source_(shape, law, std::move(stop)); });
  FutureSignature future = task.get_future().share();
  const std::lock_guard lock(mutex_);
  tasks_.push_back(std::move(task));
  more_.notify_one();
  return future;
}

void BackgroundSignatures::work(const std::stop_token& stop) {
  for (;;) {
    std::unique_lock lock(mutex_);
    if (!more_.wait(lock, stop, [this] { return !tasks_.empty(); })) return;
    Task task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    if (stop.stop_requested()) return;
    task(stop);
  }
}

}  // namespace lodestone
