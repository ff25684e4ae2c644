// The engine's public face: bodies on three rungs, full (ODE trimesh), `support` (hull) and `tables`
// (sphere), moved between them by a policy. One step: 1 choose rungs, 2 transfer, 3 statistical rungs and
// their contacts with full bodies (3a to 3f: lod/rungs/statistical_level.h), 4 full level, with the impulses
// of those contacts, 5 report.
//
// SI units unless a name ends in another (`_ms`, `_px`), world frame right-handed, quaternions w, x, y, z.
//
// - Errors. Whatever is passed here at run time and cannot be used (a stale id, a number that is not finite
//   or out of the range given, a material that the table does not have) throws InputError (reference/error.h)
//   before anything has changed; nothing aborts for it. Where one of ODE's own assertions fails in a step,
//   that throws SimulationError (reference/simulation_error.h), and the manager can be read and destroyed,
//   and steps no more.
// - Ids. That of a removed body, ground or group is stale for good, though its index comes back: valid()
//   tells so, every other call throws.
// - Threads. A manager is used by one thread at a time; between two steps any number of threads may call its
//   const functions.
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
  /// An engine's own, for so many threads; empty: oneTBB's. What it throws in a step comes out of that once
  /// it has been taken.
  JobRunner jobs = {};
  int full_substeps = 4;       ///< ≥ 1, ODE steps per step; 16 while thin bodies are awake among others
  bool sleeping = true;        ///< bodies at rest cost nothing until something wakes them
  SleepThresholds sleep = {};  ///< on every rung
  /// That all statistical bodies have; none: what the policy finds, body by body.
  std::optional<StatisticalModel> model = {};
  TablesOptions tables = {};  ///< of the tables model
  PolicySettings policy = {};
  /// Processor time of each step for the audit: demoted bodies simulated on in full beside the world
  /// (AuditReport); 0: none. One step of one body may exceed it.
  double audit_ms = 0.0;
  /// Whether two bodies may meet, beside what their properties say; empty: all may. Asked about pairs that
  /// are near each other, in any order, from several threads and more than once a step: it must answer the
  /// same for the same two, whichever comes first, until the step is over, and not call the manager.
  PairFilter pair_filter = {};
  EventSettings events = {};          ///< which contacts step() tells of
  SignatureFunction signatures = {};  ///< empty: find_or_measure_signature with its defaults
  /// Whether a step waits for a signature or the body goes without meanwhile.
  SignatureTiming signature_timing = SignatureTiming::automatic;
};

class Manager {
 public:
  /// With an ODE world of its own, made when a first body is full.
  explicit Manager(const ManagerSettings& settings = {});
  /// On the caller's world and space (dWorldID, dSpaceID), with that world's gravity, which every rung
  /// follows when it changes; step() advances the caller's own bodies too. Static and kinematic geoms there,
  /// of whatever class, are ground of material 0 on every rung, and his dynamic bodies are met with impulses
  /// both ways; all of them may come, go and move between steps. World and space must outlive the manager.
  /// Bodies of two managers in one world do not meet each other, and a step() of one of them would move the
  /// full bodies of the other without their contacts: there all call before_world_step, then the world steps
  /// once, then all call after_world_step.
  Manager(dxWorld* world, dxSpace* space, const ManagerSettings& settings = {});
  ~Manager();
  Manager(Manager&&) noexcept;
  Manager& operator=(Manager&&) noexcept;

  // ---- The scene ----

  /// Materials are added before the bodies that use them.
  MaterialTable& materials();

  // Ground of bodies on every rung, not of the caller's own, who makes these' contacts with his geoms alone;
  // what comes to lie in it wakes.
  /// normal·x = offset (m); the normal's length within 1e-3 of 1.
  GroundId add_plane(const Vec3& normal, double offset, MaterialId material = 0);
  /// Vertices in the world frame, m, each coordinate within 1e6; two faces or more, one at least with an
  /// area.
  GroundId add_static_mesh(const Mesh& mesh, MaterialId material = 0);
  /// Full sides, the longest 1e-4 … 1e6 m, none below 2e-6 of it.
  GroundId add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation,
                          MaterialId material = 0);
  /// Puts a box or mesh elsewhere (a mesh was made at the origin, unturned) and wakes what is near. With a
  /// velocity it carries what lies on it, on every rung: `state` is that at the beginning of the step to
  /// come, within which it goes on from there; after it it stands where it was put again, as queries see it,
  /// until it is moved: each time before a step, and once without a velocity at the end. Who only gives it a
  /// velocity has a belt. Put on before each step without one it pushes what it meets. A plane is removed and
  /// added anew.
  void move_ground(GroundId ground, const RigidState& state);
  void remove_ground(GroundId ground);  ///< wakes what lies on it; its id is never valid again
  bool valid(GroundId ground) const;
  /// In a caller's world. Forces that the caller gives a body of his own (dBodyAddForce, joint motors) act
  /// for the whole of a step if its geoms are in his space, or if joints tie it, through others too, to one
  /// whose are or to a full body. Any other dBodyID is named here, until it is destroyed. Throws InputError
  /// for null and for a world of the manager's own.
  void include_body(dxBody* body);
  void exclude_body(dxBody* body);  ///< before it is destroyed; nothing for one that was not named

  /// The state must be finite, within 1e8 m of the origin, its orientation within 1e-3 of unit length (it is
  /// normalised); velocities beyond 1e6 m/s or rad/s are taken as these. Mass is 1e-6 … 1e12 kg, importance
  /// positive, the material known, the shape no thinner about an axis than every rung can take. A body that
  /// is forced full is so at once. Any other gets its level in its next step, whatever the dwell and the cap;
  /// that is not counted as a promotion, and until then the body waits as it was given. Of many at one place
  /// (deep in each other) all but four wait longer: Counters::bodies_held_back.
  BodyId add_body(const BodyDefinition& definition);
  void remove_body(BodyId body);  ///< its id is never valid again

  // ---- Between steps ----

  void set_level(BodyId body, LevelChoice choice);      ///< from the next step on
  void set_importance(BodyId body, double importance);  ///< > 0, from the next step on
  /// With the ranges of add_body; wakes it and what it touches or touched.
  void set_state(BodyId body, const RigidState& state);
  void set_user_data(BodyId body, std::uintptr_t user_data);
  /// Whether its contacts make events, see BodyDefinition::events.
  void set_events(BodyId body, bool events);
  /// Kept on every rung; wakes it, and what it touches where it is to meet others, or to be met by them,
  /// otherwise. A body whose properties are not all default is never at `tables`, whose
  /// loops know none of them, but at `support` instead, whatever was asked for. A kinematic body moves as its
  /// velocity says (set_state), through whatever it meets, and carries and pushes the others.
  void set_properties(BodyId body, const BodyProperties& properties);

  /// N and N m about the centre of mass, over the whole of the next step, on top of those given before; wakes
  /// it. Their sum must be finite. A new body that this step holds back (StepReport's counter
  /// `bodies_held_back`) feels none of it.
  void add_force(BodyId body, const Vec3& force, const Vec3& torque = Vec3::Zero());
  /// N, at a point of the world (m) as the body is now.
  void add_force_at(BodyId body, const Vec3& force, const Vec3& point);
  /// N s, at a point of the world (m): changes the velocities at once, as state() shows; wakes it. Nothing on
  /// a kinematic body.
  void add_impulse(BodyId body, const Vec3& impulse, const Vec3& point);

  /// Lays it still where it is, even in the air, until something wakes it: a touch, a force, wake(). Forces
  /// given for the next step are dropped.
  void sleep(BodyId body);
  void wake(BodyId body);  ///< it, and what is joined to it

  /// Between which rungs the policy keeps it, from the next step on; a LevelChoice that names a rung goes
  /// before it.
  void set_rung_range(BodyId body, Rung least, Rung greatest);
  /// Bodies that change rung together, all or none, as the nearest of them and at the cost of all; what wakes
  /// one of a sleeping group wakes all. Joints of the caller's (ode_body) pin a body at the full level, in a
  /// group or not, unless the group has GroupJoints. Refused are no body, one twice, and one that is in a
  /// group already. A group ends with the last of its bodies.
  GroupId make_group(std::span<const BodyId> bodies, GroupJoints joints = {});
  void dissolve_group(GroupId group);             ///< puts its joints on first, where they are off
  void set_policy(const PolicySettings& policy);  ///< from the next step on
  // From where the world is looked at, from the next step on; positions (m, within 1e12 of the origin) alone
  // see all around, in pictures as Viewpoint has them. Where there is none, as at first, every body is as far
  // as can be: no policy makes one full then, which why() says, and the log as a warning.
  void set_viewpoints(std::span<const Vec3> positions);
  void set_viewpoints(std::span<const Viewpoint> viewpoints);
  void set_viewpoints(std::initializer_list<Viewpoint> viewpoints);
  /// m/s², any finite one, zero too; wakes every body. On a caller's world sets that world's;
  /// dWorldSetGravity by the caller does the same from the next step on.
  void set_gravity(const Vec3& gravity);
  void set_full_substeps(int substeps);            ///< ≥ 1
  void set_events(const EventSettings& settings);  ///< from the next step on
  void set_threads(int threads);                   ///< ≥ 1; of a caller's JobRunner: how many it has

  // ---- A step ----

  /// Advances every body by `dt` seconds, 1e-9 … 10, or 0. Zero is a pause: nothing happens, the report is
  /// that of the last step with a dt_s of 0, and the lists below are empty. More than .1 s, a hitch, is
  /// divided into equal parts of at most .1 s and counted (Counters::divided_steps). Throws InputError for
  /// any other dt, for a caller's world whose gravity is not finite, and where a signature that is needed
  /// cannot be had: then no body has moved (of a divided step: beyond the parts before). A body whose
  /// signature a thread is still measuring is at `support`, without settling clips, where it is not full.
  const StepReport& step(double dt);

  /// For a caller who keeps his own dSpaceCollide and dWorldStep, on his world alone. Before his dWorldStep
  /// or dWorldQuickStep of `dt` s, 1e-9 … .1: chooses rungs, moves the statistical bodies and makes the
  /// contacts of the full ones, as joints in his world; after it: removes these and does what else a step
  /// does. Both in place of step(). Between the two he calls nothing else of the manager but what reads,
  /// destroys neither bodies nor geoms, and attaches no joint elsewhere. Throws InputError where the two do
  /// not take turns.
  void before_world_step(double dt);
  const StepReport& after_world_step();

  // What the last step did, in an order that is the same in every run. Each list costs in proportion to what
  // it holds, never to all bodies, and is good until the next step; ids of bodies that were removed since are
  // in it still.
  /// That were awake; the others are where they were, a sleeper that went to `tables` to 1e-7 of a turn (see
  /// rung_changes).
  std::span<const BodyId> moved() const;
  std::span<const BodyId> fell_asleep() const;  ///< asleep now, and not after the step before
  std::span<const BodyId> woke() const;         ///< awake now, and asleep after the step before
  /// In the order in which they were made, from the end of the step before on; not of new bodies.
  std::span<const RungChange> rung_changes() const;

  /// What touched what in the last step, between any two rungs, ground and the caller's geoms: see events.h.
  /// By the bodies' indices; in the same order in every run.
  std::span<const ContactEvent> contact_events() const;

  // ---- Reading ----

  int bodies() const;
  bool valid(BodyId body) const;  ///< the one question that a stale id answers
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
  /// m, of the sphere that stands for a body at `tables`; 0 on other rungs. As published, everything meets
  /// it; else only edges and ground that turns sharply do, of a body that touches no other: planes and bodies
  /// meet heights of its hull.
  double collision_radius(BodyId body) const;
  Why explain(BodyId body) const;       ///< the rule that decided the level, and the figures behind it
  std::string why(BodyId body) const;   ///< the same in a sentence
  dxBody* ode_body(BodyId body) const;  ///< dBodyID while full, else null
  Vec3 gravity() const;                 ///< m/s², as of the last step
  const StepReport& report() const;     ///< of the last step
  /// Held by the arrays of `tables`, its cells and the store of sleepers; 0 where no body is at `tables`:
  /// those of `support` are not counted.
  std::size_t statistical_bytes() const;
  /// All that its next steps depend on, as bytes for restore(): the bodies with their ids, what is remembered
  /// of contacts, sleepers, random draws, what the policy has learnt and put off, and the gravity of a world
  /// of the manager's own. Not the policy itself, hooks, ground and materials, nor the caller's own bodies.
  /// Only the same build reads it.
  std::vector<std::byte> snapshot() const;
  /// From then on steps give the same states, to the bit, as they gave the manager that the snapshot is of,
  /// on any number of threads, if the same is done to it and, in a caller's world, his own geoms and bodies
  /// are as they were then: put them so before. That manager or another, even one that has made no step: with
  /// the same settings, policy, materials and ground. Its shapes are looked for among `shapes` and those of
  /// the bodies here. Ids of bodies are those of the snapshot; one given since may be given again. Where the
  /// full bodies are not those that the snapshot has, all ODE bodies of the manager are made anew, in a
  /// caller's world after his own. Throws InputError, and nothing has changed, where the snapshot is damaged
  /// or of another build, seed, material table or set of planes, in a caller's world of another gravity than
  /// it has now, where a shape or a signature is missing, a group whose joints are off has no functions here
  /// (make it before: a group of the same id lends it its own), or a body that is made anew hangs on a joint
  /// (there the caller's geoms count as having stood still since the last step). What its bodies move by is
  /// asked for as in a step, and waited for.
  void restore(std::span<const std::byte> snapshot,
               std::span<const std::shared_ptr<const Shape>> shapes = {});

  /// From now on every call that changes the manager, and what each step came to, goes to `write`: first a
  /// snapshot, then each call as it is made. Empty: no more. What is done to the caller's own bodies and
  /// through ode_body() is not seen, nor are materials; of a policy's functions only whether there are any.
  /// Where `write` throws, the recording has ended; what it threw comes out of the next step, once that is
  /// done, or of this.
  void set_record(RecordFunction write);
  /// Does again what a recording tells, from its snapshot on (see restore, also for `shapes`, which must have
  /// those of bodies that it adds; neither has the policy or the full_substeps of the beginning), up to the
  /// first step that comes out otherwise than recorded, in the state of any body to the bit. Under a budget
  /// of milliseconds that is no fault, as rungs follow the clock. What lay between before_world_step and
  /// after_world_step is done again as one dWorldStep. One that ends in the midst of a call, as where the
  /// program ended, is done as far as it goes. Throws InputError for what is no recording, where it comes to
  /// what is damaged, where restore does, and where it sets a policy with a function that the policy here
  /// lacks, whose functions are used.
  ReplayResult replay(std::span<const std::byte> recording,
                      std::span<const std::shared_ptr<const Shape>> shapes = {});

  void set_log(LogFunction log);  ///< empty: none; what happens is counted in the report all the same
  void set_profile(ProfileHooks hooks);
  void draw(const DebugDrawer& drawer, const DrawSettings& settings = {}) const;

  std::uint64_t state_hash() const;  ///< of every body's state and level, in order of creation

  // ---- Queries (queries.h), of bodies and ground as they are now, and of the caller's bodies ----
  // Many at once go to the threads. The first one after a step, or after something was moved, costs in
  // proportion to what is awake, as do all between before_world_step and after_world_step, where one thread
  // may ask; the very first, to all bodies. Where the caller has dynamic bodies, each
  // call walks through his space, unless its filter leaves them out.

  /// The nearest; none: nothing is met.
  std::optional<QueryHit> cast_ray(const Ray& ray, const QueryFilter& filter = {}) const;
  std::optional<QueryHit> sweep_sphere(const SphereSweep& sphere, const QueryFilter& filter = {}) const;
  /// Of each one the nearest: as many as rays or spheres.
  void cast_rays(std::span<const Ray> rays, std::span<std::optional<QueryHit>> firsts,
                 const QueryFilter& filter = {}) const;
  void sweep_spheres(std::span<const SphereSweep> spheres, std::span<std::optional<QueryHit>> firsts,
                     const QueryFilter& filter = {}) const;
  /// Of each one all that it meets, by distance: each body and piece of ground once. The lists are emptied
  /// before, and keep their room.
  void cast_rays_through(std::span<const Ray> rays, std::span<std::vector<QueryHit>> hits,
                         const QueryFilter& filter = {}) const;
  void sweep_spheres_through(std::span<const SphereSweep> spheres, std::span<std::vector<QueryHit>> hits,
                             const QueryFilter& filter = {}) const;
  /// Of each one all that it touches or contains or lies in: bodies by index, then ground, then what is the
  /// caller's.
  void overlap_spheres(std::span<const SphereVolume> spheres, std::span<std::vector<QueryHit>> hits,
                       const QueryFilter& filter = {}) const;
  void overlap_boxes(std::span<const BoxVolume> boxes, std::span<std::vector<QueryHit>> hits,
                     const QueryFilter& filter = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
