#include "tools/bench/command_bench_attached.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "lod/full/full_level.h"
#include "lod/timing/thread_clock.h"
#include "reference/ode/callers_level.h"
#include "tools/interrupt.h"
#include "tools/median.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

constexpr double kSide = 0.3, kMass = 27.0;  // m and kg, of a crate
constexpr double kStep = 1.0 / 60.0;
constexpr int kSettled = 240;  // steps after which all sleep

struct Arguments {
  int boxes = 10'000, crates = 100;
  bool json = false;
};

struct Row {
  const char *space, *method;
  double awake_ms = 0.0, asleep_ms = 0.0;
  int awake_at_last = 0;
};

std::vector<RigidState> crate_states(int count) {
  std::vector<RigidState> states;
  const int side = int(std::ceil(std::sqrt(count)));
  for (int i = 0; i < count; ++i)
    states.push_back({.position = Vec3(3.0 * (i % side - 0.5 * side) + 0.13,
                                       3.0 * (i / side - 0.5 * side) + 0.27, 0.6 + 1e-3 * i),
                      .orientation = Quat(1, 0.2, 0.1 * (i % 7), 0.3).normalized()});
  return states;
}

/// The thread's own time in the first second, from the tenth step on, and once all sleep; medians.
template <class Step>
void measure(Row& row, const Step& step) {
  std::vector<double> awake, asleep;
  for (int i = 0; i < kSettled + 60; ++i) {
    throw_if_interrupted();
    const double before = thread_time_ms();
    step();
    const double ms = thread_time_ms() - before;
    if (i >= 10 && i < 60) awake.push_back(ms);
    if (i >= kSettled) asleep.push_back(ms);
  }
  row.awake_ms = median_of(awake), row.asleep_ms = median_of(asleep);
}

Row measure_plain(const CallersLevelSettings& settings, const char* space, int crates, int substeps) {
  Row row{.space = space, .method = substeps == 1 ? "plain ODE" : "plain ODE, 4 substeps"};
  CallersLevel level(settings);
  level.add_crates(crate_states(crates), kSide, kMass);
  measure(row, [&] {
    for (int i = 0; i < substeps; ++i) level.step(kStep / substeps);
  });
  row.awake_at_last = level.awake();
  return row;
}

Row measure_full(const CallersLevelSettings& settings, const char* space, int crates) {
  Row row{.space = space, .method = "full, 4 substeps"};
  CallersLevel level(settings);
  MaterialTable materials;
  materials.replace(0, {.restitution = settings.restitution, .friction = settings.friction});
  OdeWorld world(level.world(), level.space(), ode_settings_of({}), materials);
  const auto shape = std::make_shared<const Shape>(make_shape("crate", make_box(Vec3::Constant(kSide))));
  std::vector<OdeBodyId> bodies;
  for (const RigidState& state : crate_states(crates))
    bodies.push_back(world.add_body({.shape = shape, .mass = kMass, .state = state}));
  measure(row, [&] { world.step(kStep, 4); });
  for (const OdeBodyId body : bodies) row.awake_at_last += !world.asleep(body);
  return row;
}

std::vector<Row> bench_attached(const Arguments& arguments) {
  constexpr std::pair<CallersSpace, const char*> kSpaces[] = {
      {CallersSpace::hash, "hash"},
      {CallersSpace::sweep_and_prune, "sweep and prune"},
      {CallersSpace::quadtree, "quadtree"},
      {CallersSpace::simple, "simple"}};
  std::vector<Row> rows;
  const auto measure_rows_of = [&](CallersSpace space, const char* name) {
    const CallersLevelSettings settings{.space = space, .boxes = arguments.boxes};
    // The simple space looks at every two geoms: half a second a step of 10,000, which needs no measuring.
    if (space != CallersSpace::simple || arguments.boxes <= 2000)
      for (const int substeps : {1, 4})
        rows.push_back(measure_plain(settings, name, arguments.crates, substeps));
    rows.push_back(measure_full(settings, name, arguments.crates));
  };
  until_interrupted([&] {
    for (const auto& [space, name] : kSpaces) measure_rows_of(space, name);
  });
  return rows;
}

void show_json(const Arguments& arguments, const std::vector<Row>& rows) {
  nlohmann::ordered_json json = {{"boxes", arguments.boxes}, {"crates", arguments.crates}};
  for (const Row& row : rows)
    json["rows"].push_back({{"space", row.space},
                            {"method", row.method},
                            {"awake_ms", row.awake_ms},
                            {"asleep_ms", row.asleep_ms},
                            {"awake_at_last", row.awake_at_last}});
  print_json(json);
}

void print_text(const Arguments& arguments, const std::vector<Row>& rows) {
  TextTable table({"space", "method", "awake ms", "asleep ms", "awake at last"});
  for (const Row& row : rows)
    table.add_row({row.space, row.method, fmt::format("{:.3f}", row.awake_ms),
                   fmt::format("{:.3f}", row.asleep_ms), fmt::format("{}", row.awake_at_last)});
  fmt::print(
      "{} crates fall on {} static boxes in a space of the caller's, medians of a step of 1/60 s, this "
      "thread's time\n\n{}",
      arguments.crates, arguments.boxes, table.text());
}

}  // namespace

void add_bench_attached_command(CLI::App& bench, ExitCode& exit_code) {
  CLI::App* command =
      bench.add_subcommand("attached", "full bodies in a caller's space of each type, beside plain ODE");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("--boxes", arguments->boxes, "static, in the caller's space")
      ->check(CLI::Range(100, 100'000))
      ->capture_default_str();
  command->add_option("--crates", arguments->crates, "that fall on them")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object on stdout");
  command->callback([arguments, &exit_code] {
    const std::vector<Row> rows = bench_attached(*arguments);
    arguments->json ? show_json(*arguments, rows) : print_text(*arguments, rows);
    exit_code = ExitCode::done;
  });
}

}  // namespace lodestone
