// Rigid bodies simulated by the Open Dynamics Engine (ODE): the ground truth, the full level and its
// baselines. ODE stays behind this file. Pitfalls that it takes care of: trimesh–trimesh contacts are
// filtered (contact_filter.h), plane contacts come from hull vertices, messages are counted and not printed,
// QuickStep's global generator is seeded from (seed, step), sleeping neighbours wake on removal, bodies
// faster than they are thick stop at what they would have passed through (sweep_ode.h), every value is
// checked before ODE could abort on it. What a caller passes wrongly throws InputError and changes nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "reference/body_properties.h"
#include "reference/geometry.h"
#include "reference/material.h"
#include "reference/mesh/simplified_shapes.h"
#include "reference/ode/space_mirror.h"
#include "reference/shape.h"

struct dxWorld;  // ODE's own types (dWorldID is dxWorld*), so that no header includes ODE
struct dxSpace;
struct dxBody;
struct dxGeom;

namespace lodestone {

class StateArchive;

/// How two trimeshes meet.
enum class MeshContacts {
  plain,     ///< as ODE's dCollide finds them
  filtered,  ///< as it finds them, made believable (contact_filter.h)
  /// Two convex bodies by their hulls (hull_manifold.h), which bound the same solids; others filtered.
  exact,
};

/// ODE's own, for bodies that something holds: one slower than this for long enough is put to rest.
struct SleepLaw {
  double speed = 0.05;          ///< m/s, of its centre of mass
  double turning_speed = 0.05;  ///< m/s, of its farthest point about that
  double time = 0.5;            ///< s
};

struct OdeSettings {
  Vec3 gravity{0, 0, -9.81};  ///< m/s²
  std::uint64_t seed = 1;
  bool quick_step = false;  ///< dWorldQuickStep instead of dWorldStep (another friction law)
  int quick_step_iterations = 20;
  /// Of g h²: overlap that is left to bodies whose last substep was QuickStep's, as by ODE's contact surface
  /// layer. Pushed apart to nothing, they are parted by what its iterations leave of an error, fall for a
  /// substep and land again: a heap never comes to rest.
  double quick_step_layer = 0.0;
  /// Contacts of one island above which a substep is QuickStep's: dWorldStep's time grows with their cube.
  /// The second where bodies that touch differ twelvefold in mass.
  int direct_contacts_max = 1 << 30, uneven_direct_contacts_max = 1 << 30;
  /// ODE's error reduction and constraint force mixing (s/kg) at contacts; less, in proportion, for bodies
  /// above 100 kg, whose impacts it would soften.
  double erp = 0.2, cfm = 1e-10;
  double bounce_velocity = 0.05;  ///< m/s, slower contacts do not bounce
  /// m/s, how fast overlap is pushed apart (ODE's own default: unlimited).
  double max_correcting_velocity = 1e9;
  /// s: a shorter substep undoes less of an overlap, in proportion: by the same part it would push the faster
  /// the shorter it is.
  double correcting_time = 0.0;
  /// False: along ODE's own choice of axes, so that friction depends on the compass direction.
  bool friction_along_slip = true;
  /// What a force or torque drives, and slides as a whole, hardly turning, has Coulomb's friction across its
  /// way, the less the faster it is. False: a bound of its own, by which it goes as on rails.
  bool slides_straight = false;
  int max_contacts_per_pair = 8;
  MeshContacts mesh_contacts = MeshContacts::exact;
  /// Of the contacts of two concave meshes in a substep: after so many the search for their directions ends
  /// (contact_filter.h).
  int most_mesh_measures = 1 << 30;
  /// False: dCollide of the trimesh with the plane, brute force over all faces.
  bool plane_contacts_from_hull = true;
  /// Over the shape's size: a hull vertex that would sink deeper into a plane within the step bounces
  /// beforehand.
  double plane_depth_max = 1e9;
  /// In substeps longer than the first and no longer than the second (s) a hull's contacts with planes are
  /// answered at their own time, where it touches nothing else (timed_contacts.h). Nowhere unless the first
  /// is set.
  double timed_contacts_above = 1e9, timed_contacts_up_to = 0.01;
  bool gyroscopic = true;
  bool hash_space = false;    ///< ODE's hash space as the broad phase instead of sweep and prune
  bool auto_disable = false;  ///< bodies at rest fall asleep
  SleepLaw sleep = {};
};

/// What a body is to ODE's collision detection. `hull` is a trimesh of the hull: ODE's own dConvex gives one
/// contact a pair, on which nothing stacks. `sphere` has the shape's volume. `box` is ODE's primitive, with
/// the sides of the shape's bounding box, whose centre must be that of mass.
enum class OdeGeometry { trimesh, hull, spheres, sphere, box };

/// A body of an OdeWorld; stays valid until removed. Zero is null.
struct OdeBodyId {
  std::uint32_t value = 0;
  explicit operator bool() const { return value != 0; }
  friend bool operator==(OdeBodyId, OdeBodyId) = default;
};

struct OdeBodyDefinition {
  std::shared_ptr<const Shape> shape{};
  double mass = 1.0;  ///< kg
  MaterialId material = 0;
  RigidState state{};
  OdeGeometry geometry = OdeGeometry::trimesh;
  std::span<const Sphere> spheres = {};  ///< for OdeGeometry::spheres, about the centre of mass
  BodyProperties properties = {};
};

/// Since the world was made.
struct OdeCounters {
  std::int64_t bodies_created = 0, trimeshes_built = 0, contacts = 0, contacts_dropped = 0, messages = 0,
               quick_steps = 0, states_recovered = 0;
  /// Times that a body was wholly inside another in a substep (both meshes, one of them concave).
  std::int64_t swallowed = 0;
  /// Times that a body would have gone through another, or through ground, within a substep.
  std::int64_t passes_prevented = 0;
  /// Contacts, in substeps by QuickStep, of bodies 100 times as heavy as each other: it lets the heavy one
  /// sink in.
  std::int64_t uneven_contacts = 0;
};

/// What ODE said last on the calling thread, at most 255 characters; empty where it has said nothing. Until
/// its next message.
std::string_view last_ode_message();

/// Wall time of the last step(), all its substeps, ms.
struct OdeTimes {
  double collision_ms = 0.0;  ///< finding the contacts
  double response_ms = 0.0;   ///< ODE's own step
};

/// Two of this world's bodies that touched in the last substep (`second` null: static ground or a body of the
/// caller's).
struct OdeContact {
  OdeBodyId first, second;
  Vec3 point, normal;            ///< world; the normal points from `second` into `first`
  double depth;                  ///< m, ≥ 0
  Vec3 velocity = Vec3::Zero();  ///< m/s, at the point, of what is no body of this world's
  bool moves = false;            ///< that does, or was moved before this step
  Vec3 first_arm = Vec3::Zero(),
       second_arm = Vec3::Zero();  ///< m, body axes: where the point was on each; none of what is no body
  std::int32_t callers_slot = -1;  ///< of its geom in the mirror: of a dynamic body of the caller's
  double above = 0.0;              ///< m, ≥ 0: by which they had not met yet when it was found
  MaterialId second_material = 0;  ///< of ground, too
};

/// Ground of an OdeWorld; stays valid until removed. Zero is null.
struct OdeGroundId {
  std::uint32_t value = 0;
  explicit operator bool() const { return value != 0; }
  friend bool operator==(OdeGroundId, OdeGroundId) = default;
};

/// A body of this world's, and what it touched in the last step: another (`second`), ground of this world's,
/// or a geom of the caller's.
struct OdeTouch {
  OdeBodyId first, second = {};
  OdeGroundId ground = {};
  dxGeom* callers_geom = nullptr;
  MaterialId first_material = 0, second_material = 0;
  Vec3 point = Vec3::Zero(),
       normal = Vec3::UnitZ();  ///< m and unit, world, where it was hardest; the normal points into `first`
  double impulse = 0.0;         ///< N s, along the normals, all contacts and substeps together
  double approach = 0.0;  ///< m/s, the greatest along a normal before a substep; 0 where they only parted
  bool at_end = true;     ///< in the last substep, too
};

class OdeWorld {
 public:
  /// A world of its own. `materials` must outlive it.
  OdeWorld(const OdeSettings& settings, const MaterialTable& materials);
  /// Joins the caller's world and space (dWorldID, dSpaceID), both of which must outlive it. Static geoms and
  /// other bodies there are met, with material 0, and stepped; their contacts with each other remain the
  /// caller's to make, before step(), and last all its substeps. So do forces that he gives his bodies (see
  /// include_body). Of `settings` those of a whole world (gravity, QuickStep's iterations) are left as the
  /// caller has them. His space may be of any type and change at any time between steps. Our geoms are in a
  /// space of their own that his knows nothing of; the caller must not collide trimeshes on another thread
  /// meanwhile.
  OdeWorld(dxWorld* world, dxSpace* space, const OdeSettings& settings, const MaterialTable& materials);
  ~OdeWorld();
  OdeWorld(OdeWorld&&) noexcept;
  OdeWorld& operator=(OdeWorld&&) noexcept;

  /// Ground that nothing pushes. Each throws InputError where it cannot be.
  OdeGroundId add_plane(const Vec3& normal, double offset,
                        MaterialId material);  ///< normal·x = offset, normal of unit length
  OdeGroundId add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation,
                             MaterialId material);
  OdeGroundId add_static_mesh(const Mesh& mesh, MaterialId material);
  /// A box's or mesh's (which begins at the origin, unturned); wakes what is near where it was and where it
  /// is. With a velocity (m/s and rad/s, world) it carries what touches it: it goes on from there through the
  /// substeps of each step, and after it stands where it was put again, until the caller moves it, before the
  /// next. A plane cannot be moved.
  void move_ground(OdeGroundId ground, const RigidState& state);
  void remove_ground(OdeGroundId ground);  ///< wakes what is near it
  /// The next steps are parts of one that began `gone` s ago (0: no more): ground that was moved for that has
  /// gone on since.
  void go_on(double gone);

  /// Throws InputError where mass ≤ 0 or the state is not finite or beyond 1e8 m. The first body of a shape
  /// builds its trimesh data, shared by the rest.
  OdeBodyId add_body(const OdeBodyDefinition& definition);
  /// Wakes what touched it (the caller's bodies, too, in the next step), unless it `stays` where it is, as
  /// something else.
  void remove_body(OdeBodyId body, bool stays = false);

  /// Advances by `dt` seconds in `substeps` equal steps: collide, then dWorldStep (or QuickStep). Nearly free
  /// while all bodies sleep. A body whose state stops being finite is put back to its last good pose at rest,
  /// and counted. A substep that ODE's solver gives up on is repeated a little softer (not in a caller's
  /// world). Throws SimulationError once an assertion in ODE fails.
  void step(double dt, int substeps = 1);

  /// For a caller who keeps a loop of his own. Before his dWorldStep or dWorldQuickStep of `dt` seconds:
  /// makes the contacts of this world's bodies, as joints in his world; and after it: removes them, and does
  /// what else step() does after a substep. Between the two he destroys neither bodies nor geoms, and steps
  /// once.
  void begin_callers_step(double dt);
  void end_callers_step();

  /// Looks at what the caller did since the last step: what his space holds, and bodies here that he spoilt,
  /// which are put back; each step does so first.
  void look_at_callers_space();
  /// Where no step follows: until the next look nothing of what was seen is touched, as the caller may change
  /// it.
  void look_away();
  /// As seen then; null in a world of its own.
  const SpaceMirror* callers_space() const;
  /// Forces that the caller gives a body (dBodyAddForce, dBodyAddTorque, the motors of joints) act for the
  /// whole of the next step(), as gravity does, if its geoms are in his space, or if joints tie it, through
  /// others too, to a body whose are or to one of ours. Any other is to be named here, until it is destroyed.
  void include_body(dxBody* body);
  void exclude_body(dxBody* body);
  /// The caller's forces of the last step() act in the next one, too, for one that is done in parts.
  void repeat_callers_forces();

  RigidState state(OdeBodyId body) const;
  const Shape& shape(OdeBodyId body) const;
  void set_state(OdeBodyId body, const RigidState& state);  ///< leaves sleep as it is
  /// N and N m, over the whole of the next step(); does not wake.
  void add_force(OdeBodyId body, const Vec3& force, const Vec3& torque);
  /// N and N m, by what holds the body up besides ODE's contacts and joints: over the whole of the next
  /// step(), and while the body sleeps. (In the step in which ODE wakes it, it would fall.)
  void hold(OdeBodyId body, const Vec3& force, const Vec3& torque);
  bool asleep(OdeBodyId body) const;
  void set_asleep(OdeBodyId body, bool asleep);  ///< wakes what is joined to it, too
  const BodyProperties& properties(OdeBodyId body) const;
  void set_properties(OdeBodyId body, const BodyProperties& properties);  ///< does not wake
  void set_sleep_law(const SleepLaw& law);
  /// Whether two bodies of this world's may meet, beside what their bits say; empty: always. Asked in each
  /// substep of each two that come near each other.
  void set_pair_filter(std::function<bool(OdeBodyId, OdeBodyId)> filter);
  dxBody* ode_body(OdeBodyId body) const;  ///< dBodyID, for joints and the like

  /// In the next step neither it nor what hangs together with it falls asleep: something moves it on.
  void keep_awake(OdeBodyId body);

  /// All that the next steps depend on, save ground and settings. Where it reads, bodies are kept if the
  /// writer had the very same ones; else all are made anew, with another dBodyID. Throws InputError, and
  /// nothing has changed, where one of those has a joint.
  void archive(StateArchive& a);
  /// As if it had never had a body, or made a step.
  void begin_anew();

  std::span<const OdeContact> contacts() const;  ///< of the last substep
  /// From the next step on; costs a little for each contact.
  void record_touches(bool on);
  std::span<const OdeTouch> touches() const;  ///< of the last step; none unless they are recorded
  const OdeCounters& counters() const;
  const OdeTimes& times() const;
  dxWorld* ode_world() const;  ///< an own world is stepped only while a body of this OdeWorld's is awake

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
