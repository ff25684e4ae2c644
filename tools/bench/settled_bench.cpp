#include "tools/bench/settled_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "lod/manager.h"
#include "reference/random.h"
#include "signature/measure/measure.h"
#include "tools/interrupt.h"
#include "tools/median.h"
#include "tools/memory.h"

namespace lodestone {
namespace {

constexpr double kSleeperFrame = 1.0 / 60, kSleeperApart = 0.5;  // s, m
constexpr int kSleeperSettlingMost = 600;                        // steps
constexpr double kSleeperHeight = 5.0,
                 kSearched = 30.0;  // m: of the viewpoint, a little farther than anyone becomes full; about
                                    // where a body falls, in which those woken are looked for
const Vec3 kSleeperSides(0.2, 0.3, 0.24);  // m, of a crate

class SettledWorld {
 public:
  SettledWorld(const SettledSettings& settings, StatisticalModel model, std::shared_ptr<const Shape> shape,
               std::shared_ptr<const Signature> signature)
      : settings_(settings),
        shape_(std::move(shape)),
        heap_before_(heap_bytes()),
        manager_(make_manager(settings, model, std::move(signature))) {
    row_.model = model, row_.bodies = settings.bodies, row_.threads = settings.threads;
    manager_.add_plane(Vec3::UnitZ(), 0.0);
    side_ = int(std::ceil(std::sqrt(double(settings.bodies))));
    for (int i = 0; i < settings.bodies; ++i)
      bodies_.push_back(manager_.add_body({.shape = shape_, .state = start(i)}));
  }

  SettledRow measure() {
    settle();
    row_.settled_us = time_steps([](int) {});
    row_.watched_us = time_steps([this](int step) {
      if (step == 0) view_from({0, 0, kSleeperHeight});
    });
    row_.moving_us = time_steps([this](int step) { view_from({0.1 * (step + 1), 0, kSleeperHeight}); });
    manager_.set_viewpoints({});
    manager_.step(kSleeperFrame);
    disturb();
    return row_;
  }

 private:
  static Manager make_manager(const SettledSettings& settings, StatisticalModel model,
                              std::shared_ptr<const Signature> signature) {
    ManagerSettings manager;
    manager.seed = settings.seed, manager.threads = settings.threads, manager.model = model;
    manager.signatures = [signature](const Shape&, const ContactLaw&) { return signature; };
    return Manager(manager);
  }

  RigidState start(int i) const {
    RigidState state;
    state.position = {kSleeperApart * (i % side_ - side_ / 2), kSleeperApart * (i / side_ - side_ / 2),
                      0.5 * kSleeperSides.z()};
    return state;
  }

  int count_awake() const {
    return manager_.report().statistical + manager_.report().full - manager_.report().asleep;
  }
  void view_from(const Vec3& place) { manager_.set_viewpoints({&place, 1}); }

  double step_us() {
    const auto begin = std::chrono::steady_clock::now();
    manager_.step(kSleeperFrame);
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  }

  void settle() {
    do {
      show("settling", double(row_.settling_steps) / kSleeperSettlingMost);
      manager_.step(kSleeperFrame);
    } while (++row_.settling_steps < kSleeperSettlingMost && count_awake() > 0);
    row_.awake = count_awake();
    row_.bytes_per_body = (heap_bytes() - heap_before_) / settings_.bodies;
  }

  template <class Before>
  double time_steps(const Before& before) {
    std::vector<double> us;
    for (int step = 0; step < settings_.steps; ++step) {
      before(step);
      us.push_back(step_us());
    }
    return median_of(us);
  }

  void disturb() {
    const std::vector<int> near = bodies_near_middle();
    RigidState falling;
    falling.position =
        bodies_.empty()
            ? Vec3(0, 0, 1)
            : Vec3(manager_.state(bodies_[std::size_t(near.front())]).position + Vec3(0.05, 0.03, 0.5));
    falling.velocity = {0.3 * settings_.speed, 0, -settings_.speed};
    const BodyId fallen = manager_.add_body({.shape = shape_, .state = falling});
    std::vector<bool> woke(near.size());
    std::vector<double> us;
    int awake = 1;
    while (awake > 0 && int(us.size()) < settings_.steps) {
      show("disturbed", double(us.size()) / settings_.steps);
      us.push_back(step_us());
      awake = count_awake();
      row_.woken = std::max(row_.woken, awake);
      int seen = !manager_.asleep(fallen);
      for (std::size_t i = 0; i < near.size(); ++i)
        if (!manager_.asleep(bodies_[std::size_t(near[i])])) ++seen, woke[i] = true;
      row_.woken_unseen = std::max(row_.woken_unseen, awake - seen);
    }
    for (std::size_t i = 0; i < near.size(); ++i)
      if (woke[i])
        row_.farthest_woken_m =
            std::max(row_.farthest_woken_m, (start(near[i]).position - falling.position).norm());
    row_.disturbed_steps = int(us.size());
    row_.disturbed_us = median_of(us);
    row_.disturbed_most_us = std::ranges::max(us);
  }

  // The nearest to the middle first.
  std::vector<int> bodies_near_middle() const {
    std::vector<int> near;
    for (int i = 0; i < settings_.bodies; ++i)
      if (start(i).position.norm() < kSearched) near.push_back(i);
    std::ranges::sort(near, {}, [this](int i) { return start(i).position.squaredNorm(); });
    return near;
  }

  void show(std::string_view what, double part) const {
    if (settings_.progress)
      settings_.progress(
          fmt::format("{} {}", row_.model == StatisticalModel::tables ? "tables" : "support", what), part);
  }

  const SettledSettings& settings_;
  std::shared_ptr<const Shape> shape_;
  double heap_before_;
  Manager manager_;
  std::vector<BodyId> bodies_;
  int side_ = 1;
  SettledRow row_;
};

}  // namespace

std::shared_ptr<const Signature> make_coarse_signature(const Shape& shape) {
  SignatureSettings settings;
  settings.n_theta = 4, settings.n_phi = 4, settings.n_alpha = 6, settings.trials_per_cell = 16;
  settings.height_trials = 200, settings.settling_trials = 60, settings.clips = 30;
  return std::make_shared<const Signature>(measure_signature(shape, settings, 0));
}

std::vector<SettledRow> bench_settled(const SettledSettings& settings) {
  const auto shape = std::make_shared<const Shape>(make_shape("crate", make_box(kSleeperSides)));
  const auto signature = make_coarse_signature(*shape);
  std::vector<SettledRow> rows;
  until_interrupted([&] {
    for (const StatisticalModel model : settings.models)
      rows.push_back(SettledWorld(settings, model, shape, signature).measure());
  });
  return rows;
}

}  // namespace lodestone
