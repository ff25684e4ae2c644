// S8.
#include <fmt/format.h>

#include "reference/random.h"
#include "tools/bench/lone_body_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr double kSpeed = 200.0, kSphereRadius = 0.1;

struct Subject {
  StatisticalModel model;
  std::shared_ptr<const Shape> shape;
  std::shared_ptr<const Signature> signature;
};

/// From 1 to 20 m above the plane, slanted by up to 60 degrees. True where its centre ends up below.
bool passes_plane(const Subject& subject, std::uint32_t trial) {
  RandomStream random(110, trial, 0);
  Manager manager = make_case_manager({.model = subject.model, .seed = trial + 1, .signature = subject.signature});
  const Vec3 direction = Vec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), -1.0).normalized();
  const BodyId body = add_case_body(manager, subject.shape, {.position = {0, 0, random.uniform(1.0, 20.0)}, .orientation = random.orientation(),
                                                             .velocity = kSpeed * direction, .angular_velocity = 10.0 * random.direction()});
  bool below = false;
  for (int i = 0; i < 20 && !below; ++i) {
    manager.step(kCaseStep);
    below = !(manager.state(body).position.z() > 0.0);
  }
  return below;
}

/// Two at each other, at most 1.6 inner radii off the same line; no gravity. True where neither changes its course.
bool pass_each_other(const Subject& subject, std::uint32_t trial) {
  RandomStream random(111, trial, 0);
  Manager manager = make_case_manager({.model = subject.model, .gravity = Vec3::Zero(), .plane_normals = {}, .seed = trial + 1, .signature = subject.signature});
  const Vec3 velocity = kSpeed * Vec3::UnitX();
  const Vec3 offset = random.uniform(0.0, 0.8) * subject.shape->inner_radius * Vec3::UnitX().cross(random.direction()).normalized();
  const double distance = random.uniform(1.0, 5.0);
  const BodyId left = add_case_body(manager, subject.shape, {.position = -distance * Vec3::UnitX() + offset, .orientation = random.orientation(), .velocity = velocity});
  add_case_body(manager, subject.shape, {.position = distance * Vec3::UnitX() - offset, .orientation = random.orientation(), .velocity = -velocity});
  for (int i = 0; i < 6; ++i) manager.step(kCaseStep);
  return !((manager.state(left).velocity - velocity).norm() > 1e-9);
}

template <typename Pass>
HardCaseRow row_of(const Subject& subject, const std::string& what, int trials, Pass pass) {
  int passed = 0;
  for (int trial = 0; trial < trials; ++trial) passed += pass(subject, std::uint32_t(trial));
  return {.what = fmt::format("{:.0e} x {}, 200 m/s, dt 1/60 s: passed through", double(trials), what), .value = double(passed), .bound = 0.0, .unit = "bodies"};
}

}  // namespace

std::vector<HardCaseRow> measure_fast_hits(const HardCaseSettings& settings) {
  const int trials = settings.quick ? 1000 : 10'000;
  std::vector<HardCaseRow> rows;
  for (const auto& [shape, what] : {std::pair{ball_of(kSphereRadius), "ball"}, {box_of({0.2, 0.3, 0.4}), "box"}}) {
    const auto signature = find_case_signature(*shape);
    for (const auto& [model, name] : kBothModels) {
      const Subject subject{model, shape, signature};
      rows.push_back(row_of(subject, fmt::format("{} at a plane, {}", what, name), trials, passes_plane));
      rows.push_back(row_of(subject, fmt::format("{} at an equal one, {}", what, name), trials, pass_each_other));
    }
  }
  return rows;
}

}  // namespace lodestone
