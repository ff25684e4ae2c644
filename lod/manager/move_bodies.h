// Stage 2 of a step: the changes of rung that were decided, and what is put off.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/manager/choose.h"
#include "lod/manager/levels.h"
#include "lod/step_report.h"

namespace lodestone {

class MoveBodies {
 public:
  MoveBodies(Levels& levels, Choose& choose) : levels_(levels), choose_(choose) {}

  /// Promotions that were put off may be tried again, once their time has come. Before the bodies are chosen.
  void count_down_retries();
  /// Moves the bodies, and gives those that are new a rung.
  void run(const RungChanges& changes, StepReport& report);
  void forget(std::uint32_t body) { std::erase(put_off_, body); }

 private:
  void promote(const RungChanges::Change& change, StepReport& report);
  void put_off(std::uint32_t body, StepReport& report);

  Levels& levels_;
  Choose& choose_;
  std::vector<std::uint32_t> put_off_;  // waiting to be tried again
};

}  // namespace lodestone
