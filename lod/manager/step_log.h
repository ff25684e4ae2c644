// What a step has to say: the trouble that it met, from its counts.
#pragma once

#include "lod/hooks.h"
#include "lod/step_report.h"

namespace lodestone {

class StepLog {
 public:
  void set(LogFunction log) { log_ = std::move(log); }
  void begin_step(const Counters& counters) { before_ = counters; }
  void end_step(const StepReport& report) const;

 private:
  LogFunction log_;
  Counters before_;  // of the last step
};

}  // namespace lodestone
