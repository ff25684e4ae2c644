// Rigid bodies simulated by the Open Dynamics Engine (ODE): the ground truth, the full level and its baselines.
// ODE stays behind this file. Pitfalls that it takes care of: trimesh–trimesh contacts are filtered (contact_filter.h), plane
// contacts come from hull vertices, messages are counted and not printed, QuickStep's global generator is seeded from
// (seed, step), sleeping neighbours wake on removal, bodies faster than they are thick stop at what they would have passed through (sweep_ode.h), every
// value is checked before ODE could abort on it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "reference/geometry.h"
#include "reference/material.h"
#include "reference/shape.h"
#include "reference/mesh/simplified_shapes.h"

struct dxWorld;  // ODE's own types (dWorldID is dxWorld*), so that no header includes ODE
struct dxSpace;
struct dxBody;

namespace lodestone {

/// How two trimeshes meet.
enum class MeshContacts {
  plain,     ///< as ODE's dCollide finds them
  filtered,  ///< as it finds them, made believable (contact_filter.h)
  exact,     ///< two convex bodies by their hulls (hull_manifold.h), which bound the same solids; others filtered
};

struct OdeSettings {
  Vec3 gravity{0, 0, -9.81};            ///< m/s²
  std::uint64_t seed = 1;
  bool quick_step = false;              ///< dWorldQuickStep instead of dWorldStep (another friction law)
  int quick_step_iterations = 20;
  int direct_contacts_max = 1 << 30;    ///< contacts of one island above which a substep is QuickStep's: dWorldStep's time grows with their cube
  double erp = 0.2, cfm = 1e-10;        ///< ODE's error reduction and constraint force mixing (s/kg) at contacts; less, in proportion, for bodies above 100 kg, whose
                                        ///< impacts it would soften
  double bounce_velocity = 0.05;        ///< m/s, slower contacts do not bounce
  double max_correcting_velocity = 1e9; ///< m/s, how fast overlap is pushed apart (ODE's own default: unlimited)
  bool friction_along_slip = true;      ///< false: along ODE's own choice of axes, so that friction depends on the compass direction
  int max_contacts_per_pair = 8;
  MeshContacts mesh_contacts = MeshContacts::exact;
  int most_mesh_measures = 1 << 30;     ///< of the contacts of two concave meshes in a substep: after so many the search for their directions ends (contact_filter.h)
  bool plane_contacts_from_hull = true; ///< false: dCollide of the trimesh with the plane, brute force over all faces
  double plane_depth_max = 1e9;         ///< over the shape's size: a hull vertex that would sink deeper into a plane within the step bounces beforehand
  /// In substeps longer than the first and no longer than the second (s) a hull's contacts with planes are answered at their own time, where it
  /// touches nothing else (timed_contacts.h). Nowhere unless the first is set.
  double timed_contacts_above = 1e9, timed_contacts_up_to = 0.01;
  bool gyroscopic = true;
  bool hash_space = false;              ///< ODE's hash space as the broad phase instead of sweep and prune
  bool auto_disable = false;            ///< ODE's sleeping: below .05 m/s and .05/R rad/s for .5 s
};

/// What a body is to ODE's collision detection. `hull` is a trimesh of the hull: ODE's own dConvex gives one contact a pair, on which nothing stacks.
/// `sphere` has the shape's volume. `box` is ODE's primitive, with the sides of the shape's bounding box, whose centre must be that of mass.
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
};

/// Since the world was made.
struct OdeCounters {
  std::int64_t bodies_created = 0, trimeshes_built = 0, contacts = 0, contacts_dropped = 0, messages = 0, quick_steps = 0, states_recovered = 0;
  std::int64_t swallowed = 0;  ///< times that a body was wholly inside another in a substep (both meshes, one of them concave)
  std::int64_t passes_prevented = 0;  ///< times that a body would have gone through another, or through ground, within a substep
  std::int64_t uneven_contacts = 0;   ///< contacts, in substeps by QuickStep, of bodies 100 times as heavy as each other: it lets the heavy one sink in
};

/// Wall time of the last step(), all its substeps, ms.
struct OdeTimes {
  double collision_ms = 0.0;  ///< finding the contacts
  double response_ms = 0.0;   ///< ODE's own step
};

/// Two of this world's bodies that touched in the last substep (`second` null: static ground or a body of the caller's).
struct OdeContact {
  OdeBodyId first, second;
  Vec3 point, normal;  ///< world; the normal points from `second` into `first`
  double depth;        ///< m, ≥ 0
};

class OdeWorld {
 public:
  /// A world of its own. `materials` must outlive it.
  OdeWorld(const OdeSettings& settings, const MaterialTable& materials);
  /// Joins the caller's world and space (dWorldID, dSpaceID), both of which must outlive it. Static geoms and other bodies there are met, with
  /// material 0, and stepped; their contacts with each other remain the caller's to make, before step(), and last all its substeps. Of `settings` those of
  /// a whole world (gravity, QuickStep's iterations) are left as the caller has them. Our geoms are in a space of their own within his,
  /// hidden from his dSpaceCollide (cast rays into ode_space() to meet them); the caller must not collide trimeshes on another thread meanwhile.
  OdeWorld(dxWorld* world, dxSpace* space, const OdeSettings& settings, const MaterialTable& materials);
  ~OdeWorld();
  OdeWorld(OdeWorld&&) noexcept;
  OdeWorld& operator=(OdeWorld&&) noexcept;

  void add_plane(const Vec3& normal, double offset, MaterialId material);  ///< normal·x = offset, normal of unit length
  void add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material);
  void add_static_mesh(const Mesh& mesh, MaterialId material);

  /// Aborts where mass ≤ 0 or the state is not finite or beyond 1e8 m. The first body of a shape builds its trimesh data, shared by the rest.
  OdeBodyId add_body(const OdeBodyDefinition& definition);
  /// Wakes what touched it, the caller's bodies too, unless it `stays` where it is, as something else.
  void remove_body(OdeBodyId body, bool stays = false);

  /// Advances by `dt` seconds in `substeps` equal steps: collide, then dWorldStep (or QuickStep). Nearly free while all bodies sleep. A body whose state stops being finite is
  /// put back to its last good pose at rest, and counted. A substep that ODE's solver gives up on is repeated a little softer (not in a caller's world).
  void step(double dt, int substeps = 1);

  RigidState state(OdeBodyId body) const;
  void set_state(OdeBodyId body, const RigidState& state);  ///< leaves sleep as it is
  void add_force(OdeBodyId body, const Vec3& force, const Vec3& torque);  ///< N and N m, over the whole of the next step(); does not wake
  bool asleep(OdeBodyId body) const;
  void set_asleep(OdeBodyId body, bool asleep);
  dxBody* ode_body(OdeBodyId body) const;                    ///< dBodyID, for joints and the like

  std::span<const OdeContact> contacts() const;              ///< of the last substep
  const OdeCounters& counters() const;
  const OdeTimes& times() const;
  dxWorld* ode_world() const;                                ///< an own world is stepped only while a body of this OdeWorld's is awake
  dxSpace* ode_space() const;                                ///< dSpaceID that holds this world's bodies

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
