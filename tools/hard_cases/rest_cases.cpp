// S9, S11, S15: where statistical bodies come to rest, beside ODE's.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "reference/drop_trial.h"
#include "reference/random.h"
#include "tools/compare/drop_trials.h"
#include "tools/compare/rest_classes.h"
#include "tools/hard_cases/hard_case.h"
#include "tools/hard_cases/statistical_case_parts.h"

namespace lodestone {
namespace {

// S9: slopes from 0 to 60 degrees: what slides and what is led to a rest pose.
namespace rest_on_slopes {

constexpr double kDegree = std::numbers::pi / 180.0, kFriction = 0.5;
constexpr int kTrials = 60, kSeconds = 4;
constexpr double kNearPose = 2.0 * kDegree;  // of a rest pose

struct Subject {
  StatisticalModel model;
  std::shared_ptr<const Shape> shape = box_of({0.2, 0.3, 0.4});
  std::shared_ptr<const Signature> signature = find_case_signature(*shape);
};

struct Figures {
  int asleep = 0;          ///< at the end
  double in_pose = 0.0;    ///< fraction, of those whose orientation is that of a rest pose on the slope
  double slowest = 1e300;  ///< m/s down the slope at the end
};

/// Boxes let fall, tilted at random, on a slope of `tilt` rad; at the full level they are ODE's.
Figures drop_on(const Subject& subject, double tilt, LevelChoice level = LevelChoice::statistical) {
  Figures figures;
  const Vec3 normal(std::sin(tilt), 0, std::cos(tilt)), down(std::cos(tilt), 0, -std::sin(tilt));
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    RandomStream random(112, trial, 0);
    Manager manager = make_case_manager({.model = subject.model,
                                         .law = {0.0, kFriction},
                                         .plane_normals = {normal},
                                         .seed = trial + 1,
                                         .signature = subject.signature});
    const Quat orientation = random.orientation();
    const RigidState start{.position = (resting_height(*subject.shape, orientation, normal) + 0.02) * normal,
                           .orientation = orientation};
    const BodyId body = manager.add_body({.shape = subject.shape, .state = start, .level = level});
    for (int i = 0; i < kSeconds * 60; ++i) manager.step(kCaseStep);
    const RigidState state = manager.state(body);
    figures.asleep += manager.asleep(body);
    figures.slowest = lesser(figures.slowest, state.velocity.dot(down));
    const Vec3 up = state.orientation.conjugate() * normal;
    for (const RestPose& pose : subject.signature->rest_poses)
      if (pose.normal.dot(up) > std::cos(kNearPose)) {
        figures.in_pose += 1.0 / kTrials;
        break;
      }
  }
  return figures;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels) {
    const Subject subject{model};
    const Figures level = drop_on(subject, 0.0);
    rows.push_back({.what = fmt::format("{} x box let fall on the horizontal, {}: fraction in a rest pose",
                                        kTrials, name),
                    .value = level.in_pose,
                    .bound = 1.0,
                    .side = BoundSide::at_least});
    for (const double degrees : {5.0, 15.0, 25.0, 35.0, 45.0, 60.0}) {
      const Figures slope = drop_on(subject, degrees * kDegree);
      const std::string what =
          fmt::format("{} x box let fall on a slope of {:g} deg, friction .5, {}: ", kTrials, degrees, name);
      if (std::tan(degrees * kDegree) <= kFriction) {  // ODE's boxes come to lie flat, too
        const double in_pose = drop_on(subject, degrees * kDegree, LevelChoice::full).in_pose;
        rows.push_back({.what = what + fmt::format("fraction flat on it, off ODE's {:.2f}", in_pose),
                        .value = std::abs(slope.in_pose - in_pose),
                        .bound = 0.1});
        continue;
      }
      const double sliding =
          kCaseGravity * (std::sin(degrees * kDegree) - kFriction * std::cos(degrees * kDegree)) * kSeconds;
      rows.push_back(
          {.what = what + "asleep", .value = double(slope.asleep), .bound = 0.0, .unit = "bodies"});
      rows.push_back({.what = what + fmt::format("slowest after {} s over that of sliding", kSeconds),
                      .value = slope.slowest / sliding,
                      .bound = 0.95,
                      .side = BoundSide::at_least});
    }
  }
  return rows;
}

}  // namespace rest_on_slopes

// S11: how often drops end in each rest pose, beside ODE's.
namespace rest_poses {

constexpr double kRarePose = 0.004;  // frequency above which a pose must not be missed

struct Subject {
  std::string what;
  std::shared_ptr<const Shape> shape;
  int truth_drops;
};

/// How many of `drops` end in each class; last, those that end in none.
std::vector<double> counts_of(std::span<const DropObservation> drops, const RestClasses& classes) {
  std::vector<double> counts(classes.size() + 1, 0.0);
  for (const DropObservation& drop : drops)
    ++counts[std::size_t(drop.at_rest
                             ? find_rest_class(classes, drop.up_in_body).value_or(int(classes.size()))
                             : int(classes.size()))];
  return counts;
}

double sum_of(const std::vector<double>& counts) {
  double sum = 0.0;
  for (const double count : counts) sum += count;
  return sum;
}

double total_variation(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] / sum_of(a) - b[i] / sum_of(b));
  return 0.5 * sum;
}

/// `n` draws from the frequencies of `counts`.
std::vector<double> draw_counts(const std::vector<double>& counts, int n, RandomStream random) {
  std::vector<double> drawn(counts.size(), 0.0);
  for (int k = 0; k < n; ++k) {
    double left = random.uniform() * sum_of(counts);
    std::size_t i = 0;
    while (i + 1 < counts.size() && (left -= counts[i]) >= 0.0) ++i;
    ++drawn[i];
  }
  return drawn;
}

/// The total variation that samples of these sizes have from each other although they are of the same
/// frequencies.
double floor_of(const std::vector<double>& truth, int method_drops) {
  constexpr int kResamples = 40;
  double sum = 0.0;
  for (std::uint32_t i = 0; i < kResamples; ++i)
    sum += total_variation(draw_counts(truth, int(sum_of(truth)), {116, i, 0}),
                           draw_counts(truth, method_drops, {116, i, 1}));
  return sum / kResamples;
}

/// That samples of the same frequencies differ as much (χ² of two samples, Wilson and Hilferty's
/// approximation).
double chi_squared_p(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = sum_of(a), m = sum_of(b);
  double chi = 0.0;
  int classes = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] + b[i] == 0.0) continue;
    const double d = std::sqrt(m / n) * a[i] - std::sqrt(n / m) * b[i];
    chi += d * d / (a[i] + b[i]), ++classes;
  }
  if (classes < 2) return 1.0;
  const double freedom = classes - 1, spread = 2.0 / (9.0 * freedom);
  return 0.5 * std::erfc((std::cbrt(chi / freedom) - 1.0 + spread) / std::sqrt(2.0 * spread));
}

RestClasses classes_of(std::span<const DropObservation> drops) {
  std::vector<Vec3> ups;
  for (const DropObservation& drop : drops)
    if (drop.at_rest) ups.push_back(drop.up_in_body);
  return make_rest_classes(ups);
}

void add_rows(std::vector<HardCaseRow>& rows, const Subject& subject, int method_drops) {
  const DropJob job{.shape = subject.shape, .conditions = {}, .material = {}};
  const auto signature = find_case_signature(*job.shape);
  const auto truth_drops = observe_drops(job, make_truth(job), {.trials = subject.truth_drops, .seed = 3});
  const RestClasses classes = classes_of(truth_drops);
  const std::vector<double> truth = counts_of(truth_drops, classes);
  const double floor = floor_of(truth, method_drops);
  for (const auto& [model, name] : kBothModels) {
    const Method method{"statistical", StatisticalMethod{model, signature}, ""};
    const std::vector<double> found =
        counts_of(observe_drops(job, method, {.trials = method_drops, .seed = 4}), classes);
    int missing = 0;
    for (std::size_t i = 0; i < classes.size(); ++i)
      missing += truth[i] > kRarePose * sum_of(truth) && found[i] == 0.0;
    const std::string what = fmt::format("{} x {} dropped, {}: ", method_drops, subject.what, name);
    rows.push_back(
        {.what = what +
                 fmt::format("rest poses' total variation above the floor of {:.3f} (chi-squared p {:.2g})",
                             floor, chi_squared_p(truth, found)),
         .value = total_variation(truth, found) - floor,
         .bound = 0.04});
    rows.push_back(
        {.what = what + "poses above .4 % missing", .value = double(missing), .bound = 0.0, .unit = "poses"});
  }
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const bool quick = settings.quick;
  std::vector<Subject> subjects = {{"box", box_of({0.2, 0.3, 0.4}), quick ? 1000 : 3000}};
  if (!quick) {
    subjects.push_back({"plate", box_of({0.4, 0.3, 0.02}), 3000});
    subjects.push_back({"L", share(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1))), 3000});
    subjects.push_back({"bunny", share(make_bunny_shape(0.2)), 1000});
  }
  std::vector<HardCaseRow> rows;
  for (const Subject& subject : subjects) add_rows(rows, subject, quick ? 3000 : 10'000);
  return rows;
}

}  // namespace rest_poses

// S15: a box let down flat (the paper's 5.1), beside ODE's.
namespace flat_landings {

constexpr int kTrials = 200;
constexpr double kSeconds = 4.0;
const double kFlat = std::cos(std::numbers::pi / 180.0);

/// On one of its faces, level, its heading drawn, .3 to .8 m above the plane, without any motion.
RigidState start_of(const Shape& shape, std::uint32_t trial) {
  static const Vec3 kDown[] = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  RandomStream random(114, trial, 0);
  RigidState state;
  state.orientation = Quat(Eigen::AngleAxisd(random.uniform(0.0, 2.0 * std::numbers::pi), Vec3::UnitZ())) *
                      rotation_between(kDown[trial % 3], Vec3::UnitZ());
  state.position.z() = resting_height(shape, state.orientation) + random.uniform(0.3, 0.8);
  return state;
}

/// Still on the face that was below.
bool lies_flat(const RigidState& start, const RigidState& end) {
  return (end.orientation.conjugate() * Vec3::UnitZ()).dot(start.orientation.conjugate() * Vec3::UnitZ()) >
         kFlat;
}

double flat_under_ode(const std::shared_ptr<const Shape>& shape) {
  const MaterialTable materials;
  int flat = 0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    OdeWorld world({}, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    const RigidState start = start_of(*shape, trial);
    const OdeBodyId body = world.add_body({.shape = shape, .state = start});
    for (int i = 0; i < int(kSeconds / kObservationStep); ++i) world.step(kObservationStep, kTruthSubsteps);
    flat += lies_flat(start, world.state(body));
  }
  return double(flat) / kTrials;
}

double flat_under(StatisticalModel model, const std::shared_ptr<const Shape>& shape,
                  const std::shared_ptr<const Signature>& signature) {
  int flat = 0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    Manager manager = make_case_manager({.model = model, .seed = trial + 1, .signature = signature});
    const RigidState start = start_of(*shape, trial);
    const BodyId body = add_case_body(manager, shape, start);
    for (int i = 0; i < int(kSeconds / kCaseStep); ++i) manager.step(kCaseStep);
    flat += lies_flat(start, manager.state(body));
  }
  return double(flat) / kTrials;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  const auto box = box_of({0.2, 0.3, 0.4});
  const auto signature = find_case_signature(*box);
  const double ode = flat_under_ode(box);
  std::vector<HardCaseRow> rows = {
      {.what = fmt::format("{} x box let down flat, ODE: fraction that lies on that face", kTrials),
       .value = ode,
       .bound = 1.0,
       .side = BoundSide::at_least}};
  for (const auto& [model, name] : kBothModels)
    rows.push_back(
        {.what = fmt::format("{} x box let down flat, {}: fraction that lies on that face", kTrials, name),
         .value = flat_under(model, box, signature),
         .bound = ode - 0.05,
         .side = BoundSide::at_least});
  return rows;
}

}  // namespace flat_landings

}  // namespace

std::span<const HardCase> rest_cases() {
  static constexpr std::array kCases = {
      HardCase{"S9", rest_on_slopes::measure_case},
      HardCase{"S11", rest_poses::measure_case},
      HardCase{"S15", flat_landings::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
