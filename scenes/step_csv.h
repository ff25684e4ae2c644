// One row a step, for whoever wants to plot a run.
#pragma once

#include <filesystem>
#include <fstream>

#include "lod/step_report.h"

namespace lodestone {

class StepCsv {
 public:
  /// Starts `file` anew. Throws InputError where it cannot be written.
  explicit StepCsv(const std::filesystem::path& file);
  void add(const StepReport& report, double time_s, double energy_j, double penetration_m);

 private:
  std::ofstream out_;
};

}  // namespace lodestone
