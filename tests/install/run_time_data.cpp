// What a game's bad day passes to a manager: nothing aborts, all of it is refused or put right, and nothing
// has changed.
#include <ode/ode.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "check.h"
#include "lod/manager.h"
#include "reference/error.h"

using namespace lodestone;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                 kInfinity = std::numeric_limits<double>::infinity();

int refused = 0, changed = 0, let_through = 0;

void refuse(Manager& manager, const std::function<void()>& act) {
  const std::uint64_t before = manager.state_hash();
  try {
    act();
    ++let_through;
  } catch (const InputError&) {
    ++refused;
  }
  changed += manager.state_hash() != before;
}

int main() {
  Manager manager({.policy = {.policy = DistancePolicy{.full_within = 3.0}},
                   .signatures = [](const Shape&, const ContactLaw&) { return nullptr; }});
  manager.add_plane({0, 0, 1}, 0.0);
  const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
  const auto at = [](double x, double z) {
    return RigidState{Vec3(x, 0, z), Quat::Identity(), Vec3::Zero(), Vec3::Zero()};
  };
  const BodyId near = manager.add_body({.shape = crate, .state = at(0, 1)}),
               far = manager.add_body({.shape = crate, .state = at(20, 1)});
  const BodyId gone = manager.add_body({.shape = crate, .state = at(5, 1)});
  const Vec3 camera(0, 0, 1);
  manager.set_viewpoints({&camera, 1});
  for (int i = 0; i < 10; ++i) manager.step(1.0 / 60.0);
  manager.remove_body(gone);
  check::that(manager.rung(near) == Rung::full && manager.rung(far) == Rung::support,
              "one body is full, the other is not");

  for (const double dt : {-1.0, 11.0, kNan, kInfinity}) refuse(manager, [&] { manager.step(dt); });
  for (const BodyId id : {gone, BodyId{}, BodyId{1000000, 1}}) {
    refuse(manager, [&] { manager.state(id); });
    refuse(manager, [&] { manager.remove_body(id); });
    refuse(manager, [&] { manager.add_force(id, {0, 0, 1}); });
    check::that(!manager.valid(id), "a stale id is not valid");
  }
  for (const BodyId body : {near, far})
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
      refuse(manager, [&] { manager.set_state(body, at(bad, 1)); });
      refuse(manager, [&] { manager.add_force(body, {bad, 0, 0}); });
      refuse(manager, [&] { manager.add_impulse(body, {0, bad, 0}, {0, 0, 0}); });
      refuse(manager, [&] { manager.set_importance(body, bad); });
      RigidState fast = at(0, 1);
      fast.angular_velocity.y() = bad;
      refuse(manager, [&] { manager.set_state(body, fast); });
    }
  RigidState crooked = at(0, 2);
  crooked.orientation.coeffs() *= 1.002;
  refuse(manager, [&] { manager.set_state(near, crooked); });
  refuse(manager, [&] { manager.add_body({.shape = nullptr}); });
  refuse(manager, [&] { manager.add_body({.shape = crate, .material = 9}); });
  refuse(manager, [&] { manager.add_body({.shape = crate, .mass = kNan}); });
  refuse(manager, [&] { manager.materials().add({.restitution = 1.5}); });
  refuse(manager, [&] { manager.materials().add({.friction = -0.5}); });
  refuse(manager, [&] { manager.materials().set_law(0, 4, {}); });
  refuse(manager, [&] { manager.set_gravity({0, kNan, 0}); });
  refuse(manager, [&] { manager.add_plane({0, 0, 3}, 0.0); });
  refuse(manager, [&] {
    manager.add_static_mesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, kNan}}, {{0, 1, 2}, {0, 2, 1}}});
  });
  refuse(manager, [&] { manager.cast_ray({.from = {0, 0, 1}, .direction = {0, 0, 0}}); });
  refuse(manager, [&] { make_shape("flat", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}}); });
  check::within(refused, 55, 55, "calls refused");
  check::within(let_through, 0, 0, "let through");
  check::within(changed, 0, 0, "of them changed something");

  RigidState nearly = at(0, 2);
  nearly.orientation.coeffs() *= 1.0 + 1e-5;
  nearly.velocity = {1e200, 0, 0};
  manager.set_state(near, nearly);
  check::within(std::abs(manager.state(near).orientation.norm() - 1.0), 0.0, 1e-15,
                "length of a quaternion that was 1e-5 off, less 1");
  check::within(manager.state(near).velocity.x(), 1e6, 1e6, "m/s of one that was given 1e200");
  manager.set_state(near, at(0, 1));
  manager.add_force(far, {1e308, 0, 0});
  refuse(manager, [&] { manager.add_force(far, {1e308, 0, 0}); });
  for (int i = 0; i < 60; ++i) manager.step(1.0 / 60.0);
  check::that(manager.state(far).position.allFinite(),
              "a force beyond all bounds leaves the body where it can be held");

  int handled = 0;
  set_assertion_handler([&](std::string_view message) {
    ++handled;
    throw std::runtime_error(std::string(message));
  });
  try {
    check_that(false, "this is a bug of ours");
  } catch (const std::runtime_error&) {
    ++handled;
  }
  set_assertion_handler({});
  check::within(handled, 2, 2, "an assertion goes through the handler");
  return check::result();
}
