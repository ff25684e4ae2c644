// A game that keeps its own loop: its dSpaceCollide, its contacts and its dWorldStep, with a call to the
// manager before and one after.
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

constexpr double kStep = 1.0 / 60.0;

// What the game has: a floor, a ramp, a ball that rolls down it, and the contacts that it makes of its own.
struct Game {
  Game() {
    dWorldSetGravity(world, 0, 0, -9.81);
    dCreatePlane(space, 0, 0, 1, 0);
    const dGeomID ramp = dCreateBox(space, 4, 2, 0.2);
    const dQuaternion tilted = {std::cos(0.15), 0, std::sin(0.15), 0};
    dGeomSetQuaternion(ramp, tilted);
    dGeomSetPosition(ramp, -4, 0, 0.5);
    dMass mass;
    dMassSetSphereTotal(&mass, 30.0, 0.25);
    dBodySetMass(ball, &mass);
    dBodySetPosition(ball, -5, 0, 1.2);
    dGeomSetBody(dCreateSphere(space, 0.25), ball);
  }
  ~Game() {
    dJointGroupDestroy(contacts);
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }

  void collide() {
    met = 0;
    dSpaceCollide(space, this,
                  [](void* game, dGeomID a, dGeomID b) { static_cast<Game*>(game)->meet(a, b); });
  }
  void meet(dGeomID a, dGeomID b) {
    if (!dGeomGetBody(a) && !dGeomGetBody(b)) return;
    dContact found[4] = {};
    const int count = dCollide(a, b, 4, &found[0].geom, sizeof(dContact));
    met += count;
    for (int i = 0; i < count; ++i) {
      found[i].surface.mode = dContactApprox1;
      found[i].surface.mu = 0.8;
      dJointAttach(dJointCreateContact(world, contacts, &found[i]), dGeomGetBody(a), dGeomGetBody(b));
    }
  }

  dWorldID world = dWorldCreate();
  dSpaceID space = dQuadTreeSpaceCreate(nullptr, kCenter, kHalf, 4);
  dJointGroupID contacts = dJointGroupCreate(0);
  dBodyID ball = dBodyCreate(world);
  int met = 0;
  static constexpr dVector3 kCenter = {0, 0, 0}, kHalf = {50, 50, 50};
};

struct Outcome {
  std::vector<std::vector<double>> frames;  // m: x and z of each crate, x of the ball
  std::int64_t steps = 0;
  int joints_left = 0;
  std::size_t solved = 0;  // frames before the first that ODE's solver gave up on, which step() does again
};

// Four crates at the foot of the ramp, on every rung, and the ball that comes.
Outcome play(LevelChoice level, bool own_loop) {
  Game game;
  Manager manager(game.world, game.space, {.full_substeps = 1, .signature_timing = SignatureTiming::in_step});
  const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.3, 0.3, 0.3})));
  std::vector<BodyId> bodies;
  for (int i = 0; i < 4; ++i) {
    RigidState state;
    state.position = Vec3(-0.5 + 0.6 * i, 0.1 * i, 0.16);
    bodies.push_back(manager.add_body({.shape = crate, .state = state, .mass = 10.0, .level = level}));
  }
  Outcome outcome;
  for (int frame = 0; frame < 240; ++frame) {
    game.collide();
    if (own_loop) {
      manager.before_world_step(kStep);
      dWorldStep(game.world, kStep);
      manager.after_world_step();
    } else {
      manager.step(kStep);
    }
    dJointGroupEmpty(game.contacts);
    outcome.joints_left += dBodyGetNumJoints(game.ball);
    if (manager.report().counters.ode_messages == 0) ++outcome.solved;
    std::vector<double>& places = outcome.frames.emplace_back();
    for (const BodyId body : bodies)
      for (const int axis : {0, 2}) places.push_back(manager.state(body).position[axis]);
    places.push_back(dBodyGetPosition(game.ball)[0]);
  }
  outcome.steps = manager.report().step;
  return outcome;
}

}  // namespace

int main() {
  dInitODE2(0);
  constexpr std::array<LevelChoice, 3> kRungs{LevelChoice::tables, LevelChoice::support, LevelChoice::full};
  constexpr std::array<const char*, 3> kNames{"tables", "support", "full"};
  for (std::size_t i = 0; i < kRungs.size(); ++i) {
    std::printf("%s\n", kNames[i]);
    const Outcome own = play(kRungs[i], true), step = play(kRungs[i], false);
    check::within(double(own.steps), 240, 240, "steps of the manager's");
    check::within(own.joints_left, 0, 0, "contact joints of the manager's left on the game's ball");
    const std::vector<double>& end = own.frames.back();
    check::within(end[0], -0.4, 100, "m, where the first crate is that the ball hit, from -.5");
    check::within(std::min({end[1], end[3], end[5], end[7]}), 0.05, 0.5, "m, the lowest crate");
    check::within(double(step.solved), 200, 240, "frames that ODE's solver solves all of");
    check::that(
        std::equal(own.frames.begin(), own.frames.begin() + std::ptrdiff_t(step.solved), step.frames.begin()),
        "to the bit what step() gives with one substep in these");
  }
  return check::result();
}
