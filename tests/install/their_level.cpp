// A game's own level under a manager: boxes, meshes, height fields, convexes, capsules, planes and dynamic
// bodies of the caller's, met by bodies on every rung.
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "callers_world.h"
#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

constexpr double kStep = 1.0 / 60.0;

using Level = CallersWorld;

std::shared_ptr<const Shape> crate() {
  static const auto shape = std::make_shared<const Shape>(make_shape("crate", make_box({0.3, 0.3, 0.3})));
  return shape;
}

ManagerSettings settings() {
  ManagerSettings s;
  s.policy.policy = DistancePolicy{.full_within = 1.0};
  s.signature_timing = SignatureTiming::in_step;
  return s;
}

BodyId add(Manager& manager, const Vec3& position, LevelChoice level, const Vec3& velocity = Vec3::Zero()) {
  RigidState state;
  state.position = position;
  state.velocity = velocity;
  return manager.add_body({.shape = crate(), .state = state, .level = level});
}

constexpr std::array<LevelChoice, 3> kRungs{LevelChoice::tables, LevelChoice::support, LevelChoice::full};
constexpr std::array<const char*, 3> kNames{"tables", "support", "full"};

double height_of(const Vec3& position) { return position.z(); }

/// Drops a crate on each rung onto what `build` makes and tells where it comes to rest: at what `height` of
/// it.
void drop_onto(const char* what, const std::function<void(Level&)>& build, double least, double most,
               const Vec3& from = Vec3(0, 0, 2), double (*height)(const Vec3&) = height_of) {
  for (std::size_t i = 0; i < kRungs.size(); ++i) {
    Level level;
    build(level);
    Manager manager(level.world, level.space, settings());
    const BodyId body = add(manager, from, kRungs[i]);
    for (int step = 0; step < 240; ++step) manager.step(kStep);
    char text[160];
    std::snprintf(text, sizeof text, "%s: a crate at rung %s lies at height (m)", what, kNames[i]);
    check::within(height(manager.state(body).position), least, most, text);
  }
}

void static_geoms() {
  drop_onto(
      "a static box", [](Level& l) { dGeomSetPosition(dCreateBox(l.space, 4, 4, 1), 0, 0, 0.5); }, 1.14,
      1.16);
  drop_onto(
      "a tilted stack of boxes",
      [](Level& l) {
        for (int i = 0; i < 3; ++i) dGeomSetPosition(dCreateBox(l.space, 4, 4, 0.2), 0, 0, 0.1 + 0.2 * i);
      },
      0.74, 0.76);
  drop_onto(
      "a great sphere", [](Level& l) { dGeomSetPosition(dCreateSphere(l.space, 20), 0, 0, -20); }, 0.14, 0.16,
      Vec3(0, 0, 2), [](const Vec3& position) { return (position - Vec3(0, 0, -20)).norm() - 20.0; });
  drop_onto(
      "a lying capsule in a trough",
      [](Level& l) {
        for (const double y : {-0.26, 0.26}) {
          const dGeomID geom = dCreateCapsule(l.space, 0.25, 4);
          const dQuaternion turned = {std::sqrt(0.5), 0, std::sqrt(0.5), 0};
          dGeomSetQuaternion(geom, turned);
          dGeomSetPosition(geom, 0, y, 0.25);
        }
      },
      0.3, 0.7);
  drop_onto(
      "a cylinder on end", [](Level& l) { dGeomSetPosition(dCreateCylinder(l.space, 1.5, 1), 0, 0, 0.5); },
      1.14, 1.16);
  drop_onto(
      "a convex",
      [](Level& l) {
        static const dReal planes[] = {1, 0,  0, 2, -1, 0, 0, 2,   0, 1, 0,  2,
                                       0, -1, 0, 2, 0,  0, 1, 0.5, 0, 0, -1, 0.5};
        static const dReal points[] = {-2, -2, -0.5, 2, -2, -0.5, 2, 2, -0.5, -2, 2, -0.5,
                                       -2, -2, 0.5,  2, -2, 0.5,  2, 2, 0.5,  -2, 2, 0.5};
        static const unsigned polygons[] = {4, 1, 2, 6, 5, 4, 0, 4, 7, 3, 4, 2, 3, 7, 6,
                                            4, 0, 1, 5, 4, 4, 4, 5, 6, 7, 4, 0, 3, 2, 1};
        dGeomSetPosition(dCreateConvex(l.space, planes, 6, points, 8, polygons), 0, 0, 0.5);
      },
      1.13, 1.17);
  drop_onto(
      "a plane", [](Level& l) { dCreatePlane(l.space, 0, 0, 1, 0.25); }, 0.39, 0.41);
  drop_onto(
      "a triangle mesh",
      [](Level& l) {
        static const float vertices[] = {-3, -3, 1, 3, -3, 1, 3, 3, 1, -3, 3, 1};
        static const dTriIndex faces[] = {0, 1, 2, 0, 2, 3};
        const dTriMeshDataID data = dGeomTriMeshDataCreate();
        dGeomTriMeshDataBuildSingle(data, vertices, 3 * sizeof(float), 4, faces, 6, 3 * sizeof(dTriIndex));
        dCreateTriMesh(l.space, data, nullptr, nullptr, nullptr);
      },
      1.13, 1.17);
  drop_onto(
      "a height field",
      [](Level& l) {
        static std::array<float, 33 * 33> heights;
        for (int z = 0; z < 33; ++z)
          for (int x = 0; x < 33; ++x)
            heights[std::size_t(33 * z + x)] = 0.02f * float(std::abs(x - 16));  // a valley along x = 0
        const dHeightfieldDataID data = dGeomHeightfieldDataCreate();
        dGeomHeightfieldDataBuildSingle(data, heights.data(), 0, 16, 16, 33, 33, 1, 0, 1, 0);
        const dGeomID geom = dCreateHeightfield(l.space, data, 1);
        const dQuaternion upright = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // its y axis up
        dGeomSetQuaternion(geom, upright);
      },
      0.1, 0.3);
}

// A body asleep on a static box: the box goes, and it falls, on every rung; the box comes back under it
// before it can.
void streaming() {
  for (std::size_t i = 0; i < kRungs.size(); ++i) {
    Level level;
    dCreatePlane(level.space, 0, 0, 1, 0);
    const dGeomID box = dCreateBox(level.space, 2, 2, 1);
    dGeomSetPosition(box, 0, 0, 0.5);
    Manager manager(level.world, level.space, settings());
    const BodyId body = add(manager, {0, 0, 1.3}, kRungs[i]);
    for (int step = 0; step < 300; ++step) manager.step(kStep);
    char text[160];
    std::snprintf(text, sizeof text, "asleep on a box at rung %s", kNames[i]);
    check::that(manager.asleep(body), text);
    dGeomDestroy(box);
    for (int step = 0; step < 180; ++step) manager.step(kStep);
    std::snprintf(text, sizeof text, "the box gone, at rung %s it lies on the plane, height (m)", kNames[i]);
    check::within(manager.state(body).position.z(), 0.13, 0.17, text);
  }
}

// A platform of the caller's, moved by its velocity, carries a crate.
void platform() {
  for (std::size_t i = 0; i < kRungs.size(); ++i) {
    Level level;
    const dBodyID body = dBodyCreate(level.world);
    dBodySetKinematic(body);
    const dGeomID geom = dCreateBox(level.space, 3, 3, 0.5);
    dGeomSetBody(geom, body);
    dBodySetPosition(body, 0, 0, 0.25);
    Manager manager(level.world, level.space, settings());
    const BodyId crate = add(manager, {0, 0, 0.66}, kRungs[i]);
    for (int step = 0; step < 120; ++step) manager.step(kStep);
    const double from = manager.state(crate).position.x();
    dBodySetLinearVel(body, 0.25, 0, 0);
    for (int step = 0; step < 120; ++step) manager.step(kStep);
    char text[160];
    std::snprintf(text, sizeof text, "a platform that moves .5 m carries a crate at rung %s (m)", kNames[i]);
    check::within(manager.state(crate).position.x() - from, 0.45, 0.52, text);
  }
}

// A dynamic body of the caller's is struck and strikes back, and is never passed through.
void dynamic_body() {
  for (std::size_t i = 0; i < kRungs.size(); ++i) {
    Level level;
    dWorldSetGravity(level.world, 0, 0, 0);
    const dBodyID body = dBodyCreate(level.world);
    dMass mass;
    dMassSetBoxTotal(&mass, 27, 0.3, 0.3, 0.3);
    dBodySetMass(body, &mass);
    dGeomSetBody(dCreateBox(level.space, 0.3, 0.3, 0.3), body);
    ManagerSettings s = settings();
    Manager manager(level.world, level.space, s);
    const BodyId crate = add(manager, {-1, 0, 0}, kRungs[i], {3, 0, 0});
    for (int step = 0; step < 60; ++step) manager.step(kStep);
    const double theirs = dBodyGetLinearVel(body)[0], ours = manager.state(crate).velocity.x();
    char text[160];
    std::snprintf(text, sizeof text,
                  "a crate at rung %s strikes a body of the caller's of the same mass: it moves on at (m/s)",
                  kNames[i]);
    check::within(theirs, 1.6, 3.0, text);
    std::snprintf(text, sizeof text, "rung %s: momentum lost (of 81 kg m/s)", kNames[i]);
    check::within(std::abs(27.0 * (theirs + ours) - 81.0), 0.0, 1e-9, text);
  }
}

// The camera leaves a crate on a roof, and comes back: it lies where it lay.
void camera_leaves() {
  Level level;
  dCreatePlane(level.space, 0, 0, 1, 0);
  dGeomSetPosition(dCreateBox(level.space, 3, 3, 2), 0, 0, 1);
  ManagerSettings s = settings();
  s.policy = {.policy = DistancePolicy{.full_within = 5.0, .support_within = 10.0}, .min_dwell_frames = 2};
  Manager manager(level.world, level.space, s);
  const BodyId body = add(manager, {0.5, 0.2, 2.3}, LevelChoice::automatic);
  double lowest = 10.0;
  bool was_full = false, was_support = false, was_tables = false;
  for (int step = 0; step < 600; ++step) {
    const Vec3 camera(20.0 * std::sin(step * 2.0 * 3.14159265 / 300.0), 0, 3);
    manager.set_viewpoints({&camera, 1});
    manager.step(kStep);
    lowest = std::min(lowest, manager.state(body).position.z());
    was_full |= manager.rung(body) == Rung::full, was_support |= manager.rung(body) == Rung::support,
        was_tables |= manager.rung(body) == Rung::tables;
  }
  check::that(was_full && was_support && was_tables,
              "while the camera flies, the crate on the roof is on every rung");
  check::within(lowest, 2.12, 2.2, "its lowest height meanwhile (m)");
}

}  // namespace

int main() {
  static_geoms();
  streaming();
  platform();
  dynamic_body();
  camera_leaves();
  return check::result();
}
