// A game's own space, of any type, one within another, whose geoms come, go and move between steps.
#include <ode/ode.h>

#include <cmath>
#include <ctime>
#include <memory>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

constexpr double kStep = 1.0 / 60.0;
const char* const kTypes[] = {"simple", "hash", "sweep and prune", "quadtree"};

dSpaceID make_space(int type, dSpaceID in = nullptr) {
  const dVector3 center = {0, 0, 0}, half = {120, 120, 120};
  return type == 0   ? dSimpleSpaceCreate(in)
         : type == 1 ? dHashSpaceCreate(in)
         : type == 2 ? dSweepAndPruneSpaceCreate(in, dSAP_AXES_XYZ)
                     : dQuadTreeSpaceCreate(in, center, half, 6);
}

dGeomID add_box(dSpaceID space, const Vec3& sides, const Vec3& position) {
  const dGeomID box = dCreateBox(space, sides.x(), sides.y(), sides.z());
  dGeomSetPosition(box, position.x(), position.y(), position.z());
  return box;
}

BodyId add_crate(Manager& manager, const Vec3& position) {
  static const auto crate = std::make_shared<const Shape>(make_shape("crate", make_box({0.3, 0.3, 0.3})));
  RigidState state;
  state.position = position;
  return manager.add_body({.shape = crate, .state = state, .level = LevelChoice::full});
}

void steps(Manager& manager, int count) {
  for (int i = 0; i < count; ++i) manager.step(kStep);
}

void rests_everywhere(int type) {
  const dWorldID world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.81);
  const dSpaceID space = make_space(type);
  std::vector<dGeomID> pads;
  std::vector<BodyId> crates;
  {
    Manager manager(world, space, {.signature_timing = SignatureTiming::in_step});
    for (int inner = 0; inner < 4;
         ++inner) {  // pads in the space itself and in two of each type within it, the second without cleanup
      const dSpaceID within = make_space(inner, space), deeper = make_space(3 - inner, within);
      dSpaceSetCleanup(deeper, 0);
      for (const dSpaceID in : {space, within, deeper})
        pads.push_back(add_box(in, {1, 1, 1}, {2.0 * double(pads.size()), 0, -0.5}));
    }
    for (std::size_t i = 0; i < pads.size(); ++i)
      crates.push_back(add_crate(manager, {2.0 * double(i), 0.1, 0.3}));
    steps(manager, 120);
    double highest = -1e9, lowest = 1e9;
    int asleep = 0;
    for (const BodyId body : crates) {
      highest = std::max(highest, manager.state(body).position.z()),
      lowest = std::min(lowest, manager.state(body).position.z());
      asleep += manager.asleep(body);
    }
    check::within(lowest, 0.149, highest, "m, the lowest crate on a pad");
    check::within(highest, lowest, 0.151, "m, the highest");
    check::within(asleep, 12, 12, "crates asleep of 12");
    dGeomDestroy(pads[0]);
    dGeomSetPosition(pads[1], 2, 0, -1.0);
    steps(manager, 60);
    check::within(manager.state(crates[0]).position.z(), -1e9, -1.0, "m, a crate whose pad went");
    check::within(manager.state(crates[1]).position.z(), -0.36, -0.34,
                  "m, a crate whose pad sank by half a metre");
    check::that(manager.asleep(crates[2]), "its neighbour sleeps on");
  }
  for (std::size_t i = 1; i < pads.size(); ++i) dGeomDestroy(pads[i]);
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

double cpu_ms() { return 1e3 * double(std::clock()) / CLOCKS_PER_SEC; }

struct Plain {
  dWorldID world;
  dJointGroupID contacts;
};

void meet_plainly(void* data, dGeomID a, dGeomID b) {
  const auto& [world, contacts] = *static_cast<Plain*>(data);
  const dBodyID first = dGeomGetBody(a), second = dGeomGetBody(b);
  if (!(first && dBodyIsEnabled(first)) && !(second && dBodyIsEnabled(second))) return;
  dContact found[8] = {};
  const int count = dCollide(a, b, 8, &found[0].geom, sizeof(dContact));
  for (int k = 0; k < count; ++k) {
    found[k].surface.mode = dContactApprox1;
    found[k].surface.mu = 0.5;
    dJointAttach(dJointCreateContact(world, contacts, &found[k]), first, second);
  }
}

// 100 crates on a floor of 10,000 boxes. Timings are printed, not judged: `lodestone bench attached` is for
// that.
void time_a_level(int type, bool managed) {
  const dWorldID world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.81);
  dWorldSetAutoDisableFlag(world, 1);
  const dSpaceID space = make_space(type);
  Plain plain{world, dJointGroupCreate(0)};
  for (int i = 0; i < 10000; ++i) add_box(space, {1, 1, 1}, {i % 100 - 50.0, i / 100 - 50.0, -0.5});
  {
    Manager manager(world, space, {.signature_timing = SignatureTiming::in_step});
    for (int i = 0; i < 100; ++i) {
      const Vec3 place(3.0 * (i % 10) - 15.2, 3.0 * (i / 10) - 15.3, 0.4);
      if (managed) {
        add_crate(manager, place);
      } else {
        const dBodyID body = dBodyCreate(world);
        dMass mass;
        dMassSetBoxTotal(&mass, 27, 0.3, 0.3, 0.3);
        dBodySetMass(body, &mass);
        dBodySetPosition(body, place.x(), place.y(), place.z());
        dGeomSetBody(dCreateBox(space, 0.3, 0.3, 0.3), body);
      }
    }
    const auto step = [&] {
      if (managed) return void(manager.step(kStep));
      dSpaceCollide(space, &plain, meet_plainly);
      dWorldStep(world, kStep);
      dJointGroupEmpty(plain.contacts);
    };
    double ms[2];
    for (double& phase : ms) {
      const double before = cpu_ms();
      for (int i = 0; i < 20; ++i) step();
      phase = (cpu_ms() - before) / 20;
      if (&phase == ms)
        for (int i = 0; i < 60; ++i) step();
    }
    std::printf("     %s, %s: %.2f ms a step falling, %.2f ms asleep\n", kTypes[type],
                managed ? "full bodies of the manager's, 4 substeps" : "plain ODE, 1 step", ms[0], ms[1]);
  }
  dJointGroupDestroy(plain.contacts);
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

}  // namespace

int main() {
  dInitODE2(0);
  for (int type = 0; type < 4; ++type) {
    std::printf("%s space\n", kTypes[type]);
    rests_everywhere(type);
  }
  for (const bool managed : {false, true}) time_a_level(1, managed);
  return check::result();
}
