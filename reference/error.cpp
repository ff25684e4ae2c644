#include "reference/error.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <mutex>

namespace lodestone {
namespace {

// One for the process, as a bug ends it as a whole.
struct AssertionHandler {
  std::mutex access;
  std::function<void(std::string_view)> call;
};

AssertionHandler& assertion_handler() {
  static AssertionHandler handler;
  return handler;
}

}  // namespace

void throw_input_error(std::string_view what, std::string_view found, std::string_view expected) {
  throw InputError(fmt::format("{}: found {}, expected {}", what, found, expected));
}

void check_that(bool holds, std::string_view contract, std::string_view values, const char* file, int line) {
  if (holds) return;
  const std::string message = fmt::format("{}:{}: contract broken: {} {}", file, line, contract, values);
  std::fprintf(stderr, "%s\n", message.c_str());
  std::unique_lock lock(assertion_handler().access);
  const std::function<void(std::string_view)> handler = assertion_handler().call;
  lock.unlock();  // it may break a contract itself
  if (handler) handler(message);
  std::abort();
}

void set_assertion_handler(std::function<void(std::string_view message)> handler) {
  const std::lock_guard lock(assertion_handler().access);
  assertion_handler().call = std::move(handler);
}

}  // namespace lodestone
