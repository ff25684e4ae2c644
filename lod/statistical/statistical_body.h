// A body of the statistical level: the state that a step works on, and, apart from it, the description that
// all bodies of one kind (shape and material) share.
#pragma once

#include <cstdint>
#include <memory>

#include "reference/free_rotation.h"
#include "reference/hull/resting_faces.h"
#include "reference/material.h"
#include "reference/shape.h"
#include "signature/settling_clips.h"

namespace lodestone {

/// What all bodies of one shape and material share.
struct BodyKind {
  std::shared_ptr<const Shape> shape;
  std::shared_ptr<const Signature> signature;  ///< may be null (support model)
  /// Finds settling clips in the signature; null without a signature, or where no model plays clips.
  std::shared_ptr<const ClipIndex> clips;
  std::shared_ptr<const RestingFaces> faces;  ///< on which it can stand (tables model); none for a sphere
  MaterialId material = 0;
  bool isotropic = false;                  ///< equal moments of inertia (sphere, cube): rotates steadily
  bool round = false;                      ///< a sphere or nearly one: rolls down a slope (tables model)
  bool angular = false;                    ///< has long and sharp edges: does not roll over small facets
  Quat principal_axes = Quat::Identity();  ///< takes principal axes of inertia to body axes
  bool along_principal_axes = true;        ///< whether body axes are principal axes
  Vec3 inverse_moments = Vec3::Ones();     ///< of inertia over mass, 1/m², along principal axes; ascending
};

/// Computes what follows from the shape and its inertia.
BodyKind make_body_kind(std::shared_ptr<const Shape> shape,
                        std::shared_ptr<const Signature> signature = nullptr, MaterialId material = 0);

enum class Motion : std::uint8_t {
  dynamic,   ///< flies and collides
  settling,  ///< under the resting conditions of section 3.4, or in a settling clip
  asleep,
};

struct StatisticalBody {
  Vec3 position = Vec3::Zero();         ///< m, world frame, of the centre of mass
  Quat orientation = Quat::Identity();  ///< body axes to the world's
  Vec3 velocity = Vec3::Zero();         ///< m/s
  Vec3 spin = Vec3::Zero();    ///< angular momentum over mass, m²/s, world frame: what free flight conserves
  double mass = 1.0;           ///< kg
  float sphere_radius = 0.0f;  ///< m, of the colliding sphere at `tables`; 0 for a body of `support`
  float quiet_time = 0.0f;     ///< s, time spent below the sleeping threshold
  float speed = 0.0f;          ///< m/s, `support`: √(2 kinetic energy over mass) after the last step
  float rising_from = 0.0f;    ///< m/s, `support`: `speed` when it last began to rise without a break
  float rising_time = 0.0f;    ///< s, time since then
  std::int32_t support_hint = 0;  ///< hull vertex last found lowest, from which the next search climbs
  std::int32_t settling = -1;     ///< index of the settling record (clip or rest pose) while Motion::settling
  std::uint32_t owner = 0;        ///< the manager's index of the body
  std::uint32_t events = 0;       ///< number of collisions so far: keys the random draws
  std::uint32_t kind = 0;         ///< index of its BodyKind
  Motion motion = Motion::dynamic;
  bool crowded = false;         ///< touches another body in this step
  bool on_solid = false;        ///< touches solids of the ground in this step that are more than planes to it
  bool alone_on_solid = false;  ///< touches these and nothing that moves, so it is moved by itself
  bool in_great_heap = false;  ///< is in a great island (IslandKind::great); asleep: was, when last awake
  bool on_edge = false;        ///< slow and in a crowd, but not over an area of what it stands on (Footing)
  /// So deep in a body of many times its mass, or in one that much lighter, that it is not moved out.
  bool pinned = false;
  bool carried = false;        ///< by what nothing stops (CarriedBodies), when it last met others or solids
  bool struck = false;         ///< a sphere among hulls that a blow reached in this step
  float since_crowded = 1e9f;  ///< s, time since it last met another body
  /// s, time left in which it is not to rest in overlaps: it was put into them, or pressed into them by one
  /// that was.
  float placed = 0.0f;
  float eased = 0.0f;  ///< s, time left in which overlaps brought from another rung are undone slowly

  /// m/s², of a guest from `tables`: how bodies of its own rung bear it through the step, against gravity and
  /// the steady load that hulls lay on it.
  Vec3 borne = Vec3::Zero();
  /// m²/s², torque over mass: what those that bear it resist its rolling with, at most.
  float rolling_resistance = 0.0f;

  bool is_sphere() const { return sphere_radius > 0.0f; }
  bool is_solved_in_crowd() const { return crowded || (on_solid && !alone_on_solid); }
};

/// Takes from the turning of a guest what those that bear it resist in `time` seconds.
inline void resist_rolling(StatisticalBody& body, double time) {
  if (body.rolling_resistance == 0.0f) return;
  const double turning = body.spin.norm(), resisted = double(body.rolling_resistance) * time;
  body.spin *= resisted < turning ? 1.0 - resisted / turning : 0.0;
}

/// Kinetic energy over mass, J/kg, with the true inertia.
inline double kinetic_energy(const StatisticalBody& body, const Shape& shape) {
  return 0.5 *
         (body.velocity.squaredNorm() + body.spin.dot(angular_velocity(body.orientation, body.spin, shape)));
}

}  // namespace lodestone
