// Thousands of bodies, each of a mass of its own: what takes long to prepare is shared by all of one shape,
// scaled copies too, and each keeps its mass.
#include <ode/ode.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

constexpr int kBodies = 8000;

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::shared_ptr<const Shape> crate() {
  static const auto shape = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
  return shape;
}

Manager make_world(StatisticalModel model, double gravity) {
  Manager manager({.gravity = Vec3(0, 0, -gravity),
                   .model = model,
                   .policy = {.policy = DistancePolicy{.full_within = 1.0}},
                   .signature_timing = SignatureTiming::in_step});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  return manager;
}

// Far apart, over the ground.
void first_step(StatisticalModel model, bool scaled, const char* what) {
  Manager manager = make_world(model, 9.81);
  std::vector<BodyId> bodies;
  for (int i = 0; i < kBodies; ++i) {
    const auto shape =
        scaled && i % 8 == 0 ? std::make_shared<const Shape>(scale_shape(*crate(), 1.0 + 1e-5 * i)) : crate();
    bodies.push_back(manager.add_body({.shape = shape,
                                       .state = {.position = Vec3(i % 100, i / 100, 0.5)},
                                       .mass = 1.0 + 0.01 * i,
                                       .level = LevelChoice::statistical}));
  }
  const double start = seconds();
  manager.step(1.0 / 60);
  check::within(seconds() - start, 0.0, 30.0, what);
  double greatest = 0.0;
  for (int i = 0; i < kBodies; ++i)
    greatest = std::max(greatest, std::abs(manager.mass(bodies[std::size_t(i)]) - (1.0 + 0.01 * i)));
  check::within(greatest, 0.0, 0.0, "kg by which a mass differs from the one given");
}

// A light one meets a heavy one head-on, without gravity.
void momentum(StatisticalModel model, const char* what) {
  Manager manager = make_world(model, 0.0);
  const BodyId light = manager.add_body({.shape = crate(),
                                         .state = {.position = Vec3(0, 0, 5), .velocity = Vec3(3, 0, 0)},
                                         .mass = 1.0,
                                         .level = LevelChoice::statistical});
  const BodyId heavy = manager.add_body({.shape = crate(),
                                         .state = {.position = Vec3(0.6, 0, 5)},
                                         .mass = 7.0,
                                         .level = LevelChoice::statistical});
  for (int i = 0; i < 30; ++i) manager.step(1.0 / 60);
  const Vec3 momentum = 1.0 * manager.state(light).velocity + 7.0 * manager.state(heavy).velocity;
  check::that(manager.state(heavy).velocity.x() > 0.1, "the heavy one was hit");
  check::within((momentum - Vec3(3, 0, 0)).norm(), 0.0, model == StatisticalModel::tables ? 1e-5 : 1e-12,
                what);
}

}  // namespace

int main() {
  dInitODE2(0);
  {
    Manager manager =
        make_world(StatisticalModel::support, 9.81);  // measures the crate's signature, or finds it
    manager.add_body({.shape = crate()});
    manager.step(1.0 / 60);
  }
  first_step(StatisticalModel::support, false, "s of a first step with 8,000 masses, support");
  first_step(StatisticalModel::tables, false, "s of a first step with 8,000 masses, tables");
  first_step(StatisticalModel::support, true, "s of a first step with 8,000 masses and 1,001 sizes, support");
  momentum(StatisticalModel::support, "N s that two hulls' momentum changed by");
  momentum(StatisticalModel::tables, "N s that two spheres' momentum changed by");
  return check::result();
}
