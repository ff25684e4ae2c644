#include "tools/bench/rungs_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>

#include "lod/manager.h"
#include "scenes/shape_source.h"
#include "tools/bench/falling_heap.h"
#include "tools/hard_cases/statistical_case_parts.h"
#include "tools/interrupt.h"
#include "tools/median.h"

namespace lodestone {
namespace {

constexpr int kHeapSettlingMost = 1'800, kSettlingAwake = 60;  // steps

/// m, of a move in one frame: beyond what gravity can have added, from a velocity at its start that was v0,
/// or any between v0 and v1.
double move_beyond(const Vec3& moved, const Vec3& v0, const Vec3& v1) {
  return std::max(0.0, distance_beyond(moved, kCaseStep * v0, kCaseStep * v1) -
                           0.5 * kCaseGravity * kCaseStep * kCaseStep);
}
double move_beyond(const Vec3& moved, const Vec3& velocity) { return move_beyond(moved, velocity, velocity); }

/// Some bodies' change to a rung.
struct Change {
  std::string name;
  std::span<const int> bodies = {};
  LevelChoice choice = LevelChoice::support;
  Rung rung = Rung::support;
};

struct Samples {
  std::vector<double> moves, unexplained;  // m
  RungsRow row = {};
};

RungsRow row_of(const std::string& name, Samples samples) {
  std::ranges::sort(samples.moves);
  std::ranges::sort(samples.unexplained);
  RungsRow row = samples.row;
  row.change = name, row.changes = std::int64_t(samples.moves.size());
  row.p50_mm = 1e3 * percentile_of(samples.moves, 0.5), row.p99_mm = 1e3 * percentile_of(samples.moves, 0.99);
  row.p999_mm = 1e3 * percentile_of(samples.moves, 0.999),
  row.max_mm = 1e3 * percentile_of(samples.moves, 1.0);
  row.unexplained_p999_mm = 1e3 * percentile_of(samples.unexplained, 0.999),
  row.unexplained_max_mm = 1e3 * percentile_of(samples.unexplained, 1.0);
  return row;
}

class RungsRun {
 public:
  RungsRun(const RungsSettings& settings, std::string name, std::shared_ptr<const Shape> shape,
           std::shared_ptr<const Signature> signature, std::span<const RigidState> starts, bool kept_awake)
      : settings_(settings),
        shape_(std::move(shape)),
        manager_(make_manager(std::move(signature), kept_awake)) {
    manager_.add_plane(Vec3::UnitZ(), 0.0);
    heap_.shape = std::move(name), heap_.bodies = int(starts.size()), heap_.kept_awake = kept_awake;
    for (const RigidState& start : starts)
      bodies_.push_back(manager_.add_body({.shape = shape_, .state = start, .level = LevelChoice::support}));
    before_.resize(bodies_.size()), after_.resize(bodies_.size());
  }

  /// Until all sleep.
  std::vector<RigidState> settle() {
    for (int step = 0; step < kHeapSettlingMost && (step == 0 || manager_.report().asleep < heap_.bodies);
         ++step) {
      show("comes to rest", double(step) / kHeapSettlingMost);
      manager_.step(kCaseStep);
    }
    read(before_);
    return before_;
  }

  /// Of a settled heap.
  RungsHeap measure() {
    if (heap_.kept_awake)
      for (int step = 0; step < kSettlingAwake; ++step) manager_.step(kCaseStep);
    heap_.mean_height_before_m = mean_height();
    heap_.asleep_before = manager_.report().asleep;
    order_from_the_edge();
    for (int round = 0; round < settings_.rounds; ++round) climb(round);
    heap_.mean_height_after_m = mean_height();
    heap_.asleep_after = manager_.report().asleep;
    for (const char* name : {"none", "support to tables", "tables to support", "support to full",
                             "full to support", "tables to full", "full to tables"})
      heap_.rows.push_back(row_of(name, std::move(samples_[name])));
    return heap_;
  }

 private:
  static Manager make_manager(std::shared_ptr<const Signature> signature, bool kept_awake) {
    return Manager({.sleeping = !kept_awake,
                    .signatures = [signature](const Shape&, const ContactLaw&) { return signature; }});
  }

  void order_from_the_edge() {
    read(before_);
    double edge = 0.0;
    for (const RigidState& state : before_) edge = std::max(edge, state.position.head<2>().norm());
    order_.resize(bodies_.size());
    std::iota(order_.begin(), order_.end(), 0);
    const Vec3 place(edge, 0, 0);
    std::ranges::sort(order_, {}, [&](int i) { return (before_[std::size_t(i)].position - place).norm(); });
  }

  int slices() const { return (heap_.bodies + settings_.slice - 1) / settings_.slice; }
  std::span<const int> slice(int index) const {
    const int first = index * settings_.slice;
    return std::span(order_).subspan(std::size_t(first),
                                     std::size_t(std::min(settings_.slice, heap_.bodies - first)));
  }

  void climb(int round) {
    show(fmt::format("round {} of {}", round + 1, settings_.rounds), double(round) / settings_.rounds);
    const std::span<const int> all = order_, one = slice(round % slices());
    watch({{.name = "none", .bodies = all}});
    watch({{"support to tables", all, LevelChoice::tables, Rung::tables}});
    watch({{"tables to full", one, LevelChoice::full, Rung::full}});
    watch({{"full to tables", one, LevelChoice::tables, Rung::tables}});
    watch({{"tables to support", all, LevelChoice::support, Rung::support}});
    // While a slice goes up, the last one comes down.
    for (int i = 0; i <= slices(); ++i) {
      std::vector<Change> changes;
      if (i < slices()) changes.push_back({"support to full", slice(i), LevelChoice::full, Rung::full});
      if (i > 0) changes.push_back({"full to support", slice(i - 1), LevelChoice::support, Rung::support});
      watch(changes);
    }
  }

  void watch(const std::vector<Change>& changes) {
    for (const Change& change : changes)
      for (const int i : change.bodies) manager_.set_level(bodies_[std::size_t(i)], change.choice);
    const int asleep = manager_.report().asleep;
    read(before_);
    const double energy_before = energy_of(before_);
    double highest = energy_before;
    std::vector<double> moves(bodies_.size(), 0.0), unexplained(bodies_.size(), 0.0);
    for (int frame = 0; frame < settings_.frames; ++frame) {
      manager_.step(kCaseStep);
      read(after_);
      for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const Vec3 moved = after_[i].position - before_[i].position;
        moves[i] = std::max(moves[i], move_beyond(moved, before_[i].velocity));
        unexplained[i] =
            std::max(unexplained[i], move_beyond(moved, before_[i].velocity, after_[i].velocity));
      }
      highest = std::max(highest, energy_of(after_));
      std::swap(before_, after_);
    }
    const double rise =
        (highest - energy_before) / (manager_.mass(bodies_[0]) * kCaseGravity * shape_->radius);
    const int woken = std::max(0, asleep - manager_.report().asleep);
    std::vector<bool> changed(bodies_.size());
    for (const Change& change : changes)
      for (const int i : change.bodies) changed[std::size_t(i)] = true;
    double others = 0.0;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (!changed[i]) others = std::max(others, moves[i]);
    for (const Change& change : changes) add(change, moves, unexplained, rise, woken, others);
  }

  void add(const Change& change, std::span<const double> moves, std::span<const double> unexplained,
           double rise, int woken, double others) {
    Samples& samples = samples_[change.name];
    RungsRow& row = samples.row;
    for (const int i : change.bodies) {
      samples.moves.push_back(moves[std::size_t(i)]);
      samples.unexplained.push_back(unexplained[std::size_t(i)]);
      row.put_off += manager_.rung(bodies_[std::size_t(i)]) != change.rung;
    }
    row.energy_rise = std::max(row.energy_rise, rise);
    row.woken += woken;
    row.others_max_mm = std::max(row.others_max_mm, 1e3 * others);
  }

  void read(std::vector<RigidState>& states) const {
    for (std::size_t i = 0; i < bodies_.size(); ++i) states[i] = manager_.state(bodies_[i]);
  }

  /// J, kinetic and potential.
  double energy_of(std::span<const RigidState> states) const {
    const double mass = manager_.mass(bodies_[0]);
    double sum = 0.0;
    for (const RigidState& state : states)
      sum += kinetic_energy(*shape_, mass, state) + mass * kCaseGravity * state.position.z();
    return sum;
  }

  double mean_height() {
    read(before_);
    double sum = 0.0;
    for (const RigidState& state : before_) sum += state.position.z();
    return sum / double(before_.size());
  }

  void show(const std::string& what, double part) const {
    if (settings_.progress)
      settings_.progress(fmt::format("{} x {}, {}: {}", heap_.bodies, heap_.shape,
                                     heap_.kept_awake ? "kept awake" : "asleep", what),
                         part);
  }

  const RungsSettings& settings_;
  std::shared_ptr<const Shape> shape_;
  Manager manager_;
  std::vector<BodyId> bodies_;
  std::vector<int> order_;                  // nearest to the edge's place first
  std::vector<RigidState> before_, after_;  // of a frame
  std::map<std::string, Samples> samples_;  // by kind of change
  RungsHeap heap_;
};

}  // namespace

double distance_beyond(const Vec3& moved, const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double length = way.squaredNorm();
  const double part = length > 0.0 ? std::clamp((moved - from).dot(way) / length, 0.0, 1.0) : 0.0;
  return (moved - from - part * way).norm();
}

bool is_unseen(const RungsRow& row) { return row.p999_mm <= 5.0 && row.max_mm <= 20.0; }

std::vector<RungsHeap> bench_rungs(const RungsSettings& settings) {
  std::vector<RungsHeap> heaps;
  const auto measure_heaps_of = [&](const std::string& name) {
    const bool bunny = name == "bunny";
    const auto shape = share(make_shape_from_text(bunny ? "bunny" : "l:0.3,0.2,0.08,0.1"));
    const auto signature = find_case_signature(*shape);
    const FallingHeap falling =
        make_falling_heap(settings.bodies.value_or(bunny ? 1'000 : 300), shape->radius, settings.seed);
    RungsRun asleep(settings, name, shape, signature, falling.starts, false);
    const std::vector<RigidState> settled = asleep.settle();
    heaps.push_back(asleep.measure());
    heaps.push_back(RungsRun(settings, name, shape, signature, settled, true).measure());
  };
  until_interrupted([&] { std::ranges::for_each(settings.shapes, measure_heaps_of); });
  return heaps;
}

}  // namespace lodestone
