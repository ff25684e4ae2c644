// Methods against the truth: what comparisons of drops and of piles have in common.
//
// Two batches of truth with different starts, A and B, give the noise floor: B against A. A method takes the
// starts of B and is compared with A, too. So a method that equals the truth scores the floor exactly, and
// what it scores above the floor is its own error.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tools/interrupt.h"
#include "tools/methods/method.h"

namespace lodestone {

struct ComparisonSettings {
  std::vector<double> dt_s = {kObservationStep};  ///< steps of the methods
  std::vector<std::string> methods = {};
  SignatureSettings measuring = {};  ///< of the signature of `statistical`; its law is the job's
  std::uint64_t seed = 1;
  int threads = 0;    ///< 0: all cores
  bool costs = true;  ///< measure them, too
  Progress progress = {};

  void report(const std::string& stage, double fraction) const {
    if (progress) progress(stage, fraction);
  }
  // Starts of the two batches, and of the bootstrap, must not coincide whatever the user's seed.
  std::uint64_t seed_of_truth_a() const { return 2 * seed; }
  std::uint64_t seed_of_truth_b() const { return 2 * seed + 1; }
};

/// One method at one step: what the rows of every comparison begin with.
struct MethodAtStep {
  std::string method, model;  ///< model "" for ODE and Bullet
  double dt_s = kObservationStep;
  int substeps = 1;
  std::string reason = {};  ///< why left out
};

MethodAtStep at_step(const Method& method, double dt_s);

/// As progress names it.
std::string name_of(const MethodAtStep& row);

/// A row for each method at each step, by method, then by step. `compare(method, row)` fills in one that is
/// not left out; then, in a pass of its own with nothing else running, `measure_cost(method, row)`. Where the
/// program is interrupted (tools/interrupt.h): the rows that are whole.
template <class Row, class Compare, class MeasureCost>
std::vector<Row> compare_methods(std::span<const Method> methods, const ComparisonSettings& settings,
                                 Compare compare, MeasureCost measure_cost) {
  std::vector<Row> rows;
  until_interrupted([&] {
    for (const Method& method : methods)
      for (const double dt_s : settings.dt_s) {
        Row row{at_step(method, dt_s)};
        if (row.reason.empty()) compare(method, row);
        rows.push_back(std::move(row));
      }
    for (std::size_t i = 0; settings.costs && i < rows.size(); ++i) {
      if (!rows[i].reason.empty()) continue;
      settings.report("timing", 0.0);
      measure_cost(methods[i / settings.dt_s.size()], rows[i]);
    }
  });
  return rows;
}

}  // namespace lodestone
