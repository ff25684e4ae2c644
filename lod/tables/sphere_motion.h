// What every awake body does in a step, in loops over dense arrays: the start, which tells how far it may
// reach, and the end, which moves it.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <span>

#include "lod/simd/lane_math.h"
#include "lod/simd/row.h"
#include "lod/statistical/rest_law.h"
#include "lod/tables/sphere_kinds.h"
#include "lod/tables/spheres.h"

namespace lodestone {

/// What the ground does to a body in this step.
enum class GroundState : std::uint8_t {
  free,     ///< does not meet it
  near,     ///< meets it at a speed that is an impact, or may meet it
  lies,     ///< presses on it, and slides along it: no parabola
  settles,  ///< so, and comes under the resting conditions
  moved,    ///< met it by itself and was moved: the end leaves it alone
  within,   ///< its hull may meet it, the sphere that stands for it does not
  stands,   ///< touches no other and moves on its hull
  unsound,  ///< after the end of the step: its state cannot be
};

/// J/kg, in place of a kinetic energy: what slides is not near-still, however slow.
inline constexpr float kSlides = 1e9f;

/// Of a step, one element an awake body. What contacts read and add are rows, and one more stands for all
/// that sleep.
struct SphereStep {
  std::vector<float> reach;  // m, as seen from the frame that goes with StepConstants::drift
  // The rows: a vector in xyz, a number in w. r is the sphere's radius, ω its angular velocity.
  // p  xyz  m/s   velocity, with the step's gravity and the impulses known so far
  //    w          how many contacts it has with other bodies, and with the ground that carries it among them
  // u  xyz  m/s   rω at the start, then with what friction changed of it
  //    w          1 + r² over the softest inertia over mass: what an impulse along its surface changes the
  //               velocity there by, times the mass
  // a  xyz  m/s   what the contacts of this step add to p
  //    w    m/s   what the ground gives it against what presses
  // s  xyz  m²/s  what the contacts add to the spin (angular momentum over mass)
  //    w    J/kg  kinetic energy at the start, and kSlides more for what slides face on face
  // d  xyz  m     how far contacts move it out of overlaps
  //    w    m     how far the ground alone does
  std::vector<lane::Row> p, u, a, s, d;
  std::vector<float> gap;               // m, to its plane, where near
  std::vector<std::uint8_t> on_ground;  // GroundState
  std::vector<std::uint8_t> flush;      // whether a face of its hull lies on its plane; of those among others
  std::vector<std::int32_t> plane;      // that carries it most, of those the nearest
  void resize(std::size_t count);
  std::size_t bytes() const;
  /// Rows that serve for nothing until clear_added.
  std::array<std::span<std::byte>, 2> free_rows() {
    return {std::as_writable_bytes(std::span(a)), std::as_writable_bytes(std::span(d))};
  }
  /// Sets the row of those that sleep.
  void clear_still(std::size_t row) { p[row] = u[row] = a[row] = s[row] = d[row] = {}; }

  /// Calls visit(i) for those of [begin, end) that stand so on the ground: mostly few or none.
  template <class Visit>
  void each(GroundState state, std::int64_t begin, std::int64_t end, const Visit& visit) const {
    const std::uint8_t *at = on_ground.data() + begin, *last = on_ground.data() + end;
    while (at < last &&
           (at = static_cast<const std::uint8_t*>(std::memchr(at, int(state), std::size_t(last - at)))))
      visit(at++ - on_ground.data());
  }
  bool touches(std::int64_t i) const { return p[std::size_t(i)].w > 0.0f; }
  /// m/s, with gravity but for `without`.
  Vec3 velocity(std::int64_t i, lane::Row without = {}) const {
    return vector_of(lane::row_of(lane::lanes_of(p[std::size_t(i)]) + lane::lanes_of(a[std::size_t(i)]) -
                                  lane::lanes_of(without)));
  }
  void add_velocity(std::int64_t i, const Vec3& by) {
    lane::Row& row = p[std::size_t(i)];
    row.x += float(by.x()), row.y += float(by.y()), row.z += float(by.z());
  }
  Vec3 added_spin(std::int64_t i) const { return vector_of(s[std::size_t(i)]); }
  Vec3 push_out(std::int64_t i) const { return vector_of(d[std::size_t(i)]); }

 private:
  static Vec3 vector_of(lane::Row row) { return {double(row.x), double(row.y), double(row.z)}; }
};

/// What the next step begins with of an impulse: times what the step before began with, and in weights of the
/// heaviest body. A load grows step by step, a blow comes at once.
inline constexpr float kLoadGrowth = 2.0f, kLoadAtOnce = 4.0f;

struct StepConstants {
  float time = 0.0f;                                                    // s
  float gx = 0.0f, gy = 0.0f, gz = 0.0f;                                // m/s²
  double wide_time = 0.0, wide_gx = 0.0, wide_gy = 0.0, wide_gz = 0.0;  // for flight
  float gravity = 0.0f;                                                 // m/s²
  Vec3 drift = Vec3::Zero();     // m/s, that most bodies have in common (rungs/drift.h)
  float resting_energy = 0.15f;  // J/kg over g R: the first threshold of 3.4
  float remembered = 1.0f;       // of forces known, the part that contacts begin with
  float held = 1.0f;             // of what the ground gave in the last step, likewise
  float rubbed = 1.0f;           // of friction, face on face, likewise
  bool remembers = true;         // what contacts give in this step
  bool update_radius = true;     // of those in flight
  float pressing = 1.0f;         // m/s²: gravity, or 1 where there is less, since forces press, too
  float heaviest = 1.0f;         // kg: of those awake
  int ticks = 17;                // ms that the step is long, as whole ones: over many steps they add up
  bool one_kind = false;
  bool hulls = false;  // bodies that touch no other stand on their hulls
};

/// ms since a body last touched another, up to which it leans on it still.
inline constexpr int kLeaningTicks = int(1000.0 * RestLaw::kLeaningTime);

/// Of each kind, over mass, body axes, 1/m².
inline lane::Tensors inverse_inertias_of(const SphereKinds& k) {
  return {k.ixx.data(), k.iyy.data(), k.izz.data(), k.ixy.data(), k.ixz.data(), k.iyz.data()};
}

inline lane::Tensors rolling_levers_of(const SphereKinds& k) {
  return {k.rxx.data(), k.ryy.data(), k.rzz.data(), k.rxy.data(), k.rxz.data(), k.ryz.data()};
}

/// Angular velocities, radii, reaches, and velocities with gravity.
void start_step(const Spheres& spheres, const SphereKinds& kinds, const StepConstants& constants, Simd simd,
                std::int64_t begin, std::int64_t end, SphereStep& step, Spheres& out);

/// Clears what contacts add to velocities and positions: in its memory the search for pairs kept its arrays.
void clear_added(std::int64_t begin, std::int64_t end, SphereStep& step);

/// The impulses of a round of contacts become part of the velocities that the next one sees.
void take_impulses(Simd simd, std::int64_t begin, std::int64_t end, SphereStep& step);

/// Moves the bodies that are not GroundState::moved, and marks those as GroundState::unsound whose state
/// cannot be.
void end_step(Spheres& spheres, const SphereKinds& kinds, const StepConstants& constants, Simd simd,
              std::int64_t begin, std::int64_t end, SphereStep& step);

}  // namespace lodestone
