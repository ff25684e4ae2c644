#include "signature/measure.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numbers>

#include "reference/random.h"
#include "signature/collision_trial.h"
#include "signature/response_table.h"
#include "signature/settling_trial.h"

namespace lodestone {
namespace {

constexpr double kMeasuringRadius = 0.2;  // m: every shape is measured at this size, and so is the same at all sizes

// Says how far a stage has come; called from many threads.
class Stage {
 public:
  Stage(std::string name, std::int64_t total, const Progress& progress) : name_(std::move(name)), total_(total), progress_(progress) {}
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

// Mean and deviation of a sample, one pass (Welford).
template <class Value>
struct Moments {
  Value mean = Value(), squares = Value();
  std::uint32_t count = 0;
  void add(const Value& x) {
    ++count;
    const Value before = x - mean;
    mean += before / float(count);
    squares += before.cwiseProduct(x - mean);
  }
};

struct Measuring {
  std::shared_ptr<const Shape> shape;
  const SignatureSettings& settings;
  const Progress& progress;

  template <class Body>
  void for_each(const std::string& name, std::int64_t count, std::int64_t grain, Body body) const {
    Stage stage(name, count, progress);
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, std::size_t(grain)), [&](const auto& range) {
      body(range.begin(), range.end());
      stage.add(range.end() - range.begin());
    }, tbb::simple_partitioner{});
  }

  CollisionHeights measure_heights() const;
  ResponseTable measure_responses(const std::string& name, const ContactLaw& law) const;
  std::vector<SettlingRecord> simulate_settlings() const;
};

// Section 3.2.1: fixed speed, random orientation, spin axis and height.
CollisionHeights Measuring::measure_heights() const {
  const int n = settings.height_samples;
  CollisionHeights heights{std::vector<float>(n), std::vector<float>(n)};
  for_each("collision heights", n, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k) {
      const double alpha = std::min(k * std::numbers::pi / 2 / (n - 1), std::numbers::pi / 2 - 0.01);  // without falling there is no collision
      double sum = 0.0, squares = 0.0;
      int count = 0;
      for (int trial = 0; trial < settings.height_trials; ++trial) {
        RandomStream random(settings.seed, std::uint64_t(k) | 1ull << 40, std::uint32_t(trial));
        RigidState state;
        state.orientation = random.orientation();
        state.position.z() = shape->radius * (1.0 + random.uniform());
        state.velocity = {0.0, 0.0, -std::cos(alpha)};
        state.angular_velocity = std::sin(alpha) / shape->radius * random.direction();
        if (!advance_to_contact(*shape, state)) continue;
        const double height = state.position.z() / shape->radius;
        sum += height, squares += height * height, ++count;
      }
      const double mean = count ? sum / count : 1.0;
      heights.mean[k] = float(mean);
      heights.deviation[k] = float(count > 1 ? std::sqrt(std::max(0.0, squares / count - mean * mean)) : 0.0);
    }
  });
  return heights;
}

// Section 3.2.2.
ResponseTable Measuring::measure_responses(const std::string& name, const ContactLaw& law) const {
  ResponseTable table{settings.n_theta, settings.n_phi, settings.n_alpha, {}, {}, {}};
  table.mean.resize(table.cells());
  table.deviation.resize(table.cells());
  table.samples.resize(table.cells());
  for_each(name, table.cells(), 8, [&](std::int64_t begin, std::int64_t end) {
    CollisionTrial trials(shape, law, settings.trial_end);
    for (std::int64_t cell = begin; cell < end; ++cell) {
      const CollisionConfiguration c{
          .theta = cell_center(int(cell / (table.n_alpha * table.n_phi)), table.n_theta, std::numbers::pi / 2),
          .phi = cell_center(int(cell / table.n_alpha % table.n_phi), table.n_phi, std::numbers::pi),
          .alpha = cell_center(int(cell % table.n_alpha), table.n_alpha, std::numbers::pi / 2)};
      Moments<Response> moments{Response::Zero(), Response::Zero()};
      for (int trial = 0; trial < settings.trials_per_cell; ++trial)
        if (const auto outcome = trials.run(c, settings.seed, std::uint64_t(cell), std::uint32_t(trial))) moments.add(outcome->response);
      table.mean[cell] = moments.mean;
      table.deviation[cell] = moments.count > 1 ? Response((moments.squares / float(moments.count - 1)).cwiseSqrt()) : Response(Response::Zero());
      table.samples[cell] = moments.count;
    }
  });
  return table;
}

// Section 3.2.3.
std::vector<SettlingRecord> Measuring::simulate_settlings() const {
  std::vector<SettlingRecord> records(settings.settling_trials);
  for_each("settling", std::int64_t(records.size()), 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) records[i] = simulate_settling(shape, settings.law, settings.seed, std::uint32_t(i));
  });
  return records;
}

Signature measure(const Measuring& measuring) {
  const SignatureSettings& settings = measuring.settings;
  const Shape& shape = *measuring.shape;
  Signature signature;
  signature.shape_hash = shape.content_hash;
  signature.shape_name = shape.name;
  signature.settings = settings;
  signature.collision_heights = measuring.measure_heights();
  signature.bouncing = measuring.measure_responses("responses", settings.law);
  signature.non_bouncing = measuring.measure_responses("responses without bounce", {0.0, settings.law.friction});
  const std::vector<SettlingRecord> records = measuring.simulate_settlings();
  signature.rest_poses = find_rest_poses(records, shape.radius, settings.rest_pose_frequency_min);
  signature.rest_poses_above_5_percent =
      int(std::count_if(signature.rest_poses.begin(), signature.rest_poses.end(), [](const RestPose& p) { return p.frequency > 0.05; }));
  add_clips(records, shape, settings.clips, signature);
  signature.trials = std::uint64_t(settings.height_samples) * settings.height_trials +
                     2ull * signature.bouncing.cells() * settings.trials_per_cell + settings.settling_trials;
  return signature;
}

}  // namespace

Signature measure_signature(const Shape& shape, const SignatureSettings& settings, int threads, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const Measuring measuring{std::make_shared<const Shape>(scale_shape(shape, kMeasuringRadius / shape.radius)), settings, progress};
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  Signature signature;
  arena.execute([&] { signature = measure(measuring); });
  signature.measuring_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return signature;
}

}  // namespace lodestone
