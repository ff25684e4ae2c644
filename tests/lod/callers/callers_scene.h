// A caller's world and space, mirrored.
#pragma once

#include <ode/ode.h>

#include <optional>

#include "reference/ode/space_mirror.h"

namespace lodestone::testing {

struct CallersScene {
  CallersScene() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world = dWorldCreate();
    space = dHashSpaceCreate(nullptr);
    mirror.emplace(space);
  }
  ~CallersScene() {
    mirror.reset();
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  CallersScene(const CallersScene&) = delete;
  CallersScene& operator=(const CallersScene&) = delete;

  dGeomID box(const Vec3& sides, const Vec3& place) {
    const dGeomID geom = dCreateBox(space, sides.x(), sides.y(), sides.z());
    dGeomSetPosition(geom, place.x(), place.y(), place.z());
    return geom;
  }
  /// A cube of .4 m and that mass.
  dBodyID body(double mass, const Vec3& place) {
    const dBodyID made = dBodyCreate(world);
    dMass parameters;
    dMassSetBoxTotal(&parameters, mass, 0.4, 0.4, 0.4);
    dBodySetMass(made, &parameters);
    dBodySetPosition(made, place.x(), place.y(), place.z());
    dGeomSetBody(box({0.4, 0.4, 0.4}, {0, 0, 0}), made);
    return made;
  }

  dWorldID world;
  dSpaceID space;
  std::optional<SpaceMirror> mirror;
};

}  // namespace lodestone::testing
