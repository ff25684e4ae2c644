// The engine's public face: bodies on three rungs, full (ODE trimesh), `support` (hull) and `tables`
// (sphere), moved between them by a policy. One step: 1 choose rungs, 2 transfer, 3 statistical rungs and
// their contacts with full bodies (3a to 3f: lod/rungs/statistical_level.h), 4 full level, with the impulses
// of those contacts, 5 report.
//
// SI units unless a name ends in another (`_ms`, `_px`), world frame right-handed, quaternions w, x, y, z.
//
// - Errors. An argument that cannot be used (a stale id, a number that is not finite or out of its range, a
//   material that is not in the table) throws InputError (reference/error.h) before anything has changed;
//   nothing aborts. If one of ODE's own assertions fails in a step, the step throws SimulationError
//   (reference/simulation_error.h); after that the manager can be read and destroyed, but not stepped.
// - Ids. The id of a removed body, ground or group stays stale for good, even when its index is used again.
//   valid() tells whether an id is stale; every other call throws for one that is.
// - Threads. One thread at a time uses a manager; between two steps any number of threads may call its const
//   functions.
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lod/body.h"
#include "lod/events.h"
#include "lod/groups.h"
#include "lod/hooks.h"
#include "lod/jobs.h"
#include "lod/policy.h"
#include "lod/queries.h"
#include "lod/record.h"
#include "lod/signatures.h"
#include "lod/step_report.h"
#include "lod/tables_options.h"
#include "lod/viewpoint.h"
#include "lod/why.h"
#include "reference/mesh/mesh.h"
#include "reference/simulation_error.h"  // IWYU pragma: export

struct dxWorld;
struct dxSpace;
struct dxBody;

namespace lodestone {

using PairFilter = std::function<bool(BodyId, BodyId)>;

struct ManagerSettings {
  Vec3 gravity{0, 0, -9.81};  ///< m/s², finite; not on a caller's world, which has its own
  std::uint64_t seed = 1;
  int threads = 1;  ///< ≥ 1, for the statistical level; the results do not depend on it
  /// Runs jobs on an engine's own threads, `threads` of them; empty: oneTBB's. What it throws comes out of
  /// the step, once the step has been taken.
  JobRunner jobs = {};
  int full_substeps = 4;       ///< ≥ 1, ODE steps per step; 16 while thin bodies are awake among others
  bool sleeping = true;        ///< bodies at rest cost nothing until something wakes them
  SleepThresholds sleep = {};  ///< on every rung
  /// The model of all statistical bodies; none: the policy chooses one for each body.
  std::optional<StatisticalModel> model = {};
  TablesOptions tables = {};  ///< of the tables model
  PolicySettings policy = {};
  /// Processor time (ms) that each step spends on the audit, which goes on simulating demoted bodies in full
  /// beside the world (AuditReport); 0: no audit. One step of one body may exceed it.
  double audit_ms = 0.0;
  /// Whether two bodies may meet, in addition to what their properties say; empty: all may. Called for pairs
  /// that are near each other, in any order, from several threads and more than once a step. Within a step it
  /// must give the same answer for the same two bodies, whichever comes first. It must not call the manager.
  PairFilter pair_filter = {};
  EventSettings events = {};          ///< which contacts step() reports
  SignatureFunction signatures = {};  ///< empty: find_or_measure_signature with its defaults
  /// Whether a step waits for a signature, or the body does without it until it is there.
  SignatureTiming signature_timing = SignatureTiming::automatic;
};

class Manager {
 public:
  /// With an ODE world of its own, which is made when the first body becomes full.
  explicit Manager(const ManagerSettings& settings = {});
  /// In the caller's world and space (dWorldID, dSpaceID), which must outlive the manager. Gravity is that
  /// world's, on every rung and also when it changes. step() advances the caller's own bodies too. Static and
  /// kinematic geoms in the space, of any class, are ground of material 0 on every rung; the caller's dynamic
  /// bodies exchange impulses with the manager's. All of them may come, go and move between steps.
  /// Bodies of two managers in one world do not meet each other, and a step() of one manager would move the
  /// full bodies of the other without their contacts. So with several managers all call before_world_step,
  /// then the world steps once, then all call after_world_step.
  Manager(dxWorld* world, dxSpace* space, const ManagerSettings& settings = {});
  ~Manager();
  Manager(Manager&&) noexcept;
  Manager& operator=(Manager&&) noexcept;

  // ---- The scene ----

  /// Materials are added before the bodies that use them.
  MaterialTable& materials();

  // Ground for the manager's bodies, on every rung. The caller's own bodies do not meet it: the caller makes
  // their contacts, and only with his own geoms. Sleepers that new ground overlaps wake.
  /// normal·x = offset (m); the normal's length within 1e-3 of 1.
  GroundId add_plane(const Vec3& normal, double offset, MaterialId material = 0);
  /// Vertices in the world frame, each coordinate within 1e6 m; at least two faces, at least one of them with
  /// an area.
  GroundId add_static_mesh(const Mesh& mesh, MaterialId material = 0);
  /// `sides` are whole edge lengths: the longest 1e-4 … 1e6 m, none shorter than 2e-6 of it.
  GroundId add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation,
                          MaterialId material = 0);
  /// Puts a box or mesh elsewhere (a mesh is made at the origin, unturned) and wakes what is near, unless it
  /// stood still there before. `state` is that at the beginning of the next step. With a velocity it carries
  /// what lies on it, on every rung: within the step it moves on from `state`; after the step it is back
  /// there, also for queries, until it is moved again. So a platform is moved before each step, and once
  /// without a velocity where it stops. Ground that has a velocity and is never moved is a conveyor belt.
  /// Ground that is moved before each step without a velocity pushes what it meets. A plane cannot be moved:
  /// remove it and add another.
  void move_ground(GroundId ground, const RigidState& state);
  void remove_ground(GroundId ground);  ///< wakes what lies on it
  bool valid(GroundId ground) const;
  /// In a caller's world, names a body of the caller's whose forces (dBodyAddForce, joint motors) are to act
  /// through all substeps of a step. That is so without a call for a body whose geoms are in the caller's
  /// space, or that joints tie, directly or through others, to such a body or to a full one. Throws
  /// InputError for null and for a world of the manager's own.
  void include_body(dxBody* body);
  void exclude_body(dxBody* body);  ///< before it is destroyed; nothing for one that was not named

  /// The state must be finite, within 1e8 m of the origin, and its orientation within 1e-3 of unit length (it
  /// is normalised); velocities are limited to 1e6 m/s and rad/s. Mass is 1e-6 … 1e12 kg, importance
  /// positive, the material known, and the shape not thinner about an axis than every rung can take. A body
  /// that is forced full is full at once. Any other waits as it was given until the next step, which gives it
  /// its level, whatever the dwell and the cap; that does not count as a promotion. Of many that lie deep in
  /// each other all but four wait longer (Counters::bodies_held_back).
  BodyId add_body(const BodyDefinition& definition);
  void remove_body(BodyId body);

  // ---- Between steps ----

  void set_level(BodyId body, LevelChoice choice);      ///< from the next step on
  void set_importance(BodyId body, double importance);  ///< > 0, from the next step on
  /// With the ranges of add_body; wakes it and what it touches or touched.
  void set_state(BodyId body, const RigidState& state);
  void set_user_data(BodyId body, std::uintptr_t user_data);
  /// Whether its contacts make events, see BodyDefinition::events.
  void set_events(BodyId body, bool events);
  /// They hold on every rung. Wakes the body and, where the change alters what it meets, what it touches. A
  /// body whose properties are not all default is never at `tables`, whose loops know none of them, but at
  /// `support` instead, whatever was asked for. A kinematic body moves as its velocity says (set_state),
  /// through whatever it meets, and carries and pushes the others.
  void set_properties(BodyId body, const BodyProperties& properties);

  /// N, and N m about the centre of mass: act over the whole of the next step, added to those given before;
  /// wakes it. Their sum must be finite. A new body that the next step holds back
  /// (Counters::bodies_held_back) feels none of it.
  void add_force(BodyId body, const Vec3& force, const Vec3& torque = Vec3::Zero());
  /// N, at a point of the world (m) as the body is now.
  void add_force_at(BodyId body, const Vec3& force, const Vec3& point);
  /// N s, at a point of the world (m): changes the velocities at once, as state() shows; wakes it. Does
  /// nothing to a kinematic body.
  void add_impulse(BodyId body, const Vec3& impulse, const Vec3& point);

  /// Puts it to sleep where it is, even in the air, until something wakes it: a touch, a force, wake().
  /// Forces given for the next step are dropped.
  void sleep(BodyId body);
  void wake(BodyId body);  ///< it, and what is joined to it

  /// The rungs between which the policy keeps it, from the next step on. A LevelChoice that names a rung
  /// overrides this.
  void set_rung_range(BodyId body, Rung least, Rung greatest);
  /// Bodies that change rung together, all or none: by the distance of the nearest, at the cost of all. What
  /// wakes one of a sleeping group wakes all. Joints of the caller's (ode_body) pin a body at the full level,
  /// in a group or not, unless the group has GroupJoints. Throws InputError for an empty list, a body that is
  /// in it twice, and one that is in a group already. A group ends with the last of its bodies.
  GroupId make_group(std::span<const BodyId> bodies, GroupJoints joints = {});
  void dissolve_group(GroupId group);             ///< attaches its joints first, where they are off
  void set_policy(const PolicySettings& policy);  ///< from the next step on
  // From where the world is looked at, from the next step on; each replaces all viewpoints. Plain positions
  // (m, within 1e12 of the origin) see all around, in pictures of Viewpoint's default size. Without
  // viewpoints, as at first, every body counts as infinitely far: no policy makes one full then; why() says
  // so, and the log warns of it.
  void set_viewpoints(std::span<const Vec3> positions);
  void set_viewpoints(std::span<const Viewpoint> viewpoints);
  void set_viewpoints(std::initializer_list<Viewpoint> viewpoints);
  /// m/s², any finite one, zero too; wakes every body, if it is another than before. On a caller's world sets
  /// that world's; dWorldSetGravity by the caller does the same from the next step on.
  void set_gravity(const Vec3& gravity);
  void set_full_substeps(int substeps);            ///< ≥ 1
  void set_events(const EventSettings& settings);  ///< from the next step on
  void set_threads(int threads);                   ///< ≥ 1; of a caller's JobRunner: how many it has

  // ---- A step ----

  /// Advances every body by `dt` seconds, 1e-9 … 10, or 0. Zero is a pause: nothing happens, the report is
  /// that of the last step with a dt_s of 0, and the lists below are empty. A dt of more than .1 s, a hitch,
  /// is divided into equal parts of at most .1 s and counted (Counters::divided_steps). Throws InputError for
  /// any other dt, for a caller's world whose gravity is not finite, and if a signature that is needed cannot
  /// be had; then no body has moved (in a divided step: since the last complete part). A body whose signature
  /// is still being measured in the background is full, or at `support` without settling clips.
  const StepReport& step(double dt);

  /// In place of step(), for a caller who keeps his own dSpaceCollide and dWorldStep; only in a caller's
  /// world. before_world_step, before his dWorldStep or dWorldQuickStep of `dt` s (1e-9 … .1), chooses rungs,
  /// moves the statistical bodies and makes the contacts of the full ones, as joints in his world;
  /// after_world_step removes these and does the rest of a step. Between the two the caller may only read
  /// from the manager, and must neither destroy bodies or geoms nor attach joints to other bodies. Throws
  /// InputError where the two do not alternate.
  void before_world_step(double dt);
  const StepReport& after_world_step();

  // What the last step did, in an order that is the same in every run. Each list costs in proportion to its
  // own length, not to the number of bodies, and is valid until the next step. It still has the ids of bodies
  // that were removed since.
  /// Bodies that were awake. The others are where they were; but a sleeper that went to `tables`
  /// (rung_changes) may have turned by 1e-7 of a turn.
  std::span<const BodyId> moved() const;
  std::span<const BodyId> fell_asleep() const;  ///< asleep now, and not after the step before
  std::span<const BodyId> woke() const;         ///< awake now, and asleep after the step before
  /// In the order in which they were made, since the end of the step before; not those of new bodies.
  std::span<const RungChange> rung_changes() const;

  /// What touched what in the last step, between any two rungs, ground and the caller's geoms: see events.h.
  /// By the bodies' indices; in the same order in every run.
  std::span<const ContactEvent> contact_events() const;

  // ---- Reading ----

  int bodies() const;
  bool valid(BodyId body) const;  ///< the one call that takes a stale id
  bool valid(GroupId group) const;
  RigidState state(BodyId body) const;
  /// Of many at once: as many states as bodies.
  void read_states(std::span<const BodyId> bodies, std::span<RigidState> states) const;
  /// Three floats and four for each body: its centre of mass (m) and its orientation, w first as ODE has it.
  void read_poses(std::span<const BodyId> bodies, std::span<float> positions_xyz,
                  std::span<float> orientations_wxyz) const;
  double mass(BodyId body) const;  ///< kg
  const Shape& shape(BodyId body) const;
  std::uintptr_t user_data(BodyId body) const;
  /// Until they are set anew or a body is added or removed.
  const BodyProperties& properties(BodyId body) const;
  Level level(BodyId body) const;
  Rung rung(BodyId body) const;  ///< `support` for a body that waits for its first step
  bool asleep(BodyId body) const;
  /// m, of the sphere that stands for a body at `tables`; 0 on other rungs. In the published model everything
  /// meets this sphere. Otherwise planes and bodies meet the hull at its height towards them; only edges and
  /// sharply curved ground meet the sphere, of a body that touches no other.
  double collision_radius(BodyId body) const;
  Why explain(BodyId body) const;       ///< the rule that decided the level, and the figures behind it
  std::string why(BodyId body) const;   ///< the same in a sentence
  dxBody* ode_body(BodyId body) const;  ///< dBodyID while full, else null
  Vec3 gravity() const;                 ///< m/s², as of the last step
  const StepReport& report() const;     ///< of the last step
  /// Bytes of the arrays of `tables`, its cells and the store of sleepers; 0 while no body is at `tables`.
  /// The arrays of `support` are not counted.
  std::size_t statistical_bytes() const;
  /// All that the next steps depend on, as bytes for restore(): the bodies with their ids, what is remembered
  /// of contacts, sleepers, random draws, what the policy has learnt and put off, and the gravity of a world
  /// of the manager's own. It does not have the policy itself, hooks, ground, materials or the caller's own
  /// bodies. Only the same build can read it.
  std::vector<std::byte> snapshot() const;
  /// Goes back to a snapshot, of this manager or another; this one may have made no step yet. After it, the
  /// same calls give the same states, to the bit, as they gave the manager that the snapshot is of, on any
  /// number of threads. For that:
  /// - settings, policy, materials and ground must be the same, and in a caller's world his own geoms and
  ///   bodies must have been put back to where they were then;
  /// - the snapshot's shapes are looked for among `shapes` and those of the bodies here;
  /// - signatures are asked for as in a step, and waited for.
  /// Ids of bodies become those of the snapshot; an id given since may be given again. If the full bodies
  /// here are not those of the snapshot, all ODE bodies of the manager are made anew, in a caller's world
  /// after his own. Throws InputError, and changes nothing,
  /// - if the snapshot is damaged, or of another build, seed, material table or set of planes;
  /// - if a caller's world has another gravity now than the snapshot;
  /// - if a shape or a signature is missing;
  /// - if a group whose joints are off has no functions here (make the group before: one of the same id lends
  ///   it its own);
  /// - if a body that has to be made anew hangs on a joint (the caller's geoms count as having stood still
  ///   since the last step).
  void restore(std::span<const std::byte> snapshot,
               std::span<const std::shared_ptr<const Shape>> shapes = {});

  /// From now on passes every call that changes the manager, and what each step came to, to `write`: first a
  /// snapshot, then each call as it is made. Empty: ends the recording. It does not see what is done to the
  /// caller's own bodies, through ode_body(), or to materials; of a policy's functions it notes only whether
  /// there are any. If `write` throws, the recording has ended, and what it threw comes out of the next step,
  /// once that is done, or of this call.
  void set_record(RecordFunction write);
  /// Repeats a recording from its snapshot on, up to the first step in which the state of any body differs by
  /// a bit from what was recorded. See restore() for what must be the same, and for `shapes`, which must have
  /// those of bodies that the recording adds. The policy and full_substeps with which it began are not in it:
  /// set the same before. Where it sets a policy with functions, those of the policy here are used. Under a
  /// budget of milliseconds a difference is no fault, as rungs then depend on the clock. What lay between
  /// before_world_step and after_world_step is repeated as one dWorldStep. A recording that breaks off within
  /// a call, as when the program ended, is repeated as far as it goes. Throws InputError if the bytes are no
  /// recording, on reaching damage, where restore() would, and where the recording sets a policy with a
  /// function that the policy here lacks.
  ReplayResult replay(std::span<const std::byte> recording,
                      std::span<const std::shared_ptr<const Shape>> shapes = {});

  void set_log(LogFunction log);  ///< empty: none; what happens is counted in the report all the same
  void set_profile(ProfileHooks hooks);
  void draw(const DebugDrawer& drawer, const DrawSettings& settings = {}) const;

  std::uint64_t state_hash() const;  ///< of every body's state and level, in order of creation

  // ---- Queries (queries.h), of bodies and ground as they are now, and of the caller's bodies ----
  // Calls with many rays or volumes use the manager's threads. The very first query costs in proportion to
  // all bodies; the first after a step, or after something was moved, to those awake. So does every query
  // between before_world_step and after_world_step, where only one thread may ask. If the caller has dynamic
  // bodies, each call walks through his space, unless its filter leaves them out.

  /// The nearest hit; none: nothing is met.
  std::optional<QueryHit> cast_ray(const Ray& ray, const QueryFilter& filter = {}) const;
  std::optional<QueryHit> sweep_sphere(const SphereSweep& sphere, const QueryFilter& filter = {}) const;
  /// The nearest hit of each: `firsts` has as many places as there are rays or spheres.
  void cast_rays(std::span<const Ray> rays, std::span<std::optional<QueryHit>> firsts,
                 const QueryFilter& filter = {}) const;
  void sweep_spheres(std::span<const SphereSweep> spheres, std::span<std::optional<QueryHit>> firsts,
                     const QueryFilter& filter = {}) const;
  /// All that each meets, by distance: each body and piece of ground once. The lists are cleared first, and
  /// keep their capacity.
  void cast_rays_through(std::span<const Ray> rays, std::span<std::vector<QueryHit>> hits,
                         const QueryFilter& filter = {}) const;
  void sweep_spheres_through(std::span<const SphereSweep> spheres, std::span<std::vector<QueryHit>> hits,
                             const QueryFilter& filter = {}) const;
  /// All that each touches, contains or lies in: bodies by index, then ground, then what is the caller's.
  void overlap_spheres(std::span<const SphereVolume> spheres, std::span<std::vector<QueryHit>> hits,
                       const QueryFilter& filter = {}) const;
  void overlap_boxes(std::span<const BoxVolume> boxes, std::span<std::vector<QueryHit>> hits,
                     const QueryFilter& filter = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
