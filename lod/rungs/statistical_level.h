// The statistical bodies of a world, on two rungs: `support` (support/) and `tables` (tables/), stepped
// without ODE (sections 3.3 and 3.4). They meet each other and the full bodies near them; one broad phase
// finds who is near whom, and one store holds those that sleep.
//
// Its step is stage 3 of the manager's (lod/manager.h), in six parts, of which the files' heads say theirs:
// - 3a start: forces that were given for the step, on both rungs; radii and reaches of spheres
// - 3b near pairs of all that moves (near_search.h); the contacts of spheres with each other
// - 3c spheres answer: the impulses of those contacts
// - 3d hulls and their guests (near_bodies.h): hulls, spheres near them, full bodies, in substeps
// - 3e spheres move; impacts on the ground on their way are answered at their exact time
// - 3f rest, on both rungs: which bodies come to rest, and which fall asleep
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

/// Where a statistical body is kept: its rung, and its slot there. Slots are dense: a removal moves the
/// rung's last body into the free slot.
struct StatisticalPlace {
  StatisticalModel model = StatisticalModel::support;
  std::int32_t slot = -1;  ///< −1: nowhere
  explicit operator bool() const { return slot >= 0; }
  friend bool operator==(StatisticalPlace, StatisticalPlace) = default;
};

/// What a body does, as far as that decides what it costs.
enum class Activity : std::uint8_t {
  asleep,
  alone,   ///< flies, slides or rests by itself
  crowded  ///< touches other bodies
};
inline constexpr std::size_t kActivities = 3;

/// Numbers of bodies on each rung by what they did in the last step, and the processor time (ms) of the
/// calling thread that they took. The time of `support` includes the contacts of hulls with guests from
/// `tables`.
struct StatisticalCost {
  std::array<int, kActivities> tables{}, support{};
  double tables_ms = 0.0, support_ms = 0.0;
};

class StatisticalLevel {
 public:
  /// `ground` and `materials` must outlive the level.
  StatisticalLevel(const StatisticalSettings& settings, const Ground& ground, const MaterialTable& materials);
  ~StatisticalLevel();

  /// Adds a body for `owner` (the manager's index of it); `mass` in kg. `signature` may be null for
  /// `support`, which then rests without settling clips. A body that `arrives` from another rung neither
  /// leaps nor drops: overlaps that it has are undone slowly.
  StatisticalPlace add(StatisticalModel model, std::uint32_t owner, std::shared_ptr<const Shape> shape,
                       double mass, MaterialId material, const RigidState& state, bool asleep,
                       std::shared_ptr<const Signature> signature, bool arrives = false);
  /// Frees the place. The rung's last body moves into it, and its owner is returned (none if it was the last
  /// itself). Wakes what touches the body, unless it `stays` where it is, on another rung.
  std::optional<std::uint32_t> remove(StatisticalPlace place, bool stays = false);

  /// Forgets what is remembered of the last step: in place of step() while it has no bodies.
  void forget_contacts();
  /// Advances all bodies by `dt` seconds. `neighbors` receive their share of the contacts; `full_contacts`
  /// are those between neighbours. Times and counts are added to `report`.
  void step(double dt, std::span<FullNeighbor> neighbors, StepReport& report,
            std::span<const FullContact> full_contacts = {});

  /// Bytes of the arrays of `tables`; those of `support` are not counted.
  std::size_t bytes() const;
  int size() const { return size(StatisticalModel::tables) + size(StatisticalModel::support); }
  int size(StatisticalModel model) const;
  int asleep_count() const;
  /// Appends the owners of bodies awake: those of `tables` first, each rung by slot.
  void find_awake(std::vector<std::uint32_t>& owners) const;
  /// Owners of bodies that fell asleep in the last step.
  std::span<const std::uint32_t> fell_asleep() const;
  /// Appends the owners of bodies that woke since the last call; some may appear twice, or sleep again.
  void take_woke(std::vector<std::uint32_t>& owners);
  /// Where steps write what touches what; null, as at first: nowhere.
  void set_log(ContactLog* log);
  /// m/s², from the next step on; wakes nobody.
  void set_gravity(const Vec3& gravity);
  /// How many threads the jobs run on.
  void set_threads(int threads);
  RigidState state(StatisticalPlace place) const;
  Vec3 position(StatisticalPlace place) const;
  void set_state(StatisticalPlace place, const RigidState& state);  ///< wakes it
  bool asleep(StatisticalPlace place) const;
  /// m, of the colliding sphere at `tables`; 0 at `support`.
  double sphere_radius(StatisticalPlace place) const;
  void wake(StatisticalPlace place);
  void note_placed(StatisticalPlace place);  ///< it may overlap others, and is to be parted from them
  /// Wakes what touches it, as its removal does: what bore them may be gone.
  void let_fall_near(StatisticalPlace place);
  void put_to_sleep(StatisticalPlace place);  ///< where it is, at once
  /// N and N m about the centre of mass, over the next step; wakes it.
  void add_force(StatisticalPlace place, const Vec3& force, const Vec3& torque);
  double reach() const;  ///< m, greatest bounding radius
  /// Appends the owners of sleepers whose bounding sphere meets this one, and perhaps others; `reach` in m.
  void find_sleepers(const Vec3& center, double reach, std::vector<std::uint32_t>& owners) const;

  /// Kinematic bodies that touched full ones in the last step; a pair may appear more than once.
  std::span<const CarriedFull> carriers() const;
  /// Appends the contacts of the last step in which one of the two bodies met as a hull.
  void find_contacts(std::vector<PairContact>& contacts) const;

  /// The signature by which a body moves; null: none.
  const std::shared_ptr<const Signature>& signature(StatisticalPlace place) const;
  /// The signatures by which its bodies move, each once.
  std::vector<KindSignature> signatures() const;
  /// All that its next steps depend on, besides these signatures: see Kinds.
  void archive(StateArchive& a, std::span<const std::shared_ptr<const Signature>> signatures);

  /// What it did in the last step.
  Activity activity(StatisticalPlace place) const;
  /// Whether a body of `support` was carried by what nothing stops, directly or through others.
  bool is_carried(StatisticalPlace place) const;
  /// Of the last step. Times are measured from the step after set_clocked(true).
  const StatisticalCost& cost() const;
  void set_clocked(bool clocked);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
