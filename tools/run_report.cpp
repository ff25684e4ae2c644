#include "tools/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "tools/interrupt.h"
#include "tools/terminal.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

constexpr std::array<std::pair<std::string_view, double StageTimes::*>, 9> kStages = {{
    {"choose", &StageTimes::choose_ms},
    {"transfer", &StageTimes::transfer_ms},
    {"full", &StageTimes::full_ms},
    {"flight", &StageTimes::flight_ms},
    {"broad_phase", &StageTimes::broad_phase_ms},
    {"pairs", &StageTimes::pairs_ms},
    {"crowd", &StageTimes::crowd_ms},
    {"rest", &StageTimes::rest_ms},
    {"cross_level", &StageTimes::cross_level_ms},
}};

constexpr std::array<std::pair<std::string_view, std::int64_t Counters::*>, 15> kCounters = {{
    {"ode_bodies_created", &Counters::ode_bodies_created},
    {"trimeshes_built", &Counters::trimeshes_built},
    {"signatures_loaded", &Counters::signatures_loaded},
    {"pair_phases", &Counters::pair_phases},
    {"ode_messages", &Counters::ode_messages},
    {"contacts_dropped", &Counters::contacts_dropped},
    {"full_quick_steps", &Counters::full_quick_steps},
    {"full_passes_prevented", &Counters::full_passes_prevented},
    {"full_uneven_contacts", &Counters::full_uneven_contacts},
    {"full_swallowed", &Counters::full_swallowed},
    {"states_recovered", &Counters::states_recovered},
    {"energy_clamps", &Counters::energy_clamps},
    {"table_extrapolations", &Counters::table_extrapolations},
    {"promotions_put_off", &Counters::promotions_put_off},
    {"bodies_held_back", &Counters::bodies_held_back},
}};

constexpr std::array kFromTheTop = {Rung::full, Rung::support, Rung::tables};

ordered_json number_or_null(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

std::string text_of_stages(const RunResult& result) {
  std::string text;
  for (const auto& [name, stage] : kStages)
    if (const double ms = result.mean_ms(stage); ms >= 0.0005)
      text += fmt::format("{}{} {:.3f}", text.empty() ? "" : ", ", name, ms);
  return text;
}

std::string text_of_counters(const Counters& counters) {
  std::string text;
  for (const auto& [name, counter] : kCounters)
    if (counters.*counter != 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, counters.*counter);
  return text.empty() ? "all 0" : text;
}

// Of a run in which steps were counted.
std::string text_of(const BudgetFigures& budget) {
  const TimeSummary& ms = budget.step_ms;
  std::string text = budget.budget_ms
                         ? fmt::format("budget       {:g} ms: {} of {} steps over", *budget.budget_ms,
                                       *budget.over, budget.steps)
                         : fmt::format("budget       {:g} units: {:.0f} foretold, mean of {} steps",
                                       *budget.budget_work, budget.mean_work, budget.steps);
  text += fmt::format("; processor ms median {:.3f}, 99 % {:.3f}, longest {:.3f}\n", ms.p50, ms.p99, ms.max);
  text += fmt::format("             foretold {:.3f} ms", budget.mean_predicted_ms);
  if (budget.budget_ms)  // no clock runs where work is counted
    text += fmt::format(", measured {:.3f}, {:.3f} apart", budget.mean_measured_ms, budget.mean_error_ms);
  text += fmt::format("; mean bodies, ms foretold{}:", budget.budget_ms ? " and measured" : "");
  for (const Rung rung : kFromTheTop) {
    const std::size_t i = std::size_t(rung);
    text += fmt::format("{} {} {:.1f}, {:.3f}", rung == Rung::full ? "" : ";", name_of(rung),
                        budget.mean_bodies[i], budget.mean_cost[i].predicted_ms);
    if (budget.budget_ms) text += fmt::format(", {:.3f}", budget.mean_cost[i].measured_ms);
  }
  return text + '\n';
}

std::string text_of(const AuditReport& audit) {
  const auto figure = [](const char* name, const AuditFigure& f) {
    return fmt::format("; {} {:.3g} full, {:.3g} demoted, {:+.2g} to {:+.2g}", name, f.full, f.demoted,
                       f.difference[0], f.difference[1]);
  };
  return fmt::format(
      "audit        {} demoted bodies beside themselves in full{}{}{}; apart after 1 s {:.2f} sizes, {:.2f} "
      "to {:.2f}\n",
      audit.bodies, figure("time to rest s", audit.rest_time_s), figure("distance m", audit.distance_m),
      figure("rest height", audit.rest_height), audit.drift, audit.drift_interval[0],
      audit.drift_interval[1]);
}

std::string text_of(const CheckResult& check) {
  return fmt::format("check        {} {}: {:.4g}, bound {:.4g}\n",
                     !check.decided ? "open:  "
                     : check.pass   ? styled("holds: ", Style::good)
                                    : styled("FAILED:", Style::bad),
                     check.name, check.value, check.bound);
}

std::string text_of(const ForkedRun& fork) {
  const StepReport& last = fork.result.last();
  return fmt::format(
      "fork         after step {}: {} full, {} support, {} tables, {} asleep at the end; bodies on average "
      "{:.4g} m from where they are else; processor ms median {}; state hash {:016x}\n{}",
      fork.step, last.full, last.support, last.tables, last.asleep, fork.mean_distance_m.back(),
      text_of_ms(fork.result.processor_ms.p50), fork.result.state_hash,
      fork.result.finite ? "" : "DIVERGED: a state of the fork was not finite\n");
}

ordered_json json_of(const TimeSummary& ms) {
  return {{"p50", ms.p50}, {"p95", ms.p95}, {"p99", ms.p99}, {"mean", ms.mean}, {"max", ms.max}};
}

}  // namespace

std::string text_of(const RunResult& result) {
  const StepReport& last = result.last();
  const TimeSummary &ms = result.step_ms, &processor = result.processor_ms;
  std::string text;
  for (const auto& [name, times] : {std::pair("step", ms), {"processor", processor}})
    text += fmt::format("{:<12} median {} ms, 95 % {}, 99 % {}, longest {}\n", name, text_of_ms(times.p50),
                        text_of_ms(times.p95), text_of_ms(times.p99), text_of_ms(times.max));
  text += fmt::format("stages       mean ms: {}\n", text_of_stages(result));
  text += fmt::format("at the end   {} full, {} statistical, {} of all asleep\n", last.full, last.statistical,
                      last.asleep);
  text += fmt::format("rungs        {} full, {} support, {} tables\n", last.full, last.support, last.tables);
  if (result.budget && result.budget->steps > 0) text += text_of(*result.budget);
  if (result.budget && result.budget->mean_error_pixels)
    text += fmt::format("error        {:.1f} px predicted, sum over the bodies, mean of {} steps\n",
                        *result.budget->mean_error_pixels, result.budget->steps);
  if (last.audit.bodies > 0) text += text_of(last.audit);
  if (result.in_picture)
    text += fmt::format("in picture   {} full at least, {:.1f} on average\n", result.in_picture->min_full,
                        result.in_picture->mean_full);
  text += fmt::format("transitions  {}, of which {} promotions\n", result.transitions, result.promotions);
  text += fmt::format("deepest      {:.4g} m in planes and boxes of the ground, at tables {:.4g} m\n",
                      result.max_penetration_m, result.max_tables_penetration_m);
  text += fmt::format("energy       {:.6g} J at the start, {:.6g} J at most, {:.6g} J at the end\n",
                      result.energy_start_j, result.energy_max_j, result.energy_end_j);
  text += fmt::format("counters     {}\n", text_of_counters(last.counters));
  for (const CheckResult& check : result.checks) text += text_of(check);
  if (result.incomplete) text += fmt::format("INCOMPLETE   ended after step {}\n", result.steps);
  if (!result.finite) text += "DIVERGED: a state was not finite\n";
  if (result.fork) text += text_of(*result.fork);
  for (const auto& file :
       {result.playback, result.fork ? result.fork->result.playback : std::filesystem::path(),
        result.trajectory, result.csv})
    if (!file.empty()) text += fmt::format("written      {}\n", file.string());
  text += fmt::format("state hash   {:016x}\n", result.state_hash);
  return text;
}

ordered_json json_of(const AuditReport& audit) {
  const auto figure = [](const AuditFigure& f) {
    return ordered_json{
        {"full", f.full}, {"demoted", f.demoted}, {"deviation", f.deviation}, {"difference", f.difference}};
  };
  return {{"bodies", audit.bodies},
          {"watched", audit.watched},
          {"left_out", audit.left_out},
          {"rest_time_s", figure(audit.rest_time_s)},
          {"distance_m", figure(audit.distance_m)},
          {"rest_height", figure(audit.rest_height)},
          {"drift", audit.drift},
          {"drift_interval", audit.drift_interval}};
}

ordered_json json_of(const BudgetFigures& budget) {
  ordered_json json;
  if (budget.budget_ms)
    json["ms"] = *budget.budget_ms;
  else
    json["work"] = budget.budget_work.value();
  json["steps"] = budget.steps;
  const auto counted = [&](double figure) {
    return budget.steps > 0 ? ordered_json(figure) : ordered_json(nullptr);
  };
  const auto timed = [&](double figure) {  // no clock runs where work is counted
    return budget.budget_ms ? counted(figure) : ordered_json(nullptr);
  };
  json["over"] = budget.over && budget.steps > 0 ? ordered_json(*budget.over) : ordered_json(nullptr);
  json["p50"] = counted(budget.step_ms.p50);
  json["p99"] = counted(budget.step_ms.p99);
  json["max"] = counted(budget.step_ms.max);
  for (const Rung rung : kFromTheTop)
    json[fmt::format("mean_{}", name_of(rung))] = counted(budget.mean_bodies[std::size_t(rung)]);
  json["mean_work"] = counted(budget.mean_work);
  json["mean_predicted_ms"] = counted(budget.mean_predicted_ms);
  json["mean_measured_ms"] = timed(budget.mean_measured_ms);
  json["mean_error_ms"] = timed(budget.mean_error_ms);
  if (budget.mean_error_pixels) json["mean_predicted_error_px"] = counted(*budget.mean_error_pixels);
  for (const Rung rung : kFromTheTop) {
    const RungCost& cost = budget.mean_cost[std::size_t(rung)];
    json["rungs"][std::string(name_of(rung))] = {{"predicted_ms", counted(cost.predicted_ms)},
                                                 {"measured_ms", timed(cost.measured_ms)},
                                                 {"work", counted(cost.work)}};
  }
  return json;
}

ordered_json json_of(const RunResult& result) {
  const StepReport& last = result.last();
  ordered_json json;
  json["steps"] = result.steps;
  json["bodies"] = result.bodies;
  json["state_hash"] = fmt::format("{:016x}", result.state_hash);
  json["step_ms"] = json_of(result.step_ms);
  json["step_processor_ms"] = json_of(result.processor_ms);
  for (const auto& [name, stage] : kStages) json["stage_mean_ms"][name] = result.mean_ms(stage);
  json["levels"] = {{"full", last.full},
                    {"statistical", last.statistical},
                    {"support", last.support},
                    {"tables", last.tables},
                    {"asleep", last.asleep}};
  if (result.budget) json["budget"] = json_of(*result.budget);
  if (last.audit.bodies + last.audit.watched + last.audit.left_out > 0) json["audit"] = json_of(last.audit);
  if (result.in_picture)
    json["in_picture"] = {{"min_full", result.in_picture->min_full},
                          {"mean_full", result.in_picture->mean_full}};
  json["transitions"] = result.transitions;
  json["promotions"] = result.promotions;
  for (const auto& [name, counter] : kCounters) json["counters"][name] = last.counters.*counter;
  json["max_penetration_m"] = number_or_null(result.max_penetration_m);
  json["max_tables_penetration_m"] = number_or_null(result.max_tables_penetration_m);
  json["energy_start_j"] = number_or_null(result.energy_start_j);
  json["energy_max_j"] = number_or_null(result.energy_max_j);
  json["energy_end_j"] = number_or_null(result.energy_end_j);
  json["finite"] = result.finite;
  if (result.incomplete) json["incomplete"] = true;
  if (result.failure) json["failure"] = result.failure->what();
  json["checks"] = ordered_json::array();
  for (const CheckResult& check : result.checks)
    json["checks"].push_back({{"name", check.name},
                              {"value", number_or_null(check.value)},
                              {"bound", check.bound},
                              {"pass", check.pass},
                              {"decided", check.decided}});
  if (result.fork)
    json["fork"] = {{"step", result.fork->step},
                    {"mean_distance_m", result.fork->mean_distance_m},
                    {"run", json_of(result.fork->result)}};
  json["playback"] = result.playback.empty() ? ordered_json(nullptr) : ordered_json(result.playback.string());
  json["trajectory"] =
      result.trajectory.empty() ? ordered_json(nullptr) : ordered_json(result.trajectory.string());
  return json;
}

ExitCode exit_code_of(const RunResult& result) {
  if (!result.finite || result.failure || (result.fork && !result.fork->result.finite))
    return ExitCode::diverged;
  if (!result.write_error.empty()) return ExitCode::bad_input;
  if (result.incomplete) return interrupted_exit_code();
  const bool all_hold = std::ranges::all_of(result.checks, &CheckResult::pass);
  return all_hold ? ExitCode::done : ExitCode::check_failed;
}

}  // namespace lodestone
