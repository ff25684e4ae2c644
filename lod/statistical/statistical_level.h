// The statistical level: bodies as dense arrays, stepped without ODE (sections 3.3 and 3.4). One step: 1 near pairs (broad phase),
// 2 contacts of those pairs, 3 flight and ground contact of bodies that touch no other, 4 the contact solver for bodies that do, 5 rest. `support` takes
// stages 2 to 4 in substeps for bodies that are near others.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lod/body.h"
#include "lod/jobs.h"
#include "lod/static_ground.h"
#include "lod/step_report.h"
#include "lod/tables_options.h"
#include "signature/signature.h"

namespace lodestone {

struct StatisticalSettings {
  Vec3 gravity{0, 0, -9.81};
  std::uint64_t seed = 1;
  int threads = 1;
  JobRunner jobs = {};  ///< empty: oneTBB's on so many threads
  StatisticalModel model = StatisticalModel::support;
  TablesOptions tables;
  bool sleeping = true;
};

/// Linear (N s) and angular (N m s, about the centre of mass) momentum given to a body.
struct Impulse {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

/// A body of the full level, as statistical ones meet it: it takes part in this step's contacts with its own mass and shape.
struct FullNeighbor {
  std::uint32_t owner = 0;                ///< as in StatisticalLevel::add
  const Shape* shape = nullptr;
  const Signature* signature = nullptr;   ///< null where it was never needed
  double mass = 1.0;
  MaterialId material = 0;
  RigidState state;                       ///< at the start of the step
  Vec3 force = Vec3::Zero();              ///< N, acting on it over the step besides gravity
  bool asleep = false;                    ///< stands still like ground; also out: false where a hit woke it
  Impulse hit;                            ///< out: of impacts, to be given to the body before the full level's step
  Impulse push;                           ///< out: of resting, sliding and rolling, to be given as a force spread over that step
  Vec3 shift = Vec3::Zero();              ///< out: m, to be moved by, so that an overlap shrinks
};

/// Where two full neighbours, or one and the ground, touch: what holds up a body that statistical ones lean on. Solved along with their contacts;
/// what it gives to the full bodies is the full level's matter.
struct FullContact {
  std::int32_t first = 0, second = -1;    ///< indices of neighbours; `second` −1: the ground
  Vec3 point = Vec3::Zero();              ///< world
  Vec3 normal = Vec3::UnitZ();            ///< from `second` into `first`
  double gap = 0.0;                       ///< m, negative where they overlap
  double friction = 0.5;
};

class TablesLevel;

class StatisticalLevel {
 public:
  /// `ground` and `materials` must outlive the level.
  StatisticalLevel(const StatisticalSettings& settings, const StaticGround& ground, const MaterialTable& materials);
  ~StatisticalLevel();

  /// Adds a body for `owner` (the manager's index of it) and returns its slot. `signature` may be null for `support`, which then rests
  /// without settling clips.
  int add(std::uint32_t owner, std::shared_ptr<const Shape> shape, double mass, MaterialId material, const RigidState& state, bool asleep,
          std::shared_ptr<const Signature> signature);
  /// Frees `slot`, waking what touches it; the last body moves into it and its owner is returned (none where `slot` was the last).
  std::optional<std::uint32_t> remove(int slot);

  /// `neighbors` receive their share of the contacts; `full_contacts` are among them. Times and counts are added to `report`.
  void step(double dt, std::span<FullNeighbor> neighbors, StepReport& report, std::span<const FullContact> full_contacts = {});

  /// That its arrays hold; 0 under `support`, where nobody counts them.
  std::size_t bytes() const;
  int size() const;
  int asleep_count() const;
  std::span<const std::int32_t> awake() const;                             ///< slots
  RigidState state(int slot) const;
  Vec3 position(int slot) const;
  void set_state(int slot, const RigidState& state);                       ///< wakes it
  bool asleep(int slot) const;
  void wake(int slot);
  void add_force(int slot, const Vec3& force, const Vec3& torque);         ///< over the next step; wakes it
  double reach() const;                                                    ///< m, greatest bounding radius
  /// Adds the slots that sleep and whose bounding sphere meets this one, and perhaps others; `reach` in m.
  void find_sleepers(const Vec3& center, double reach, std::vector<std::int32_t>& slots) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;            // the support model's
  std::unique_ptr<TablesLevel> tables_;   // the tables model's; one of the two is there
};

}  // namespace lodestone
