// The bodies of a manager and the rungs that they are on: what is the same to do with a body whatever its
// rung.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "lod/callers/callers_bodies.h"
#include "lod/callers/callers_ground.h"
#include "lod/full/full_level.h"
#include "lod/manager/body_table.h"
#include "lod/manager/eased_bodies.h"
#include "lod/manager/near_full.h"
#include "lod/manager/put_off_promotions.h"
#include "lod/manager/signature_store.h"
#include "lod/rungs/statistical_level.h"

namespace lodestone {

/// Bodies at rest on each other are apart by less than this fraction of their radii.
inline constexpr double kTouchMargin = 0.05;

struct Levels {
  Levels(const StatisticalSettings& statistical_level, const FullSettings& full_level, SignatureStore store)
      : full(full_level, materials),
        statistical_settings(statistical_level),
        signatures(std::move(store)),
        callers{CallersGround(ground)} {}
  Levels(dxWorld* world, dxSpace* space, const StatisticalSettings& statistical_level,
         const FullSettings& full_level, SignatureStore store)
      : full(world, space, full_level, materials),
        statistical_settings(statistical_level),
        signatures(std::move(store)),
        callers{CallersGround(ground)} {}
  Levels(const Levels&) = delete;  // the levels point at materials and ground
  Levels& operator=(const Levels&) = delete;

  MaterialTable materials;
  Ground ground;
  BodyTable bodies;
  FullLevel full;
  std::unique_ptr<StatisticalLevel> statistical;  ///< null until a first body is statistical
  StatisticalSettings statistical_settings;
  SignatureStore signatures;
  EasedBodies eased;  ///< at the full level
  PutOffPromotions put_off;
  /// What the statistical rungs meet of a caller's own space.
  struct Callers {
    CallersGround ground;
    CallersBodies bodies = {};
  } callers;
  std::int64_t now = 0;                  ///< steps so far
  std::vector<RungChange> rung_changes;  ///< since the last step was over
  std::vector<std::uint32_t> woken;      ///< by wake(), until somebody takes note

  /// The law between a body and the ground that it most likely meets: the first plane, else ground of the
  /// default material.
  ContactLaw ground_law(MaterialId material) const;

  /// What a body on a statistical rung moves by; null: nothing, or it is on none.
  const std::shared_ptr<const Signature>& own_signature(std::uint32_t body) const;

  /// Of a body's shape at each rung, by Rung; the drifts of one that touches others with their overlaps.
  std::array<RungError, kRungs> errors_of(std::uint32_t body, Activity does) const;

  RigidState state(std::uint32_t body) const;
  /// What hashes of its state are of: position, orientation (w first), velocity, angular velocity, whether it
  /// is full, whether it sleeps.
  std::array<double, 15> numbers_of(std::uint32_t body) const;
  bool asleep(std::uint32_t body) const;
  /// Wakes the body and what was near it.
  void set_state(std::uint32_t body, const RigidState& state);
  /// Wakes the body alone: for another motion in the same place.
  void set_motion(std::uint32_t body, const RigidState& state);
  void wake(std::uint32_t body);
  /// Lays it still where it is, without the force that is held for it. One on no rung yet will be so on its
  /// first.
  void put_to_sleep(std::uint32_t body);
  void wake_all();
  /// m/s², from now on; wakes all.
  void set_gravity(const Vec3& gravity);
  /// The same, of bodies that are about to be put as they were under it: wakes none.
  void use_gravity(const Vec3& gravity);
  /// Brings ground and bodies to what the caller's space holds now, before a step of `dt` s, in which he has
  /// put it so for `since` s; 0: in a later part of a divided step. What lay on ground that came, went or
  /// moved wakes.
  void follow_callers_space(double dt, double since);
  /// After that, where no step follows: the caller may change it again.
  void look_away();
  /// The geoms of the caller's dynamic bodies as they are now, at any time.
  std::vector<CallersPart> callers_parts() const;
  /// Wakes the statistical bodies whose bounding spheres meet `box`, and full ones that lie as they did
  /// there.
  void wake_in(const Eigen::AlignedBox3d& box);
  /// Wakes the bodies of either level whose bounding spheres meet `box`, from which ground is gone or was put
  /// elsewhere, and what is piled on them, which would not feel it where the lowest fall by a hair.
  void wake_piled_in(const Eigen::AlignedBox3d& box);
  /// Wakes the bodies of either level whose bounding spheres meet `box`: new ground is there.
  void wake_all_in(const Eigen::AlignedBox3d& box);
  /// Wakes the bodies of either level that a new `plane` cuts.
  void wake_on(const HalfSpace& plane);
  /// Wakes every other body of `level` whose bounding sphere meets that of `body`.
  void wake_near(std::uint32_t body, Level level);
  /// Wakes every body, of either level, whose bounding sphere meets one of `radius` m about `center`.
  void wake_at(const Vec3& center, double radius);
  /// Adds the other bodies of `level`, or those of them that sleep, whose bounding sphere meets that of
  /// `body`, both `factor` times as large.
  void find_near(std::uint32_t body, double factor, Level level, std::vector<std::uint32_t>& near,
                 bool asleep_only) const;
  /// A body has become full, or was moved there.
  void note_full(std::uint32_t body);
  /// The full level has moved its bodies.
  void forget_places() { near_full_.clear(); }
  /// Gives bodies the forces that are held for them, over the next step of their level.
  void give_forces();

 private:
  /// Wakes those of either level that sleep above the body, bounding sphere to bounding sphere, and above
  /// these, and so on: nothing holds them up any more.
  void wake_piled_on(std::uint32_t body);
  /// The ground may have come into it.
  void wake_in_ground(std::uint32_t body);
  /// Whether its bounding sphere about `place`, m, meets the box.
  bool meets(std::uint32_t body, const Vec3& place, const Eigen::AlignedBox3d& box) const;
  std::vector<std::uint32_t> find_sleepers_in(const Eigen::AlignedBox3d& box) const;  // statistical ones
  std::vector<std::uint32_t> find_full_in(const Eigen::AlignedBox3d& box) const;
  void find_at(const Vec3& center, double radius, double factor, Level level,
               std::vector<std::uint32_t>& near, bool asleep_only) const;
  const NearFull& near_full() const;
  mutable NearFull near_full_;
};

}  // namespace lodestone
