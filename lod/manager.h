// The engine's public face: bodies on three rungs, full (ODE trimesh), `support` (hull) and `tables` (sphere), moved between them by a policy.
// One step: 1 choose rungs, 2 transfer, 3 statistical rungs and their contacts with full bodies, 4 full level, with the impulses of those
// contacts, 5 report.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "lod/body.h"
#include "lod/jobs.h"
#include "lod/policy.h"
#include "lod/signatures.h"
#include "lod/step_report.h"
#include "lod/tables_options.h"
#include "reference/mesh/mesh.h"

struct dxWorld;
struct dxSpace;
struct dxBody;

namespace lodestone {

struct ManagerSettings {
  Vec3 gravity{0, 0, -9.81};  ///< m/s²
  std::uint64_t seed = 1;
  int threads = 1;            ///< for the statistical level; the results do not depend on it
  JobRunner jobs = {};        ///< an engine's own, for so many threads; empty: oneTBB's
  int full_substeps = 4;      ///< ODE steps per step
  bool sleeping = true;       ///< bodies at rest cost nothing until something wakes them
  std::optional<StatisticalModel> model = {};  ///< that all statistical bodies have; none: what the policy finds, body by body
  TablesOptions tables = {};  ///< of the tables model
  PolicySettings policy = {};
  SignatureFunction signatures = {};  ///< empty: find_or_measure_signature with its defaults
  SignatureTiming signature_timing = SignatureTiming::automatic;  ///< whether a step waits for a signature or the body stays full meanwhile
};

class Manager {
 public:
  /// With an ODE world of its own, made when a first body is full.
  explicit Manager(const ManagerSettings& settings = {});
  /// On the caller's world and space (dWorldID, dSpaceID), with that world's gravity; step() advances the caller's own bodies too. Static geoms
  /// there are ground, of material 0, for full bodies; statistical ones meet the planes among them only, and none of the caller's bodies.
  /// World and space must outlive the manager.
  Manager(dxWorld* world, dxSpace* space, const ManagerSettings& settings = {});
  ~Manager();
  Manager(Manager&&) noexcept;
  Manager& operator=(Manager&&) noexcept;

  /// Materials are added before the bodies that use them.
  MaterialTable& materials();

  void add_plane(const Vec3& normal, double offset, MaterialId material = 0);  ///< normal·x = offset, unit normal
  // Static meshes and boxes are ground for full bodies and for those at `support`. `tables` knows planes only: a body that nears one's bounding box goes up to `support`,
  // or where all statistical bodies are `tables` (ManagerSettings::model) becomes full, unless it was forced there: it then passes through.
  void add_static_mesh(const Mesh& mesh, MaterialId material = 0);             ///< vertices in the world frame
  void add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material = 0);

  /// Aborts unless the state is finite, within 1e8 m of the origin and its orientation of unit length within 1e-6, the mass and importance
  /// positive, the material known. A body that is forced full is so at once. Any other gets its level in its next step, whatever the dwell
  /// and the cap; that is not counted as a promotion, and until then the body waits as it was given.
  BodyId add_body(const BodyDefinition& definition);
  void remove_body(BodyId body);
  void set_level(BodyId body, LevelChoice choice);              ///< from the next step on
  void set_policy(const PolicySettings& policy);                ///< from the next step on
  void set_viewpoints(std::span<const Vec3> positions);
  void set_state(BodyId body, const RigidState& state);         ///< wakes it
  void add_force(BodyId body, const Vec3& force, const Vec3& torque = Vec3::Zero());  ///< N, N m, over the next step; wakes it

  /// Advances every body by `dt` seconds (0 < dt ≤ 0.1). Throws InputError only where a signature that is needed cannot be had.
  /// A body whose signature a thread is still measuring is full until it is there, whatever level was asked for.
  const StepReport& step(double dt);

  int bodies() const;
  bool valid(BodyId body) const;
  RigidState state(BodyId body) const;
  double mass(BodyId body) const;
  const Shape& shape(BodyId body) const;
  Level level(BodyId body) const;
  Rung rung(BodyId body) const;                                 ///< `support` for a body that waits for its first step
  bool asleep(BodyId body) const;
  std::string why(BodyId body) const;                           ///< the rule that decided the level, in words
  dxBody* ode_body(BodyId body) const;                          ///< dBodyID while full, else null
  const StepReport& report() const;                             ///< of the last step
  std::size_t statistical_bytes() const;                        ///< held by the statistical level's arrays; 0 where that is not counted: under `support`
  std::uint64_t state_hash() const;                             ///< of every body's state and level, in order of creation

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
