#include "lod/manager/step_log.h"

#include <fmt/format.h>

#include <utility>

#include "reference/ode/ode_world.h"

namespace lodestone {

void StepLog::end_step(const StepReport& report, bool blind) {
  if (!log_) return;
  if (blind && !std::exchange(told_blind_, true))
    log_(LogLevel::warning,
         fmt::format("step {}: there is no viewpoint, so to the policy every body is far", report.step));
  const auto say = [&](LogLevel level, std::int64_t Counters::*count, std::string_view what) {
    if (const std::int64_t times = report.counters.*count - before_.*count; times > 0)
      log_(level, fmt::format("step {}: {} {}", report.step, times, what));
  };
  say(LogLevel::info, &Counters::promotions_put_off, "promotions put off, for overlap with another body");
  say(LogLevel::info, &Counters::bodies_held_back, "new bodies held back, too many at one place");
  say(LogLevel::warning, &Counters::states_recovered, "states recovered that were no longer finite or sound");
  say(LogLevel::warning, &Counters::contacts_dropped, "contacts dropped");
  say(LogLevel::warning, &Counters::ode_messages,
      fmt::format("messages of ODE's, the last: {}", last_ode_message()));
  say(LogLevel::warning, &Counters::full_uneven_contacts,
      "contacts of bodies a hundred times as heavy as each other, by QuickStep");
}

}  // namespace lodestone
