// The caller's own bodies, by their dBodyID, for those who may not include ODE.
#pragma once

#include "reference/geometry.h"

struct dxWorld;  // dWorldID is dxWorld*
struct dxBody;   // dBodyID is dxBody*
struct dxGeom;   // dGeomID is dxGeom*

namespace lodestone::callers {

Vec3 gravity(dxWorld* world);  ///< m/s²
void set_gravity(dxWorld* world, const Vec3& gravity);
void step(dxWorld* world, double h);  ///< dWorldStep, s

dxBody* body_of(dxGeom* geom);  ///< null: static
RigidState state(dxBody* body);
Vec3 position(dxGeom* geom);  ///< m, world; of one that is no plane
Quat orientation(dxGeom* geom);
Vec3 offset_position(dxGeom* geom);     ///< m, from its body's centre of mass, in the body's axes
Quat offset_orientation(dxGeom* geom);  ///< to the body's axes
double mass(dxBody* body);              ///< kg
Mat3 inverse_inertia(dxBody* body);     ///< 1/(kg m²), about the centre of mass, in the body's axes
Vec3 force(dxBody* body);               ///< N, gathered since its last step
Vec3 torque(dxBody* body);              ///< N m, world
bool is_enabled(dxBody* body);
bool is_kinematic(dxBody* body);
bool has_gravity(dxBody* body);

void set_state(dxBody* body, const RigidState& state);  ///< does not wake
/// N at the centre of mass and N m, world, over its next step.
void add_force(dxBody* body, const Vec3& force, const Vec3& torque);
void set_enabled(dxBody* body, bool enabled);

}  // namespace lodestone::callers
