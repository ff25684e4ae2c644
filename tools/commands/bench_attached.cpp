#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lod/full/full_level.h"
#include "lod/timing/thread_clock.h"
#include "reference/ode/callers_level.h"
#include "tools/commands.h"
#include "tools/interrupt.h"
#include "tools/median.h"
#include "tools/results.h"
#include "tools/text_table.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

constexpr double kCrateSide = 0.3, kCrateMass = 27.0;  // m and kg, of a crate
constexpr double kAttachedStep = 1.0 / 60.0;
constexpr int kSettledSteps = 240;  // steps after which all sleep

struct BenchAttachedArguments {
  int boxes = 10'000, crates = 100;
  ResultArguments results;
};

struct AttachedRow {
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
void measure(AttachedRow& row, const Step& step) {
  std::vector<double> awake, asleep;
  for (int i = 0; i < kSettledSteps + 60; ++i) {
    throw_if_interrupted();
    const double before = thread_time_ms();
    step();
    const double ms = thread_time_ms() - before;
    if (i >= 10 && i < 60) awake.push_back(ms);
    if (i >= kSettledSteps) asleep.push_back(ms);
  }
  row.awake_ms = median_of(awake), row.asleep_ms = median_of(asleep);
}

AttachedRow measure_plain(const CallersLevelSettings& settings, const char* space, int crates, int substeps) {
  AttachedRow row{.space = space, .method = substeps == 1 ? "plain ODE" : "plain ODE, 4 substeps"};
  CallersLevel level(settings);
  level.add_crates(crate_states(crates), kCrateSide, kCrateMass);
  measure(row, [&] {
    for (int i = 0; i < substeps; ++i) level.step(kAttachedStep / substeps);
  });
  row.awake_at_last = level.awake();
  return row;
}

AttachedRow measure_full(const CallersLevelSettings& settings, const char* space, int crates) {
  AttachedRow row{.space = space, .method = "full, 4 substeps"};
  CallersLevel level(settings);
  MaterialTable materials;
  materials.replace(0, {.restitution = settings.restitution, .friction = settings.friction});
  OdeWorld world(level.world(), level.space(), ode_settings_of({}), materials);
  const auto shape = std::make_shared<const Shape>(make_shape("crate", make_box(Vec3::Constant(kCrateSide))));
  std::vector<OdeBodyId> bodies;
  for (const RigidState& state : crate_states(crates))
    bodies.push_back(world.add_body({.shape = shape, .mass = kCrateMass, .state = state}));
  measure(row, [&] { world.step(kAttachedStep, 4); });
  for (const OdeBodyId body : bodies) row.awake_at_last += !world.asleep(body);
  return row;
}

std::vector<AttachedRow> bench_attached(const BenchAttachedArguments& arguments) {
  constexpr std::pair<CallersSpace, const char*> kSpaces[] = {
      {CallersSpace::hash, "hash"},
      {CallersSpace::sweep_and_prune, "sweep and prune"},
      {CallersSpace::quadtree, "quadtree"},
      {CallersSpace::simple, "simple"}};
  std::vector<AttachedRow> rows;
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

ordered_json json_of(const BenchAttachedArguments& arguments, const std::vector<AttachedRow>& rows) {
  ordered_json json = {
      {"boxes", arguments.boxes}, {"crates", arguments.crates}, {"rows", ordered_json::array()}};
  for (const AttachedRow& row : rows)
    json["rows"].push_back({{"space", row.space},
                            {"method", row.method},
                            {"awake_ms", row.awake_ms},
                            {"asleep_ms", row.asleep_ms},
                            {"awake_at_last", row.awake_at_last}});
  return json;
}

std::string text_of(const BenchAttachedArguments& arguments, const std::vector<AttachedRow>& rows) {
  TextTable table({"space", "method", "awake ms", "asleep ms", "awake at last"});
  for (const AttachedRow& row : rows)
    table.add_row({row.space, row.method, fmt::format("{:.3f}", row.awake_ms),
                   fmt::format("{:.3f}", row.asleep_ms), fmt::format("{}", row.awake_at_last)});
  return fmt::format(
      "{} crates fall on {} static boxes in a space of the caller's, medians of a step of 1/60 s, this "
      "thread's time\n\n{}",
      arguments.crates, arguments.boxes, table.text());
}

void run_attached(const BenchAttachedArguments& arguments) {
  const std::vector<AttachedRow> rows = bench_attached(arguments);
  print_results(arguments.results, json_of(arguments, rows), text_of(arguments, rows));
}

}  // namespace

void add_bench_attached_command(Command& bench) {
  auto [command, arguments] = bench.add<BenchAttachedArguments>(
      "attached", "full bodies in a caller's space of each type, beside plain ODE", run_attached);
  command.add_option("--boxes", arguments.boxes, "static, in the caller's space").within(100, 100'000);
  command.add_option("--crates", arguments.crates, "that fall on them").within(1, 10'000);
  add_json_argument(command, arguments.results);
}

}  // namespace lodestone
