// Bodies at the ground's planes, in loops over dense arrays: which may meet one, what it gives to those that
// it carries among others, and how those that lie there rub and turn into their rest poses (3.4). Impacts are
// for the response tables, body by body.
#pragma once

#include "lod/ground/ground.h"
#include "lod/statistical/step_world.h"
#include "lod/tables/sphere_motion.h"

namespace lodestone {

/// Planes as floats: the ground's, which all spheres may meet, then faces of its parts, each for a sphere
/// near it. Friction is by material and kind.
struct SphereGround {
  std::vector<float> nx, ny, nz;  // normals
  std::vector<float> ux, uy, uz;  // m/s: of the ground there
  std::vector<float> turn;        // rad/s: of the ground about the normal
  std::vector<float> pressure;    // m/s²: of gravity onto the plane
  std::vector<float>
      slope;  // 0: gravity presses straight onto it; 1: not so, and not every rest pose holds there
  std::vector<std::int32_t> row;  // of each plane's material in `friction`
  std::vector<float> friction;    // of kind k with a material at row · kinds + k
  std::size_t kinds = 0;
  bool any_moves = false;
  std::vector<std::int32_t> row_of_material;
  std::vector<float> of_material;  // friction with the material of a new row; negative: not asked for yet

  bool is_one_plane() const { return nx.size() == 1 && !any_moves; }  ///< and it stands
  Vec3 velocity(std::size_t plane) const;                             ///< m/s, of the ground there
  void clear(std::size_t kinds_now);
  /// Returns the plane's number. Its ground moves and turns by `velocity` (m/s, there) and `angular_velocity`
  /// (rad/s).
  std::int32_t add(const HalfSpace& plane, const MaterialTable& materials, const SphereKinds& of,
                   const Vec3& gravity, const Vec3& velocity = Vec3::Zero(),
                   const Vec3& angular_velocity = Vec3::Zero());
};

/// Marks as GroundState::near those that may meet a plane in this step, with the gap to it and its number: of
/// several that which gravity presses on most, of those the nearest. Where bodies stand on their hulls, as
/// GroundState::within those whose hulls alone may.
void find_near_ground(const Spheres& spheres, const SphereKinds& kinds, const SphereGround& ground,
                      const HalfSpace& plane, std::int32_t number, const StepConstants& constants, Simd simd,
                      std::int64_t begin, std::int64_t end, SphereStep& step);

/// Of those near: GroundState::lies where it presses on the ground, with what the ground gave in the last
/// step if it has contacts with others, which the ground then adds one to; approaches slower than
/// `bounce_velocity` are no impacts; GroundState::settles where it must choose a rest pose first, or, on a
/// slope, look whether its own still holds it; the rest stays near, for an impact. Clears what contacts add,
/// as clear_added.
void sort_near_ground(const Spheres& spheres, const SphereKinds& kinds, const SphereGround& ground,
                      const StepConstants& constants, float bounce_velocity, Simd simd, std::int64_t begin,
                      std::int64_t end, SphereStep& step);

/// A round of the contacts with the ground of those that lie on it among others.
void sweep_ground(const SphereGround& ground, const StepConstants& constants, Simd simd, std::int64_t begin,
                  std::int64_t end, SphereStep& step);

/// Of those that touch others, too: what contacts would move into the plane stays on it.
void keep_on_ground(const SphereGround& ground, std::int64_t begin, std::int64_t end, SphereStep& step);

/// Velocities and spins of those that lie on the ground after friction and, under the resting conditions, the
/// turn into the rest pose.
void lie_on_ground(Spheres& spheres, const SphereKinds& kinds, const SphereGround& ground,
                   const StepConstants& constants, Simd simd, std::int64_t begin, std::int64_t end,
                   SphereStep& step);

}  // namespace lodestone
