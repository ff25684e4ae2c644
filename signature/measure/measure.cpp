#include "signature/measure/measure.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <mutex>
#include <numbers>

#include "reference/allowed_threads.h"
#include "reference/error.h"
#include "reference/random.h"
#include "signature/measure/cell_trials.h"
#include "signature/measure/choose_clips.h"
#include "signature/measure/contact_time.h"
#include "signature/measure/measurement_journal.h"
#include "signature/measure/measurement_shape.h"
#include "signature/measure/response_grid.h"

namespace lodestone {
namespace {

constexpr std::uint64_t kHeightTrials = 1ull << 40;  // keys of what is no cell

// Says how far a stage has come; called from many threads.
class Stage {
 public:
  Stage(std::string name, std::int64_t total, const Progress& progress)
      : name_(std::move(name)), total_(total), progress_(progress) {}
  void add(std::int64_t done) {
    if (!progress_) return;
    const std::lock_guard lock(mutex_);
    done_ += done;
    progress_(name_, double(done_) / double(total_));
  }

 private:
  std::string name_;
  std::int64_t total_, done_ = 0;
  const Progress& progress_;
  std::mutex mutex_;
};

class Measuring {
 public:
  Measuring(const Shape& shape, const SignatureSettings& settings, const Share& share,
            const MeasureOptions& options)
      : shape_(make_measurement_shape(shape)), settings_(settings), share_(share), options_(options) {}

  Measurement measure() const {
    Measurement m = make_empty_measurement(settings_, share_);
    measure_heights(m.heights);
    if (settings_.paper_grid) {
      measure_speed_table(m.by_speed);
    } else {
      measure_table("responses", UnitKind::bouncing, UnitKind::bouncing_held_out, settings_.law, m.bouncing);
      measure_table("responses without bounce", UnitKind::non_bouncing, UnitKind::non_bouncing_held_out,
                    {0.0, settings_.law.friction}, m.non_bouncing);
    }
    measure_settlings(m.settlings);
    return m;
  }

 private:
  // Sets the units i of the share to `measure(i)`, from many threads.
  template <class Unit, class Measure>
  void for_each(const std::string& name, UnitKind kind, std::vector<Unit>& units, std::int64_t grain,
                Measure measure) const {
    const auto count = std::int64_t(units.size());
    Stage stage(name, count, options_.progress);
    tbb::parallel_for(
        tbb::blocked_range<std::int64_t>(0, count, std::size_t(grain)),
        [&](const auto& range) {
          for (std::int64_t i = range.begin(); i < range.end() && !options_.stop.stop_requested(); ++i) {
            if (!share_.holds(i) || (options_.journal && options_.journal->take(kind, i, units[i]))) continue;
            units[i] = measure(i);
            if (options_.journal) options_.journal->note(kind, i, units[i]);
          }
          stage.add(range.end() - range.begin());
        },
        tbb::simple_partitioner{});
  }

  void measure_heights(std::vector<HeightUnit>& units) const {
    for_each("collision heights", UnitKind::height, units, 1,
             [&](std::int64_t k) { return measure_height(k); });
  }

  // Section 3.2.1: fixed speed, random orientation and spin axis.
  HeightUnit measure_height(std::int64_t k) const {
    const double ratio = double(k) / (settings_.height_samples - 1);
    const double alpha = std::min(ratio * std::numbers::pi / 2,
                                  std::numbers::pi / 2 - 0.01);  // without falling there is no collision
    ContactTime contact_time(*shape_);
    double sum = 0.0, squares = 0.0;
    int count = 0;
    for (int trial = 0; trial < settings_.height_trials; ++trial) {
      RandomStream random(settings_.seed, std::uint64_t(k) | kHeightTrials, std::uint32_t(trial));
      RigidState state;
      state.orientation = random.orientation();
      state.position.z() = shape_->radius;
      state.velocity = {0.0, 0.0, -std::cos(alpha)};
      state.angular_velocity = std::sin(alpha) / shape_->radius * random.direction();
      if (!contact_time.advance(state)) continue;
      const double height = state.position.z() / shape_->radius;
      sum += height, squares += height * height, ++count;
    }
    const double mean = count ? sum / count : 1.0;
    return {float(mean), float(count > 1 ? std::sqrt(std::max(0.0, squares / count - mean * mean)) : 0.0)};
  }

  // Section 3.2.2, over (θ, φ, α).
  void measure_table(const std::string& name, UnitKind cells, UnitKind held_out, const ContactLaw& law,
                     TableUnits& units) const {
    const ResponseTable grid = make_response_grid(settings_);
    measure_cells(name, cells, law, kAlwaysBounces, grid, units.cells);
    const bool every_psi = grid.n_psi == 1;
    measure_held_out(name + ", held out", held_out, law, kAlwaysBounces, every_psi, units.held_out,
                     [&](std::int64_t i) { return held_out_condition(i, settings_.seed); });
  }

  // Over the paper's (θ, φ, ‖V⁻‖, ‖Ω⁻‖).
  void measure_speed_table(TableUnits& units) const {
    const SpeedTable grid = make_speed_grid(settings_);
    const double bounce_velocity = OdeSettings{}.bounce_velocity;
    measure_cells("responses on the paper's grid", UnitKind::by_speed, settings_.law, bounce_velocity, grid,
                  units.cells);
    measure_held_out("responses, held out", UnitKind::by_speed_held_out, settings_.law, bounce_velocity, true,
                     units.held_out,
                     [&](std::int64_t i) { return held_out_condition(grid, i, settings_.seed); });
  }

  template <class Grid>
  void measure_cells(const std::string& name, UnitKind kind, const ContactLaw& law, double bounce_velocity,
                     const Grid& grid, std::vector<CellUnit>& cells) const {
    const CellSampling sampling = make_cell_sampling(settings_);
    auto trials = make_trials(law, bounce_velocity);
    for_each(name, kind, cells, 8,
             [&](std::int64_t i) { return measure_cell(trials.local(), grid.center(i), i, sampling); });
  }

  template <class Condition>
  void measure_held_out(const std::string& name, UnitKind kind, const ContactLaw& law, double bounce_velocity,
                        bool every_psi, std::vector<HeldOutUnit>& units, Condition condition) const {
    auto trials = make_trials(law, bounce_velocity);
    for_each(name, kind, units, 8, [&](std::int64_t i) {
      return lodestone::measure_held_out(trials.local(), condition(i), i, settings_.seed, every_psi);
    });
  }

  // Section 3.2.3. The first of them are followed to the end, for clips.
  void measure_settlings(std::vector<SettlingRecord>& records) const {
    tbb::enumerable_thread_specific<SettlingTrial> trials(
        [&] { return SettlingTrial(shape_, settings_.law); });
    for_each("settling", UnitKind::settling, records, 1, [&](std::int64_t i) {
      return trials.local().run(settings_.seed, std::uint32_t(i),
                                i < kCandidatesPerClip * std::int64_t(settings_.clips));
    });
  }

  // One world for each thread.
  tbb::enumerable_thread_specific<CollisionTrial> make_trials(const ContactLaw& law,
                                                              double bounce_velocity) const {
    return tbb::enumerable_thread_specific<CollisionTrial>(
        [=, this] { return CollisionTrial(shape_, law, settings_.trial_end, bounce_velocity); });
  }

  std::shared_ptr<const Shape> shape_;
  const SignatureSettings& settings_;
  Share share_;
  const MeasureOptions& options_;
};

}  // namespace

void check_settings(const SignatureSettings& settings) {
  MaterialTable{settings.law};  // which throws where it is out of range
  constexpr double kMost = 1e7;
  const auto check = [](const char* what, double value, double least, double most) {
    if (!(value >= least && value <= most))
      throw_input_error(fmt::format("{} of a signature", what), fmt::format("{:g}", value),
                        fmt::format("{:g} … {:g}", least, most));
  };
  for (const int n : {settings.n_theta, settings.n_phi, settings.n_alpha, settings.n_psi})
    check("an axis", n, 1, 1000);
  check("trials_per_cell", settings.trials_per_cell, 1, kMost);
  check("most_trials_per_cell", settings.most_trials_per_cell, 1, kMost);
  check("table_error", settings.table_error, 0, 1);
  check("held_out_conditions", settings.held_out_conditions, 0, kMost);
  check("height_samples", settings.height_samples, 2, kMost);
  check("height_trials", settings.height_trials, 1, kMost);
  check("settling_trials", settings.settling_trials, 1, kMost);
  check("clips", settings.clips, 0, kMost);
  check("rest_pose_frequency_min", settings.rest_pose_frequency_min, 0, 1);
}

Measurement measure_units(const Shape& shape, const SignatureSettings& settings, const Share& share,
                          const MeasureOptions& options) {
  check_settings(settings);
  tbb::task_arena arena(allowed_threads(options.threads));
  Measurement measurement;
  arena.execute([&] { measurement = Measuring(shape, settings, share, options).measure(); });
  return measurement;
}

Signature measure_signature(const Shape& shape, const SignatureSettings& settings, int threads,
                            const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  Signature signature = make_signature(
      shape, settings, measure_units(shape, settings, {}, {.threads = threads, .progress = progress}));
  signature.measuring_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return signature;
}

}  // namespace lodestone
