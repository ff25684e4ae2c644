// Bodies that belong together: joints of the caller's pin a body at the full level; a group changes rung
// together, and with joints leaves the full level only while it sleeps, to the bit.
#include <ode/ode.h>

#include <cmath>
#include <memory>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

const auto kCrate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.2, 0.4})));
constexpr double kFrame = 1.0 / 60.0;

struct World {
  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  World() {
    dWorldSetGravity(world, 0, 0, -9.81);
    dCreatePlane(space, 0, 0, 1, 0);
  }
  ~World() {
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
};

PolicySettings by_distance(double full_within = 5.0) {
  return {.policy = DistancePolicy{.full_within = full_within, .support_within = 20},
          .min_dwell_frames = 0,
          .max_transitions_per_frame = 4};
}
ManagerSettings settings(const PolicySettings& policy) {
  return {.policy = policy, .signature_timing = SignatureTiming::in_step};
}

void look_from(Manager& manager, double x) {
  const Vec3 camera(x, 0, 1);
  manager.set_viewpoints({&camera, 1});
}
void run(Manager& manager, int frames) {
  for (int i = 0; i < frames; ++i) manager.step(kFrame);
}

void joints_pin() {
  World w;
  Manager manager(w.world, w.space, settings(by_distance()));
  look_from(manager, 0);
  const BodyId lamp = manager.add_body({.shape = kCrate, .state = {.position = {0, 0, 3}}});
  run(manager, 1);
  check::that(manager.ode_body(lamp) != nullptr, "a body near the camera has an ODE body");
  const dJointID hinge = dJointCreateHinge(w.world, nullptr);
  dJointAttach(hinge, manager.ode_body(lamp), nullptr);
  dJointSetHingeAnchor(hinge, 0.5, 0, 3.0);
  dJointSetHingeAxis(hinge, 0, 1, 0);
  look_from(manager, 500);
  run(manager, 120);
  check::that(manager.rung(lamp) == Rung::full && manager.explain(lamp).rule == Rule::joined,
              "a jointed body stays full though the camera left, and why() says joined");
  manager.set_level(lamp, LevelChoice::tables);
  run(manager, 5);
  check::that(manager.rung(lamp) == Rung::full, "even where the caller asks for another rung");
  manager.set_level(lamp, LevelChoice::automatic);
  dJointDestroy(hinge);
  run(manager, 5);
  check::that(manager.rung(lamp) != Rung::full, "it goes down once the joint is gone");
}

void groups_change_together() {
  World w;
  Manager manager(w.world, w.space, settings(by_distance()));
  std::vector<BodyId> caravan;
  for (int i = 0; i < 8; ++i)
    caravan.push_back(manager.add_body({.shape = kCrate, .state = {.position = {1.0 * i, 0, 0.21}}}));
  const GroupId group = manager.make_group(caravan);
  int mixed = 0;
  const auto one_rung = [&] {
    for (const BodyId body : caravan)
      if (manager.rung(body) != manager.rung(caravan[0])) return false;
    return true;
  };
  for (int frame = 0; frame < 600; ++frame) {
    look_from(manager, 40 - 0.1 * frame);
    manager.step(kFrame);
    mixed += !one_rung();
  }
  check::within(
      mixed, 0, 0,
      "frames in which a group of 8 was on two rungs, the camera passing by, with 4 changes a frame");
  look_from(manager, 11);
  run(manager, 60);
  check::that(manager.rung(caravan[0]) == Rung::full,
              "the nearest of them decides for all (4 m away; the farthest is 11 m away)");
  check::that(manager.explain(caravan[3]).group == group, "explain() names the group");
  bool refused = false;
  try {
    manager.make_group({&caravan[0], 1});
  } catch (const std::exception&) {
    refused = true;
  }
  check::that(refused, "a body is in one group at most");
  manager.dissolve_group(group);
  run(manager, 30);
  check::that(manager.rung(caravan[0]) != Rung::full && manager.rung(caravan[7]) == Rung::full,
              "dissolved, each goes its way");
}

// A chain of four on ball joints, which the caller takes off and puts on again.
struct Chain {
  World& w;
  Manager& manager;
  std::vector<BodyId> links;
  std::vector<dJointID> joints;
  int off = 0, on = 0;

  double link_z(int i) const { return 0.21 + 0.41 * i; }
  void join() {
    for (std::size_t i = 0; i + 1 < links.size(); ++i) {
      const dJointID joint = dJointCreateBall(w.world, nullptr);
      const dBodyID a = manager.ode_body(links[i]), b = manager.ode_body(links[i + 1]);
      dJointAttach(joint, a, b);
      const dReal *x = dBodyGetPosition(a), *y = dBodyGetPosition(b);
      if (anchors.size() <= i) {
        dVector3 local;
        dBodyGetPosRelPoint(a, 0.5 * (x[0] + y[0]), 0.5 * (x[1] + y[1]), 0.5 * (x[2] + y[2]), local);
        anchors.push_back({local[0], local[1], local[2]});
        dBodyGetPosRelPoint(b, 0.5 * (x[0] + y[0]), 0.5 * (x[1] + y[1]), 0.5 * (x[2] + y[2]), local);
        others.push_back({local[0], local[1], local[2]});
      }
      dVector3 world;
      dBodyGetRelPointPos(a, anchors[i].x(), anchors[i].y(), anchors[i].z(), world);
      dJointSetBallAnchor(joint, world[0], world[1], world[2]);
      joints.push_back(joint);
    }
  }
  void part() {
    for (const dJointID joint : joints) dJointDestroy(joint);
    joints.clear();
  }
  /// m: how far apart the two sides of a joint are, at most.
  double gap() const {
    double widest = 0;
    for (std::size_t i = 0; i + 1 < links.size(); ++i) {
      const RigidState a = manager.state(links[i]), b = manager.state(links[i + 1]);
      const Vec3 of_a = a.position + a.orientation * anchors[i],
                 of_b = b.position + b.orientation * others[i];
      widest = std::max(widest, (of_a - of_b).norm());
    }
    return widest;
  }
  std::vector<Vec3> anchors, others;
};

void jointed_groups_sleep_and_wake_as_one() {
  World w;
  Manager manager(w.world, w.space, settings(by_distance()));
  look_from(manager, 0);
  Chain chain{w, manager, {}, {}, 0, 0, {}, {}};
  for (int i = 0; i < 4; ++i)
    chain.links.push_back(manager.add_body({.shape = kCrate, .state = {.position = {0.45 * i, 0, 0.6}}}));
  run(manager, 1);
  chain.join();
  manager.make_group(chain.links, {.before_demotion = [&](GroupId) { ++chain.off, chain.part(); },
                                   .after_promotion = [&](GroupId) { ++chain.on, chain.join(); }});
  look_from(manager, 500);
  run(manager, 5);
  check::that(chain.off == 0 && manager.rung(chain.links[0]) == Rung::full,
              "a joined group that is awake stays full, however far");
  int frames = 0;
  while (chain.off == 0 && frames < 3000) run(manager, 1), ++frames;
  check::within(frames, 10, 2000, "frames until the chain lay still and left the full level");
  bool all_down = true;
  for (const BodyId link : chain.links)
    all_down &= manager.rung(link) != Rung::full && manager.asleep(link) && !manager.ode_body(link);
  check::that(all_down, "as one, asleep");
  const double gap_before = chain.gap();
  run(manager, 200);

  // Something comes down on one of them.
  manager.add_body({.shape = kCrate, .state = {.position = {0.45, 0, 1.5}, .velocity = {0, 0, -3}}});
  double widest = 0;
  bool all_up = false;
  for (int i = 0; i < 120; ++i) {
    const int on = chain.on;
    run(manager, 1);
    widest = std::max(widest, chain.gap());
    if (chain.on == on) continue;
    all_up = true;
    for (const BodyId link : chain.links) all_up &= manager.rung(link) == Rung::full && !manager.asleep(link);
  }
  check::that(all_up && chain.on == 1,
              "a hit on one brings all back, at once, and the caller has joined them again");
  // Its second blow comes at 1.9 m/s on a link that is awake: in the step until ODE's joints answer that goes
  // on at half of it, 16 mm.
  check::within(widest, 0.0, 0.016, "m, widest gap of a joint through sleep, hit and after");
  check::within(gap_before, 0.0, 0.005, "m, gap while it slept");

  // The camera comes back to a sleeping chain: to the bit where it was.
  frames = 0;
  while (chain.off == 1 && frames < 3000) run(manager, 1), ++frames;
  std::vector<RigidState> before;
  for (const BodyId link : chain.links) before.push_back(manager.state(link));
  look_from(manager, 0);
  run(manager, 3);
  double moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    moved = std::max(moved, (manager.state(chain.links[i]).position - before[i].position).norm());
  check::that(chain.on == 2 && manager.rung(chain.links[0]) == Rung::full,
              "the camera's return brings a sleeping chain back");
  check::within(moved, 0.0, 0.0, "m that its links moved by that");
  check::that(manager.asleep(chain.links[0]), "and it sleeps on");
}

}  // namespace

int main() {
  dInitODE2(0);
  joints_pin();
  groups_change_together();
  jointed_groups_sleep_and_wake_as_one();
  return check::result();
}
