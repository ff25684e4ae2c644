// The statistical bodies of a world, on two rungs: `support` (support/) and `tables` (tables/), stepped
// without ODE (sections 3.3 and 3.4). They meet each other and the full bodies near them; one broad phase
// finds who is near whom, and one store holds those that sleep.
//
// Its step is stage 3 of the manager's (lod/manager.h), in six parts, of which the files' heads say theirs:
// - 3a start: what was given for the step (forces), on both rungs; radii and reaches of spheres
// - 3b near pairs of all that moves (near_search.h); the contacts of spheres with each other
// - 3c spheres answer: the impulses of those contacts
// - 3d hulls and their guests (near_bodies.h): hulls, spheres near them, full bodies, in substeps
// - 3e spheres move; who strikes the ground on its way is answered at the exact time
// - 3f rest, on both rungs: who comes to rest, who falls asleep
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lod/body.h"
#include "lod/contact/pair_contacts.h"
#include "lod/ground/ground.h"
#include "lod/statistical/contact_log.h"
#include "lod/statistical/full_neighbor.h"
#include "lod/statistical/kinds.h"
#include "lod/statistical/statistical_settings.h"
#include "lod/step_report.h"
#include "reference/state_archive.h"
#include "signature/signature.h"

namespace lodestone {

/// Where a statistical body is kept: on which rung, and its slot there. Slots are dense: a removal moves the
/// rung's last body into the free one.
struct StatisticalPlace {
  StatisticalModel model = StatisticalModel::support;
  std::int32_t slot = -1;  ///< −1: nowhere
  explicit operator bool() const { return slot >= 0; }
  friend bool operator==(StatisticalPlace, StatisticalPlace) = default;
};

/// What a body does, as far as its cost goes.
enum class Activity : std::uint8_t {
  asleep,
  alone,   ///< flies, slides or rests by itself
  crowded  ///< touches other bodies
};
inline constexpr std::size_t kActivities = 3;

/// Bodies of each rung by what they did in the last step, and the processor time of the calling thread that
/// they took, ms; that of `support` with what it and full bodies have to do with those of `tables` near them.
struct StatisticalCost {
  std::array<int, kActivities> tables{}, support{};
  double tables_ms = 0.0, support_ms = 0.0;
};

class StatisticalLevel {
 public:
  /// `ground` and `materials` must outlive the level.
  StatisticalLevel(const StatisticalSettings& settings, const Ground& ground, const MaterialTable& materials);
  ~StatisticalLevel();

  /// Adds a body for `owner` (the manager's index of it). `signature` may be null for `support`, which then
  /// rests without settling clips. One that `arrives` from another rung neither leaps nor drops: what it
  /// overlaps comes apart slowly.
  StatisticalPlace add(StatisticalModel model, std::uint32_t owner, std::shared_ptr<const Shape> shape,
                       double mass, MaterialId material, const RigidState& state, bool asleep,
                       std::shared_ptr<const Signature> signature, bool arrives = false);
  /// Frees the place; the rung's last body moves into it and its owner is returned (none where it was the
  /// last). Wakes what touches it, unless it `stays` where it is, on another rung.
  std::optional<std::uint32_t> remove(StatisticalPlace place, bool stays = false);

  /// What is remembered of the last step: for steps in which it has no body, and step() is not called.
  void forget_contacts();
  /// `neighbors` receive their share of the contacts; `full_contacts` are among them. Times and counts are
  /// added to `report`.
  void step(double dt, std::span<FullNeighbor> neighbors, StepReport& report,
            std::span<const FullContact> full_contacts = {});

  /// That the arrays of `tables` hold; those of `support` are not counted.
  std::size_t bytes() const;
  int size() const { return size(StatisticalModel::tables) + size(StatisticalModel::support); }
  int size(StatisticalModel model) const;
  int asleep_count() const;
  /// Appends the owners of those awake, of `tables` first, each by slot.
  void find_awake(std::vector<std::uint32_t>& owners) const;
  /// Owners of those that fell asleep in the last step.
  std::span<const std::uint32_t> fell_asleep() const;
  /// Appends the owners of those that woke since this was last asked; some may be twice there, or asleep
  /// again.
  void take_woke(std::vector<std::uint32_t>& owners);
  /// Where steps write down what touches what; null, as at first: nowhere.
  void set_log(ContactLog* log);
  /// m/s², from the next step on; wakes nobody.
  void set_gravity(const Vec3& gravity);
  /// As many as the jobs run on.
  void set_threads(int threads);
  RigidState state(StatisticalPlace place) const;
  Vec3 position(StatisticalPlace place) const;
  void set_state(StatisticalPlace place, const RigidState& state);  ///< wakes it
  bool asleep(StatisticalPlace place) const;
  /// m, of the colliding sphere at `tables`; 0 at `support`.
  double sphere_radius(StatisticalPlace place) const;
  void wake(StatisticalPlace place);
  void note_placed(StatisticalPlace place);  ///< it may be in others, and is to part from them
  /// Wakes who touches it, as when it is removed: what bore them may be gone.
  void let_fall_near(StatisticalPlace place);
  void put_to_sleep(StatisticalPlace place);  ///< where it is, at once
  /// Over the next step; wakes it.
  void add_force(StatisticalPlace place, const Vec3& force, const Vec3& torque);
  double reach() const;  ///< m, greatest bounding radius
  /// Appends the owners of sleepers whose bounding sphere meets this one, and perhaps others; `reach` in m.
  void find_sleepers(const Vec3& center, double reach, std::vector<std::uint32_t>& owners) const;

  /// Of the last step, each perhaps more than once.
  std::span<const CarriedFull> carriers() const;
  /// Appends the contacts of the last step in which one of the two bodies met as a hull.
  void find_contacts(std::vector<PairContact>& contacts) const;

  /// What a body moves by; null: none.
  const std::shared_ptr<const Signature>& signature(StatisticalPlace place) const;
  /// What its bodies move by, each once, and all that its next steps depend on, with these: see Kinds.
  std::vector<KindSignature> signatures() const;
  void archive(StateArchive& a, std::span<const std::shared_ptr<const Signature>> signatures);

  /// What it did in the last step.
  Activity activity(StatisticalPlace place) const;
  /// Of one at `support`: whether what nothing stops carried it, directly or through others.
  bool is_carried(StatisticalPlace place) const;
  /// Of the last step. Times are taken only from the next step on after `clocked` was set.
  const StatisticalCost& cost() const;
  void set_clocked(bool clocked);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
