// What a game changes while it runs, and what it reads in bulk.
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

constexpr double kFrame = 1.0 / 60.0;

const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
RigidState at(double x, double z) { return {Vec3(x, 0, z), Quat::Identity(), Vec3::Zero(), Vec3::Zero()}; }

// Gravity as the caller's world has it, on every rung, from step to step.
void follow_gravity() {
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(nullptr);
  dWorldSetGravity(world, 0, 0, -9.81);
  dCreatePlane(space, 0, 0, 1, 0);
  {
    Manager manager(world, space, {.signature_timing = SignatureTiming::in_step});
    std::vector<BodyId> bodies;
    for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
      bodies.push_back(
          manager.add_body({.shape = crate, .state = at(3.0 * double(bodies.size()), 0.5), .level = level}));
    for (int i = 0; i < 300; ++i) manager.step(kFrame);
    check::within(manager.report().asleep, 3, 3, "bodies at rest, one on each rung");
    dWorldSetGravity(world, 0, 0, 2.0);
    manager.step(kFrame);
    check::within(double(manager.woke().size()), 3, 3, "woke as the caller turned gravity round");
    for (int i = 1; i < 60; ++i) manager.step(kFrame);
    double least = 1e9, most = 0.0;
    for (const BodyId body : bodies)
      least = std::min(least, manager.state(body).velocity.z()),
      most = std::max(most, manager.state(body).velocity.z());
    check::within(least, 1.95, 2.0 + 1e-9, "m/s up after a second, of the slowest");
    check::within(most, 1.95, 2.0 + 1e-9, "m/s up after a second, of the fastest");
    manager.set_gravity(Vec3::Zero());
    dVector3 now;
    dWorldGetGravity(world, now);
    check::that(now[2] == 0.0, "set_gravity sets the caller's world's");
    std::vector<RigidState> before(3), after(3);
    manager.read_states(bodies, before);
    for (int i = 0; i < 60; ++i) manager.step(kFrame);
    manager.read_states(bodies, after);
    double off = 0.0;
    for (int i = 0; i < 3; ++i)
      off = std::max(off, (after[std::size_t(i)].position - before[std::size_t(i)].position -
                           before[std::size_t(i)].velocity)
                              .norm());
    check::within(off, 0.0, 1e-4, "m off a straight line in a second without gravity");
  }
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

void pause_and_hitch() {
  Manager manager({.signatures = [](const Shape&, const ContactLaw&) { return nullptr; }});
  const BodyId full = manager.add_body({.shape = crate, .state = at(0, 100), .level = LevelChoice::full}),
               support = manager.add_body({.shape = crate, .state = at(3, 100)});
  manager.step(kFrame);
  const std::uint64_t hash = manager.state_hash();
  const std::int64_t step = manager.report().step;
  const StepReport paused = manager.step(0.0);
  check::that(manager.state_hash() == hash && paused.step == step && paused.dt_s == 0.0,
              "a step of 0 s is a pause");
  for (const BodyId body : {full, support}) manager.set_state(body, at(body == full ? 0 : 3, 100));
  for (const BodyId body : {full, support}) manager.add_force(body, {manager.mass(body), 0, 0});
  const StepReport hitch = manager.step(1.0);
  check::within(double(hitch.counters.divided_steps), 1, 1, "a step of 1 s is divided");
  check::within(hitch.dt_s, 1, 1, "s that it lasted");
  for (const BodyId body : {full, support}) {
    check::within(manager.state(body).velocity.z(), -9.82, -9.80, "m/s down after it");
    check::within(manager.state(body).velocity.x(), 0.999, 1.001,
                  "m/s along the force that was given for it");
  }
}

void impulses() {
  Manager manager(
      {.gravity = Vec3::Zero(), .signatures = [](const Shape&, const ContactLaw&) { return nullptr; }});
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support}) {
    const BodyId body = manager.add_body(
        {.shape = crate, .state = at(level == LevelChoice::full ? 0 : 5, 1), .level = level});
    manager.step(kFrame);
    const Vec3 arm(0.1, 0, 0), impulse(0, 3, 1);
    manager.add_impulse(body, impulse, manager.state(body).position + arm);
    const RigidState state = manager.state(body);
    const double mass = manager.mass(body);
    check::within((mass * state.velocity - impulse).norm(), 0, 1e-12, "N s off the impulse given at a point");
    const Vec3 momentum = mass * (crate->inertia_per_mass * state.angular_velocity);
    check::within((momentum - arm.cross(impulse)).norm(), 0, 1e-12, "N m s off its moment");
    manager.set_state(body, at(level == LevelChoice::full ? 0 : 5, 1));
    manager.add_force_at(body, impulse / kFrame, manager.state(body).position + arm);
    manager.step(kFrame);
    check::within((mass * manager.state(body).velocity - impulse).norm(), 0, 1e-9,
                  "N s off what a force at a point gives in a step");
  }
}

// Sleep by the caller's hand; lists; data.
void sleepers() {
  Manager manager({.sleep = {.speed = 0.05, .time = 0.3},
                   .signatures = [](const Shape&, const ContactLaw&) { return nullptr; }});
  manager.add_plane({0, 0, 1}, 0.0);
  std::vector<BodyId> bodies;
  for (int i = 0; i < 20; ++i)
    bodies.push_back(manager.add_body({.shape = crate,
                                       .state = at(i, 0.2),
                                       .level = i < 10 ? LevelChoice::full : LevelChoice::support,
                                       .user_data = std::uintptr_t(i)}));
  const BodyId restless = manager.add_body({.shape = crate,
                                            .state = at(30, 0.2),
                                            .level = LevelChoice::support,
                                            .properties = {.allow_sleep = false}});
  std::size_t slept = 0;
  for (int i = 0; i < 180; ++i) {
    manager.step(kFrame);
    slept += manager.fell_asleep().size();
  }
  check::within(double(slept), 20, 20, "fell asleep, of 20 that may");
  check::that(!manager.asleep(restless), "one that may not does not");
  check::within(double(manager.moved().size()), 1, 1, "moved in the last step");
  manager.wake(bodies[3]);
  manager.add_force(bodies[13], {0, 0, 1.0});
  manager.step(kFrame);
  check::within(double(manager.woke().size()), 2, 2, "woke: by hand, and by a force");
  check::within(double(manager.moved().size()), 3, 3, "moved in that step");
  manager.set_state(bodies[5], at(5, 50));
  manager.set_state(bodies[15], at(15, 50));
  manager.sleep(bodies[5]);
  manager.sleep(bodies[15]);
  for (int i = 0; i < 60; ++i) manager.step(kFrame);
  check::that(manager.state(bodies[5]).position.z() == 50.0 && manager.state(bodies[15]).position.z() == 50.0,
              "who is laid to sleep in the air stays there");
  manager.set_level(bodies[5], LevelChoice::support);
  manager.set_level(bodies[15], LevelChoice::full);
  manager.step(kFrame);
  const auto changes = manager.rung_changes();
  check::that(changes.size() == 2 && changes[0].from != changes[0].to && manager.asleep(bodies[5]) &&
                  manager.asleep(bodies[15]),
              "changes of rung are listed, and sleepers sleep on");
  check::that(manager.user_data(bodies[5]) == 5 && manager.user_data(bodies[15]) == 15,
              "the caller's own data stays with them");
  std::vector<float> positions(60), orientations(80);
  manager.read_poses(bodies, positions, orientations);
  double off = 0.0;
  for (std::size_t i = 0; i < 20; ++i)
    off = std::max(off, std::abs(double(positions[3 * i + 2]) - manager.state(bodies[i]).position.z()) +
                            std::abs(1.0 - double(orientations[4 * i])));
  check::within(off, 0, 1e-3, "m off, of poses read in bulk");
}

int main() {
  dInitODE2(0);
  follow_gravity();
  pause_and_hitch();
  impulses();
  sleepers();
  // Threads by the way: the same results.
  std::uint64_t hashes[2];
  for (const int threads : {1, 2}) {
    Manager manager({.signatures = [](const Shape&, const ContactLaw&) { return nullptr; }});
    manager.add_plane({0, 0, 1}, 0.0);
    for (int i = 0; i < 100; ++i)
      manager.add_body({.shape = crate,
                        .state = {Vec3(i % 5 * 0.4, i / 5 % 5 * 0.4, 0.3 + 0.5 * (i / 25)), Quat::Identity(),
                                  Vec3::Zero(), Vec3::Zero()}});
    for (int i = 0; i < 60; ++i) {
      if (i == 10) manager.set_threads(threads);
      manager.step(kFrame);
    }
    hashes[threads - 1] = manager.state_hash();
  }
  check::that(hashes[0] == hashes[1], "set_threads changes no result");
  return check::result();
}
