#include "tools/bench/budget_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lod/manager.h"
#include "lod/timing/thread_clock.h"
#include "reference/mesh/mesh.h"
#include "tools/bench/falling_heap.h"
#include "tools/hard_cases/statistical_case_parts.h"
#include "tools/interrupt.h"

namespace lodestone {
namespace {

constexpr ContactLaw kLaw{.restitution = 0.3, .friction = 0.5};
constexpr int kSettled = 30;  // steps after a jump
const int kJumpSteps = int(std::lround(kJumpEvery_s / kCaseStep));

// Each place as far from those before as it can be: the golden angle apart.
Vec3 viewpoint_at(int step, double heap_radius_m) {
  const double angle = (step / kJumpSteps) * std::numbers::pi * (3.0 - std::sqrt(5.0));
  return {0.6 * heap_radius_m * std::cos(angle), 0.6 * heap_radius_m * std::sin(angle), 0.5};
}

class RunningMean {
 public:
  void add(double value) { mean_ += (value - mean_) / ++count_; }
  double mean() const { return mean_; }

 private:
  double mean_ = 0.0;
  int count_ = 0;
};

class BudgetRun {
 public:
  BudgetRun(const BudgetBenchSettings& settings, const PolicySettings& policy, int threads,
            const std::shared_ptr<const Shape>& shape, const std::shared_ptr<const Signature>& signature)
      : settings_(settings),
        policy_(policy),
        heap_(make_falling_heap(settings.bodies, shape->radius, settings.seed)),
        manager_({.seed = settings.seed,
                  .threads = threads,
                  .policy = policy,
                  .signatures = [signature](const Shape&, const ContactLaw&) { return signature; }}) {
    row_.threads = threads;
    manager_.materials().replace(0, {.restitution = kLaw.restitution, .friction = kLaw.friction});
    manager_.add_plane(Vec3::UnitZ(), 0.0);
    for (const RigidState& start : heap_.starts)
      bodies_.push_back(manager_.add_body({.shape = shape, .state = start}));
  }

  BudgetBenchRow measure(const std::string& name) {
    for (int step = 0; step < settings_.steps; ++step) {
      if (settings_.progress) settings_.progress(name, double(step) / settings_.steps);
      const Vec3 viewpoint = viewpoint_at(step, heap_.radius_m);
      manager_.set_viewpoints({&viewpoint, 1});
      const double before = thread_time_ms();
      const StepReport& report = manager_.step(kCaseStep);
      step_ms_.push_back(thread_time_ms() - before);
      reports_.push_back(report);
      if (step + 1 >= kFirstBudgetStep) observe(step, viewpoint);
    }
    row_.figures = find_budget_figures(policy_, reports_, step_ms_).value();
    row_.nearest = nearest_.mean(), row_.nearest_settled = nearest_settled_.mean();
    for (auto& [why, count] : row_.waiting) count /= row_.figures.steps;
    row_.state_hash = manager_.state_hash();
    return row_;
  }

 private:
  void observe(int step, const Vec3& viewpoint) {
    const StepReport& report = reports_.back();
    std::array<int, kRungs> now{};
    now[std::size_t(Rung::full)] = report.full, now[std::size_t(Rung::support)] = report.support,
    now[std::size_t(Rung::tables)] = report.tables;
    const bool first = step + 1 == kFirstBudgetStep;
    for (std::size_t rung = 0; rung < kRungs; ++rung) {
      row_.least[rung] = first ? now[rung] : std::min(row_.least[rung], now[rung]);
      row_.most[rung] = std::max(row_.most[rung], now[rung]);
    }
    std::vector<std::pair<double, BodyId>> near;  // m
    for (const BodyId body : bodies_)
      near.emplace_back((manager_.state(body).position - viewpoint).norm(), body);
    const int looked_at = std::min(settings_.bodies, std::max(report.full, kNearest));
    std::ranges::partial_sort(near, near.begin() + looked_at, {}, &std::pair<double, BodyId>::first);
    const auto is_full = [this](const auto& one) { return manager_.rung(one.second) == Rung::full; };
    for (int i = 0; i < std::min(settings_.bodies, kNearest); ++i)
      if (!is_full(near[std::size_t(i)])) ++row_.waiting[manager_.why(near[std::size_t(i)].second)];
    if (report.full == 0) return;
    const double part =
        double(std::count_if(near.begin(), near.begin() + report.full, is_full)) / report.full;
    nearest_.add(part);
    if (step % kJumpSteps >= kSettled) nearest_settled_.add(part);
  }

  const BudgetBenchSettings& settings_;
  PolicySettings policy_;
  FallingHeap heap_;
  Manager manager_;
  std::vector<BodyId> bodies_;
  std::vector<StepReport> reports_;
  std::vector<double> step_ms_;
  RunningMean nearest_, nearest_settled_;
  BudgetBenchRow row_;
};

}  // namespace

bool is_kept(const BudgetFigures& figures) {
  if (!figures.budget_ms) return true;
  const double budget = *figures.budget_ms;
  return figures.step_ms.p99 <= 1.1 * budget && 100 * *figures.over <= figures.steps &&
         figures.step_ms.max <= 2.0 * budget;
}

std::vector<BudgetBenchRow> bench_budget(const BudgetBenchSettings& settings) {
  const auto shape = std::make_shared<const Shape>(make_bunny_shape(0.2));
  const auto signature = find_case_signature(*shape, kLaw);
  std::vector<BudgetBenchRow> rows;
  until_interrupted([&] {
    for (const double ms : settings.budgets_ms)
      rows.push_back(BudgetRun(settings, {.policy = BudgetPolicy{ms}}, settings.threads, shape, signature)
                         .measure(fmt::format("{:g} ms", ms)));
    if (settings.work > 0.0)
      for (const int threads : {1, 2, 1, 2})
        rows.push_back(BudgetRun(settings, {.policy = WorkPolicy{settings.work}}, threads, shape, signature)
                           .measure(fmt::format("{:g} units, {} threads", settings.work, threads)));
  });
  return rows;
}

bool repeats_exactly(const std::vector<BudgetBenchRow>& rows) {
  const BudgetBenchRow* first = nullptr;
  for (const BudgetBenchRow& row : rows) {
    if (!row.figures.budget_work) continue;
    if (first && first->state_hash != row.state_hash) return false;
    first = &row;
  }
  return true;
}

}  // namespace lodestone
