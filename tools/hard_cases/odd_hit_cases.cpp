// S1 to S3: single collisions of the statistical level, the odd ones.
#include <fmt/format.h>

#include <array>
#include <numbers>

#include "lod/contact/contact_impulse.h"
#include "reference/random.h"
#include "tools/hard_cases/hard_case.h"
#include "tools/hard_cases/statistical_case_parts.h"

namespace lodestone {
namespace {

// S1: collisions of bodies that do not move, or do not spin.
namespace motionless_hits {

constexpr int kTrials = 300, kSteps = 30;
constexpr double kResponse = 1e-12;  // m/s: rounding is no response
const Vec3 kSides{0.2, 0.3, 0.4};

struct Motion {
  double speed, spin;
};  // m/s towards what is touched, rad/s

/// A body that touches the plane, or another that stands still; no gravity.
struct Touch {
  std::shared_ptr<const Shape> shape = box_of(kSides);
  std::shared_ptr<const Signature> signature = find_case_signature(*shape);

  Manager make(StatisticalModel model, const Motion& motion, bool pair, int trial,
               std::vector<BodyId>& bodies) const {
    RandomStream random(101, std::uint64_t(trial), 0);
    Manager manager = make_case_manager(
        {.model = model, .gravity = Vec3::Zero(), .seed = std::uint64_t(trial) + 1, .signature = signature});
    const Quat orientation = random.orientation();
    const RigidState state{.position = resting_height(*shape, orientation) * Vec3::UnitZ() +
                                       (pair ? Vec3(0, 0, 5) : Vec3::Zero()),
                           .orientation = orientation,
                           .velocity = -motion.speed * Vec3::UnitZ(),
                           .angular_velocity = motion.spin * random.direction()};
    bodies = {add_case_body(manager, shape, state)};
    if (pair)
      bodies.push_back(
          add_case_body(manager, shape,
                        {.position = {0, 0, 5 - resting_height(*shape, Quat::Identity(), -Vec3::UnitZ())}}));
    return manager;
  }
};

struct Figures {
  int lost = 0, answered = 0;
};

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
      answered =
          answered ||
          (after.velocity - before).norm() + touch.shape->radius * after.angular_velocity.norm() > kResponse;
      side = 0.0;
    }
    figures.lost += !finite;
    figures.answered += answered;
  }
  return figures;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  const Touch touch;
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels)
    for (const bool pair : {false, true}) {
      const std::string what =
          fmt::format("{} x box touches {}, {}: ", kTrials, pair ? "another" : "a plane", name);
      int lost = 0;
      for (const Motion& motion : {Motion{0, 0}, {0, 10}, {2, 0}})
        lost += measure(touch, model, motion, pair).lost;
      rows.push_back({.what = what + "v = 0, spin = 0, or both: no finite state",
                      .value = double(lost),
                      .bound = 0.0,
                      .unit = "bodies"});
      rows.push_back({.what = what + "v and spin 0: a response",
                      .value = double(measure(touch, model, {0, 0}, pair).answered),
                      .bound = 0.0,
                      .unit = "bodies"});
      const int struck = measure(touch, model, {2, 0}, pair).answered;
      rows.push_back({.what = what + "spin 0: a response",
                      .value = double(struck),
                      .bound = double(kTrials),
                      .unit = "bodies",
                      .side = BoundSide::at_least});
    }
  return rows;
}

}  // namespace motionless_hits

// S2: the working frame where velocity and normal are all but parallel.
namespace contact_frames {

constexpr int kDirections = 1000;

/// How far from orthonormal, right-handed and with the normal for its first axis.
double fault_of(const Mat3& frame, const Vec3& normal) {
  const double skew = (frame.transpose() * frame - Mat3::Identity()).cwiseAbs().maxCoeff();
  const double off = (frame.col(0) - normal).norm(), handed = std::abs(frame.determinant() - 1.0);
  return worse(worse(skew, off), handed);
}

double worst_frame(double tilt) {
  double worst = 0.0;
  for (int i = 0; i < kDirections; ++i) {
    RandomStream random(102, std::uint64_t(i), 0);
    const Vec3 normal = random.direction(), aside = normal.cross(random.direction()).normalized();
    for (const double sign : {-1.0, 1.0})
      for (const double speed : {1e-9, 1.0, 1e9})
        worst = worse(
            worst,
            fault_of(contact_frame(normal, speed * (sign * std::cos(tilt) * normal + std::sin(tilt) * aside)),
                     normal));
  }
  return worst;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  double tilted = 0.0;
  for (int k = 1; k <= 16; ++k) tilted = worse(tilted, worst_frame(std::pow(10.0, -k)));
  double none = worst_frame(0.0);
  for (const Vec3& normal :
       {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ()), Vec3(-Vec3::UnitZ())})
    for (const Vec3& velocity :
         {Vec3(Vec3::Zero()), Vec3(-3.0 * normal), Vec3(5e-324 * normal), Vec3(1e-200, 2e-200, 3e-200)})
      none = worse(none, fault_of(contact_frame(normal, velocity), normal));
  return {{.what = "working frame, v tilted by 1e-1 to 1e-16 from +-n: off orthonormal and right-handed",
           .value = tilted,
           .bound = 1e-12},
          {.what = "working frame, v along +-n or 0: off orthonormal and right-handed",
           .value = none,
           .bound = 1e-12}};
}

}  // namespace contact_frames

// S3: spin along the velocity; bodies in contact that move apart.
namespace odd_directions {

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
    Manager manager =
        make_case_manager({.model = model, .seed = std::uint64_t(trial) + 1, .signature = subject.signature});
    const Vec3 direction = (random.direction() - 1.01 * Vec3::UnitZ()).normalized();
    const BodyId body = add_case_body(manager, subject.shape,
                                      {.position = {0, 0, 0.4},
                                       .orientation = random.orientation(),
                                       .velocity = 5.0 * direction,
                                       .angular_velocity = sign * 20.0 * direction});
    bool finite = true;
    for (int i = 0; i < 30 && finite; ++i) {
      manager.step(kCaseStep);
      finite = is_finite(manager.state(body));
    }
    lost += !finite;
  }
  return lost;
}

/// Greatest change of velocity, over the speed, of bodies that touch (or overlap by `depth`) what they leave
/// at `theta` from −n; no gravity, no spin.
double worst_response(const Subject& subject, StatisticalModel model, double theta_deg, double depth,
                      bool pair) {
  double worst = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(104, std::uint64_t(trial), 0);
    Manager manager = make_case_manager({.model = model,
                                         .gravity = Vec3::Zero(),
                                         .seed = std::uint64_t(trial) + 1,
                                         .signature = subject.signature});
    const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi), base = pair ? 5.0 : 0.0;
    const double theta = theta_deg * std::numbers::pi / 180.0,
                 along = theta_deg == 90.0 ? 0.0 : -std::cos(theta);
    const Vec3 velocity(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), along);
    const Quat orientation =
        pair ? Quat(Quat::Identity())
             : random.orientation();  // askew they might be nearest across, and meet on the way
    const Vec3 place(0, 0, base + resting_height(*subject.shape, orientation) - depth);
    std::vector<BodyId> bodies = {add_case_body(
        manager, subject.shape, {.position = place, .orientation = orientation, .velocity = velocity})};
    if (pair) {
      const double below = resting_height(*subject.shape, Quat::Identity(), -Vec3::UnitZ());
      bodies.push_back(
          add_case_body(manager, subject.shape, {.position = {0, 0, base - below}, .velocity = -velocity}));
    }
    manager.step(kCaseStep);
    double sign = 1.0;
    for (const BodyId body : bodies) {
      worst = worse(worst, (manager.state(body).velocity - sign * velocity).norm() +
                               subject.shape->radius * manager.state(body).angular_velocity.norm());
      sign = -1.0;
    }
  }
  return worst;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  const Subject box{box_of({0.2, 0.3, 0.4})};
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels) {
    for (const auto& [sign, way] : {std::pair{1.0, "along"}, {-1.0, "against"}})
      rows.push_back(
          {.what = fmt::format("{} x box at a plane, spin {} v, {}: no finite state", kTrials, way, name),
           .value = double(count_lost(box, model, sign)),
           .bound = 0.0,
           .unit = "bodies"});
    for (const bool pair : {false, true}) {
      double worst = 0.0;
      for (const double depth : {0.0, 0.001})
        for (const double theta : {90.0, 90.001, 100.0, 135.0, 180.0})
          worst = worse(worst, worst_response(box, model, theta, depth, pair));
      rows.push_back(
          {.what = fmt::format("{} x {}, touching, theta >= 90 deg, {}: change of velocity over speed",
                               kTrials, pair ? "box on another leaves it, flat" : "box leaves a plane", name),
           .value = worst,
           .bound = 1e-9});
    }
  }
  return rows;
}

}  // namespace odd_directions

}  // namespace

std::span<const HardCase> odd_hit_cases() {
  static constexpr std::array kCases = {
      HardCase{"S1", motionless_hits::measure_case},
      HardCase{"S2", contact_frames::measure_case},
      HardCase{"S3", odd_directions::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
