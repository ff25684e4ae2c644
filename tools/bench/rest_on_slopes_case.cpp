// S9.
#include <fmt/format.h>

#include <numbers>

#include "reference/random.h"
#include "tools/bench/lone_body_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0, kFriction = 0.5;
constexpr int kTrials = 60, kSeconds = 4;
constexpr double kNearPose = 2.0 * kDegree;  // of a rest pose

struct Subject {
  StatisticalModel model;
  std::shared_ptr<const Shape> shape = box_of({0.2, 0.3, 0.4});
  std::shared_ptr<const Signature> signature = find_case_signature(*shape);
};

struct Figures {
  int asleep = 0;           ///< at the end
  double in_pose = 0.0;     ///< fraction, of those whose orientation is that of a rest pose on the slope
  double slowest = 1e300;   ///< m/s down the slope at the end
};

/// Boxes let fall, tilted at random, on a slope of `tilt` rad; at the full level they are ODE's.
Figures drop_on(const Subject& subject, double tilt, LevelChoice level = LevelChoice::statistical) {
  Figures figures;
  const Vec3 normal(std::sin(tilt), 0, std::cos(tilt)), down(std::cos(tilt), 0, -std::sin(tilt));
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    RandomStream random(112, trial, 0);
    Manager manager = make_case_manager({.model = subject.model, .law = {0.0, kFriction}, .plane_normals = {normal}, .seed = trial + 1, .signature = subject.signature});
    const Quat orientation = random.orientation();
    const RigidState start{.position = (resting_height(*subject.shape, orientation, normal) + 0.02) * normal, .orientation = orientation};
    const BodyId body = manager.add_body({.shape = subject.shape, .state = start, .level = level});
    for (int i = 0; i < kSeconds * 60; ++i) manager.step(kCaseStep);
    const RigidState state = manager.state(body);
    figures.asleep += manager.asleep(body);
    figures.slowest = std::min(figures.slowest, state.velocity.dot(down));
    const Vec3 up = state.orientation.conjugate() * normal;
    for (const RestPose& pose : subject.signature->rest_poses)
      if (pose.normal.dot(up) > std::cos(kNearPose)) {
        figures.in_pose += 1.0 / kTrials;
        break;
      }
  }
  return figures;
}

}  // namespace

std::vector<HardCaseRow> measure_rest_on_slopes(const HardCaseSettings&) {
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels) {
    const Subject subject{model};
    const Figures level = drop_on(subject, 0.0);
    rows.push_back({.what = fmt::format("{} x box let fall on the horizontal, {}: fraction in a rest pose", kTrials, name), .value = level.in_pose, .bound = 1.0, .side = BoundSide::at_least});
    for (const double degrees : {5.0, 15.0, 25.0, 35.0, 45.0, 60.0}) {
      const Figures slope = drop_on(subject, degrees * kDegree);
      const std::string what = fmt::format("{} x box let fall on a slope of {:g} deg, friction .5, {}: ", kTrials, degrees, name);
      if (std::tan(degrees * kDegree) <= kFriction) {  // ODE's boxes come to lie flat, too
        const double in_pose = drop_on(subject, degrees * kDegree, LevelChoice::full).in_pose;
        rows.push_back({.what = what + fmt::format("fraction flat on it, off ODE's {:.2f}", in_pose), .value = std::abs(slope.in_pose - in_pose), .bound = 0.1});
        continue;
      }
      if (model == StatisticalModel::tables)  // `support` may slide flat, as a box does
        rows.push_back({.what = what + "fraction snapped into a rest pose", .value = slope.in_pose, .bound = 0.1});
      const double sliding = kCaseGravity * (std::sin(degrees * kDegree) - kFriction * std::cos(degrees * kDegree)) * kSeconds;
      rows.push_back({.what = what + "asleep", .value = double(slope.asleep), .bound = 0.0, .unit = "bodies"});
      if (model == StatisticalModel::support)
        rows.push_back({.what = what + fmt::format("slowest after {} s over that of sliding", kSeconds), .value = slope.slowest / sliding, .bound = 0.95, .side = BoundSide::at_least});
      else  // whose responses slow a body down as it skips along
        rows.push_back({.what = what + fmt::format("slowest after {} s", kSeconds), .value = slope.slowest, .bound = 0.05, .unit = "m/s", .side = BoundSide::at_least});
    }
  }
  return rows;
}

}  // namespace lodestone
