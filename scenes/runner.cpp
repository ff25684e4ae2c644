#include "scenes/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>

#include "lod/timing/thread_clock.h"
#include "reference/argument_error.h"
#include "reference/output_file.h"
#include "scenes/camera.h"
#include "scenes/playback.h"
#include "scenes/run_sample.h"
#include "scenes/scene_sections.h"
#include "scenes/step_csv.h"
#include "scenes/trajectory.h"
#include "signature/signature_source.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

void check_settings(const Scene& scene, int steps, double dt_s, const RunSettings& settings) {
  const auto fail = [](const std::string& what) { throw ArgumentError(what); };
  if (steps < 1) fail(fmt::format("steps: found {}, expected at least 1", steps));
  if (!(dt_s > 0 && dt_s <= 0.1)) fail(fmt::format("dt: found {} s, expected a number in (0, 0.1]", dt_s));
  if (settings.budget_ms && settings.budget_work)
    fail("budget_ms and budget_work: found both, expected one of them");
  for (const auto& [name, budget] :
       {std::pair("budget_ms", settings.budget_ms), {"budget_work", settings.budget_work}})
    if (budget && !(*budget > 0 && std::isfinite(*budget)))
      fail(fmt::format("{}: found {}, expected a number above 0", name, *budget));
  if (settings.threads < 1) fail(fmt::format("threads: found {}, expected at least 1", settings.threads));
  if (!settings.record.empty() && !scene.joints.empty())
    throw InputError(fmt::format(
        "{}: found joints in a scene to be recorded, expected none: a recording knows nothing of them",
        scene.file.string()));
  if (settings.full_within_m && (settings.budget_ms || settings.budget_work))
    fail("full_within_m: found it beside a budget, expected one of them");
  if (settings.full_within_m && !(*settings.full_within_m >= 0))
    fail(fmt::format("full_within_m: found {}, expected a number from 0 on", *settings.full_within_m));
  if (settings.fork_step) {
    const auto fail_fork = [&](const std::string& found, const std::string& expected) {
      fail(fmt::format("fork: found {}, expected {}", found, expected));
    };
    if (*settings.fork_step < 1 || *settings.fork_step >= steps)
      fail_fork(std::to_string(*settings.fork_step),
                fmt::format("a step from 1 to {}, before the run's last", steps - 1));
    if (!scene.joints.empty()) fail_fork("a scene with joints", "none: a snapshot knows nothing of them");
    if (!settings.record.empty()) fail_fork("a recording beside it", "one of them");
    if (settings.level == LevelChoice::automatic && !settings.model && !settings.budget_ms &&
        !settings.budget_work && !settings.full_within_m)
      fail_fork("nothing that the second future has otherwise",
                "a level, a model, a budget or full_within_m");
  }
  const int every = scene.output.every_n_steps, frames = steps / every + (steps % every != 0) + 1,
            most = max_trajectory_frames(int(scene.bodies.size()));
  if (!settings.out.empty() && frames > most)
    throw InputError(
        fmt::format("{}: output.every_n_steps: found {} ({} frames of {} bodies), expected at least {} (a "
                    ".glb holds 4 GB)",
                    scene.file.string(), scene.output.every_n_steps, frames, scene.bodies.size(),
                    steps / std::max(1, most - 1) + 1));
}

PolicySettings policy_of(const Scene& scene, const RunSettings& settings) {
  PolicySettings policy = scene.lod;
  const bool by_error = std::holds_alternative<ErrorBudgetPolicy>(policy.policy);
  if (settings.budget_ms && by_error)
    policy.policy = ErrorBudgetPolicy{.budget_ms = *settings.budget_ms};
  else if (settings.budget_ms)
    policy.policy = BudgetPolicy{*settings.budget_ms};
  if (settings.budget_work && by_error)
    policy.policy = ErrorBudgetPolicy{.budget_work = *settings.budget_work};
  else if (settings.budget_work)
    policy.policy = WorkPolicy{*settings.budget_work};
  if (settings.full_within_m) policy.policy = DistancePolicy{.full_within = *settings.full_within_m};
  return policy;
}

Manager make_manager(const Scene& scene, const RunSettings& settings, const SignatureFunction& signatures) {
  Manager manager({.gravity = scene.step.gravity_m_per_s2,
                   .seed = scene.step.seed,
                   .threads = settings.threads,
                   .full_substeps = scene.step.full_substeps,
                   .model = settings.model ? settings.model : scene.model,
                   .tables = scene.tables,
                   .policy = policy_of(scene, settings),
                   .audit_ms = settings.audit_ms.value_or(scene.audit_ms),
                   .signatures = signatures});
  manager.materials() = scene.materials;
  for (const SceneGround& ground : scene.ground) {
    if (const auto* plane = std::get_if<GroundPlane>(&ground))
      manager.add_plane(plane->normal, plane->offset_m, plane->material);
    else if (const auto* box = std::get_if<GroundBox>(&ground))
      manager.add_static_box(box->sides_m, box->position_m, box->orientation, box->material);
    else
      manager.add_static_mesh(std::get<GroundMesh>(ground).mesh, std::get<GroundMesh>(ground).material);
  }
  return manager;
}

void write_recording(OutputFile& out, std::span<const std::byte> bytes) {
  out.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  out.flush();
}

std::vector<std::byte> bytes_of(const fs::path& file) {
  if (const std::string fault = find_reading_fault(file); !fault.empty())
    throw_input_error(file.string(), fault, "a recording");
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw_input_error(file.string(), "an error of reading", "a recording");
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// What of the levels is not the scene's own choice, in words.
std::string text_of_choice(const RunSettings& settings) {
  std::vector<std::string> parts;
  if (settings.level != LevelChoice::automatic)
    parts.push_back(fmt::format("level {}", name_of(settings.level)));
  if (settings.model) parts.push_back(fmt::format("model {}", name_of(rung_of(*settings.model))));
  if (settings.budget_ms) parts.push_back(fmt::format("a budget of {:g} ms", *settings.budget_ms));
  if (settings.budget_work)
    parts.push_back(fmt::format("a budget of {:g} work units", *settings.budget_work));
  if (settings.full_within_m) parts.push_back(fmt::format("full within {:g} m", *settings.full_within_m));
  return parts.empty() ? "as the scene says" : fmt::format("{}", fmt::join(parts, ", "));
}

/// One run, step by step.
class Run {
 public:
  Run(const Scene& scene, const RunSettings& settings, int steps, double dt_s)
      : scene_(scene),
        settings_(settings),
        steps_(steps),
        dt_s_(dt_s),
        manager_(make_manager(scene, settings, timed_signatures())),
        trajectory_(int(scene.bodies.size())),
        budget_(policy_of(scene, settings)) {
    open_output();
    move_viewpoints(0);
    if (!settings.record.empty())
      manager_.set_record(
          [this, out = std::make_shared<OutputFile>(settings.record, "room for the recording")](
              std::span<const std::byte> bytes) { write([&] { write_recording(*out, bytes); }); });
    add_bodies();
    result_.bodies = int(bodies_.size());
    observe();
    result_.energy_start_j = result_.energy_max_j = sample_.energy_j;
    result_.max_tables_penetration_m = max_other_penetration_m_ =
        0;  // of the run, not of how the scene was set up
    record(0);
  }

  /// Goes on from where `other`, a run of the same scene, is after `step` steps, with settings of its own.
  void fork_from(const Run& other, int step) {
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const SceneBody& body : scene_.bodies) shapes.push_back(body.definition.shape);
    manager_.restore(other.manager_.snapshot(), shapes);
    manager_.set_policy(policy_of(scene_, settings_));
    if (settings_.level != LevelChoice::automatic)  // else each has what the scene says
      for (const BodyId body : bodies_) manager_.set_level(body, settings_.level);
    trajectory_ = Trajectory(int(scene_.bodies.size()));
    from_step_ = step;
    sample_ = other.sample_, last_awake_s_ = other.last_awake_s_;
    observe();
    result_.energy_start_j = result_.energy_max_j = sample_.energy_j;
    record(step);
  }

  /// Of the bodies here from those there, mean.
  double mean_distance_m(const Run& other) const {
    double sum = 0;
    for (std::size_t i = 0; i < sample_.states.size(); ++i)
      sum += (sample_.states[i].position - other.sample_.states[i].position).norm();
    return sample_.states.empty() ? 0.0 : sum / double(sample_.states.size());
  }

  /// Whether there is another step after `step` of them.
  bool goes_on(int step) {
    if (step >= steps_ || !result_.finite) return false;
    const bool is_stopped = result_.steps > 0 && settings_.stop && settings_.stop();
    result_.incomplete = result_.incomplete || is_stopped || !result_.write_error.empty();
    return !result_.incomplete;
  }

  void advance(int step) {
    move_viewpoints(step * dt_s_);
    const auto start = Clock::now();
    const double signatures_before = result_.signature_seconds;
    const double thread_start = stepping_ms();
    const StepReport report = manager_.step(dt_s_);
    const double processor_ms = stepping_ms() - thread_start;
    times_.add(1e3 * (seconds_since(start) - (result_.signature_seconds - signatures_before)));
    count(report, processor_ms);
    result_.promotions += report.promotions;
    result_.transitions += report.promotions + report.demotions;
    if (report.asleep < result_.bodies) last_awake_s_ = (step + 1) * dt_s_;
    if (settings_.watch) before_ = sample_;
    observe();
    if (settings_.watch)
      settings_.watch({manager_, bodies_, before_, sample_, step * dt_s_, dt_s_, processor_ms});
    look(step);
    record(step + 1);
    write([&] {
      if (csv_)
        csv_->add(report, (step + 1) * dt_s_, sample_.energy_j,
                  std::max(sample_.max_tables_penetration_m, sample_.max_other_penetration_m));
    });
    if (settings_.progress)
      settings_.progress({.step = step + 1,
                          .steps = steps_,
                          .full = report.full,
                          .support = report.support,
                          .tables = report.tables,
                          .asleep = report.asleep});
  }

  RunResult finish() {
    record_frame(end_step());  // whatever every_n_steps is
    result_.state_hash = manager_.state_hash();
    result_.step_ms = times_.summary();
    result_.processor_ms = processor_times_.summary();
    result_.budget = budget_.figures();
    result_.states = sample_.states;
    check_penetration();
    if (scene_.checks.all_asleep_by_s) result_.checks.push_back(asleep_check(*scene_.checks.all_asleep_by_s));
    write([&] {
      if (csv_) csv_->close();
    });
    if (!result_.playback.empty() && !write([&] {
          save_playback(
              result_.playback, trajectory_, scene_,
              {.label = fmt::format("{}: {}", scene_.file.stem().string(), text_of_choice(settings_)),
               .from_step = from_step_,
               .step_ms = result_.step_processor_ms,
               .dt_s = dt_s_});
        }))
      result_.playback.clear();
    if (!result_.trajectory.empty() &&
        !write([&] { save_trajectory(result_.trajectory, trajectory_, scene_); }))
      result_.trajectory.clear();
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

  /// Of a step that has just ended. What is not asked for is not kept: a run may have as many steps as anyone
  /// can wait for.
  void count(const StepReport& report, double processor_ms) {
    ++result_.steps;
    result_.last_report = report;
    result_.stage_ms += report.times;
    processor_times_.add(processor_ms);
    budget_.add(report, processor_ms);
    if (settings_.keep_steps) result_.reports.push_back(report);
    if (settings_.keep_steps || !result_.playback.empty()) result_.step_processor_ms.push_back(processor_ms);
  }

  int end_step() const { return from_step_ + result_.steps; }

  /// Whether `write_file` found room; if not, the run ends with what there is.
  template <class WriteFile>
  bool write(WriteFile write_file) {
    try {
      write_file();
      return true;
    } catch (const std::exception& error) {  // too little memory to put it together, too
      if (result_.write_error.empty()) result_.write_error = error.what();
      return false;
    }
  }

  void add_bodies() {
    std::vector<char> joined(scene_.bodies.size());
    for (const SceneJoint& joint : scene_.joints)
      for (const int body : {joint.first, joint.second})
        if (body != SceneJoint::kWorld) joined[std::size_t(body)] = true;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      BodyDefinition definition = scene_.bodies[i].definition;
      if (settings_.level != LevelChoice::automatic && !joined[i]) definition.level = settings_.level;
      bodies_.push_back(manager_.add_body(definition));
      if (scene_.bodies[i].asleep) manager_.sleep(bodies_.back());
    }
    const auto ode_body = [this](int body) {
      return body == SceneJoint::kWorld ? nullptr : manager_.ode_body(bodies_[std::size_t(body)]);
    };
    for (const SceneJoint& joint : scene_.joints)
      join_bodies(ode_body(joint.first), ode_body(joint.second), joint.kind, joint.anchor_m, joint.axis);
    for (const std::vector<int>& group : scene_.groups) {
      std::vector<BodyId> members;
      for (const int body : group) members.push_back(bodies_[std::size_t(body)]);
      manager_.make_group(members);
    }
  }

  void open_output() {
    if (settings_.out.empty()) return;
    std::error_code error;
    fs::create_directories(settings_.out, error);
    if (error) throw_file_error(settings_.out, error.value(), "a folder for results");
    result_.playback = settings_.out / (settings_.fork_step ? "fork.play" : "run.play");
    if (settings_.fork_step) return;
    result_.csv = settings_.out / "steps.csv";
    csv_.emplace(result_.csv);
    if (!scene_.output.trajectory.empty()) result_.trajectory = settings_.out / scene_.output.trajectory;
  }

  void move_viewpoints(double time_s) {
    std::vector<Viewpoint> viewpoints;
    for (const SceneViewpoint& viewpoint : scene_.viewpoints) {
      const Vec3 position = viewpoint.position_at(time_s), direction = viewpoint.look_at_m - position;
      const auto of_sight = direction.isZero(0.0) ? std::nullopt : std::optional(direction);
      viewpoints.push_back({.position = position,
                            .direction = of_sight,
                            .vertical_fov_rad = kFieldOfView,
                            .height_px = viewpoint.height_px,
                            .aspect = kAspectRatio});
    }
    manager_.set_viewpoints(viewpoints);
  }

  void observe() {
    read_sample(manager_, bodies_, scene_, sample_);
    result_.finite = result_.finite && sample_.finite;
    result_.energy_max_j = std::max(result_.energy_max_j, sample_.energy_j);
    result_.energy_end_j = sample_.energy_j;
    result_.max_tables_penetration_m =
        std::max(result_.max_tables_penetration_m, sample_.max_tables_penetration_m);
    max_other_penetration_m_ = std::max(max_other_penetration_m_, sample_.max_other_penetration_m);
  }

  /// At the picture of the first viewpoint, from where the step that ended was given it.
  void look(int step) {
    constexpr double kFrom = 0.5;  // s
    if (scene_.viewpoints.empty() || (step + 1) * dt_s_ < kFrom) return;
    const SceneViewpoint& viewpoint = scene_.viewpoints.front();
    const int full =
        count_full_in_picture(sample_, Camera(viewpoint.position_at(step * dt_s_), viewpoint.look_at_m));
    PictureFigures& figures = result_.in_picture
                                  ? *result_.in_picture
                                  : result_.in_picture.emplace(PictureFigures{.min_full = full});
    figures.min_full = std::min(figures.min_full, full);
    figures.mean_full += (full - figures.mean_full) / ++pictures_;
  }

  void record(int step) {
    if (step == 1 && trajectory_.frames() > 0) trajectory_.set_first_statuses(read_statuses());
    if ((step - from_step_) % scene_.output.every_n_steps == 0) record_frame(step);
  }

  void record_frame(int step) {
    if (result_.playback.empty() || !sample_.finite) return;
    trajectory_.add_frame(step * dt_s_, sample_.states, read_statuses());
  }

  std::span<const BodyStatus> read_statuses() {
    statuses_.clear();
    for (const BodyId body : bodies_)
      statuses_.push_back({.rung = manager_.rung(body),
                           .asleep = manager_.asleep(body),
                           .rule = manager_.explain(body).rule,
                           .collision_radius_m = float(manager_.collision_radius(body))});
    return statuses_;
  }

  void check_penetration() {
    const auto add = [this](const char* name, double value, std::optional<double> bound) {
      if (bound) result_.checks.push_back({name, value, *bound, value <= *bound});
    };
    const std::optional<double> of_tables = scene_.checks.max_tables_penetration_m;
    result_.max_penetration_m = std::max(result_.max_tables_penetration_m, max_other_penetration_m_);
    add("max_penetration_m", of_tables ? max_other_penetration_m_ : result_.max_penetration_m,
        scene_.checks.max_penetration_m);
    add("max_tables_penetration_m", result_.max_tables_penetration_m, of_tables);
  }

  /// Its value is when somebody was last awake: who is so at the bound or after it fails it, even where he
  /// slept before.
  CheckResult asleep_check(double bound_s) const {
    constexpr double kRounding = 1e-9;  // s, of times that are sums of steps
    const double end_s = end_step() * dt_s_;
    const bool all_asleep = last_awake_s_ < end_s,
               in_time = last_awake_s_ < std::max(bound_s, dt_s_) - kRounding;
    return {"all_asleep_by_s", last_awake_s_, bound_s, in_time, all_asleep || end_s >= bound_s - kRounding};
  }

  const Scene& scene_;
  const RunSettings& settings_;
  int steps_;
  double dt_s_;
  RunResult result_;
  Manager manager_;
  std::vector<BodyId> bodies_;
  Trajectory trajectory_;
  std::vector<BodyStatus> statuses_;  // of a frame
  std::optional<StepCsv> csv_;
  RunSample sample_, before_;          // the second for settings_.watch alone
  TimeTally times_, processor_times_;  // ms
  BudgetTally budget_;
  double signature_thread_ms_ = 0;
  int pictures_ = 0, from_step_ = 0;
  double last_awake_s_ = 0, max_other_penetration_m_ = 0;
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
    first.advance(step);
    if (!together) continue;
    second.advance(step);
    forked->mean_distance_m.push_back(second.mean_distance_m(first));
  }
  RunResult result = first.finish();
  if (forked->mean_distance_m.empty()) return result;  // it diverged before
  forked->result = second.finish();
  result.fork = forked;
  return result;
}

}  // namespace

std::string text_of(const RunProgress& p) {
  return fmt::format("step {} of {}: {} full, {} support, {} tables, {} asleep", p.step, p.steps, p.full,
                     p.support, p.tables, p.asleep);
}

RunResult run_scene(const Scene& scene, const RunSettings& settings) {
  const int steps = settings.steps.value_or(scene.default_steps);
  const double dt_s = settings.dt_s.value_or(scene.step.dt_s);
  check_settings(scene, steps, dt_s, settings);
  if (settings.fork_step) return run_forked(scene, settings, steps, dt_s);
  Run run(scene, settings, steps, dt_s);
  for (int step = 0; run.goes_on(step); ++step) run.advance(step);
  return run.finish();
}

ReplayResult replay_scene(const Scene& scene, const RunSettings& settings,
                          const std::filesystem::path& recording) {
  Manager manager = make_manager(scene, settings, settings.signatures);
  std::vector<std::shared_ptr<const Shape>> shapes;
  for (const auto& [name, shape] : scene.shapes) shapes.push_back(shape);
  const auto bytes = bytes_of(recording);
  try {
    return manager.replay(bytes, shapes);
  } catch (const InputError& error) {
    // The recording, and the snapshot that it begins with, are this file.
    const std::string_view text = error.what();
    for (const std::string_view where : {"recording: ", "snapshot: ", "state: "})
      if (text.starts_with(where))
        throw InputError(fmt::format("{}: {}", recording.string(), text.substr(where.size())));
    throw;
  }
}

}  // namespace lodestone
