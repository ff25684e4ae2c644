#include "tools/bench/endurance_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "lod/manager.h"
#include "lod/timing/thread_clock.h"
#include "reference/random.h"
#include "scenes/run_measures.h"
#include "scenes/runner.h"
#include "tools/bench/settled_bench.h"
#include "tools/interrupt.h"
#include "tools/median.h"
#include "tools/memory.h"

namespace lodestone {
namespace {

constexpr double kEnduranceFrame = 1.0 / 60, kGravity = 9.81;  // s, m/s²
constexpr double kCircle_m = 6.0, kCircle_s = 7.0;             // of the viewpoint: radius, and once round
const Vec3 kEnduranceSides(0.2, 0.3, 0.24);                    // m, of a crate
constexpr double kSceneCircle_m = 10.0, kSceneHeight_m = 2.0;  // of a scene's viewpoint

/// What is read at the end of each round.
class Rounds {
 public:
  explicit Rounds(std::int64_t steps) {  // before memory is looked at
    for (auto* each : {&step_us_, &heap_, &resident_}) each->reserve(std::size_t(steps / kEnduranceRound));
  }

  void add(double step_us) {
    step_us_.push_back(step_us);
    heap_.push_back(heap_bytes()), resident_.push_back(resident_bytes());
  }

  void sum_up(EnduranceFigures& figures) const {
    if (step_us_.size() < 2) return;
    const auto rounds = double(step_us_.size());
    const auto tenth = std::max<std::ptrdiff_t>(1, std::ptrdiff_t(rounds / 10));
    const auto growth = [&](const std::vector<double>& bytes) {
      return *std::ranges::max_element(bytes.begin() + tenth, bytes.end()) - bytes[std::size_t(tenth - 1)];
    };
    figures.heap_growth_bytes = growth(heap_);
    figures.resident_growth_bytes = growth(resident_);
    const auto second = step_us_.begin() + tenth;
    figures.first_step_us =
        median_of(std::vector<double>(second, second + std::min(tenth, step_us_.end() - second)));
    figures.last_step_us = median_of(std::vector<double>(step_us_.end() - tenth, step_us_.end()));
  }

 private:
  std::vector<double> step_us_, heap_, resident_;
};

void show_progress(const EnduranceSettings& settings, std::int64_t steps) {
  if (settings.progress)
    settings.progress(fmt::format("step {} of {}", steps, settings.steps),
                      double(steps) / double(settings.steps));
}

class EndlessWorld {
 public:
  explicit EndlessWorld(const EnduranceSettings& settings)
      : settings_(settings),
        shape_(std::make_shared<const Shape>(make_shape("crate", make_box(kEnduranceSides)))),
        manager_(make_manager(settings, make_coarse_signature(*shape_))),
        rounds_(settings.steps) {
    manager_.add_plane(Vec3::UnitZ(), 0.0);
    for (int i = 0; i < settings.bodies; ++i)
      bodies_.push_back(manager_.add_body({.shape = shape_, .state = start(0, i)}));
  }

  EnduranceFigures measure() {
    until_interrupted([this] {
      for (std::int64_t round = 0; (round + 1) * kEnduranceRound <= settings_.steps && figures_.finite;
           ++round) {
        show_progress(settings_, figures_.steps);
        run_round(round);
      }
    });
    rounds_.sum_up(figures_);
    return figures_;
  }

 private:
  static Manager make_manager(const EnduranceSettings& settings,
                              const std::shared_ptr<const Signature>& signature) {
    ManagerSettings manager;
    manager.gravity = {0, 0, -kGravity};
    manager.seed = settings.seed, manager.threads = settings.threads;
    manager.policy = {.policy = DistancePolicy{.full_within = 5.0, .support_within = 7.0}};
    manager.signatures = [signature](const Shape&, const ContactLaw&) { return signature; };
    return Manager(manager);
  }

  // In a square of cells too wide for two to meet in the air.
  RigidState start(std::int64_t round, int body) const {
    RandomStream random(settings_.seed, std::uint64_t(round), std::uint32_t(body));
    const int side = int(std::ceil(std::sqrt(double(settings_.bodies))));
    RigidState state;
    state.position = {0.6 * (body % side - 0.5 * side), 0.6 * (body / side - 0.5 * side),
                      random.uniform(0.5, 1.5)};
    state.orientation = random.orientation();
    const Vec3 way = random.direction();  // apart: the order of two draws in one expression is the compiler's
    state.velocity = random.uniform(0.0, 1.0) * way;
    const Vec3 axis = random.direction();
    state.angular_velocity = random.uniform(0.0, 10.0) * axis;
    return state;
  }

  void run_round(std::int64_t round) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) manager_.set_state(bodies_[i], start(round, int(i)));
    const double energy_at_start = energy_j();
    double spent_ms = 0;
    for (int step = 0; step < kEnduranceRound && figures_.finite; ++step) {
      const double angle =
          2 * std::numbers::pi * std::fmod(double(figures_.steps) * kEnduranceFrame / kCircle_s, 1.0);
      const Vec3 viewpoint = kCircle_m * Vec3(std::cos(angle), std::sin(angle), 0.2);
      manager_.set_viewpoints({&viewpoint, 1});
      const double before_ms = thread_time_ms();
      const StepReport& report = manager_.step(kEnduranceFrame);
      spent_ms += thread_time_ms() - before_ms;
      ++figures_.steps;
      figures_.changes += report.promotions + report.demotions;
      figures_.states_recovered = report.counters.states_recovered;
      figures_.energy_over_start = std::max(figures_.energy_over_start, energy_j() / energy_at_start);
    }
    rounds_.add(1e3 * spent_ms / kEnduranceRound);
  }

  double energy_j() {
    double sum = 0;
    for (const BodyId body : bodies_) {
      const RigidState state = manager_.state(body);
      figures_.finite = figures_.finite && is_finite(state);
      sum += kinetic_energy(*shape_, manager_.mass(body), state) +
             manager_.mass(body) * kGravity * state.position.z();
    }
    return sum;
  }

  const EnduranceSettings& settings_;
  std::shared_ptr<const Shape> shape_;
  Manager manager_;
  std::vector<BodyId> bodies_;
  Rounds rounds_;
  EnduranceFigures figures_;
};

// Round where the scene's first viewpoint looks, as a path of its own for all the steps.
SceneViewpoint circling_viewpoint(const Scene& scene, std::int64_t steps) {
  constexpr int kCorners = 24;
  SceneViewpoint viewpoint;
  if (!scene.viewpoints.empty()) viewpoint.look_at_m = scene.viewpoints.front().look_at_m;
  for (std::int64_t corner = 0; corner <= kCorners * (steps / kEnduranceCircle + 1); ++corner) {
    const double angle = 2 * std::numbers::pi * double(corner % kCorners) / kCorners;
    viewpoint.path.push_back({double(corner) * kEnduranceCircle * scene.step.dt_s / kCorners,
                              viewpoint.look_at_m + Vec3(kSceneCircle_m * std::cos(angle),
                                                         kSceneCircle_m * std::sin(angle), kSceneHeight_m)});
  }
  return viewpoint;
}

EnduranceFigures endure_scene(const EnduranceSettings& settings) {
  const int steps = int(std::min<std::int64_t>(settings.steps, std::numeric_limits<int>::max()));
  Scene scene = *settings.scene;
  scene.viewpoints = {circling_viewpoint(scene, steps)};
  Rounds rounds(steps);
  EnduranceFigures figures;
  double spent_ms = 0, energy_at_start = 0;
  const auto watch = [&](const WatchedStep& step) {
    if (figures.steps == 0) energy_at_start = step.before.energy_j;
    const StepReport& report = step.manager.report();
    ++figures.steps;
    figures.changes += report.promotions + report.demotions;
    figures.states_recovered = report.counters.states_recovered;
    figures.energy_over_start = std::max(figures.energy_over_start, step.after.energy_j / energy_at_start);
    figures.finite = step.after.finite;
    spent_ms += step.processor_ms;
    if (figures.steps % kEnduranceRound != 0) return;
    rounds.add(1e3 * spent_ms / kEnduranceRound);
    spent_ms = 0;
    show_progress(settings, figures.steps);
  };
  until_interrupted([&] {
    run_scene(scene, {.steps = steps, .threads = settings.threads, .watch = watch, .stop = is_interrupted});
  });
  rounds.sum_up(figures);
  return figures;
}

}  // namespace

bool endures(const EnduranceFigures& figures) {
  return figures.finite && figures.states_recovered == 0 && !(figures.heap_growth_bytes > kEnduranceMemory) &&
         !(figures.resident_growth_bytes > kEnduranceMemory) &&
         figures.energy_over_start <= kEnduranceEnergy &&
         figures.last_step_us <= kEnduranceSlower * figures.first_step_us;
}

EnduranceFigures bench_endurance(const EnduranceSettings& settings) {
  return settings.scene ? endure_scene(settings) : EndlessWorld(settings).measure();
}

}  // namespace lodestone
