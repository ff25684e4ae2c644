// What a user's first program may look like: a world of plain ODE, whose bodies a manager looks after. README
// shows the includes and play(), to the letter (readme_test.cpp).
#include <algorithm>
#include <cstdio>

// clang-format off
#include <memory>
#include <vector>
#include <ode/ode.h>
#include <lodestone/lodestone.h>

using namespace lodestone;

void draw(const RigidState& state, Level level);

void play(dWorldID world, dSpaceID space) {
  Manager manager(world, space, {.policy = {.policy = DistancePolicy{.full_within = 3.0}},
                                 .signature_timing = SignatureTiming::in_step});
  const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
  std::vector<BodyId> bodies;
  for (int i = 0; i < 100; ++i)
    bodies.push_back(manager.add_body({.shape = crate, .state = {.position = Vec3(i % 10, i / 10, 1.0)}}));

  for (int frame = 0; frame < 120; ++frame) {
    const Vec3 camera(0.05 * frame, 0.0, 1.5);
    manager.set_viewpoints({&camera, 1});
    manager.step(1.0 / 60.0);  // your own bodies too: no dWorldStep beside it
    for (const BodyId body : bodies) draw(manager.state(body), manager.level(body));
  }
}

// What was drawn.
int full = 0, statistical = 0;
double lowest = 1.0;  // m

// clang-format on

void draw(const RigidState& state, Level level) {
  ++(level == Level::full ? full : statistical);
  lowest = std::min(lowest, state.position.z());
}

struct Rungs {
  int tables = 0, support = 0, full = 0;
};

Rungs count(const Manager& manager, const std::vector<BodyId>& bodies) {
  Rungs rungs;
  for (const BodyId body : bodies)
    ++(manager.rung(body) == Rung::full      ? rungs.full
       : manager.rung(body) == Rung::support ? rungs.support
                                             : rungs.tables);
  return rungs;
}

// Crates on all three rungs, while the camera leaves and comes back; then under a budget.
bool climbs(dWorldID world, dSpaceID space) {
  Manager manager(world, space,
                  {.policy = {.policy = DistancePolicy{.full_within = 1.5, .support_within = 5.0},
                              .max_transitions_per_frame = 20},
                   .signature_timing = SignatureTiming::in_step});
  const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
  std::vector<BodyId> bodies;
  for (int i = 0; i < 100; ++i)
    bodies.push_back(manager.add_body({.shape = crate, .state = {.position = Vec3(i % 10, i / 10, 1.0)}}));
  const auto stay = [&](const Vec3& camera) {
    for (int frame = 0; frame < 120; ++frame) {
      manager.set_viewpoints({&camera, 1});
      manager.step(1.0 / 60.0);
      for (const BodyId body : bodies) lowest = std::min(lowest, manager.state(body).position.z());
    }
    return count(manager, bodies);
  };
  const Vec3 here(2.0, 2.0, 1.0), away(100.0, 0.0, 1.0);
  const Rungs before = stay(here), gone = stay(away), back = stay(here);
  manager.set_policy({.policy = BudgetPolicy{.budget_ms = 4.0}});
  const Rungs budgeted = stay(here);
  const StepReport& report = manager.report();
  std::printf(
      "full, support, tables: %d, %d, %d here; %d, %d, %d away; %d, %d, %d back; %d, %d, %d with 4 ms, of "
      "which the last step took %.3f, foretold %.3f\n",
      before.full, before.support, before.tables, gone.full, gone.support, gone.tables, back.full,
      back.support, back.tables, budgeted.full, budgeted.support, budgeted.tables, report.measured_ms,
      report.predicted_ms);
  return before.full > 0 && before.support > 0 && before.tables > 0 && gone.tables == 100 && back.full > 0 &&
         back.support > 0 && budgeted.full > 0 && report.measured_ms > 0.0;
}

int main() {
  dInitODE2(0);
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(nullptr);
  dWorldSetGravity(world, 0, 0, -9.81);
  dCreatePlane(space, 0, 0, 1, 0);
  play(world, space);
  const bool climbed = climbs(world, space);
  dSpaceDestroy(space);
  dWorldDestroy(world);
  std::printf("drawn %d times full, %d times statistical; lowest centre of mass at %.3f m\n", full,
              statistical, lowest);
  const bool fell_and_was_held = lowest > 0.08 && lowest < 0.3;
  return full > 0 && statistical > 0 && fell_and_was_held && climbed ? 0 : 1;
}
