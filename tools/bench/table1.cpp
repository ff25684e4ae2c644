#include "tools/bench/table1.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "lod/timing/thread_clock.h"
#include "tools/interrupt.h"
#include "tools/median.h"
#include "tools/memory.h"
#include "tools/methods/method_world.h"

namespace lodestone {
namespace {

constexpr int kMeshBodiesMax = 1'000, kOtherBodiesMax = 10'000;
constexpr int kLatestSteps = 10;  // whose mean predicts those to come
constexpr double kPartToJudge =
    0.1;  // of the time allowed is spent first: the steps in which all bodies land are the slowest

bool is_mesh(const Method& method) {
  const auto* ode = std::get_if<OdeMethod>(&method.way);
  return ode && (ode->geometry == OdeGeometry::trimesh || ode->geometry == OdeGeometry::hull);
}

// Plain ODE, as the table's baselines are set: QuickStep with 20 iterations, eight contacts a pair, nothing
// of ours.
OdeSettings baseline_settings() {
  return {.quick_step = true,
          .quick_step_iterations = 20,
          .bounce_velocity = 0.2,
          .friction_along_slip = false,
          .max_contacts_per_pair = 8,
          .mesh_contacts = MeshContacts::plain,
          .plane_contacts_from_hull = false};
}

// The name says which: `full` and full_N are our full level.
bool is_baseline(const Method& method) {
  return method.name == "full_plain" || !method.name.starts_with("full");
}

Method with_settings(Method method, bool sleeping, bool hash_space) {
  if (auto* ode = std::get_if<OdeMethod>(&method.way)) {
    if (is_baseline(method)) ode->settings = baseline_settings();
    ode->settings.hash_space = hash_space;
  } else if (auto* bullet = std::get_if<BulletMethod>(&method.way)) {
    bullet->settings = {.bounce_velocity = 0.2};
  }
  return with_sleep(std::move(method), sleeping);
}

std::vector<RigidState> table1_starts(int bodies, std::uint64_t seed) {
  std::vector<RigidState> starts;
  for (int i = 0; i < bodies; ++i) starts.push_back(table1_start(i, bodies, seed));
  return starts;
}

/// Of a step, ms: on one thread processor time, which other work on the machine does not lengthen (wall time
/// where that is less: reading its clock costs some .2 us); on several, wall time. The stages, in wall time,
/// only where the method tells them apart; they are not all of a step.
struct StepMs {
  double step = 0.0;
  double bytes_moved = 0.0;  ///< where the method counts them
  std::optional<double> collision = {}, response = {}, rest = {};
};

StepMs time_step(MethodWorld& world, int threads) {
  StepMs ms;
  const double processor_start = thread_time_ms();
  const auto start = std::chrono::steady_clock::now();
  world.step(kTable1Step);
  ms.step = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (threads == 1) ms.step = std::min(ms.step, thread_time_ms() - processor_start);
  if (const OdeWorld* ode = world.ode()) {
    ms.collision = ode->times().collision_ms;
    ms.response = ode->times().response_ms;
  } else if (const Manager* manager = world.manager()) {
    const StepReport& report = manager->report();
    ms.collision = report.times.broad_phase_ms + report.times.pairs_ms;
    ms.response = report.times.flight_ms + report.times.crowd_ms;
    ms.rest = report.times.rest_ms;
    ms.bytes_moved = report.bytes_moved;
  }
  return ms;
}

std::uint64_t state_hash_of(const MethodWorld& world) {
  std::uint64_t hash = 0;
  for (int i = 0; i < world.bodies(); ++i) {
    const auto [x, q, v, w] = world.state(i);
    const std::array<double, 13> numbers{x.x(), x.y(), x.z(), q.w(), q.x(), q.y(), q.z(),
                                         v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
    hash = XXH64(numbers.data(), sizeof numbers, hash);
  }
  return hash;
}

/// Steps made so far, and when they would all be done.
class Clock {
 public:
  void add(double step_ms) {
    spent_ms_ += step_ms;
    steps_ms_.push_back(step_ms);
  }
  double predicted_s() const {
    const std::size_t latest = std::min<std::size_t>(kLatestSteps, steps_ms_.size());
    double sum = 0.0;
    for (std::size_t i = steps_ms_.size() - latest; i < steps_ms_.size(); ++i) sum += steps_ms_[i];
    return 1e-3 * (spent_ms_ + sum / double(latest) * double(kTable1Steps - int(steps_ms_.size())));
  }
  double spent_s() const { return 1e-3 * spent_ms_; }

 private:
  double spent_ms_ = 0.0;
  std::vector<double> steps_ms_;
};

/// The medians of what a row shows.
class Columns {
 public:
  void add(const StepMs& ms) {
    step_.push_back(ms.step);
    bytes_moved_.push_back(ms.bytes_moved);
    for (const auto& [value, column] :
         {std::pair{&ms.collision, &collision_}, {&ms.response, &response_}, {&ms.rest, &rest_}})
      if (*value) column->push_back(**value);
  }
  void give_to(Table1Row& row) const {
    row.step_ms = median_of(step_);
    row.bytes_moved_per_body = median_of(bytes_moved_) / row.bodies;
    for (const auto& [column, value] :
         {std::pair{&collision_, &row.collision_ms}, {&response_, &row.response_ms}, {&rest_, &row.rest_ms}})
      if (!column->empty()) *value = median_of(*column);
  }

 private:
  std::vector<double> step_, collision_, response_, rest_, bytes_moved_;
};

class Table1 {
 public:
  explicit Table1(const Table1Settings& settings) : settings_(settings), job_(make_table1_job()) {
    methods_ = make_methods(settings.methods, job_, settings.measuring, 0, settings.progress);
    keep_model(methods_, settings.model);
  }

  std::vector<Table1Row> rows() {
    std::vector<int> sizes = settings_.bodies;
    std::ranges::sort(sizes);
    std::vector<Table1Row> rows;
    for (const int bodies : sizes) {
      const std::size_t first = rows.size();
      until_interrupted([&] {
        for (const Method& method : methods_) rows.push_back(measure(method, bodies));
      });
      compare(std::span(rows).subspan(first));
    }
    return rows;
  }

 private:
  Table1Row measure(const Method& method, int bodies) {
    Table1Row row{.bodies = bodies,
                  .method = method.name,
                  .model = method.model(),
                  .threads = 1,
                  .left_out = find_reason(method, bodies)};
    if (std::holds_alternative<StatisticalMethod>(method.way)) row.threads = settings_.threads;
    if (!row.left_out.empty()) return row;
    double seconds = run(method, row, settings_.row_seconds);
    if (std::holds_alternative<OdeMethod>(method.way)) try_hash_space(method, row, seconds);
    if (row.step_ms) last_[key_of(row)] = {bodies, seconds};
    return row;
  }

  // Why not even to try; empty where there is no reason.
  std::string find_reason(const Method& method, int bodies) const {
    if (!method.left_out.empty()) return method.left_out;
    if (is_mesh(method) && bodies > kMeshBodiesMax)
      return fmt::format("trimeshes: {} bodies at most", kMeshBodiesMax);
    if (!std::holds_alternative<StatisticalMethod>(method.way) && bodies > kOtherBodiesMax)
      return fmt::format("{} bodies at most", kOtherBodiesMax);
    const auto smaller = last_.find(method.name + method.model());
    if (smaller == last_.end()) return "";
    const double seconds =
        smaller->second.seconds * bodies / smaller->second.bodies;  // at least: no method's time grows less
    if (seconds <= settings_.row_seconds) return "";
    return fmt::format("would take {:.0f} s or more by the row of {} bodies", seconds,
                       smaller->second.bodies);
  }

  // Returns the seconds that all steps took; where they would be more than `limit_s`, `row` says so instead.
  double run(const Method& method, Table1Row& row, double limit_s) const {
    const Method set = with_settings(method, settings_.sleeping, row.hash_space);
    const std::vector<RigidState> starts = table1_starts(row.bodies, settings_.seed);
    const double heap_before = heap_bytes();
    MethodWorld world(job_, set,
                      {.planes = {{Vec3::UnitZ(), 0.0}},
                       .seed = settings_.seed,
                       .threads = row.threads,
                       .sleeping = settings_.sleeping},
                      starts);
    Clock clock;
    Columns columns;
    for (int step = 0; step < kTable1Steps; ++step) {
      show(row, step);
      const StepMs ms = time_step(world, row.threads);
      clock.add(ms.step);
      if (step >= kTable1FirstTimed) columns.add(ms);
      if (step == 60) row.awake[0] = world.awake();
      if (step == 120) row.awake[1] = world.awake();
      if (clock.predicted_s() > limit_s && clock.spent_s() > kPartToJudge * limit_s) {
        row.left_out =
            fmt::format("would take {:.0f} s, as predicted after {} steps", clock.predicted_s(), step + 1);
        return clock.predicted_s();
      }
    }
    row.awake[2] = world.awake();
    row.state_hash = state_hash_of(world);
    row.bytes_per_body = (heap_bytes() - heap_before) / row.bodies;
    if (const Manager* manager = world.manager())
      row.level_bytes_per_body = double(manager->statistical_bytes()) / row.bodies;
    columns.give_to(row);
    return clock.spent_s();
  }

  // The same again with ODE's other space: the row shows the faster.
  void try_hash_space(const Method& method, Table1Row& row, double& seconds) const {
    Table1Row other{.bodies = row.bodies,
                    .method = row.method,
                    .model = row.model,
                    .threads = row.threads,
                    .hash_space = true};
    const double other_seconds = run(method, other, std::min(settings_.row_seconds, 1.5 * seconds));
    if (!other.step_ms || (row.step_ms && *row.step_ms <= *other.step_ms)) return;
    row = std::move(other);
    seconds = other_seconds;
  }

  void compare(std::span<Table1Row> rows) const {
    const auto step_of = [&](std::string_view method) {
      const auto found = std::ranges::find(rows, method, &Table1Row::method);
      return found == rows.end() ? std::nullopt : found->step_ms;
    };
    const auto plain = step_of("full_plain"), spheres = step_of("spheres7"), sphere = step_of("sphere");
    for (Table1Row& row : rows) {
      if (row.step_ms && plain) row.times_less_than_full_plain = *plain / *row.step_ms;
      if (row.step_ms && spheres) row.times_less_than_spheres7 = *spheres / *row.step_ms;
      if (row.step_ms && sphere) row.times_less_than_sphere = *sphere / *row.step_ms;
    }
  }

  void show(const Table1Row& row, int step) const {
    if (settings_.progress)
      settings_.progress(fmt::format("{} bodies, {} {}", row.bodies, row.method, row.model),
                         double(step) / kTable1Steps);
  }

  static std::string key_of(const Table1Row& row) { return row.method + row.model; }

  struct Last {
    int bodies = 0;
    double seconds = 0.0;
  };
  const Table1Settings& settings_;
  DropJob job_;
  std::vector<Method> methods_;
  std::map<std::string, Last> last_;  // the greatest row measured of each method
};

}  // namespace

std::vector<Table1Row> measure_table1(const Table1Settings& settings) { return Table1(settings).rows(); }

void compare_with(const Bandwidth& bandwidth, std::span<Table1Row> rows) {
  for (Table1Row& row : rows) {
    if (!row.step_ms || row.bytes_moved_per_body == 0.0) continue;
    row.moved_gb_per_s = 1e-6 * row.bytes_moved_per_body * row.bodies / *row.step_ms;
    row.share_of_memory = *row.moved_gb_per_s / (row.threads == 1 ? bandwidth.memory_one : bandwidth.memory);
    row.share_of_cache = *row.moved_gb_per_s / (row.threads == 1 ? bandwidth.cache_one : bandwidth.cache);
  }
}

}  // namespace lodestone
