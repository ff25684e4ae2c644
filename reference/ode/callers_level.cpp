#include "reference/ode/callers_level.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/ode/bodies_ode.h"

namespace lodestone {

using namespace ode;

namespace {

constexpr int kMostContacts = 8;

bool is_awake(dBodyID body) { return body && dBodyIsEnabled(body); }

dSpaceID make_space(CallersSpace kind, double half) {
  const dVector3 center = {0, 0, 0}, halves = {half, half, half};
  switch (kind) {
    case CallersSpace::simple:
      return dSimpleSpaceCreate(nullptr);
    case CallersSpace::hash:
      return dHashSpaceCreate(nullptr);
    case CallersSpace::sweep_and_prune:
      return dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
    case CallersSpace::quadtree:
      return dQuadTreeSpaceCreate(nullptr, center, halves, 6);
  }
  return nullptr;
}

}  // namespace

struct CallersLevel::Impl {
  dWorldID world = dWorldCreate();
  dSpaceID space = nullptr;
  dJointGroupID contacts = dJointGroupCreate(0);
  dContact contact{};
  std::vector<dBodyID> crates;

  void meet(dGeomID a, dGeomID b) {
    const dBodyID first = dGeomGetBody(a), second = dGeomGetBody(b);
    if (!is_awake(first) && !is_awake(second)) return;
    dContactGeom found[kMostContacts];
    const int count = dCollide(a, b, kMostContacts, found, sizeof(dContactGeom));
    for (int i = 0; i < count; ++i) {
      contact.geom = found[i];
      dJointAttach(dJointCreateContact(world, contacts, &contact), first, second);
    }
  }
};

CallersLevel::CallersLevel(const CallersLevelSettings& settings) {
  prepare();
  impl_ = std::make_unique<Impl>();
  const int side = int(std::ceil(std::sqrt(settings.boxes)));
  impl_->space = make_space(settings.space, side);
  dWorldSetGravity(impl_->world, 0, 0, -9.81);
  for (int i = 0; i < settings.boxes; ++i)
    dGeomSetPosition(dCreateBox(impl_->space, 1, 1, 1), i % side - 0.5 * side, i / side - 0.5 * side, -0.5);
  impl_->contact.surface.mode = dContactApprox1 | dContactBounce;
  impl_->contact.surface.mu = settings.friction;
  impl_->contact.surface.bounce = settings.restitution;
  impl_->contact.surface.bounce_vel = 0.05;
}

CallersLevel::~CallersLevel() {
  dJointGroupDestroy(impl_->contacts);
  dSpaceDestroy(impl_->space);
  dWorldDestroy(impl_->world);
}

void CallersLevel::add_crates(std::span<const RigidState> states, double side, double mass) {
  for (const RigidState& state : states) {
    const dBodyID body = dBodyCreate(impl_->world);
    dMass parameters;
    dMassSetBoxTotal(&parameters, mass, side, side, side);
    dBodySetMass(body, &parameters);
    dBodySetAutoDisableFlag(body, 1);
    dBodySetAutoDisableLinearThreshold(body, 0.05);
    dBodySetAutoDisableAngularThreshold(body, 0.1 / (side * std::sqrt(3.0)));
    dBodySetAutoDisableTime(body, 0.5);
    dBodySetAutoDisableSteps(body, 0);
    dGeomSetBody(dCreateBox(impl_->space, side, side, side), body);
    ode::set_state(body, state);
    impl_->crates.push_back(body);
  }
}

void CallersLevel::step(double dt) {
  dSpaceCollide(impl_->space, impl_.get(),
                [](void* level, dGeomID a, dGeomID b) { static_cast<Impl*>(level)->meet(a, b); });
  dWorldStep(impl_->world, dt);
  dJointGroupEmpty(impl_->contacts);
}

int CallersLevel::awake() const { return int(std::ranges::count_if(impl_->crates, is_awake)); }
dxWorld* CallersLevel::world() const { return impl_->world; }
dxSpace* CallersLevel::space() const { return impl_->space; }

}  // namespace lodestone
