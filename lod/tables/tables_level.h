// Bodies of `tables`, in dense arrays. They meet each other as hulls that touch in one point, along the best
// of five separating axes (as published: as spheres). Their part in stage 3 of a step:
// - a start: radii and reaches
// - b near pairs (cells), their contacts, and which sleepers these wake
// - c all these contacts are answered, one after the other
// - d bodies that are near ones of other rungs are moved among those (rungs/near_bodies.h)
// - e motion; impacts on the ground are answered at their exact time, by the hulls (as published: from the
//   tables)
// - f rest
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "lod/broad_phase/cell_grid.h"
#include "lod/ground/ground.h"
#include "lod/jobs.h"
#include "lod/statistical/rest_law.h"
#include "lod/statistical/sleepers.h"
#include "lod/statistical/statistical_settings.h"
#include "lod/statistical/step_lengths.h"
#include "lod/step_report.h"
#include "lod/tables/carried_spheres.h"
#include "lod/tables/driven_spheres.h"
#include "lod/tables/further_planes.h"
#include "lod/tables/ground_rubbing.h"
#include "lod/tables/ground_strikers.h"
#include "lod/tables/guest.h"
#include "lod/tables/hull_loads.h"
#include "lod/tables/hulls_on_ground.h"
#include "lod/tables/near_ground.h"
#include "lod/tables/sphere_blows.h"
#include "lod/tables/sphere_clips.h"
#include "lod/tables/sphere_contacts.h"
#include "lod/tables/sphere_forces.h"
#include "lod/tables/sphere_scene.h"
#include "lod/tables/tipping.h"
#include "lod/tables/touched_sleepers.h"
#include "reference/state_archive.h"

namespace lodestone {

class TablesLevel {
 public:
  /// All but the settings must outlive the level.
  TablesLevel(const StatisticalSettings& settings, const Ground& ground, const MaterialTable& materials,
              const Kinds& kinds, Sleepers& sleepers, const JobRunner& jobs);
  TablesLevel(const TablesLevel&) = delete;  // its stages point at it
  TablesLevel& operator=(const TablesLevel&) = delete;

  /// Returns the slot; `mass` in kg. `arrives`: it comes from another rung, at the height that its hull has.
  int add(std::uint32_t owner, std::uint32_t kind, double mass, const RigidState& state, bool asleep,
          bool arrives);
  /// The last body moves into the slot, and its owner is returned (none if it was the last itself). Wakes
  /// nobody.
  std::optional<std::uint32_t> remove(int slot);

  /// Bytes of its arrays, without the sleepers' store.
  std::size_t bytes() const;
  int size() const { return int(spheres_.size()); }
  int asleep_count() const { return int(spheres_.size() - spheres_.awake); }
  /// Slots.
  std::span<const std::int32_t> awake() const {
    return std::span(spheres_.slot).first(std::size_t(spheres_.awake));
  }
  std::span<const std::uint32_t> fell_asleep() const { return fell_asleep_; }  ///< owners, in the last step
  std::uint32_t kind(int slot) const { return spheres_.kind[place_of(slot)]; }
  std::uint32_t owner(int slot) const { return spheres_.owner[place_of(slot)]; }
  RigidState state(int slot) const;
  Vec3 position(int slot) const { return spheres_.position(std::int64_t(place_of(slot))); }
  double radius(int slot) const {
    return double(kinds_.radius[spheres_.kind[place_of(slot)]]);
  }                                                   ///< m, of the bounding sphere
  void set_state(int slot, const RigidState& state);  ///< wakes it
  bool asleep(int slot) const { return std::int64_t(place_of(slot)) >= spheres_.awake; }
  bool crowded(int slot) const {
    return spheres_.since_crowded[place_of(slot)] == 0;
  }  ///< touched another body in the last step
  void wake(int slot);
  void let_tip(int slot);       ///< as after a fall: where what bore it may be gone (tipping.h)
  void put_to_sleep(int slot);  ///< where it is, at once
  /// m/s², from the next step on. Bodies that were coming to rest begin anew.
  void set_gravity(const Vec3& gravity);
  void set_log(ContactLog* log) { log_ = log; }  ///< null: none
  /// Appends the owners of bodies that woke since the last call.
  void take_woke(std::vector<std::uint32_t>& owners);
  void add_force(int slot, const Vec3& force, const Vec3& torque);  ///< over the next step; wakes it
  double sphere_radius(int slot) const { return double(spheres_.radius[place_of(slot)]); }

  // A step, in this order. `order`: the order of the awake spheres in the cells of the step before; empty if
  // those cells were of other bodies. `drift` (m/s): see find_drift().
  void begin_step(double dt, const Vec3& drift, std::span<const std::uint32_t> order, ContactTally& tally);
  const Spheres& spheres() const { return spheres_; }
  /// m, of those awake, as seen from the frame of the drift; and of one, as seen by what lies still.
  std::span<const float> reach() const { return step_.reach; }
  double still_reach(std::int64_t place) const { return scene_.still_reach(place); }
  CellGrid::Lent free_rows() { return step_.free_rows(); }  ///< scratch memory, until respond()
  /// Finds the contacts of spheres. Pairs with other balls in `cells` go to `others`, if given. Returns
  /// whether any balls there meet.
  bool find_contacts(const CellGrid& cells, std::vector<BallPairs>* others);
  /// In place of find_contacts(), when no sphere is near another body: contacts with further planes alone.
  void find_ground_contacts();
  /// In place of find_contacts(), when there are none.
  void forget_contacts() {
    contacts_.clear(), further_planes_.clear(), touched_sleepers_.forget_left_asleep();
  }
  /// Slots of the bodies whose motion planes do not describe in this step: those at an edge of the ground, or
  /// between parts of it that move; as published, also those that touch several parts of it.
  std::span<const std::int32_t> cornered() const { return near_ground_.cornered(); }
  /// Answers the contacts. `guests`: those for which describe() and take_guests() will be called.
  void respond(std::span<const Guest> guests, ContactTally& tally);
  /// Fills in what a guest is in this step; after respond().
  void describe(Guest& guest) const;
  /// The guest as a body, with what its contacts with spheres give it.
  StatisticalBody guest_body(const Guest& guest) const;
  /// Takes the guests back as they were moved; `before`: as guest_body() gave them.
  void take_guests(std::span<const Guest> guests, std::span<const StatisticalBody> before,
                   std::span<const StatisticalBody> bodies);
  void finish(ContactTally& tally);
  void rest();

  /// The kinds must be those of the writer already.
  void archive(StateArchive& a);

  /// Bytes that the last step moved, counted from its arrays.
  double count_traffic(bool pair_phase) const;

 private:
  StepWorld world() const {
    return {settings_.gravity, ground_.planes(), &materials_, settings_.seed, nullptr, log_};
  }
  std::size_t place_of(int slot) const { return spheres_.place_of_slot[std::size_t(slot)]; }
  StillGrid& still() { return sleepers_.of(StatisticalModel::tables); }
  const StillGrid& still() const { return sleepers_.of(StatisticalModel::tables); }
  const BodyKind& kind_of(std::int64_t place) const { return all_kinds_[spheres_.kind[std::size_t(place)]]; }
  float radius_at_ground(const StatisticalBody& body, const BodyKind& kind) const;
  void lay_still(std::int64_t place);
  void forget_all_given();

  // 3a
  void put_near_together(std::span<const std::uint32_t> order);
  StepConstants next_constants(double dt, const Vec3& drift);
  // Whether radii follow from how bodies move, in one loop.
  bool has_plain_radius() const {
    return settings_.tables.interpolate && !settings_.tables.draw_height &&
           settings_.tables.radius_update_interval <= 1;
  }
  float heaviest() const;
  void update_radii_one_by_one();
  void start_block(std::int64_t begin, std::int64_t end, Simd simd);
  void start_woken(std::int64_t begin);
  // 3c
  void respond_as_paper(ContactTally& tally);
  void sort_ground();
  void choose_rest_pose(std::int64_t place);
  void let_strikers_strike(std::span<const Guest> guests, ContactTally& tally);
  int sweeps() const;
  void sweep_contacts();
  // 3d
  void wake_guests(std::span<const Guest> guests);
  // 3e
  void finish_block(std::int64_t begin, std::int64_t end);
  void move_alone(std::int64_t place, ContactTally& tally, std::vector<SphereClips::Playing>& joined);
  void end_block(std::int64_t begin, std::int64_t end);
  // 3f
  void ease();
  bool has_less_energy(std::int64_t place, double energy) const;  // kinetic over mass, J/kg
  bool rolls_on_ground(std::int64_t place) const;
  bool comes_to_rest(std::int64_t place);

  template <class Task>
  void each_block(const Task& task) const {
    constexpr std::int64_t kBlock = SphereScene::kBlock;
    if (spheres_.awake == 0) return;
    jobs_(std::int64_t(scene_.blocks()), TaskRef([&](std::int64_t block) {
            task(block * kBlock, std::min(spheres_.awake, (block + 1) * kBlock));
          }));
  }

  StatisticalSettings settings_;
  const Ground& ground_;
  const MaterialTable& materials_;
  const Kinds& all_kinds_;
  Sleepers& sleepers_;
  JobRunner jobs_;
  Simd simd_;
  TablesSettings tables_;
  RestLaw rest_law_;
  ContactLog* log_ = nullptr;

  // What the stages of a step share.
  SphereKinds kinds_;
  Spheres spheres_;
  SphereContacts contacts_;
  SphereStep step_;
  StepConstants constants_;
  const SphereScene scene_{settings_, ground_,    materials_, all_kinds_, rest_law_,
                           kinds_,    constants_, spheres_,   contacts_,  step_};

  // Their parts.
  SphereForces forces_{scene_};
  NearGround near_ground_{scene_};
  TouchedSleepers touched_sleepers_{scene_, still()};
  FurtherPlanes further_planes_{scene_, near_ground_};
  HullLoads loads_{scene_};
  GroundRubbing rubbing_{scene_, near_ground_};
  SphereBlows blows_{scene_, near_ground_};
  GroundStrikers strikers_{scene_, near_ground_};
  SphereClips clips_{scene_};
  HullsOnGround hulls_{scene_, near_ground_, clips_};
  DrivenSpheres driven_{scene_, near_ground_, still()};
  TippingStep tipping_;
  bool tips_ = false;  // whether anybody may tip over in this step
  CarriedSpheres carried_{scene_, near_ground_, forces_};
  std::vector<std::int64_t> leaning_;  // places of guests on their hulls that touch
  std::vector<std::int64_t> set_out_;  // of these, who gains speed

  double elapsed_ = 0.0;  // s, over all steps
  StepLengths lengths_;   // of steps
  std::int64_t steps_ = 0;
  int rounds_ = 0;          // of contacts, in the last step
  bool one_mass_ = true;    // all bodies have, since there last were none
  std::int64_t eased_ = 0;  // bodies that are, asleep or not
  const CellGrid no_cells_{Simd::portable};
  std::int64_t searched_ = 0;  // awake bodies at the step's start; 0 once the places of any have changed
  std::vector<std::uint32_t> fell_asleep_, woke_;  // owners

  // States that were set since the last step are read back to the bit.
  std::unordered_map<std::uint32_t, RigidState> given_;  // by slot
  std::vector<std::uint32_t> slots_of_sleepers_;         // of contacts in their order, while guests wake
  std::vector<ContactTally> tallies_;                    // in this step, by block
};

}  // namespace lodestone
