#include "reference/ode/callers_bodies.h"

#include "reference/ode/bodies_ode.h"

namespace lodestone::callers {

using namespace ode;

Vec3 gravity(dxWorld* world) {
  dVector3 gravity;
  dWorldGetGravity(world, gravity);
  return to_vec3(gravity);
}
dxBody* body_of(dxGeom* geom) { return dGeomGetBody(geom); }
void set_gravity(dxWorld* world, const Vec3& gravity) {
  dWorldSetGravity(world, gravity.x(), gravity.y(), gravity.z());
}
void step(dxWorld* world, double h) { dWorldStep(world, h); }

RigidState state(dxBody* body) { return state_of(body); }
Vec3 position(dxGeom* geom) { return to_vec3(dGeomGetPosition(geom)); }
Quat orientation(dxGeom* geom) {
  dQuaternion q;
  dGeomGetQuaternion(geom, q);
  return to_quat(q);
}

Vec3 offset_position(dxGeom* geom) { return to_vec3(dGeomGetOffsetPosition(geom)); }
Quat offset_orientation(dxGeom* geom) {
  dQuaternion q;
  dGeomGetOffsetQuaternion(geom, q);
  return to_quat(q);
}

double mass(dxBody* body) {
  dMass mass;
  dBodyGetMass(body, &mass);
  return mass.mass;
}

Mat3 inverse_inertia(dxBody* body) {
  dMass mass;
  dBodyGetMass(body, &mass);
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(mass.I).leftCols<3>().inverse();
}

Vec3 force(dxBody* body) { return to_vec3(dBodyGetForce(body)); }
Vec3 torque(dxBody* body) { return to_vec3(dBodyGetTorque(body)); }
bool is_enabled(dxBody* body) { return dBodyIsEnabled(body); }
bool is_kinematic(dxBody* body) { return dBodyIsKinematic(body); }
bool has_gravity(dxBody* body) { return dBodyGetGravityMode(body); }

void set_state(dxBody* body, const RigidState& state) { ode::set_state(body, state); }

void add_force(dxBody* body, const Vec3& force, const Vec3& torque) {
  dBodyAddForce(body, force.x(), force.y(), force.z());
  dBodyAddTorque(body, torque.x(), torque.y(), torque.z());
}

void set_enabled(dxBody* body, bool enabled) { enabled ? dBodyEnable(body) : dBodyDisable(body); }

}  // namespace lodestone::callers
