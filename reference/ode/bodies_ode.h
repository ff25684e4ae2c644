// The bodies of one OdeWorld: slots that ids point into, and the way between ODE's bodies and ours.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "reference/ode/geometry_ode.h"
#include "reference/ode/ode_world.h"
#include "reference/ode/piece_contacts.h"
#include "reference/ode/runtime_ode.h"

namespace lodestone::ode {

struct Body {
  dBodyID body = nullptr;          ///< null in a free slot
  std::uint32_t generation = 0;
  OdeBodyId id{};
  MaterialId material = 0;
  std::shared_ptr<const Shape> shape;
  std::vector<Sphere> spheres;     ///< empty: a mesh, and its contacts with planes are those of the hull
  std::vector<Piece> pieces;       ///< convex, whose union is the body; none where it is met as a trimesh or as primitives
  double reach = 0.0;              ///< m, nothing of the body is farther from its centre of mass
  double thickness = 0.0;          ///< m, radius of a ball about its centre of mass that its hull, or its sphere, contains
  Vec3 before = Vec3::Zero();      ///< m, its place before the substep
  int last_support = 0;            ///< the hull vertex deepest in a plane last time
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  RigidState last_good;
  bool in_company = false;         ///< in this substep: it may touch more than planes
  std::optional<double> impact_time = {};  ///< in this substep: s after its start, of an impact that is answered at its own time
};

/// Whether every part is finite and within ODE's reach: 1e8 m, m/s and rad/s; the squared norm of the quaternion within 1e-6 of one.
bool is_sound(const RigidState& state);

RigidState state_of(dBodyID body);
void set_state(dBodyID body, const RigidState& state);

class Bodies {
 public:
  Bodies() = default;
  ~Bodies();
  Bodies(const Bodies&) = delete;
  Bodies& operator=(const Bodies&) = delete;

  OdeBodyId add(dWorldID world, dSpaceID space, const OdeBodyDefinition& definition, const OdeSettings& settings,
                TrimeshCache& cache);
  void remove(OdeBodyId id);
  void clear();
  Body& find(OdeBodyId id);
  const Body& find(OdeBodyId id) const;

  /// This world's body that `geom` or `body` belongs to; null where it is static or the caller's.
  Body* owner(dGeomID geom) { return owner(dGeomGetBody(geom)); }
  Body* owner(dBodyID body);

  /// Every slot in order; those with a null `body` are free.
  std::span<Body> slots() { return slots_; }
  int count() const { return count_; }
  std::int64_t created() const { return created_; }

 private:
  std::size_t take_slot();

  std::vector<Body> slots_;
  std::vector<std::uint32_t> free_;
  int count_ = 0;
  std::int64_t created_ = 0;
};

}  // namespace lodestone::ode
