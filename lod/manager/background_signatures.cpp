#include "lod/manager/background_signatures.h"

#include <pthread.h>
#include <sched.h>

namespace lodestone {
namespace {

// It runs where nothing else would. Threads that the source starts inherit that.
void take_lowest_priority() {
#ifdef SCHED_IDLE
  const sched_param none{};
  pthread_setschedparam(pthread_self(), SCHED_IDLE,
                        &none);  // where it is not allowed, the priority stays as it is
#endif
}

}  // namespace

BackgroundSignatures::BackgroundSignatures(int most_threads, Source source)
    : source_(std::move(source)), most_threads_(std::size_t(most_threads)) {}

BackgroundSignatures::~BackgroundSignatures() {
  for (std::jthread& thread : threads_) thread.request_stop();  // all before the first is waited for
}

// The thread has its own copy of the shape: the body that asked may be gone before it is done.
FutureSignature BackgroundSignatures::request(const Shape& shape, const ContactLaw& law) {
  Task task([this, shape, law](std::stop_token stop) { return source_(shape, law, std::move(stop)); });
  FutureSignature future = task.get_future().share();
  const std::lock_guard lock(mutex_);
  tasks_.push_back(std::move(task));
  if (tasks_.size() > idle_ && threads_.size() < most_threads_)
    threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
  more_.notify_one();
  return future;
}

void BackgroundSignatures::work(const std::stop_token& stop) {
  take_lowest_priority();
  for (;;) {
    std::unique_lock lock(mutex_);
    ++idle_;
    const bool more = more_.wait(lock, stop, [this] { return !tasks_.empty(); });
    --idle_;
    if (!more) return;
    Task task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    if (stop.stop_requested()) return;
    task(stop);
  }
}

}  // namespace lodestone
