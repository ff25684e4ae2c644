#include "reference/ode/runtime_ode.h"

#include <cstdarg>
#include <cstdio>

#include "reference/error.h"
#include "reference/ode/ode_world.h"

namespace lodestone::ode {
namespace {

thread_local std::int64_t messages = 0;
thread_local char last_message[256] = "";
thread_local bool recoverable = false;
// What the caller had set before ODE was prepared; null where ODE would have printed.
dMessageFunction* callers_message_handler = nullptr;
dMessageFunction* callers_error_handler = nullptr;
dMessageFunction* callers_debug_handler = nullptr;

void count_message(int number, const char* message, va_list arguments) {
  ++messages;
  va_list copy;
  va_copy(copy, arguments);
  std::vsnprintf(last_message, sizeof last_message, message, copy);
  va_end(copy);
  if (callers_message_handler) callers_message_handler(number, message, arguments);
}

// ODE ends the process once these return, so they say why, as any broken contract does.
void report_fatal(dMessageFunction* callers, int number, const char* message, va_list arguments) {
  ++messages;
  if (callers) return callers(number, message, arguments);
  char text[512];
  std::vsnprintf(text, sizeof text, message, arguments);
  check_that(false, "ODE cannot go on:", text);
}

void throw_where_recoverable(const char* message, va_list arguments) {
  if (!recoverable) return;
  ++messages;
  char text[512];
  std::vsnprintf(text, sizeof text, message, arguments);
  throw AssertionFailed{text};
}

void report_error(int number, const char* message, va_list arguments) {
  throw_where_recoverable(message, arguments);
  report_fatal(callers_error_handler, number, message, arguments);
}

void report_debug(int number, const char* message, va_list arguments) {
  throw_where_recoverable(message, arguments);
  report_fatal(callers_debug_handler, number, message, arguments);
}

void start() {
  check_that(dInitODE2(0) != 0, "ODE starts");
  check_that(dCheckConfiguration("ODE_double_precision") != 0, "ODE is built in double precision");
  callers_message_handler = dGetMessageHandler();
  callers_error_handler = dGetErrorHandler();
  callers_debug_handler = dGetDebugHandler();
  dSetMessageHandler(count_message);
  dSetErrorHandler(report_error);
  dSetDebugHandler(report_debug);
}

std::mutex& random_mutex() {
  static std::mutex mutex;
  return mutex;
}

std::mutex& thread_data_mutex() {
  static std::mutex mutex;
  return mutex;
}

bool prepare_thread() {
  const std::scoped_lock lock(thread_data_mutex());
  check_that(dAllocateODEDataForThread(dAllocateMaskAll) != 0, "ODE makes its data for this thread");
  return true;
}

}  // namespace

void prepare() {
  static const bool started = (start(), true);
  thread_local const bool prepared = started && prepare_thread();
  static_cast<void>(prepared);
}

std::int64_t messages_of_this_thread() { return messages; }

void count_messages() {
  if (dGetMessageHandler() == count_message) return;
  callers_message_handler = dGetMessageHandler();
  dSetMessageHandler(count_message);
}

std::mutex& trimesh_mutex() {
  static std::mutex mutex;
  return mutex;
}

RecoverableScope::RecoverableScope() : before_(recoverable) { recoverable = true; }
RecoverableScope::~RecoverableScope() { recoverable = before_; }

bool is_placeable(dGeomID geom) {
  const int geom_class = dGeomGetClass(geom);
  if (geom_class != dHeightfieldClass || dGeomGetBody(geom)) return geom_class != dPlaneClass;
  const std::int64_t before = messages;
  try {
    const RecoverableScope scope;
    dGeomGetPosition(geom);
    return true;
  } catch (const AssertionFailed&) {
    messages = before;
    return false;
  }
}

SeededRandom::SeededRandom(std::uint64_t seed) : lock_(random_mutex()), before_(dRandGetSeed()) {
  // ODE's generator keeps 32 bits; fold the rest in.
  dRandSetSeed((seed ^ (seed >> 32)) & 0xffffffffu);
}

SeededRandom::~SeededRandom() { dRandSetSeed(before_); }

StepThreading::StepThreading(dWorldID world)
    : world_(world), threading_(dThreadingAllocateSelfThreadedImplementation()) {
  dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_), threading_);
}

StepThreading::~StepThreading() {
  dWorldSetStepThreadingImplementation(world_, nullptr, nullptr);
  if (threading_) dThreadingFreeImplementation(threading_);
}

}  // namespace lodestone::ode

namespace lodestone {
std::string_view last_ode_message() { return ode::last_message; }
}  // namespace lodestone
