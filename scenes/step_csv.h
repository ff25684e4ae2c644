// One row a step, for whoever wants to plot a run.
#pragma once

#include <filesystem>

#include "lod/step_report.h"
#include "reference/output_file.h"

namespace lodestone {

class StepCsv {
 public:
  /// Starts `file` anew. Throws InputError where it cannot be written.
  explicit StepCsv(const std::filesystem::path& file);
  /// Throws InputError where the place is full; the rows until there are kept whole.
  void add(const StepReport& report, double time_s, double energy_j, double penetration_m);
  void close();  ///< likewise

 private:
  OutputFile out_;
};

}  // namespace lodestone
