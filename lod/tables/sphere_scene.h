// What the stages of a step of `tables` share: its bodies, their contacts, what holds through the step; and
// how far these reach, towards the ground and towards each other.
#pragma once

#include <utility>

#include "lod/broad_phase/ball_way.h"
#include "lod/statistical/kinds.h"
#include "lod/statistical/rest_law.h"
#include "lod/statistical/statistical_settings.h"
#include "lod/statistical/step_world.h"
#include "lod/tables/sphere_contacts.h"
#include "lod/tables/sphere_kinds.h"
#include "lod/tables/sphere_motion.h"
#include "lod/tables/spheres.h"

namespace lodestone {

/// Whether its state can be.
bool is_sound(const StatisticalBody& body, const Shape& shape);

struct SphereScene {
  static constexpr std::int64_t kBlock = 1024;  // bodies of a job

  const StatisticalSettings& settings;
  const Ground& ground;
  const MaterialTable& materials;
  const Kinds& all_kinds;
  const RestLaw& rest_law;
  const SphereKinds& kinds;
  const StepConstants& constants;  // of this step
  Spheres& spheres;
  SphereContacts& contacts;
  SphereStep& step;

  /// Of those awake: of so many bodies each.
  std::size_t blocks() const { return std::size_t((spheres.awake + kBlock - 1) / kBlock); }
  static std::size_t block_of(std::int64_t place) { return std::size_t(place / kBlock); }

  std::size_t place_of(int slot) const { return spheres.place_of_slot[std::size_t(slot)]; }
  const BodyKind& kind_of(std::int64_t place) const { return all_kinds[spheres.kind[std::size_t(place)]]; }
  /// How one awake that begins there with that velocity goes through the step, in the frame of the drift.
  BallWay way(std::int64_t place, const Vec3& from, const Vec3& velocity) const {
    const Vec3 half_way = (0.5 * constants.wide_time) * (velocity - constants.drift);
    return {from + half_way, half_way, double(step.reach[std::size_t(place)]) - 2.0 * half_way.norm()};
  }
  /// Whether it was not asked for all in the ball about its way, but for those alone that it meets on it.
  bool is_bound_to(const BallWay& way) const { return contacts.any_passed() && way.is_long(); }
  /// m: the reach of one awake, as seen by what lies still.
  double still_reach(std::int64_t place) const {
    return double(step.reach[std::size_t(place)]) + drift_reach();
  }
  double drift_reach() const { return constants.wide_time * constants.drift.norm(); }
  float bounce_velocity() const {
    return float(StepWorld{}.bounce_velocity) + constants.gravity * constants.time;
  }  // with what gravity adds in a step
  /// Whether it moves on its hull, if nothing touches it.
  bool is_alone(std::int64_t place) const {
    return constants.hulls && spheres.since_crowded[std::size_t(place)] >= kLeaningTicks;
  }
  bool is_nearly_still(const StatisticalBody& body, const BodyKind& kind, bool among_others) const;
  /// Whether a contact that carries so much, N s, carries nothing to a blow.
  bool is_unloaded(std::uint32_t first, std::uint32_t second, float impulse) const;

  /// m, from the centre of mass: what stands for the body towards the ground, and towards others.
  float ground_height(std::int64_t place, const Vec3& direction) const;
  /// Whether a face on which it stands firmly lies on a plane that is in that direction (unit).
  bool lies_flush(std::int64_t place, const Vec3& direction) const;
  /// m: where a line in that direction (unit) from its centre leaves it.
  double exit_distance(std::int64_t place, const Vec3& direction) const;
  /// On the line of their centres, midway between where it leaves the one and the other: on or in both.
  Vec3 meeting_point(std::int64_t first, std::int64_t second) const;
  /// The way from the second to the first along which they are apart the most, and how far, m.
  std::pair<Vec3, double> separate(std::int64_t first, std::int64_t second) const;
  /// What is no number must not spread.
  void recover(std::int64_t place, ContactTally& tally) const;
};

}  // namespace lodestone
