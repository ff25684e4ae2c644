// Stage 2 of a step: the changes of rung that were decided, and what is put off.
#pragma once

#include <cstdint>
#include <span>

#include "lod/manager/audit.h"
#include "lod/manager/choose.h"
#include "lod/manager/levels.h"
#include "lod/step_report.h"

namespace lodestone {

class MoveBodies {
 public:
  MoveBodies(Levels& levels, Choose& choose, Audit& audit)
      : levels_(levels), choose_(choose), audit_(audit) {}

  /// Promotions that were put off may be tried again, once their time has come. Before the bodies are chosen.
  void count_down_retries();
  /// Moves the bodies, and gives those that are new a rung.
  void run(const RungChanges& changes, StepReport& report);
  /// Brings groups back whose joints are off and of which a member was woken: before the bodies are chosen,
  /// or between the statistical rungs and the full level.
  void bring_back_woken(Groups::Return how, StepReport& report);
  /// Gives bodies at `support` their signature that has come: they stay as they are, and play clips from now
  /// on. Before the bodies are chosen.
  void supply_signatures();

 private:
  using Run = std::span<const RungChanges::Change>;  // that changes together
  void demote(Run run, StepReport& report);
  /// `held`: the newcomers that wait in this step, ascending.
  void promote(Run run, std::span<const std::uint32_t> held, StepReport& report);
  void promote(const RungChanges::Change& change, bool blocked, StepReport& report);
  void put_off(std::uint32_t body, StepReport& report);

  Levels& levels_;
  Choose& choose_;
  Audit& audit_;
};

}  // namespace lodestone
