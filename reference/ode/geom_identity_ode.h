// What tells a caller's geom from another one at the same address, and whether it has moved since it was
// looked at last.
#pragma once

#include <array>
#include <cstdint>

#include "reference/ode/runtime_ode.h"

namespace lodestone::ode {

/// What tells one geom from another, in ODE's own numbers.
struct GeomIdentity {
  dGeomID geom = nullptr;
  dBodyID body = nullptr;
  int geom_class = 0;
  bool dynamic = false;
  unsigned category = 0, collide = 0;
  std::array<dReal, 4> sizes{};   // m; of a plane, its parameters
  std::array<dReal, 7> offset{};  // of a dynamic body's: m, and a quaternion
  const void* data = nullptr;     // of a trimesh or height field
  std::uint64_t content = 0;      // of a trimesh: see content_of
  friend bool operator==(const GeomIdentity&, const GeomIdentity&) = default;
};

/// Where it is, in ODE's own numbers.
struct GeomPose {
  std::array<dReal, 3> position{};  // m
  std::array<dReal, 6> bounds{};    // m
  std::array<dReal, 12> rotation{};
  friend bool operator==(const GeomPose&, const GeomPose&) = default;
};

/// Whether the caller gave it a number that is none (NaN, infinite). Such a geom is left alone.
bool is_spoilt(dGeomID geom, int geom_class, bool placeable);

/// `category` and `collide`: its bits, less those that the spaces around it lack. `content`: see
/// GeomIdentity.
GeomIdentity geom_identity_of(dGeomID geom, int geom_class, unsigned category, unsigned collide,
                              std::uint64_t content);

GeomPose geom_pose_of(dGeomID geom, bool placeable);

/// Whether it has another form: it is where it was, but its bounds are others.
bool is_reshaped(const GeomPose& before, const GeomPose& now);

/// A fingerprint of identity and pose: when it is the same, nothing changed. Cheaper than both.
std::uint64_t fingerprint_of(dGeomID geom, int geom_class, bool placeable, unsigned category,
                             unsigned collide, std::uint64_t content);

/// Of a trimesh: a fingerprint of how many triangles it has and of four of them, in their own axes. `probe`:
/// a trimesh geom at the origin, whose data are replaced.
std::uint64_t content_of(dGeomID mesh, dGeomID probe);

}  // namespace lodestone::ode
