// S14.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "reference/random.h"
#include "tools/bench/ensemble_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr int kBodies = 150;
constexpr double kSeconds = 2.0;

struct Subject {
  StatisticalModel model;
  std::shared_ptr<const Shape> shape;
  std::shared_ptr<const Signature> signature;
};

/// How bodies lie at first: `across` by `across`, `gap` m apart, in as many layers as that takes.
struct Layout { int across; double gap; };
constexpr Layout kHeap{5, 0.35}, kApart{13, 5.0};

RigidState start_of(int i, const Layout& layout) {
  RandomStream random(117, std::uint64_t(i), 0);
  const int across = layout.across;
  return {.position = {layout.gap * (i % across), layout.gap * (i / across % across), 0.4 + 0.4 * (i / (across * across))}, .orientation = random.orientation(), .angular_velocity = 3.0 * random.direction()};
}

/// The bodies' states at the end, by their number, added in the order `order`.
std::vector<RigidState> run(const Subject& subject, const std::vector<int>& order, const Layout& layout, int threads) {
  Manager manager = make_case_manager({.model = subject.model, .threads = threads, .signature = subject.signature});
  std::vector<BodyId> bodies(order.size());
  for (const int i : order) bodies[std::size_t(i)] = add_case_body(manager, subject.shape, start_of(i, layout));
  for (int i = 0; i < int(kSeconds / kCaseStep); ++i) manager.step(kCaseStep);
  std::vector<RigidState> states;
  for (const BodyId body : bodies) states.push_back(manager.state(body));
  return states;
}

int count_different(const std::vector<RigidState>& a, const std::vector<RigidState>& b) {
  int different = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    different += a[i].position != b[i].position || a[i].orientation.coeffs() != b[i].orientation.coeffs() || a[i].velocity != b[i].velocity ||
                 a[i].angular_velocity != b[i].angular_velocity;
  return different;
}

}  // namespace

std::vector<HardCaseRow> measure_orders(const HardCaseSettings&) {
  std::vector<int> in_order(kBodies);
  std::iota(in_order.begin(), in_order.end(), 0);
  std::vector<int> reversed(in_order.rbegin(), in_order.rend());
  const auto box = box_of({0.2, 0.3, 0.25});
  const auto signature = find_case_signature(*box);
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels) {
    const Subject subject{model, box, signature};
    const std::vector<RigidState> heap = run(subject, in_order, kHeap, 1);
    for (const int threads : {2, 5})
      rows.push_back({.what = fmt::format("heap of {} boxes, {} threads, {}: states that differ from one thread's", kBodies, threads, name),
                      .value = double(count_different(heap, run(subject, in_order, kHeap, threads))), .bound = 0.0, .unit = "bodies"});
    if (model == StatisticalModel::tables) continue;  // whose draws are keyed by the body's number
    rows.push_back({.what = fmt::format("{} boxes apart, added in reverse, {}: states that differ", kBodies, name),
                    .value = double(count_different(run(subject, in_order, kApart, 1), run(subject, reversed, kApart, 1))), .bound = 0.0, .unit = "bodies"});
    rows.push_back({.what = fmt::format("heap of {} boxes, added in reverse, {}: states that differ", kBodies, name),
                    .value = double(count_different(heap, run(subject, reversed, kHeap, 1))), .bound = 0.0, .unit = "bodies"});
  }
  return rows;
}

}  // namespace lodestone
