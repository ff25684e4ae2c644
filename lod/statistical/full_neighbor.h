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
  double mass = 1.0;
  MaterialId material = 0;
  RigidState state;  ///< at the start of the step
  Vec3 force = Vec3::Zero(),
       torque = Vec3::Zero();  ///< N and N m, acting on it over the step besides gravity
  bool touches_full = false;   ///< whether any FullContact is its own
  bool on_motor = false;       ///< whether any is a motor's
  bool on_ground = false;      ///< of the caller's: whether it is known to lie on ground
  bool driven = false;         ///< by a motor
  bool asleep = false;         ///< stands still like ground; also out: false where a hit woke it
  /// Out: by what nothing stops (CarriedBodies), or touched by a statistical body that moves: it must not
  /// sleep.
  bool carried = false;
  Impulse hit;         ///< out: of impacts, to be given to the body before the full level's step
  Impulse push;        ///< out: of resting, sliding and rolling, to be given as a force spread over that step
  Impulse backed_hit;  ///< out: of impacts against what of ODE's stands behind it
  double fastest_hit = 0.0;  ///< out: m/s, of all of them
  Impulse backing;  ///< out: of the ground and other full bodies, as the statistical level reckoned it
  Vec3 shift = Vec3::Zero();  ///< out: m, to be moved by, so that an overlap shrinks
  RigidState end;             ///< out: at the end of the step, where nothing else touches it

  bool is_touched() const { return !hit.is_zero() || !push.is_zero(); }  ///< by a statistical body
};

/// What two full neighbours gave each other in a substep, as the statistical level reckoned it.
struct FullExchange {
  std::int32_t first = 0, second = 0;  ///< indices of neighbours
  Impulse on_first, on_second;
};

/// Of those that are not asleep, once a step is reckoned: what of their hits they begin ODE's step with.
/// Where push takes back what a hit gives, in terms of kinetic energy, that part of the hit is a push, too.
/// And of a body that is struck again and again between others and what backs it, by impulses that all but
/// cancel, only what is left of all of them is a hit: ODE would not answer each with the same opposite, and
/// throw it out. Of one that is pressed by twenty times what is left of all of them what is left is the push.
/// Full bodies that back either have their part then, so that momentum is kept, and are no better off where
/// they are as light.
void answer_hits(std::span<FullNeighbor> neighbors, std::span<const FullExchange> exchanges);

/// A kinematic statistical body that touched a full neighbour which is awake and not kinematic.
struct CarriedFull {
  std::uint32_t carrier = 0, full = 0;  ///< owners
};

/// Of one that is not asleep, what ODE's step of `dt` seconds, in `substeps`, is to begin with, its push
/// given as a force. `gravity` in m/s², as it acts on the body.
RigidState find_start(const FullNeighbor& neighbor, const Vec3& gravity, double dt, int substeps);

/// What a motor does along a direction.
struct Drive {
  double speed = 0.0;  ///< m/s, that it is to reach
  double force = 0.0;  ///< N, at most
};

/// Where two full neighbours, or one and the ground, touch, or a joint holds or drives one: what holds up a
/// body that statistical ones lean on, or presses it onto them. Solved along with their contacts; what it
/// gives to the full bodies is the full level's matter.
struct FullContact {
  std::int32_t first = 0, second = -1;  ///< indices of neighbours; `second` −1: the ground
  Vec3 point = Vec3::Zero();            ///< world
  Vec3 normal = Vec3::UnitZ();          ///< from `second` into `first`
  double gap = 0.0;                     ///< m, negative where they overlap
  double friction = 0.5;
  Vec3 velocity = Vec3::Zero();     ///< m/s, of the ground there
  MaterialId ground_material = 0;   ///< where the second is the ground
  std::optional<Drive> drive = {};  ///< a motor's: no contact, but pushes along its normal
  /// Of a joint's: its number among those of the first body, odd where it pushes one way, and the next where
  /// it pushes the other; 0: a contact.
  std::uint32_t row = 0;
};

}  // namespace lodestone
