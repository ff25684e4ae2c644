#include "tools/run_arguments.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "reference/allowed_threads.h"
#include "scenes/scene_sections.h"
#include "tools/scene_signatures.h"
#include "tools/shape_arguments.h"
#include "tools/step_argument.h"

namespace lodestone {
namespace {

/// What is wrong with `text` as a budget; empty where nothing is.
std::string find_budget_fault(const std::string& text) {
  double budget = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), budget);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  return is_number && budget > 0.0 && std::isfinite(budget)
             ? ""
             : fmt::format("found '{}', expected a number above 0", text);
}

int threads_of(int asked) { return asked > 0 ? asked : allowed_threads(0); }

}  // namespace

void add_run_arguments(Command& command, RunArguments& arguments) {
  RunSettings& running = arguments.running;
  command.add_option("--steps", running.steps, "instead of the scene's").within(1, 100'000'000);
  command.add_option("--dt", arguments.step, "step, s: 0.01 or 1/60, instead of the scene's")
      .checked(find_step_fault, "SECONDS");
  command.add_option("--seed", arguments.loading.seed, "instead of the scene's, for scatters too");
  command.add_option("--threads", running.threads, "of the statistical level; 0: all cores").within(0, 4096);
  command.add_choice<LevelChoice>(
      "--level", running.level,
      {{"auto", LevelChoice::automatic},
       {"full", LevelChoice::full},
       {"support", LevelChoice::support},
       {"tables", LevelChoice::tables},
       {"statistical", LevelChoice::statistical}},
      "auto: the scene's policy; statistical: it says which of support and tables; else one rung for every "
      "body");
  command.add_choice<StatisticalModel>(
      "--model", running.model,
      {{"tables", StatisticalModel::tables}, {"support", StatisticalModel::support}},
      "of all statistical bodies, whatever the policy says");
  Option ms = command
                  .add_option("--budget-ms", running.budget_ms,
                              "processor time of a step, instead of the scene's policy")
                  .checked(find_budget_fault, "MS");
  Option work =
      command.add_option("--budget-work", running.budget_work, "the same in work units, which repeat exactly")
          .checked(find_budget_fault, "UNITS")
          .excludes(ms);
  command
      .add_option("--full-within-m", running.full_within_m,
                  "policy distance with this, instead of the scene's policy")
      .from_zero()
      .excludes(ms)
      .excludes(work);
  command
      .add_option("--audit-ms", running.audit_ms,
                  "processor time of each step for simulating demoted bodies on in full, beside the world")
      .within(0.0, 1e6);
  add_mesh_arguments(command, arguments.loading.mesh_paths, arguments.loading.untrusted);
  command.add_flag("--no-cache", arguments.no_cache, "measure the signatures anew and leave the cache alone");
}

std::string options_of(const RunArguments& arguments) {
  const RunSettings& running = arguments.running;
  std::string options;
  const auto add = [&](const char* name, const auto& value) {
    options += fmt::format(" {} {}", name, value);
  };
  const auto add_given = [&](const char* name, const auto& value) {
    if (value) add(name, *value);
  };
  add_given("--steps", running.steps);
  if (!arguments.step.empty()) add("--dt", arguments.step);
  add_given("--seed", arguments.loading.seed);
  if (running.threads != RunSettings().threads) add("--threads", running.threads);
  if (running.level != LevelChoice::automatic) add("--level", name_of(running.level));
  if (running.model) add("--model", name_of(rung_of(*running.model)));
  add_given("--budget-ms", running.budget_ms);
  add_given("--budget-work", running.budget_work);
  add_given("--full-within-m", running.full_within_m);
  add_given("--audit-ms", running.audit_ms);
  return options;
}

RunSettings run_settings(const RunArguments& arguments, ProgressLine& line) {
  RunSettings settings = arguments.running;
  settings.threads = threads_of(arguments.running.threads);
  if (!arguments.step.empty()) settings.dt_s = step_of(arguments.step);
  settings.progress = [&line](const RunProgress& run) {
    line.show(text_of(run), double(run.step) / run.steps);
  };
  settings.signatures = make_signature_function(line, !arguments.no_cache);
  return settings;
}

}  // namespace lodestone
