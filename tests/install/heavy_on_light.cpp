// A great ball rolls into a stack of boxes up to ten thousand times lighter, with the boxes full and at
// `support`: it loses the same speed, and sinks into none.
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

constexpr double kSide = 0.3, kRadius = 0.5, kLight = 10.0;  // m, m, kg
constexpr int kRuns = 3;

struct Outcome {
  double speed = 0.0;    // m/s, of the ball after a second
  double overlap = 0.0;  // m, the deepest that it was in a box
};

double depth_in_box(const Vec3& center, const RigidState& box) {
  const Vec3 local = box.orientation.conjugate() * (center - box.position);
  const Vec3 nearest = local.cwiseMax(-0.5 * kSide).cwiseMin(0.5 * kSide);
  return kRadius - (local - nearest).norm();
}

Outcome roll(double ratio, LevelChoice boxes_level, LevelChoice ball_level, int substeps, unsigned seed) {
  std::mt19937 random(seed);
  const auto some = [&](double most) { return std::uniform_real_distribution<double>(-most, most)(random); };
  Manager manager({.full_substeps = substeps, .signatures = [](const Shape&, const ContactLaw&) {
                     return std::shared_ptr<const Signature>();
                   }});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto box = std::make_shared<const Shape>(make_shape("box", make_box(Vec3::Constant(kSide))));
  const auto ball = std::make_shared<const Shape>(make_sphere_shape(kRadius));
  std::vector<BodyId> boxes;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 2; ++z) {
        RigidState state;
        state.position = {1.0 + 0.32 * x + some(0.005), 0.32 * (y - 1) + some(0.005),
                          0.5 * kSide + (kSide + 0.001) * z};
        state.orientation = Quat(Eigen::AngleAxisd(some(0.05), Vec3::UnitZ()));
        boxes.push_back(
            manager.add_body({.shape = box, .state = state, .mass = kLight, .level = boxes_level}));
      }
  const RigidState rolling{
      .position = {0, some(0.02), kRadius}, .velocity = {4, 0, 0}, .angular_velocity = {0, 4 / kRadius, 0}};
  const BodyId heavy =
      manager.add_body({.shape = ball, .state = rolling, .mass = ratio * kLight, .level = ball_level});
  Outcome outcome;
  for (int step = 0; step < 60; ++step) {
    manager.step(1.0 / 60);
    const Vec3 center = manager.state(heavy).position;
    for (const BodyId b : boxes)
      outcome.overlap = std::max(outcome.overlap, depth_in_box(center, manager.state(b)));
  }
  outcome.speed = manager.state(heavy).velocity.x();
  return outcome;
}

struct Runs {
  double least = 1e9, most = -1e9, overlap = 0.0;
  double mean = 0.0;
};

Runs run(double ratio, LevelChoice boxes, LevelChoice ball, int substeps) {
  Runs runs;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Outcome outcome = roll(ratio, boxes, ball, substeps, seed);
    runs.least = std::min(runs.least, outcome.speed), runs.most = std::max(runs.most, outcome.speed);
    runs.overlap = std::max(runs.overlap, outcome.overlap);
    runs.mean += outcome.speed / kRuns;
  }
  return runs;
}

// A slab dropped by .3 m and `more` onto four columns of two boxes: how much lower than these it stands after
// five seconds, m.
double find_sinking(double ratio, LevelChoice slab_level, double more) {
  Manager manager(
      {.signatures = [](const Shape&, const ContactLaw&) { return std::shared_ptr<const Signature>(); }});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto box = std::make_shared<const Shape>(make_shape("box", make_box(Vec3::Constant(kSide))));
  const auto slab = std::make_shared<const Shape>(make_shape("slab", make_box({1.2, 1.2, 0.4})));
  for (int i = 0; i < 8; ++i) {
    const Vec3 place(i % 2 ? 0.4 : -0.4, i / 2 % 2 ? 0.4 : -0.4, (0.5 + i / 4) * kSide);
    manager.add_body(
        {.shape = box, .state = {.position = place}, .mass = kLight, .level = LevelChoice::support});
  }
  const BodyId heavy = manager.add_body({.shape = slab,
                                         .state = {.position = {0, 0, 2 * kSide + 0.5 + more}},
                                         .mass = ratio * kLight,
                                         .level = slab_level});
  for (int step = 0; step < 300; ++step) manager.step(1.0 / 60);
  return 2 * kSide + 0.2 - manager.state(heavy).position.z();
}

}  // namespace

int main() {
  dInitODE2(0);
  for (const double ratio : {100.0, 1000.0})
    for (const LevelChoice slab : {LevelChoice::full, LevelChoice::support}) {
      const std::string what = "over a box's side: deepest sinking of a slab " + std::to_string(int(ratio)) +
                               " times a box, " + (slab == LevelChoice::full ? "full" : "support");
      double greatest = 0.0;  // of falls that differ by hardly anything, and end otherwise
      for (int i = 0; i < 6; ++i) greatest = std::max(greatest, find_sinking(ratio, slab, 1e-5 * i));
      check::within(greatest / kSide, -0.05, 0.05, what.c_str());
    }
  for (const double ratio : {1.0, 10.0, 100.0, 1e3, 1e4}) {
    const Runs full = run(ratio, LevelChoice::full, LevelChoice::full, 12);
    std::printf("ratio %g: all full %.3f to %.3f m/s, overlap %.4f m\n", ratio, full.least, full.most,
                full.overlap);
    for (const LevelChoice ball : {LevelChoice::full, LevelChoice::support}) {
      const Runs ours = run(ratio, LevelChoice::support, ball, 4);
      const std::string what = " of a ball " + std::to_string(int(ratio)) + " times a box, " +
                               (ball == LevelChoice::full ? "full" : "support");
      const double spread = 0.05 * 4.0;  // of its speed: a few runs do not show all of theirs
      // By friction on the ball: plain ODE at 1/960 s says -.60 by dWorldStep, -.82 by QuickStep (16 starts).
      const double solvers_differ = ratio == 10.0 ? 0.22 : 0.0;
      check::within(ours.mean, full.least - spread - solvers_differ, full.most + spread,
                    ("m/s after a second" + what).c_str());
      check::within(ours.overlap / kSide, -1.0, 0.05, ("overlap over the boxes' side" + what).c_str());
    }
  }
  return check::result();
}
