// S3.
#include <fmt/format.h>

#include <numbers>

#include "reference/random.h"
#include "tools/bench/response_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr int kTrials = 300;

struct Subject {
  std::shared_ptr<const Shape> shape;
  std::shared_ptr<const Signature> signature = find_case_signature(*shape);
};

/// Bodies flung at the plane with their spin along or against their velocity, of which some number is lost.
int count_lost(const Subject& subject, StatisticalModel model, double sign) {
  int lost = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(103, std::uint64_t(trial), 0);
    Manager manager = make_case_manager({.model = model, .seed = std::uint64_t(trial) + 1, .signature = subject.signature});
    const Vec3 direction = (random.direction() - 1.01 * Vec3::UnitZ()).normalized();
    const BodyId body = add_case_body(manager, subject.shape, {.position = {0, 0, 0.4}, .orientation = random.orientation(),
                                                               .velocity = 5.0 * direction, .angular_velocity = sign * 20.0 * direction});
    bool finite = true;
    for (int i = 0; i < 30 && finite; ++i) {
      manager.step(kCaseStep);
      finite = is_finite(manager.state(body));
    }
    lost += !finite;
  }
  return lost;
}

/// Greatest change of velocity, over the speed, of bodies that touch (or overlap by `depth`) what they leave at `theta` from −n; no gravity, no spin.
double worst_response(const Subject& subject, StatisticalModel model, double theta_deg, double depth, bool pair) {
  double worst = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(104, std::uint64_t(trial), 0);
    Manager manager = make_case_manager({.model = model, .gravity = Vec3::Zero(), .seed = std::uint64_t(trial) + 1, .signature = subject.signature});
    const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi), base = pair ? 5.0 : 0.0;
    const double theta = theta_deg * std::numbers::pi / 180.0, along = theta_deg == 90.0 ? 0.0 : -std::cos(theta);
    const Vec3 velocity(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), along);
    const Quat orientation = pair ? Quat(Quat::Identity()) : random.orientation();  // askew they might be nearest across, and meet on the way
    const Vec3 place(0, 0, base + resting_height(*subject.shape, orientation) - depth);
    std::vector<BodyId> bodies = {add_case_body(manager, subject.shape, {.position = place, .orientation = orientation, .velocity = velocity})};
    if (pair) {
      const double below = resting_height(*subject.shape, Quat::Identity(), -Vec3::UnitZ());
      bodies.push_back(add_case_body(manager, subject.shape, {.position = {0, 0, base - below}, .velocity = -velocity}));
    }
    manager.step(kCaseStep);
    double sign = 1.0;
    for (const BodyId body : bodies) {
      worst = worse(worst, (manager.state(body).velocity - sign * velocity).norm() + subject.shape->radius * manager.state(body).angular_velocity.norm());
      sign = -1.0;
    }
  }
  return worst;
}

}  // namespace

std::vector<HardCaseRow> measure_odd_directions(const HardCaseSettings&) {
  const Subject box{box_of({0.2, 0.3, 0.4})};
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels) {
    for (const auto& [sign, way] : {std::pair{1.0, "along"}, {-1.0, "against"}})
      rows.push_back({.what = fmt::format("{} x box at a plane, spin {} v, {}: no finite state", kTrials, way, name),
                      .value = double(count_lost(box, model, sign)), .bound = 0.0, .unit = "bodies"});
    for (const bool pair : {false, true}) {
      double worst = 0.0;
      for (const double depth : {0.0, 0.001})
        for (const double theta : {90.0, 90.001, 100.0, 135.0, 180.0}) worst = worse(worst, worst_response(box, model, theta, depth, pair));
      rows.push_back({.what = fmt::format("{} x {}, touching, theta >= 90 deg, {}: change of velocity over speed", kTrials, pair ? "box on another leaves it, flat" : "box leaves a plane", name),
                      .value = worst, .bound = 1e-9});
    }
  }
  return rows;
}

}  // namespace lodestone
