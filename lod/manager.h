// The engine's public face: bodies that live at the full (ODE trimesh) or the statistical level, moved between the two by a policy.
// One step: 1 choose levels, 2 transfer, 3 full level, 4 statistical level, 5 contacts between levels, 6 report.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "lod/body.h"
#include "lod/policy.h"
#include "lod/step_report.h"
#include "reference/mesh.h"
#include "signature/signature_source.h"

struct dxWorld;
struct dxSpace;
struct dxBody;

namespace lodestone {

/// Supplies the signature of a shape under a contact law, when a first statistical body needs it.
using SignatureFunction = std::function<std::shared_ptr<const Signature>(const Shape&, const ContactLaw&)>;

struct ManagerSettings {
  Vec3 gravity{0, 0, -9.81};  ///< m/s²
  std::uint64_t seed = 1;
  int threads = 1;            ///< for the statistical level; the results do not depend on it
  int full_substeps = 4;      ///< ODE steps per step
  StatisticalModel model = StatisticalModel::support;
  PolicySettings policy;
  SignatureFunction signatures;  ///< empty: find_or_measure_signature with its defaults
};

class Manager {
 public:
  /// With an ODE world of its own, made when a first body is full.
  explicit Manager(const ManagerSettings& settings = {});
  /// On the caller's world and space (dWorldID, dSpaceID): static geoms there are ground for every body, and step() advances the
  /// caller's own bodies too. World and space must outlive the manager.
  Manager(dxWorld* world, dxSpace* space, const ManagerSettings& settings = {});
  ~Manager();
  Manager(Manager&&) noexcept;
  Manager& operator=(Manager&&) noexcept;

  /// Materials are added before the bodies that use them.
  MaterialTable& materials();

  void add_plane(const Vec3& normal, double offset, MaterialId material = 0);  ///< normal·x = offset, unit normal
  void add_static_mesh(const Mesh& mesh, MaterialId material = 0);             ///< vertices in the world frame
  void add_static_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material = 0);

  /// Aborts unless the state is finite and the mass positive.
  BodyId add_body(const BodyDefinition& definition);
  void remove_body(BodyId body);
  void set_level(BodyId body, LevelChoice choice);
  void set_viewpoints(std::span<const Vec3> positions);
  void set_state(BodyId body, const RigidState& state);         ///< wakes it
  void add_force(BodyId body, const Vec3& force, const Vec3& torque = Vec3::Zero());  ///< N, N m, over the next step; wakes it

  /// Advances every body by `dt` seconds (0 < dt ≤ 0.1).
  const StepReport& step(double dt);

  int bodies() const;
  bool valid(BodyId body) const;
  RigidState state(BodyId body) const;
  double mass(BodyId body) const;
  const Shape& shape(BodyId body) const;
  Level level(BodyId body) const;
  bool asleep(BodyId body) const;
  std::string why(BodyId body) const;                           ///< the rule that decided the level
  dxBody* ode_body(BodyId body) const;                          ///< dBodyID while full, else null
  const StepReport& report() const;                             ///< of the last step
  std::uint64_t state_hash() const;                             ///< of every body's state and level, in order of creation

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
