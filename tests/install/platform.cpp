// A moving platform of the game's own carries what lies on it, as plain ODE does.
#include <memory>

#include "callers_world.h"
#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

constexpr double kStep = 1.0 / 60.0, kSpeed = 0.5;

struct Game : CallersWorld {
  Game() {
    dMass mass;
    dMassSetBoxTotal(&mass, 100.0, 4, 4, 0.2);
    dBodySetMass(platform, &mass);
    dBodySetPosition(platform, 0, 0, -0.1);
    dGeomSetBody(dCreateBox(space, 4, 4, 0.2), platform);
    dBodySetKinematic(platform);
  }
  dBodyID platform = dBodyCreate(world);
};

// In a second at .5 m/s, of a crate that slept.
double carried_by_manager(LevelChoice level) {
  Game game;
  Manager manager(game.world, game.space, {.signature_timing = SignatureTiming::in_step});
  manager.materials().replace(0, {.restitution = 0.0, .friction = 0.5});
  const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.4, 0.4, 0.4})));
  RigidState state;
  state.position = Vec3(0, 0, 0.2);
  const BodyId body = manager.add_body({.shape = crate, .state = state, .level = level});
  for (int i = 0; i < 90; ++i) manager.step(kStep);
  const double from = manager.state(body).position.x();
  dBodySetLinearVel(game.platform, kSpeed, 0, 0);
  for (int i = 0; i < 60; ++i) manager.step(kStep);
  return manager.state(body).position.x() - from;
}

// The same with nothing but ODE.
double carried_by_plain_ode() {
  Game game;
  const dBodyID crate = dBodyCreate(game.world);
  dMass mass;
  dMassSetBoxTotal(&mass, 64.0, 0.4, 0.4, 0.4);
  dBodySetMass(crate, &mass);
  dBodySetPosition(crate, 0, 0, 0.2);
  dGeomSetBody(dCreateBox(game.space, 0.4, 0.4, 0.4), crate);
  double from = 0.0;
  for (int i = 0; i < 150; ++i) {
    if (i == 90) from = dBodyGetPosition(crate)[0], dBodySetLinearVel(game.platform, kSpeed, 0, 0);
    dSpaceCollide(game.space, &game, [](void* data, dGeomID a, dGeomID b) {
      const Game& g = *static_cast<Game*>(data);
      dContact found[8] = {};
      const int count = dCollide(a, b, 8, &found[0].geom, sizeof(dContact));
      for (int k = 0; k < count; ++k) {
        found[k].surface.mode = dContactApprox1;
        found[k].surface.mu = 0.5;
        dJointAttach(dJointCreateContact(g.world, g.contacts, &found[k]), dGeomGetBody(a), dGeomGetBody(b));
      }
    });
    dWorldStep(game.world, kStep);
    dJointGroupEmpty(game.contacts);
  }
  return dBodyGetPosition(crate)[0] - from;
}

}  // namespace

int main() {
  const double plain = carried_by_plain_ode();
  std::printf("plain ODE carries a crate %.4f m of .5 m\n", plain);
  check::within(carried_by_manager(LevelChoice::full), plain - 0.02, 0.5 + 1e-3,
                "m that a full crate that slept is carried, of .5 m");
  return check::result();
}
