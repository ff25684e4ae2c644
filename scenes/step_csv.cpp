#include "scenes/step_csv.h"

#include <fmt/format.h>

namespace lodestone {

StepCsv::StepCsv(const std::filesystem::path& file) : out_(file, "room for the report of each step") {
  out_.write(
      "step,time_s,total_ms,choose_ms,transfer_ms,full_ms,flight_ms,broad_phase_ms,pairs_ms,crowd_ms,rest_ms,"
      "cross_level_ms,"
      "full,statistical,asleep,promotions,demotions,contacts,energy_j,penetration_m,support,tables,predicted_"
      "ms,measured_ms\n");
}

void StepCsv::add(const StepReport& r, double time_s, double energy_j, double penetration_m) {
  const StageTimes& t = r.times;
  std::string row =
      fmt::format("{},{:.6g},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},", r.step,
                  time_s, t.total_ms, t.choose_ms, t.transfer_ms, t.full_ms, t.flight_ms, t.broad_phase_ms,
                  t.pairs_ms, t.crowd_ms, t.rest_ms, t.cross_level_ms);
  row += fmt::format("{},{},{},{},{},{},{:.6g},{:.6g},{},{},{:.4f},{:.4f}\n", r.full, r.statistical, r.asleep,
                     r.promotions, r.demotions, r.contacts, energy_j, penetration_m, r.support, r.tables,
                     r.predicted_ms, r.measured_ms);
  out_.write(row);
}

void StepCsv::close() { out_.close(); }

}  // namespace lodestone
