// Forces and motors of a game's own bodies, and on ours through ode_body, act for the whole of a step,
// however many substeps it has.
#include <ode/ode.h>

#include <cmath>
#include <memory>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

constexpr double kStep = 1.0 / 60.0;

dBodyID make_ball(dWorldID world, dSpaceID space, double mass, double x) {
  const dBodyID body = dBodyCreate(world);
  dMass parameters;
  dMassSetSphereTotal(&parameters, mass, 0.2);
  dBodySetMass(body, &parameters);
  dBodySetPosition(body, x, 0, 5);
  dGeomSetBody(dCreateSphere(space, 0.2), body);
  return body;
}

// A push, a motor and a push on one of ours, for half a second.
struct Speeds {
  double pushed = 0.0, turned = 0.0, ours = 0.0, named = 0.0;
};

Speeds push_for_half_a_second(int substeps) {
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(nullptr);
  dWorldSetGravity(world, 0, 0, 0);
  const dBodyID ball = make_ball(world, space, 2.0, 0), wheel = make_ball(world, space, 2.0, 5);
  const dBodyID ghost = make_ball(world, nullptr, 2.0, 20);  // its geom is in no space
  const dGeomID ghosts = dBodyGetFirstGeom(ghost);
  const dJointID hinge = dJointCreateHinge(world, nullptr);
  dJointAttach(hinge, wheel, nullptr);
  dJointSetHingeAnchor(hinge, 5, 0, 5), dJointSetHingeAxis(hinge, 0, 0, 1);
  Speeds speeds;
  {
    Manager manager(world, space, {.full_substeps = substeps, .signature_timing = SignatureTiming::in_step});
    const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.3, 0.3, 0.3})));
    RigidState state;
    state.position = Vec3(10, 0, 5);
    const BodyId body =
        manager.add_body({.shape = crate, .state = state, .mass = 27.0, .level = LevelChoice::full});
    manager.include_body(ghost);
    for (int frame = 0; frame < 30; ++frame) {
      dBodyAddForce(ghost, 4, 0, 0);
      dBodyAddForce(ball, 4, 0, 0);
      dJointAddHingeTorque(hinge, 0.032);  // inertia .032 kg m²: 1 rad/s²
      dBodyAddForce(manager.ode_body(body), 27, 0, 0);
      manager.step(kStep);
    }
    speeds = {dBodyGetLinearVel(ball)[0], std::abs(dBodyGetAngularVel(wheel)[2]),
              manager.state(body).velocity.x(), dBodyGetLinearVel(ghost)[0]};
    manager.exclude_body(ghost);
  }
  dGeomDestroy(ghosts);
  dSpaceDestroy(space);
  dWorldDestroy(world);
  return speeds;
}

}  // namespace

int main() {
  dInitODE2(0);
  for (const int substeps : {1, 4, 8}) {
    const auto [pushed, turned, ours, named] = push_for_half_a_second(substeps);
    std::printf("%d substeps\n", substeps);
    check::within(pushed, 1.0 - 1e-9, 1.0 + 1e-9,
                  "m/s of a body of the game's own after half a second of 2 N/kg");
    check::within(named, 1.0 - 1e-9, 1.0 + 1e-9,
                  "m/s of one of whose geom his space knows nothing, and which was named");
    check::within(turned, 0.5 - 1e-6, 0.5 + 1e-6,
                  "rad/s of a wheel after half a second of a motor of 1 rad/s²");
    check::within(ours, 0.5 - 1e-9, 0.5 + 1e-9,
                  "m/s of a full body after half a second of 1 N/kg through ode_body");
  }
  return check::result();
}
