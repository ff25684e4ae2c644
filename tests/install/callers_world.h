// A world and space of the caller's, with gravity and nothing else.
#pragma once

#include <ode/ode.h>

struct CallersWorld {
  CallersWorld() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    dWorldSetGravity(world, 0, 0, -9.81);
  }
  ~CallersWorld() {
    dJointGroupDestroy(contacts);
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }
  CallersWorld(const CallersWorld&) = delete;
  CallersWorld& operator=(const CallersWorld&) = delete;

  dWorldID world = dWorldCreate();
  dSpaceID space = dHashSpaceCreate(nullptr);
  dJointGroupID contacts = dJointGroupCreate(0);
};
