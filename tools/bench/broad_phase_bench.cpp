#include "tools/bench/broad_phase_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "reference/error.h"
#include "reference/ode/space_pairs.h"
#include "tools/bench/bullet_pairs.h"
#include "tools/compare/processor_time.h"
#include "tools/interrupt.h"
#include "tools/median.h"
#include "tools/methods/bullet_world.h"

namespace lodestone {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

constexpr int kPlainMost = 10'000;  // balls that are tried each with each

double clock_ns() {
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void put_in_order(Pairs& pairs) {
  for (auto& [a, b] : pairs)
    if (a > b) std::swap(a, b);
  std::ranges::sort(pairs);
}

/// The cells as the tables model uses them.
class Cells {
 public:
  Cells(const BroadPhaseSettings& settings)
      : jobs_(make_job_runner(settings.threads)), threads_(settings.threads) {}

  void step(const Balls& balls) {
    const auto now = threads_ == 1 ? processor_ns : clock_ns;
    const double start = now();
    grid_.fill(balls.span(), jobs_, threads_);
    const double filled = now();
    if (parts_.size() < std::size_t(grid_.parts())) parts_.resize(std::size_t(grid_.parts()));
    jobs_(grid_.parts(), TaskRef([this](std::int64_t part) {
            parts_[std::size_t(part)].clear();
            grid_.find_pairs(part, parts_[std::size_t(part)]);
          }));
    fill_ns.push_back(filled - start);
    pairs_ns.push_back(now() - filled);
  }

  const CellGrid& grid() const { return grid_; }
  /// The cells also name some pairs that miss each other by a rounding.
  Pairs pairs(const Balls& balls) const {
    Pairs all;
    for (std::int64_t part = 0; part < grid_.parts(); ++part) {
      const BallPairs& found = parts_[std::size_t(part)];
      for (std::int64_t i = 0; i < found.size(); ++i)
        if (balls.meet(found.first(i), found.second(i))) all.emplace_back(found.first(i), found.second(i));
    }
    put_in_order(all);
    return all;
  }

  std::vector<double> fill_ns, pairs_ns;

 private:
  JobRunner jobs_;
  int threads_;
  CellGrid grid_;
  std::vector<BallPairs> parts_;
};

class Row {
 public:
  /// `smaller`: that of fewer balls laid out alike, if any.
  Row(const BroadPhaseSettings& settings, const BallLayout& layout, int bodies, const BroadPhaseRow* smaller)
      : settings_(settings), smaller_(smaller), first_(layout.make(bodies, settings.seed)) {
    row_.layout = layout.name, row_.bodies = bodies, row_.threads = settings.threads;
  }

  BroadPhaseRow measure() {
    measure_cells();
    const std::span<const float> reach = first_.reach;
    if (may_try(&BroadPhaseRow::ode_hash_ns))
      row_.ode_hash_ns = measure_other<OdeSpacePairs>("hash", OdeSpaceKind::hash, reach);
    if (may_try(&BroadPhaseRow::ode_sweep_ns))
      row_.ode_sweep_ns = measure_other<OdeSpacePairs>("sweep", OdeSpaceKind::sweep_and_prune, reach);
    if (bullet_available() && may_try(&BroadPhaseRow::bullet_tree_ns))
      row_.bullet_tree_ns = measure_other<BulletPairs>("tree", reach);
    for (const auto& ns : {row_.ode_hash_ns, row_.ode_sweep_ns, row_.bullet_tree_ns})
      if (ns)
        row_.times_less = std::min(row_.times_less.value_or(1e300), *ns / (row_.fill_ns + row_.pairs_ns));
    if (row_.bodies <= kPlainMost) compare(find_pairs_plainly(last_), "all");
    return row_;
  }

 private:
  void measure_cells() {
    Cells cells(settings_);
    for (int step = 0; step <= settings_.steps; ++step) {
      last_ = move(first_, settings_.speed, step, settings_.seed);
      cells.step(last_);
    }
    // The first step makes what later ones keep.
    row_.fill_ns = median_of({cells.fill_ns.begin() + 1, cells.fill_ns.end()}) / row_.bodies;
    row_.pairs_ns = median_of({cells.pairs_ns.begin() + 1, cells.pairs_ns.end()}) / row_.bodies;
    found_ = cells.pairs(last_);
    if (std::ranges::adjacent_find(found_) != found_.end()) add_fault("a pair was found twice");
    row_.pairs_per_body = double(found_.size()) / row_.bodies;
    row_.cells = cells.grid().cells();
    row_.grids = cells.grid().grids();
    row_.flat = cells.grid().flat();
    row_.bytes_per_body = double(cells.grid().bytes()) / row_.bodies;
  }

  // Not where a step of fewer balls foretells, by its growth with their square, that one step alone would
  // take too long.
  bool may_try(std::optional<double> BroadPhaseRow::*ns) const {
    if (!smaller_) return true;
    const double growth = double(row_.bodies) / smaller_->bodies;
    return smaller_->*ns && *(smaller_->*ns) * growth * row_.bodies < 1e9 * settings_.row_seconds;
  }

  // The same balls in the same steps.
  template <class Other, class... Arguments>
  std::optional<double> measure_other(std::string_view name, Arguments... arguments) {
    Other other(arguments...);
    Balls balls;
    Pairs pairs;
    std::vector<double> ns;
    double left_ns = 1e9 * settings_.row_seconds;
    for (int step = 0; step <= settings_.steps; ++step) {
      balls = move(first_, settings_.speed, step, settings_.seed);
      pairs.clear();
      ns.push_back(measure_processor_ns([&] {
        other.place(balls.x, balls.y, balls.z);
        other.find(pairs);
      }));
      left_ns -= ns.back();
      if (step > 0 && ns.back() * (settings_.steps - step) > left_ns) return {};
    }
    put_in_order(pairs);
    compare(pairs, name);
    return median_of({ns.begin() + 1, ns.end()}) / row_.bodies;
  }

  // Each side has looked at the distances: a pair that one of them names is there, and who does not name it
  // has missed it.
  void compare(const Pairs& others, std::string_view by) {
    Pairs missed, missed_by_other;
    std::ranges::set_difference(others, found_, std::back_inserter(missed));
    std::ranges::set_difference(found_, others, std::back_inserter(missed_by_other));
    if (!row_.checked_by.empty()) row_.checked_by += ' ';
    row_.checked_by += by;
    if (!missed_by_other.empty()) row_.checked_by += fmt::format("-{}", missed_by_other.size());
    if (!missed.empty())
      add_fault(
          fmt::format("{} of the {} pairs that {} found were missed", missed.size(), others.size(), by));
  }

  void add_fault(const std::string& fault) { row_.fault += (row_.fault.empty() ? "" : "; ") + fault; }

  const BroadPhaseSettings& settings_;
  const BroadPhaseRow* smaller_;
  Balls first_, last_;
  Pairs found_;
  BroadPhaseRow row_;
};

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_pairs_plainly(const Balls& balls) {
  Pairs pairs;
  for (std::uint32_t a = 0; a < balls.size(); ++a)
    for (std::uint32_t b = a + 1; b < balls.size(); ++b)
      if (balls.meet(a, b)) pairs.emplace_back(a, b);
  return pairs;
}

std::vector<BroadPhaseRow> bench_broad_phase(const BroadPhaseSettings& settings) {
  std::vector<int> sizes = settings.bodies;
  std::ranges::sort(sizes);
  std::vector<BroadPhaseRow> rows;
  const std::size_t count = sizes.size() * settings.layouts.size();
  const auto measure_rows_of = [&](const std::string& name) {
    const auto layout = std::ranges::find(ball_layouts(), name, &BallLayout::name);
    check_that(layout != ball_layouts().end(), "a layout of this name is known:", name);
    for (const int bodies : sizes) {
      if (settings.progress)
        settings.progress(fmt::format("{} bodies, {}", bodies, name), double(rows.size()) / double(count));
      const bool first = rows.empty() || rows.back().layout != name;
      rows.push_back(Row(settings, *layout, bodies, first ? nullptr : &rows.back()).measure());
    }
  };
  until_interrupted([&] { std::ranges::for_each(settings.layouts, measure_rows_of); });
  return rows;
}

}  // namespace lodestone
