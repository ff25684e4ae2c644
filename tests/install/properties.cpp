// Bits, gravity, damping, speed limits, kinematic bodies and a pair filter, on the full level and at
// `support` alike.
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "check.h"
#include "crate.h"

using namespace lodestone;

const auto platform = std::make_shared<const Shape>(make_shape("platform", make_box({2, 2, 0.2})));
ManagerSettings unmeasured() {
  return {.signatures = [](const Shape&, const ContactLaw&) { return nullptr; }};
}
ManagerSettings measured() { return {.signature_timing = SignatureTiming::in_step}; }

void run(Manager& manager, double seconds) {
  for (int i = 0; i < std::lround(seconds / kFrame); ++i) manager.step(kFrame);
}

void bits(LevelChoice upper, LevelChoice lower, const char* what) {
  Manager manager(unmeasured());
  manager.add_plane({0, 0, 1}, 0.0);
  manager.add_body(
      {.shape = crate, .state = at(0, 0.15), .level = lower, .properties = {.category = 1, .collide = 1}});
  const BodyId ghost = manager.add_body(
      {.shape = crate, .state = at(0.02, 0.5), .level = upper, .properties = {.category = 2, .collide = 2}});
  const BodyId mate = manager.add_body({.shape = crate, .state = at(2, 0.15), .level = lower});
  const BodyId solid = manager.add_body({.shape = crate, .state = at(2.02, 0.5), .level = upper});
  run(manager, 1.5);
  check::that(manager.valid(mate), what);
  check::within(manager.state(ghost).position.z(), 0.14, 0.17,
                "m, height of one that passes through the other by its bits");
  check::within(manager.state(solid).position.z(), 0.43, 0.46, "m, height of one that lies on the other");
}

void flight(LevelChoice level, const char* what) {
  Manager manager(unmeasured());
  const BodyId floats = manager.add_body({.shape = crate,
                                          .state = at(0, 5),
                                          .level = level,
                                          .properties = {.gravity = false, .allow_sleep = false}});
  RigidState moving = at(10, 5);
  moving.velocity = {1, 0, 0};
  moving.angular_velocity = {0, 0, 8};
  const BodyId damped =
      manager.add_body({.shape = crate,
                        .state = moving,
                        .level = level,
                        .properties = {.gravity = false, .linear_damping = 0.5, .angular_damping = 1.0}});
  moving.position.x() = 20;
  const BodyId limited = manager.add_body(
      {.shape = crate, .state = moving, .level = level, .properties = {.max_angular_speed = 3.0}});
  run(manager, 1.0);
  check::that(manager.level(floats) == (level == LevelChoice::full ? Level::full : Level::statistical), what);
  check::within((manager.state(floats).position - Vec3(0, 0, 5)).norm(), 0, 1e-9,
                "m moved in a second without gravity");
  check::within(manager.state(damped).velocity.x(), std::exp(-0.5) - 0.005, std::exp(-0.5) + 0.005,
                "m/s left of 1, damped by .5/s, after a second");
  check::within(manager.state(damped).angular_velocity.z(), 8 * std::exp(-1.0) - 0.05,
                8 * std::exp(-1.0) + 0.05, "rad/s left of 8, damped by 1/s");
  check::within(manager.state(limited).angular_velocity.norm(), 2.95, 3.0 + 1e-9,
                "rad/s of one that is limited to 3");
}

void kinematic(LevelChoice under, LevelChoice above, const char* what) {
  Manager manager(above == LevelChoice::tables ? measured() : unmeasured());
  RigidState moving = at(0, 1);
  moving.velocity = {0.25, 0, 0};
  const BodyId lift = manager.add_body(
      {.shape = platform, .state = moving, .level = under, .properties = {.kinematic = true}});
  const BodyId rider = manager.add_body({.shape = crate, .state = at(0, 1.26), .level = above});
  run(manager, 1.0);
  const double from = manager.state(rider).position.x() - manager.state(lift).position.x();
  run(manager, 2.0);
  std::printf("%s\n", what);
  check::within(manager.state(lift).position.x(), 0.7499, 0.7501,
                "m that a platform moved in 3 s at .25 m/s");
  check::within(manager.state(lift).position.z(), 1.0 - 1e-9, 1.0 + 1e-9, "m, its height");
  check::within(manager.state(rider).position.z(), 1.24, 1.27, "m, height of who rides on it");
  check::within(std::abs(manager.state(rider).position.x() - manager.state(lift).position.x() - from), 0,
                0.01, "m that it slid in the last 2 s");
}

void filter() {
  ManagerSettings settings = measured();
  BodyId one, other;
  settings.pair_filter = [&](BodyId a, BodyId b) {
    return !((a == one && b == other) || (a == other && b == one));
  };
  for (const auto& [lower, upper] : {std::pair{LevelChoice::support, LevelChoice::support},
                                     {LevelChoice::tables, LevelChoice::tables},
                                     {LevelChoice::full, LevelChoice::full},
                                     {LevelChoice::full, LevelChoice::support},
                                     {LevelChoice::support, LevelChoice::tables}}) {
    Manager manager(settings);
    manager.add_plane({0, 0, 1}, 0.0);
    one = manager.add_body({.shape = crate, .state = at(0, 0.2), .level = lower});
    other = manager.add_body({.shape = crate, .state = at(0.02, 0.8), .level = upper});
    run(manager, 2.0);
    check::within(manager.state(other).position.z(), 0.12, 0.23,
                  "m, height of one that the filter lets through the other");
  }
}

void keep_off_tables() {
  ManagerSettings settings = measured();
  settings.policy.policy = DistancePolicy{.full_within = 1.0, .support_within = 2.0};
  Manager manager(settings);
  const Vec3 camera(100, 0, 0);
  manager.set_viewpoints({&camera, 1});
  manager.add_plane({0, 0, 1}, 0.0);
  const BodyId own = manager.add_body(
                   {.shape = crate, .state = at(0, 0.3), .properties = {.angular_damping = 0.1}}),
               plain = manager.add_body({.shape = crate, .state = at(3, 0.3)});
  run(manager, 0.1);
  check::that(manager.rung(own) == Rung::support && manager.rung(plain) == Rung::tables,
              "one with properties of its own is never at tables");
  manager.set_properties(plain, {.linear_damping = 1.0});
  check::that(manager.rung(plain) == Rung::support, "nor one that is given some");
  manager.set_properties(own, {});
  run(manager, 1.0);
  check::that(manager.rung(own) == Rung::tables, "one that has no longer any is");
}

int main() {
  bits(LevelChoice::support, LevelChoice::support, "bits at support");
  bits(LevelChoice::full, LevelChoice::full, "bits at the full level");
  bits(LevelChoice::full, LevelChoice::support, "bits of a full body over one at support");
  bits(LevelChoice::support, LevelChoice::full, "bits of one at support over a full body");
  flight(LevelChoice::support, "flight at support");
  flight(LevelChoice::full, "flight at the full level");
  kinematic(LevelChoice::support, LevelChoice::support, "kinematic at support, rider at support");
  kinematic(LevelChoice::support, LevelChoice::tables, "kinematic at support, rider at tables");
  kinematic(LevelChoice::full, LevelChoice::full, "kinematic and rider full");
  kinematic(LevelChoice::full, LevelChoice::support, "kinematic full, rider at support");
  kinematic(LevelChoice::support, LevelChoice::full, "kinematic at support, rider full");
  filter();
  keep_off_tables();
  return check::result();
}
