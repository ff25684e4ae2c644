// Bodies of `support`, in dense arrays: how a body that touches no other moves, comes to rest, sleeps and
// wakes. Bodies near others are moved by rungs/near_bodies.h.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "lod/contact/solid_contacts.h"
#include "lod/statistical/kinds.h"
#include "lod/statistical/rest_law.h"
#include "lod/statistical/sleepers.h"
#include "lod/statistical/statistical_settings.h"
#include "lod/statistical/step_world.h"
#include "lod/support/clip_player.h"
#include "reference/state_archive.h"

namespace lodestone {

class SupportLevel {
 public:
  /// All but the settings must outlive the level.
  SupportLevel(const StatisticalSettings& settings, const Ground& ground, const MaterialTable& materials,
               const Kinds& kinds, Sleepers& sleepers)
      : settings_(settings),
        ground_(ground),
        materials_(materials),
        kinds_(kinds),
        sleepers_(sleepers),
        rest_law_(settings.sleep) {}

  /// Returns the slot; `mass` in kg. `eased`: it comes from another rung, perhaps with overlaps.
  int add(std::uint32_t owner, std::uint32_t kind, double mass, const RigidState& state, bool asleep,
          bool eased);
  /// The last body moves into the slot, and its owner is returned (none if it was the last itself). Wakes
  /// nobody.
  std::optional<std::uint32_t> remove(int slot);

  int size() const { return int(clips_.size()); }
  int asleep_count() const { return size() - int(awake_.size()); }
  std::span<const std::int32_t> awake() const { return awake_; }  ///< slots; in order during a step
  bool is_among_awake(int slot) const { return place_awake_[std::size_t(slot)] >= 0; }
  int place_among_awake(int slot) const { return place_awake_[std::size_t(slot)]; }  ///< in awake()
  std::span<const std::uint32_t> fell_asleep() const { return fell_asleep_; }  ///< owners, in the last step
  const StatisticalBody& body(int slot) const { return bodies_[std::size_t(slot)]; }
  std::uint32_t kind(int slot) const { return body(slot).kind; }
  const BodyKind& kind_of(const StatisticalBody& body) const { return kinds_[body.kind]; }
  RigidState state(int slot) const;
  void set_state(int slot, const RigidState& state);  ///< wakes it
  bool asleep(int slot) const { return body(slot).motion == Motion::asleep; }
  bool crowded(int slot) const {
    return body(slot).since_crowded == 0.0f || body(slot).on_solid;
  }  ///< touched another body, or an edge of the ground, in the last step
  void wake(int slot);
  /// It may overlap others, and is to be parted from them until a step finds that it overlaps nobody.
  void note_placed(int slot);
  void put_to_sleep(int slot);  ///< where it is, at once
  /// m/s², from the next step on. Clips end, as they were recorded under another gravity.
  void set_gravity(const Vec3& gravity);
  void set_log(ContactLog* log) { log_ = log; }  ///< null: none
  /// Appends the owners of bodies that woke since the last call.
  void take_woke(std::vector<std::uint32_t>& owners);
  void add_force(int slot, const Vec3& force, const Vec3& torque);  ///< over the next step; wakes it

  // A step, in this order.
  /// Until end_search() bodies have the velocities that forces will have given them by the end of the step:
  /// the search for near pairs needs these.
  void begin_step(double dt, ContactTally& tally);
  void end_search();
  const ActingForces& forces() const { return acting_; }  ///< of this step
  /// Appends to bodies(), until dismiss_guests(), bodies of `tables` that are near others in this step. Those
  /// that do not sleep are in awake_with_guests(), too.
  void admit_guests(std::span<const StatisticalBody> guests);
  std::span<StatisticalBody> bodies() { return bodies_; }
  std::span<const StatisticalBody> bodies() const { return bodies_; }
  bool is_guest(std::int32_t index) const { return index >= size(); }
  std::span<const std::int32_t> awake_with_guests() const { return awake_; }
  /// Moves a body that touches no other, over faces of solids and the planes. `turned`: as step_support_body
  /// takes it.
  void move_alone(std::int32_t slot, const FacesUnder& under, double time, ContactTally& tally,
                  const Quat* turned = nullptr);
  /// After a move of `time` seconds: updates whether the body rests, and repairs a state that is not sound.
  void update_quiet(std::int32_t slot, std::span<const HalfSpace> faces, double time, ContactTally& tally);
  void dismiss_guests();
  void end_step();

  void archive(StateArchive& a) {
    a(bodies_, clips_, angular_velocity_given_, last_places_, place_awake_, awake_, awake_in_order_, given_,
      pushes_, fell_asleep_, woke_);
  }

 private:
  struct Push {
    std::int32_t slot;
    Vec3 force, torque;
  };

  struct Before {
    std::int32_t slot;
    Vec3 velocity, spin;
  };

  StepWorld world() const {
    return {settings_.gravity, ground_.planes(), &materials_, settings_.seed, settings_.properties, log_};
  }
  const BodyProperties& properties_of(const StatisticalBody& body) const {
    return world().properties_of(body.owner);
  }
  void govern(StatisticalBody& body, const BodyProperties& own, double time) const;
  void put_to_sleep(StatisticalBody& body) const;
  void lay_still(std::int32_t slot);  // a sleeper leaves all loops
  void take_from_still(std::int32_t slot);
  bool lies_still(std::int32_t slot) const { return place_awake_[std::size_t(slot)] < 0; }
  void add_awake(std::int32_t slot);
  void drop_awake(std::int32_t slot);
  void put_awake_in_order();
  void note_given(std::int32_t slot);
  bool surely_moves_on(const StatisticalBody& body, const BodyKind& kind, double still_energy) const;
  bool is_sound(const StatisticalBody& body, double energy) const;
  void recover(StatisticalBody& body, const Vec3& last_place, ContactTally& tally) const;

  StatisticalSettings settings_;
  const Ground& ground_;
  const MaterialTable& materials_;
  const Kinds& kinds_;
  Sleepers& sleepers_;
  RestLaw rest_law_;
  ContactLog* log_ = nullptr;

  // One of each per body, by slot.
  std::vector<StatisticalBody> bodies_;  // and guests
  std::vector<ClipPlayback> clips_;
  std::vector<std::optional<Vec3>>
      angular_velocity_given_;     // until the next step: a state that was set is read back to the bit
  std::vector<Vec3> last_places_;  // m, at the step's start
  std::vector<std::int32_t> place_awake_;  // in `awake_`; −1: sleeps since an earlier step, and is in no loop

  std::vector<std::int32_t> awake_;  // slots, and guests
  bool awake_in_order_ = true;
  std::vector<std::int32_t>
      given_;                 // slots whose angular velocity was given, and some for which that is so no more
  std::vector<Push> pushes_;  // of the next step
  ActingForces acting_;       // in this step
  std::vector<Before> before_forces_;       // what bodies had before forces gave them anything
  std::vector<std::uint32_t> fell_asleep_;  // owners
  std::vector<std::uint32_t> woke_;         // owners
};

}  // namespace lodestone
