// A body of the full level, and what holds it up, as statistical bodies meet them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "reference/material.h"
#include "reference/shape.h"

namespace lodestone {

/// Linear (N s) and angular (N m s, about the centre of mass) momentum given to a body.
struct Impulse {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  bool is_zero() const { return linear.isZero(0.0) && angular.isZero(0.0); }
  Impulse operator+(const Impulse& other) const { return {linear + other.linear, angular + other.angular}; }
};

/// A body of the full level, as statistical ones meet it: it takes part in this step's contacts with its own
/// mass and shape.
struct FullNeighbor {
  std::uint32_t owner = 0;  ///< as in StatisticalLevel::add
  const Shape* shape = nullptr;
  double mass = 1.0;  ///< kg
  MaterialId material = 0;
  RigidState state;  ///< at the start of the step
  Vec3 force = Vec3::Zero(),
       torque = Vec3::Zero();  ///< N and N m, acting on it over the step besides gravity
  bool touches_full = false;   ///< it has a FullContact
  bool on_motor = false;       ///< it has a FullContact of a motor
  bool on_ground = false;      ///< a body of the caller's that is known to lie on ground
  bool driven = false;         ///< by a motor
  bool asleep = false;         ///< stands still like ground; out: false if a hit woke it
  bool carried = false;        ///< out: by what nothing stops (CarriedBodies); must not sleep
  bool moved = false;          ///< out: by a statistical body that goes on moving; must not sleep either
  Impulse hit;                 ///< out: of impacts; given to the body before the full level's step
  Impulse push;              ///< out: of resting, sliding and rolling; given as a force spread over that step
  Impulse backed_hit;        ///< out: of impacts that press it against ground or full bodies behind it
  double fastest_hit = 0.0;  ///< out: m/s, approach speed of the fastest of all impacts
  Impulse backing;           ///< out: by the ground and other full bodies, as the statistical level solved it
  Vec3 shift = Vec3::Zero();  ///< out: m, by which it is moved so that an overlap shrinks
  RigidState end;             ///< out: at the end of the step, if nothing else touches it

  bool is_touched() const { return !hit.is_zero() || !push.is_zero(); }  ///< by a statistical body
};

/// What two full neighbours gave each other in a substep, as the statistical level solved it.
struct FullExchange {
  std::int32_t first = 0, second = 0;  ///< indices of neighbours
  Impulse on_first, on_second;
};

/// After a step's contacts are solved, decides for each awake neighbour what ODE's step begins with (`hit`)
/// and what acts as a force during it (`push`):
/// - The part of a hit whose kinetic energy the push takes back becomes push.
/// - A squeezed body is struck again and again, between others and what backs it, by impulses that all but
///   cancel. It is given only their sum, as a hit: ODE would not answer each with the exact opposite, and
///   would throw the body out.
/// - An overloaded body, pressed by twenty times the sum of all that acts on it, is given that sum as a push.
/// Full bodies that back a squeezed or overloaded body are given their share of this (`exchanges`), so that
/// momentum is conserved; if they are as light, they count as squeezed or overloaded themselves.
void answer_hits(std::span<FullNeighbor> neighbors, std::span<const FullExchange> exchanges);

/// A kinematic statistical body that touched a full neighbour which is awake and not kinematic.
struct CarriedFull {
  std::uint32_t carrier = 0, full = 0;  ///< owners
};

/// The state with which ODE's step of `dt` seconds, in `substeps`, begins for a neighbour that is awake; its
/// push is then given as a force. `gravity` in m/s², as it acts on the body.
RigidState find_start(const FullNeighbor& neighbor, const Vec3& gravity, double dt, int substeps);

/// What a motor does along a direction.
struct Drive {
  double speed = 0.0;  ///< m/s, that is to be reached
  double force = 0.0;  ///< N, the greatest that it exerts
};

/// Where two full neighbours touch, or one touches the ground, or a joint holds or drives one. It may hold up
/// a body that statistical ones lean on, or press it onto them, so it is solved along with their contacts;
/// but the full bodies get its impulse from the full level.
struct FullContact {
  std::int32_t first = 0, second = -1;  ///< indices of neighbours; `second` −1: the ground
  Vec3 point = Vec3::Zero();            ///< m, world
  Vec3 normal = Vec3::UnitZ();          ///< from `second` into `first`
  double gap = 0.0;                     ///< m, negative where they overlap
  double friction = 0.5;
  Vec3 velocity = Vec3::Zero();     ///< m/s, of the ground there
  MaterialId ground_material = 0;   ///< if `second` is the ground
  std::optional<Drive> drive = {};  ///< a motor's, which pushes along the normal; none: a contact or a joint
  /// 0 for a contact. Of a joint, the number of this constraint among those of the first body: an odd one
  /// pushes one way, the next one the other way.
  std::uint32_t row = 0;
};

}  // namespace lodestone
