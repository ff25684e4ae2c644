// What a step has to say: the trouble that it met, from its counts.
#pragma once

#include "lod/hooks.h"
#include "lod/step_report.h"

namespace lodestone {

class StepLog {
 public:
  void set(LogFunction log) { log_ = std::move(log), told_blind_ = false; }
  void begin_step(const Counters& counters) { before_ = counters; }
  /// `blind`: the policy had bodies to decide about, and no viewpoint. That is said once.
  void end_step(const StepReport& report, bool blind = false);

 private:
  LogFunction log_;
  Counters before_;  // of the last step
  bool told_blind_ = false;
};

}  // namespace lodestone
