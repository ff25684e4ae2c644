// A game that keeps its own dSpaceCollide and dWorldStep, with a manager before and after; and ground of the
// manager's that moves, comes and goes.
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "check.h"
#include "lod/manager.h"
#include "reference/error.h"

using namespace lodestone;

constexpr double kFrame = 1.0 / 60.0;

const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.3, 0.3, 0.3})));
RigidState at(double x, double z) { return {Vec3(x, 0, z), Quat::Identity(), Vec3::Zero(), Vec3::Zero()}; }
ManagerSettings measured() {
  ManagerSettings settings;
  settings.signature_timing = SignatureTiming::in_step;
  settings.events.all_bodies = true;
  return settings;
}

struct Game {
  Game() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    dWorldSetGravity(world, 0, 0, -9.81);
    dCreatePlane(space, 0, 0, 1, 0);
    dMass mass;
    dMassSetSphereTotal(&mass, 5.0, 0.25);
    dBodySetMass(ball, &mass);
    dBodySetPosition(ball, 5, 0, 2);
    dGeomSetBody(dCreateSphere(space, 0.25), ball);
  }
  ~Game() {
    dJointGroupDestroy(contacts);
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  static void meet(void* data, dGeomID a, dGeomID b) {
    auto& game = *static_cast<Game*>(data);
    dContact contact[4];
    const int count = dCollide(a, b, 4, &contact[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      contact[i].surface.mode = dContactApprox1;
      contact[i].surface.mu = 0.5;
      dJointAttach(dJointCreateContact(game.world, game.contacts, &contact[i]), dGeomGetBody(a),
                   dGeomGetBody(b));
    }
  }
  void step() {
    dSpaceCollide(space, this, &meet);
    dWorldQuickStep(world, kFrame);
    dJointGroupEmpty(contacts);
  }
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  dBodyID ball = dBodyCreate(world);
  dJointGroupID contacts = dJointGroupCreate(0);
};

void own_loop() {
  Game game;
  Manager manager(game.world, game.space, measured());
  std::vector<BodyId> bodies;
  for (const LevelChoice level : {LevelChoice::full, LevelChoice::support, LevelChoice::tables})
    bodies.push_back(
        manager.add_body({.shape = crate, .state = at(-2.0 * double(bodies.size()), 1.0), .level = level}));
  const BodyId under_ball =
      manager.add_body({.shape = crate, .state = at(5, 0.15), .level = LevelChoice::support});
  int misused = 0, hits = 0;
  const auto misuse = [&](const auto& act) {
    try {
      act();
    } catch (const InputError&) {
      ++misused;
    }
  };
  misuse([&] { manager.after_world_step(); });
  for (int i = 0; i < 240; ++i) {
    manager.before_world_step(kFrame);
    if (i == 0) misuse([&] { manager.before_world_step(kFrame); });
    if (i == 0) misuse([&] { manager.step(kFrame); });
    game.step();
    manager.after_world_step();
    for (const ContactEvent& event : manager.contact_events())
      hits += event.phase == ContactPhase::hit && event.first.body == under_ball &&
              event.second.callers == game.ball;
  }
  check::within(misused, 3, 3, "calls out of turn, refused");
  for (const BodyId body : bodies)
    check::within(manager.state(body).position.z(), 0.14, 0.16,
                  "m, height of a crate at rest on the caller's plane, one on each rung");
  check::within(double(manager.report().step), 240, 240, "steps");
  check::within(dBodyGetPosition(game.ball)[2], 0.24, 0.56,
                "m, height of the caller's ball, that fell on a crate at support");
  check::within(hits, 1, 4, "hits told of the two");
  misuse([&] { Manager().before_world_step(kFrame); });
  check::within(misused, 4, 4, "and in a world of the manager's own");
}

// A platform of the manager's own: .5 m in 2 s, with a crate on it; then it is taken away.
void moving_ground(LevelChoice level, const char* rung) {
  Manager manager(measured());
  manager.add_plane({0, 0, 1}, 0.0);
  const GroundId platform = manager.add_static_box({2, 2, 0.2}, {0, 0, 1}, Quat::Identity());
  const BodyId rider = manager.add_body({.shape = crate, .state = at(0, 1.26), .level = level});
  for (int i = 0; i < 60; ++i) manager.step(kFrame);
  const double from = manager.state(rider).position.x();
  for (int i = 1; i <= 120; ++i) {
    RigidState state = at(0.25 * kFrame * (i - 1), 1);
    state.velocity = {0.25, 0, 0};
    manager.move_ground(platform, state);
    manager.step(kFrame);
  }
  manager.move_ground(platform, at(0.5, 1));
  for (int i = 0; i < 30; ++i) manager.step(kFrame);
  check::within(manager.state(rider).position.x() - from, 0.47, 0.53,
                (std::string("m that a crate rode on a platform which moved .5 m, at ") + rung).c_str());
  check::within(manager.state(rider).position.z(), 1.24, 1.27, "m, its height");
  for (int i = 0; i < 120; ++i) manager.step(kFrame);
  check::that(manager.asleep(rider), "it sleeps on the platform that stands");
  const auto hit = manager.cast_ray({.from = {0.5, 0.9, 5}});
  check::that(hit && hit->who.ground == platform && std::abs(hit->distance - 3.9) < 1e-9,
              "a ray meets the platform where it is, by its id");
  manager.remove_ground(platform);
  check::that(!manager.valid(platform), "a removed platform's id is not valid");
  for (int i = 0; i < 120; ++i) manager.step(kFrame);
  check::within(manager.state(rider).position.z(), 0.14, 0.17,
                "m, height of who lay on a platform that was taken away");
  int refused = 0;
  try {
    manager.remove_ground(platform);
  } catch (const InputError&) {
    ++refused;
  }
  check::within(refused, 1, 1, "stale ids of ground refused");
}

int main() {
  own_loop();
  moving_ground(LevelChoice::full, "the full level");
  moving_ground(LevelChoice::support, "support");
  moving_ground(LevelChoice::tables, "tables");
  return check::result();
}
