// The statistical level under the tables model: every body a sphere, in dense arrays. A step: 1 start (radii, reaches), 2 near pairs (cells), 3 contacts and who wakes,
// 4 the response of all contacts at once, 5 the ground: impacts at their exact time answered from the tables, 6 motion, 7 rest.
#pragma once

#include <unordered_map>

#include "lod/statistical/crowd.h"
#include "lod/tables/sphere_contacts.h"
#include "lod/tables/sphere_ground.h"
#include "lod/broad_phase/still_grid.h"

namespace lodestone {

/// As StatisticalLevel, whose functions of these names lead here.
class TablesLevel {
 public:
  TablesLevel(const StatisticalSettings& settings, const StaticGround& ground, const MaterialTable& materials, Simd simd = find_simd());

  int add(std::uint32_t owner, std::shared_ptr<const Shape> shape, double mass, MaterialId material, const RigidState& state, bool asleep,
          std::shared_ptr<const Signature> signature);
  std::optional<std::uint32_t> remove(int slot);
  void step(double dt, std::span<FullNeighbor> neighbors, StepReport& report, std::span<const FullContact> full_contacts);

  /// That its arrays hold.
  std::size_t bytes() const;
  int size() const { return int(spheres_.size()); }
  int asleep_count() const { return int(spheres_.size() - spheres_.awake); }
  /// Slots.
  std::span<const std::int32_t> awake() const { return std::span(spheres_.slot).first(std::size_t(spheres_.awake)); }
  RigidState state(int slot) const;
  Vec3 position(int slot) const;
  void set_state(int slot, const RigidState& state);
  bool asleep(int slot) const { return std::int64_t(spheres_.place_of_slot[std::size_t(slot)]) >= spheres_.awake; }
  void wake(int slot);
  void add_force(int slot, const Vec3& force, const Vec3& torque);
  double reach() const { return reach_; }
  void find_sleepers(const Vec3& center, double reach, std::vector<std::int32_t>& slots) const {
    still_.find_near(center, reach, [&](std::uint32_t slot) { slots.push_back(std::int32_t(slot)); });
  }
  double sphere_radius(int slot) const { return double(spheres_.radius[spheres_.place_of_slot[std::size_t(slot)]]); }

 private:
  struct Push {
    std::int32_t slot;
    Vec3 force, torque;
  };

  StepWorld world() const { return {settings_.gravity, &ground_, &materials_, settings_.seed}; }
  const BodyKind& kind_of(std::int64_t place) const { return kinds_.kinds[spheres_.kind[std::size_t(place)]]; }
  float bounce_velocity() const { return float(world().bounce_velocity) + constants_.gravity * constants_.time; }  // with what gravity adds in a step
  double sleep_speed(std::int64_t place) const;
  void put_to_sleep(std::int64_t place);
  void forget_all_given();

  void apply_pushes(double dt, ContactTally& tally);
  void start(double dt);
  void update_radii_one_by_one();
  void find_contacts(std::span<FullNeighbor> neighbors);
  void find_still_contacts();
  void respond(ContactTally& tally);
  void respond_as_paper(ContactTally& tally);
  void start_block(std::int64_t begin, std::int64_t end, Simd simd);
  void sort_ground();
  void choose_rest_pose(std::int64_t place);
  void end_step_with_slender(std::int64_t begin, std::int64_t end);
  void move_alone(std::int64_t place, ContactTally& tally);
  void meet_full(std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts, ContactTally& tally);
  void find_full_touches(std::span<FullNeighbor> neighbors);
  void finish(ContactTally& tally);
  void rest();
  void recover(std::int64_t place, ContactTally& tally);
  template <class Task>
  void each_block(const Task& task) const;

  StatisticalSettings settings_;
  const StaticGround& ground_;
  const MaterialTable& materials_;
  JobRunner jobs_;
  Simd simd_;
  TablesSettings tables_;

  SphereKinds kinds_;
  Spheres spheres_;
  StillGrid still_;
  CellGrid cells_;
  SphereContacts contacts_;
  SphereGround planes_;
  SphereStep step_;
  StepConstants constants_;
  Crowd crowd_;                                  // of bodies that touch full ones
  double reach_ = 0.0;
  std::int64_t steps_ = 0;
  std::int64_t ordered_ = 0;                     // awake bodies that the cells of the last step had in order

  // States that were set since the last step are read back to the bit.
  std::unordered_map<std::uint32_t, RigidState> given_;  // by slot
  std::vector<Push> pushes_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> still_touches_;  // place awake, slot asleep; then both places
  std::vector<ContactTally> tallies_;
  // Bodies that touch full ones.
  std::vector<StatisticalBody> near_full_;
  std::vector<std::uint32_t> near_full_slot_;
  std::vector<CrowdContact> full_touches_;
};

}  // namespace lodestone
