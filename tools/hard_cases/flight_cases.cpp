// S7, S8, S12, S13: single statistical bodies that fly and strike, against ODE's or against what mechanics
// predicts.
#include <fmt/format.h>

#include <array>
#include <limits>
#include <numbers>

#include "reference/drop_trial.h"
#include "reference/random.h"
#include "signature/measure/contact_time.h"
#include "tools/compare/drop_trials.h"
#include "tools/hard_cases/hard_case.h"
#include "tools/hard_cases/statistical_case_parts.h"

namespace lodestone {
namespace {

// S7: how high bodies rise after their first impact, by restitution and step, beside ODE's.
namespace first_rebounds {

constexpr double kBounceRise = 0.3;   // m/s: an impact, and not what gravity does between two samples
constexpr double kLongestFall = 2.0;  // s

/// How high above the plane the centre of mass is bound for, as soon as an impact was seen: the same whatever
/// the steps. No such impact: where it fell to.
double apex_of(MethodWorld& world, double dt, int steps_a_sample) {
  const double sample = dt * steps_a_sample;
  RigidState before = world.state();
  for (double t = 0.0; t < kLongestFall; t += sample) {
    for (int i = 0; i < steps_a_sample; ++i) world.step(dt);
    const RigidState now = world.state();
    const double up = std::max(0.0, now.velocity.z());
    if (now.velocity.z() - before.velocity.z() + kCaseGravity * sample > kBounceRise)
      return now.position.z() + up * up / (2.0 * kCaseGravity);
    before = now;
  }
  return before.position.z();
}

struct Sample {
  double mean = 0.0, variance = 0.0;
  int count = 0;
};

Sample apexes_of(const DropJob& job, const Method& method, std::uint64_t seed, double dt, int steps_a_sample,
                 int trials) {
  DropWorld world(job, method);
  Sample sample{.count = trials};
  double squares = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    const double apex = apex_of(world.start(seed, std::uint32_t(trial)), dt, steps_a_sample);
    sample.mean += apex / trials, squares += apex * apex / trials;
  }
  sample.variance = std::max(0.0, squares - sample.mean * sample.mean);
  return sample;
}

/// Over the standard error of the difference.
double difference(const Sample& a, const Sample& b) {
  return std::abs(a.mean - b.mean) / std::sqrt(a.variance / a.count + b.variance / b.count);
}

/// ODE in its own small steps, seen as seldom as a method that steps by `dt`.
Sample truth_of(const DropJob& job, double dt, int trials) {
  Method truth = make_truth(job);
  const int steps = std::max(1, int(std::lround(dt / kObservationStep * truth.substeps())));
  std::get<OdeMethod>(truth.way).substeps = 1;
  return apexes_of(job, truth, 1, dt / steps, steps, trials);
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const int trials = settings.quick ? 200 : 1000;
  std::vector<HardCaseRow> rows;
  for (const double e : {0.0, 0.5, 1.0}) {
    const DropJob job{.shape = box_of({0.2, 0.3, 0.4}), .conditions = {}, .material = {.restitution = e}};
    const auto signature = find_case_signature(*job.shape, job.law());
    for (const auto& [per_second, dt] : {std::pair{30, 1.0 / 30}, {60, 1.0 / 60}, {1000, 1.0 / 1000}}) {
      const Sample truth = truth_of(job, dt, trials);
      for (const auto& [model, name] : kBothModels) {
        const Method method{"statistical", StatisticalMethod{model, signature}, ""};
        rows.push_back({.what = fmt::format("{} x box dropped, e {:g}, dt 1/{} s, {}: mean first rebound off "
                                            "ODE's, over its standard error",
                                            trials, e, per_second, name),
                        .value = difference(truth, apexes_of(job, method, 2, dt, 1, trials)),
                        .bound = 3.3});
      }
    }
  }
  return rows;
}

}  // namespace first_rebounds

// S8: bodies at 200 m/s against a plane and against each other.
namespace fast_hits {

constexpr double kSpeed = 200.0, kSphereRadius = 0.1;

struct Subject {
  StatisticalModel model;
  std::shared_ptr<const Shape> shape;
  std::shared_ptr<const Signature> signature;
};

/// From 1 to 20 m above the plane, slanted by up to 60 degrees. True where its centre ends up below.
bool passes_plane(const Subject& subject, std::uint32_t trial) {
  RandomStream random(110, trial, 0);
  Manager manager =
      make_case_manager({.model = subject.model, .seed = trial + 1, .signature = subject.signature});
  const double y = random.uniform(-1.0, 1.0), x = random.uniform(-1.0, 1.0);
  const Vec3 direction = Vec3(x, y, -1.0).normalized();
  const BodyId body = add_case_body(manager, subject.shape,
                                    {.position = {0, 0, random.uniform(1.0, 20.0)},
                                     .orientation = random.orientation(),
                                     .velocity = kSpeed * direction,
                                     .angular_velocity = 10.0 * random.direction()});
  bool below = false;
  for (int i = 0; i < 20 && !below; ++i) {
    manager.step(kCaseStep);
    below = !(manager.state(body).position.z() > 0.0);
  }
  return below;
}

/// Two at each other, at most 1.6 inner radii off the same line; no gravity. True where neither changes its
/// course.
bool pass_each_other(const Subject& subject, std::uint32_t trial) {
  RandomStream random(111, trial, 0);
  Manager manager = make_case_manager({.model = subject.model,
                                       .gravity = Vec3::Zero(),
                                       .plane_normals = {},
                                       .seed = trial + 1,
                                       .signature = subject.signature});
  const Vec3 velocity = kSpeed * Vec3::UnitX();
  const Vec3 aside = Vec3::UnitX().cross(random.direction()).normalized();
  const Vec3 offset = random.uniform(0.0, 0.8) * subject.shape->inner_radius * aside;
  const double distance = random.uniform(1.0, 5.0);
  const BodyId left = add_case_body(manager, subject.shape,
                                    {.position = -distance * Vec3::UnitX() + offset,
                                     .orientation = random.orientation(),
                                     .velocity = velocity});
  add_case_body(manager, subject.shape,
                {.position = distance * Vec3::UnitX() - offset,
                 .orientation = random.orientation(),
                 .velocity = -velocity});
  for (int i = 0; i < 6; ++i) manager.step(kCaseStep);
  return !((manager.state(left).velocity - velocity).norm() > 1e-9);
}

template <typename Pass>
HardCaseRow row_of(const Subject& subject, const std::string& what, int trials, Pass pass) {
  int passed = 0;
  for (int trial = 0; trial < trials; ++trial) passed += pass(subject, std::uint32_t(trial));
  return {.what = fmt::format("{:.0e} x {}, 200 m/s, dt 1/60 s: passed through", double(trials), what),
          .value = double(passed),
          .bound = 0.0,
          .unit = "bodies"};
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const int trials = settings.quick ? 1000 : 10'000;
  std::vector<HardCaseRow> rows;
  for (const auto& [shape, what] :
       {std::pair{ball_of(kSphereRadius), "ball"}, {box_of({0.2, 0.3, 0.4}), "box"}}) {
    const auto signature = find_case_signature(*shape);
    for (const auto& [model, name] : kBothModels) {
      const Subject subject{model, shape, signature};
      rows.push_back(row_of(subject, fmt::format("{} at a plane, {}", what, name), trials, passes_plane));
      rows.push_back(
          row_of(subject, fmt::format("{} at an equal one, {}", what, name), trials, pass_each_other));
    }
  }
  return rows;
}

}  // namespace fast_hits

// S12: ten million steps of free flight.
namespace long_flight {

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const std::int64_t steps = settings.quick ? 300'000 : 10'000'000;
  constexpr double kStep = 1e-4;
  const double seconds = double(steps) * kStep;
  const auto box = box_of({0.2, 0.3, 0.4});
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels) {
    Manager manager =
        make_case_manager({.model = model, .plane_normals = {}, .signature = find_case_signature(*box)});
    const Vec3 velocity(3.0, -2.0, 0.5 * kCaseGravity * seconds);  // back at its height at the end
    const BodyId body =
        add_case_body(manager, box, {.velocity = velocity, .angular_velocity = {3.0, 9.0, -2.0}});
    const Vec3 momentum = angular_momentum(*box, 1.0, manager.state(body));
    double norm = 0.0;
    for (std::int64_t i = 0; i < steps; ++i) {
      manager.step(kStep);
      if (i % 1000 == 0) norm = worse(norm, std::abs(manager.state(body).orientation.norm() - 1.0));
    }
    const RigidState end = manager.state(body);
    const Vec3 expected = seconds * velocity - 0.5 * kCaseGravity * seconds * seconds * Vec3::UnitZ();
    // Each step rounds the place and the velocity to within half of their last bit.
    const double height = velocity.z() * velocity.z() / (2.0 * kCaseGravity),
                 rounding = 0.5 * std::numeric_limits<double>::epsilon();
    const double allowed = rounding * double(steps) * (height + velocity.norm() * seconds);
    const std::string what = fmt::format("{:.0e} steps of free flight, {}: ", double(steps), name);
    rows.push_back({.what = what + "quaternion's norm off 1", .value = norm, .bound = 1e-12});
    rows.push_back({.what = what + "place off the parabola, over what rounding may add up to",
                    .value = (end.position - expected).norm() / allowed,
                    .bound = 1.0});
    rows.push_back({.what = what + "angular momentum changed, relative",
                    .value = (angular_momentum(*box, 1.0, end) - momentum).norm() / momentum.norm(),
                    .bound = 1e-9});
  }
  return rows;
}

}  // namespace long_flight

// S13: the collision height of a square (the paper's figure 3).
namespace square_heights {

constexpr double kPi = std::numbers::pi, kLength = 4.0;  // of the prism whose section is a square of side 1
constexpr double kHalfDiagonal = std::numbers::sqrt2 / 2;

struct Heights {
  double mean = 0.0, least = 1e300, greatest = 0.0;
};

/// Heights of the centre at contact of a prism that turns about its own, level, axis, at `ratio` = ‖ω‖/‖v‖ in
/// radians a side.
Heights measure_heights(const Shape& prism, double ratio, int trials) {
  ContactTime contact_time(prism);
  Heights heights;
  int count = 0;
  for (int trial = 0; trial < trials; ++trial) {
    RandomStream random(113, std::uint64_t(trial), 0);
    RigidState state;
    state.orientation = Quat(Eigen::AngleAxisd(random.uniform(0.0, 2.0 * kPi), Vec3::UnitY()));
    state.position.z() = 1.0;
    state.velocity.z() = -1.0;
    state.angular_velocity.y() = trial % 2 ? ratio : -ratio;
    if (!contact_time.advance(state)) continue;
    heights.mean += state.position.z(), ++count;
    heights.least = lesser(heights.least, state.position.z());
    heights.greatest = worse(heights.greatest, state.position.z());
  }
  heights.mean /= count;
  return heights;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const int trials = settings.quick ? 500 : 5000;
  const Shape prism = *box_of({1.0, kLength, 1.0});
  const double tolerance = 2e-6 * prism.radius;  // to which contacts are found
  Heights all;
  double fall = 0.0, before = 0.0, last = 0.0, first = 0.0;
  for (const double ratio : {0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0}) {
    const Heights heights = measure_heights(prism, ratio, trials);
    all.least = lesser(all.least, heights.least), all.greatest = worse(all.greatest, heights.greatest);
    fall = worse(fall, before - heights.mean);
    before = last = heights.mean;
    if (ratio == 0.0) first = heights.mean;
  }
  // Without spin the height is √½ cos over an eighth of a turn either way: 2/π in the mean, .0622 in
  // deviation. The faster it spins, the more surely a corner strikes.
  const double sampling = 4.5 * 0.0622 / std::sqrt(double(trials));
  const std::string what = fmt::format("square prism of side 1, {} contacts at each of 8 spins: ", trials);
  return {
      {.what = what + "least collision height",
       .value = all.least,
       .bound = 0.5 - tolerance,
       .side = BoundSide::at_least},
      {.what = what + "greatest", .value = all.greatest, .bound = kHalfDiagonal + tolerance},
      {.what = what + "mean without spin off 2/pi", .value = std::abs(first - 2.0 / kPi), .bound = sampling},
      {.what = what + "the mean's greatest fall from one spin to the next", .value = fall, .bound = sampling},
      {.what = what + "mean at 100 rad a side off half the diagonal",
       .value = kHalfDiagonal - last,
       .bound = 0.01}};
}

}  // namespace square_heights

}  // namespace

std::span<const HardCase> flight_cases() {
  static constexpr std::array kCases = {
      HardCase{"S7", first_rebounds::measure_case},
      HardCase{"S8", fast_hits::measure_case},
      HardCase{"S12", long_flight::measure_case},
      HardCase{"S13", square_heights::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
