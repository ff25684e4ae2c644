// A body of the statistical level: the state that a step touches, apart from the description that bodies of a
// kind share.
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
  /// Of the signature's settling clips; none without a signature, or where no model plays them.
  std::shared_ptr<const ClipIndex> clips;
  std::shared_ptr<const RestingFaces> faces;  ///< on which it can stand (tables model); none for a sphere
  MaterialId material = 0;
  bool isotropic = false;                  ///< a sphere or a cube: rotates steadily
  bool round = false;                      ///< a sphere or nearly one: rolls down a slope (tables model)
  bool angular = false;                    ///< of long and sharp edges: it does not roll over small facets
  Quat principal_axes = Quat::Identity();  ///< take principal axes of inertia to body axes
  bool along_principal_axes = true;        ///< body axes are these very axes
  Vec3 inverse_moments = Vec3::Ones();     ///< along them, over mass, 1/m²: ascending
};

/// With what follows from the shape's inertia.
BodyKind make_body_kind(std::shared_ptr<const Shape> shape,
                        std::shared_ptr<const Signature> signature = nullptr, MaterialId material = 0);

enum class Motion : std::uint8_t {
  dynamic,   ///< flies and collides
  settling,  ///< under the resting conditions of section 3.4, or in a settling clip
  asleep,
};

struct StatisticalBody {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  Vec3 velocity = Vec3::Zero();
  Vec3 spin = Vec3::Zero();    ///< angular momentum over mass, m²/s, world frame: what free flight conserves
  double mass = 1.0;           ///< kg
  float sphere_radius = 0.0f;  ///< m, `tables`: of the colliding sphere; 0 for a body of `support`
  float quiet_time = 0.0f;     ///< s spent below the sleeping threshold
  float speed = 0.0f;          ///< m/s, `support`: √(2 kinetic energy over mass) after the last step
  float rising_from = 0.0f;    ///< m/s, `support`: that speed where it last began to rise without a break
  float rising_time = 0.0f;    ///< s since then
  std::int32_t support_hint = 0;  ///< hull vertex last found lowest: where the next climb starts
  std::int32_t settling = -1;     ///< index of the settling record (clip or rest pose) while Motion::settling
  std::uint32_t owner = 0;
  std::uint32_t events = 0;  ///< collisions so far: keys the random draws
  std::uint32_t kind = 0;
  Motion motion = Motion::dynamic;
  bool crowded = false;         ///< touches another body in this step
  bool on_solid = false;        ///< touches parts of the ground in this step, where these are no planes to it
  bool alone_on_solid = false;  ///< and nothing that moves: moved by itself
  /// A guest from `tables` whose contacts there were solved under the steady load that hulls lay on it.
  /// Without it, as it still is, it seems to rise: its contacts do not bounce, and it does not count as
  /// falling.
  bool borne_up = false;
  bool in_great_heap = false;  ///< many bodies hang together with it (IslandKind::great); asleep: did so last
  bool on_edge = false;        ///< slow and in a crowd, but not over an area of what it stands on (Footing)
  /// Deep in one of many times its mass, or the other way round, and not to be moved out.
  bool pinned = false;
  bool carried = false;        ///< by what nothing stops (CarriedBodies), when it last met others or solids
  bool struck = false;         ///< of a sphere among hulls: by a blow in this step
  float since_crowded = 1e9f;  ///< s since it last met another body
  /// s left in which it is not to rest in overlaps, since it was put where it has some, or pressed into
  /// others by one that was.
  float placed = 0.0f;
  float eased = 0.0f;  ///< s left in which overlaps that it brought from another rung are undone slowly

  bool is_sphere() const { return sphere_radius > 0.0f; }
  bool is_solved_in_crowd() const { return crowded || (on_solid && !alone_on_solid); }
};

/// Kinetic energy over mass, J/kg, with the true inertia.
inline double kinetic_energy(const StatisticalBody& body, const Shape& shape) {
  return 0.5 *
         (body.velocity.squaredNorm() + body.spin.dot(angular_velocity(body.orientation, body.spin, shape)));
}

}  // namespace lodestone
