// The bodies of one OdeWorld: slots that ids point into, and the way between ODE's bodies and ours.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reference/ode/geometry_ode.h"
#include "reference/ode/ode_world.h"
#include "reference/ode/piece_contacts.h"
#include "reference/ode/runtime_ode.h"
#include "reference/ode/timed_contacts.h"
#include "reference/state_archive.h"

namespace lodestone::ode {

struct Body {
  dBodyID body = nullptr;  ///< null in a free slot
  bool is_awake() const { return body && dBodyIsEnabled(body); }
  double mass() const {  ///< kg
    dMass mass;
    dBodyGetMass(body, &mass);
    return mass.mass;
  }
  std::uint32_t generation = 0;
  OdeBodyId id{};
  MaterialId material = 0;
  std::shared_ptr<const Shape> shape;
  std::vector<Sphere> spheres;  ///< empty: a mesh, and its contacts with planes are those of the hull
  /// Convex, whose union is the body; none where it is met as a trimesh or as primitives.
  std::vector<Piece> pieces;
  double reach = 0.0;  ///< m, nothing of the body is farther from its centre of mass
  /// m, radius of a ball about its centre of mass that its hull, or its sphere, contains.
  double thickness = 0.0;
  Vec3 before = Vec3::Zero();  ///< m, its place before the substep
  int last_support = 0;        ///< the hull vertex deepest in a plane last time
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  Vec3 held_force = Vec3::Zero(), held_torque = Vec3::Zero();  ///< see OdeWorld::hold
  RigidState last_good;
  BodyProperties properties;
  double to_sleep_s = 0.0;       ///< how much longer it has to be still to fall asleep
  bool was_enabled = true;       ///< after the last substep
  bool fell_asleep = false;      ///< in this substep
  Vec3 withheld = Vec3::Zero();  ///< m/s: taken from it as it was put to rest in one substep after another
  bool kept_awake = false;       ///< in this step, with what it touches
  bool disturbed = false;        ///< since: what it may lie on came, went or was moved
  bool damped = false;           ///< ODE was told of its damping
  std::uint64_t joints_at_rest = 0;  ///< sum_up_joints() of one that sleeps; 0: not known, or awake
  OdeGeometry geometry = OdeGeometry::trimesh;
  /// Bodies of this world made before it: ODE goes through them from the last to the first.
  std::uint64_t birth = 0;
  bool in_company = false;                 ///< in this substep: it may touch more than planes
  std::optional<TimedImpact> impact = {};  ///< in this substep, that is answered at its own time
};

/// Tells ODE, but of the damping, which depends on the step.
void set_properties(Body& body, const BodyProperties& properties);
/// Of steps of `h` s.
void set_damping(Body& body, double h);

bool is_held(const Body& body);
void set_force(dBodyID body, const Vec3& force, const Vec3& torque);

/// Whether every part is finite and within ODE's reach: 1e8 m, m/s and rad/s; the squared norm of the
/// quaternion within 1e-6 of one.
bool is_sound(const RigidState& state);
/// In words, and what is_sound() asks for.
std::string describe(const RigidState& state);
inline constexpr std::string_view kSound = "finite, below 1e8 in each part, the orientation of unit norm";

std::uint32_t slot_of(OdeBodyId id);

/// A body of ours or the caller's that can push: awake and, where it is kinematic, on its way.
bool is_moving(dBodyID body);
RigidState state_of(dBodyID body);
void set_state(dBodyID body, const RigidState& state);
void set_orientation(dBodyID body, const Quat& orientation);  ///< of unit norm

class Bodies {
 public:
  explicit Bodies(dSpaceID space) : space_(space) {}  ///< for their geoms
  ~Bodies();
  Bodies(const Bodies&) = delete;
  Bodies& operator=(const Bodies&) = delete;

  OdeBodyId add(dWorldID world, const OdeBodyDefinition& definition, const OdeSettings& settings,
                TrimeshCache& cache);
  void remove(OdeBodyId id);
  /// Where it reads, bodies are kept if the writer had the very same ones; else all are made anew. Throws
  /// InputError, and nothing has changed, where one of those has a joint.
  void archive(StateArchive& a, dWorldID world, const OdeSettings& settings, TrimeshCache& cache);
  void clear();  ///< as if there had never been any
  Body& find(OdeBodyId id);
  const Body& find(OdeBodyId id) const;

  /// This world's body that `geom` or `body` belongs to; null where it is static or the caller's.
  Body* owner(dGeomID geom) { return owner(dGeomGetBody(geom)); }
  Body* owner(dBodyID body);

  /// Every slot in order; those with a null `body` are free.
  std::span<Body> slots() { return slots_; }
  std::span<const Body> slots() const { return slots_; }
  int count() const { return count_; }
  double greatest_reach() const { return greatest_reach_; }  ///< m, of any body so far
  std::int64_t created() const { return created_; }

 private:
  std::size_t take_slot();
  void make(std::size_t slot, dWorldID world, const OdeBodyDefinition& definition,
            const OdeSettings& settings, TrimeshCache& cache);

  dSpaceID space_;
  std::vector<Body> slots_;
  std::vector<std::uint32_t> free_;
  int count_ = 0;
  std::int64_t created_ = 0;
  std::uint64_t births_ = 0;
  double greatest_reach_ = 0.0;
};

/// With all that hang together with it by joints: alone, what it is given would be lost in those that sleep.
void wake_jointed(Bodies& bodies, const Body& body);

}  // namespace lodestone::ode
