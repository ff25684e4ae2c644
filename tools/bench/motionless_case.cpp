// S1.
#include <fmt/format.h>

#include "reference/random.h"
#include "tools/bench/response_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr int kTrials = 300, kSteps = 30;
constexpr double kResponse = 1e-12;  // m/s: rounding is no response
const Vec3 kSides{0.2, 0.3, 0.4};

struct Motion { double speed, spin; };  // m/s towards what is touched, rad/s

/// A body that touches the plane, or another that stands still; no gravity.
struct Touch {
  std::shared_ptr<const Shape> shape = box_of(kSides);
  std::shared_ptr<const Signature> signature = find_case_signature(*shape);

  Manager make(StatisticalModel model, const Motion& motion, bool pair, int trial, std::vector<BodyId>& bodies) const {
    RandomStream random(101, std::uint64_t(trial), 0);
    Manager manager = make_case_manager({.model = model, .gravity = Vec3::Zero(), .seed = std::uint64_t(trial) + 1, .signature = signature});
    const Quat orientation = random.orientation();
    const RigidState state{.position = resting_height(*shape, orientation) * Vec3::UnitZ() + (pair ? Vec3(0, 0, 5) : Vec3::Zero()),
                           .orientation = orientation,
                           .velocity = -motion.speed * Vec3::UnitZ(),
                           .angular_velocity = motion.spin * random.direction()};
    bodies = {add_case_body(manager, shape, state)};
    if (pair) bodies.push_back(add_case_body(manager, shape, {.position = {0, 0, 5 - resting_height(*shape, Quat::Identity(), -Vec3::UnitZ())}}));
    return manager;
  }
};

struct Figures { int lost = 0, answered = 0; };

Figures measure(const Touch& touch, StatisticalModel model, const Motion& motion, bool pair) {
  Figures figures;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<BodyId> bodies;
    Manager manager = touch.make(model, motion, pair, trial, bodies);
    for (int i = 0; i < kSteps; ++i) manager.step(kCaseStep);
    bool finite = true, answered = false;
    double side = 1.0;
    for (const BodyId body : bodies) {
      const RigidState after = manager.state(body);
      finite = finite && is_finite(after);
      const Vec3 before = side * motion.speed * -Vec3::UnitZ();
      answered = answered || (after.velocity - before).norm() + touch.shape->radius * after.angular_velocity.norm() > kResponse;
      side = 0.0;
    }
    figures.lost += !finite;
    figures.answered += answered;
  }
  return figures;
}

}  // namespace

std::vector<HardCaseRow> measure_motionless_hits(const HardCaseSettings&) {
  const Touch touch;
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels)
    for (const bool pair : {false, true}) {
      const std::string what = fmt::format("{} x box touches {}, {}: ", kTrials, pair ? "another" : "a plane", name);
      int lost = 0;
      for (const Motion& motion : {Motion{0, 0}, {0, 10}, {2, 0}}) lost += measure(touch, model, motion, pair).lost;
      rows.push_back({.what = what + "v = 0, spin = 0, or both: no finite state", .value = double(lost), .bound = 0.0, .unit = "bodies"});
      rows.push_back({.what = what + "v and spin 0: a response", .value = double(measure(touch, model, {0, 0}, pair).answered), .bound = 0.0, .unit = "bodies"});
      const int struck = measure(touch, model, {2, 0}, pair).answered;
      rows.push_back({.what = what + "spin 0: a response", .value = double(struck), .bound = double(kTrials), .unit = "bodies", .side = BoundSide::at_least});
    }
  return rows;
}

}  // namespace lodestone
