#include "scenes/runner.h"

#include <fmt/format.h>

#include <chrono>

#include "lod/timing/thread_clock.h"
#include "reference/output_file.h"
#include "scenes/run_files.h"
#include "scenes/run_observer.h"
#include "scenes/scene_manager.h"
#include "signature/signature_source.h"

namespace lodestone {
namespace {

/// One run, step by step.
class Run {
 public:
  Run(const Scene& scene, const RunSettings& settings, int steps, double dt_s)
      : scene_(scene),
        settings_(settings),
        steps_(steps),
        dt_s_(dt_s),
        manager_(make_manager(scene, settings, timed_signatures())),
        files_(scene, settings),
        observer_(scene, dt_s),
        budget_(policy_of(scene, settings)) {
    move_viewpoints(manager_, scene_, 0);
    if (!settings_.record.empty()) record_to(settings_.record);
    bodies_ = add_scene_bodies(manager_, scene_, settings_.level);
    result_.bodies = int(bodies_.size());
    observer_.begin(manager_, bodies_);
    files_.record(manager_, bodies_, observer_.sample(), 0, dt_s_);
  }

  /// Goes on from where `other`, a run of the same scene, is after `step` steps, with settings of its own.
  void fork_from(const Run& other, int step) {
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const SceneBody& body : scene_.bodies) shapes.push_back(body.definition.shape);
    manager_.restore(other.manager_.snapshot(), shapes);
    manager_.set_policy(policy_of(scene_, settings_));
    if (settings_.level != LevelChoice::automatic)  // else each has what the scene says
      for (const BodyId body : bodies_) manager_.set_level(body, settings_.level);
    from_step_ = step;
    files_.begin_anew(step);
    observer_.begin_from(other.observer_, manager_, bodies_);
    files_.record(manager_, bodies_, observer_.sample(), step, dt_s_);
  }

  const RunObserver& observer() const { return observer_; }
  const std::optional<SimulationError>& failure() const { return result_.failure; }

  /// Whether there is another step after `step` of them.
  bool goes_on(int step) {
    if (step >= steps_ || !observer_.is_finite() || result_.failure) return false;
    const bool is_stopped = result_.steps > 0 && settings_.stop && settings_.stop();
    result_.incomplete = result_.incomplete || is_stopped || !files_.fault().empty();
    return !result_.incomplete;
  }

  /// False where ODE gave up: the step does not count.
  bool advance(int step) try {
    move_viewpoints(manager_, scene_, step * dt_s_);
    const auto start = Clock::now();
    const double signatures_before = result_.signature_seconds;
    const double thread_start = stepping_ms();
    const StepReport report = manager_.step(dt_s_);
    const double processor_ms = stepping_ms() - thread_start;
    times_.add(1e3 * (seconds_since(start) - (result_.signature_seconds - signatures_before)));
    count(report, processor_ms);
    if (settings_.watch) before_ = observer_.sample();
    observer_.look(manager_, bodies_, step);
    if (settings_.watch)
      settings_.watch({manager_, bodies_, before_, observer_.sample(), step * dt_s_, dt_s_, processor_ms});
    files_.record(manager_, bodies_, observer_.sample(), step + 1, dt_s_);
    files_.add_row(report, (step + 1) * dt_s_, observer_.sample());
    if (settings_.progress)
      settings_.progress({.step = step + 1,
                          .steps = steps_,
                          .full = report.full,
                          .support = report.support,
                          .tables = report.tables,
                          .asleep = report.asleep});
    return true;
  } catch (const SimulationError& error) {
    result_.failure = error, result_.incomplete = true;
    return false;
  }

  RunResult finish() {
    const int end_step = from_step_ + result_.steps;
    result_.state_hash = manager_.state_hash();
    result_.step_ms = times_.summary();
    result_.processor_ms = processor_times_.summary();
    result_.budget = budget_.figures();
    observer_.sum_up(result_, end_step);
    files_.finish(manager_, bodies_, observer_.sample(), end_step, dt_s_,
                  fmt::format("{}: {}", scene_.file.stem().string(), text_of_choice(settings_)), result_);
    result_.write_error = files_.fault();
    result_.incomplete = result_.incomplete || !result_.write_error.empty();
    return std::move(result_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  /// Processor time of this thread, without what went into signatures.
  double stepping_ms() const { return thread_time_ms() - signature_thread_ms_; }

  /// The source of signatures, on the clock: to measure one is preparation, though it happens within a step.
  SignatureFunction timed_signatures() {
    return [this](const Shape& shape, const ContactLaw& law) {
      const auto start = Clock::now();
      const double thread_start = thread_time_ms();
      auto signature = settings_.signatures ? settings_.signatures(shape, law)
                                            : find_or_measure_signature(shape, law).signature;
      result_.signature_seconds += seconds_since(start);
      signature_thread_ms_ += thread_time_ms() - thread_start;
      return signature;
    };
  }

  void record_to(const std::filesystem::path& file) {
    manager_.set_record([this, out = std::make_shared<OutputFile>(file, "room for the recording")](
                            std::span<const std::byte> bytes) {
      files_.write([&] {
        out->write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        out->flush();
      });
    });
  }

  /// Of a step that has just ended. What is not asked for is not kept: a run may have as many steps as anyone
  /// can wait for.
  void count(const StepReport& report, double processor_ms) {
    ++result_.steps;
    result_.last_report = report;
    result_.stage_ms += report.times;
    result_.promotions += report.promotions;
    result_.transitions += report.promotions + report.demotions;
    processor_times_.add(processor_ms);
    budget_.add(report, processor_ms);
    if (settings_.keep_steps) result_.reports.push_back(report);
    if (settings_.keep_steps || files_.has_playback()) result_.step_processor_ms.push_back(processor_ms);
  }

  const Scene& scene_;
  const RunSettings& settings_;
  int steps_;
  double dt_s_;
  RunResult result_;
  Manager manager_;
  std::vector<BodyId> bodies_;
  RunFiles files_;
  RunObserver observer_;
  RunSample before_;                   // for settings_.watch alone
  TimeTally times_, processor_times_;  // ms
  BudgetTally budget_;
  double signature_thread_ms_ = 0;
  int from_step_ = 0;
};

RunResult run_forked(const Scene& scene, const RunSettings& settings, int steps, double dt_s) {
  RunSettings as_scene = settings;
  as_scene.fork_step.reset(), as_scene.model.reset(), as_scene.budget_ms.reset(),
      as_scene.budget_work.reset(), as_scene.full_within_m.reset();
  as_scene.level = LevelChoice::automatic;
  const int at = *settings.fork_step;
  Run first(scene, as_scene, steps, dt_s), second(scene, settings, steps, dt_s);
  int step = 0;
  for (; step < at && first.goes_on(step); ++step) first.advance(step);
  const auto forked = std::make_shared<ForkedRun>();
  forked->step = step;
  if (first.goes_on(step)) second.fork_from(first, step);
  for (bool together = true; first.goes_on(step); ++step) {
    together = together && second.goes_on(step);
    if (!first.advance(step) || !together || !second.advance(step)) continue;
    forked->mean_distance_m.push_back(second.observer().mean_distance_m(first.observer()));
  }
  RunResult result = first.finish();
  if (!result.failure) result.failure = second.failure();
  if (forked->mean_distance_m.empty()) return result;  // it diverged before
  forked->result = second.finish();
  if (result.write_error.empty()) result.write_error = forked->result.write_error;
  result.fork = forked;
  return result;
}

RunResult run_alone(const Scene& scene, const RunSettings& settings, int steps, double dt_s) {
  Run run(scene, settings, steps, dt_s);
  for (int step = 0; run.goes_on(step); ++step) run.advance(step);
  return run.finish();
}

}  // namespace

RunResult run_scene(const Scene& scene, const RunSettings& settings) {
  const int steps = settings.steps.value_or(scene.default_steps);
  const double dt_s = settings.dt_s.value_or(scene.step.dt_s);
  check_settings(scene, steps, dt_s, settings);
  RunResult result = (settings.fork_step ? run_forked : run_alone)(scene, settings, steps, dt_s);
  if (result.failure) throw FailedRun(std::move(result));
  return result;
}

}  // namespace lodestone
