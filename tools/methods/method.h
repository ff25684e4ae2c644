// The ways to simulate that `--methods` names, prepared for one shape: what each of them collides with, and
// how finely it steps.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "lod/full/full_level.h"
#include "lod/manager.h"
#include "reference/drop_trial.h"
#include "signature/signature_source.h"
#include "tools/methods/bullet_world.h"
#include "tools/methods/drop_ground.h"

namespace lodestone {

/// What falls on what: the same for every method.
struct DropJob {
  std::shared_ptr<const Shape> shape;
  DropConditions conditions;
  Material material;  ///< of the body and of the ground
  DropGround ground = DropGround::plane;
  ContactLaw law() const { return {material.restitution, material.friction}; }
};

/// ODE, with one or another collision geometry.
struct OdeMethod {
  int substeps = 1;  ///< ODE steps in a step
  OdeSettings settings = {};
  OdeGeometry geometry = OdeGeometry::trimesh;
  std::shared_ptr<const Shape> collision_shape = {};  ///< with the mass distribution of the job's shape
  std::vector<Sphere> spheres = {};                   ///< for OdeGeometry::spheres
};

/// The statistical level.
struct StatisticalMethod {
  StatisticalModel model = StatisticalModel::support;
  /// None: as a body is that waits for its first one, at `support`.
  std::shared_ptr<const Signature> signature = {};
  bool published = false;  ///< `tables` as the paper has it
};

/// Bullet, where Lodestone is built with it.
struct BulletMethod {
  BulletGeometry geometry = BulletGeometry::hull;
  BulletSettings settings = {};
};

struct Method {
  std::string name;
  std::variant<OdeMethod, StatisticalMethod, BulletMethod> way;
  std::string left_out = {};  ///< why it cannot be had for this shape; empty where it can

  int substeps() const;
  std::string model() const;  ///< "tables", "tables_published" or "support"; empty for ODE
};

/// Leaves out those of the statistical level's models that are not `model`; none where that is empty.
void keep_model(std::vector<Method>& methods, const std::string& model);

/// The method with its bodies allowed to fall asleep, or not; the statistical level's is a setting of its
/// world.
Method with_sleep(Method method, bool sleeping);

/// The ground truth where it is not the usual one.
struct TruthSettings {
  /// In 1/60 s; none: 34, just under .5 ms each, so that 60 Hz falls on whole steps, and for bodies below .2
  /// m the more, the smaller they are.
  std::optional<int> substeps = {};
  /// At which overlap is pushed apart at most; none: ODE's own law, without a bound, which gives impacts up
  /// to its error reduction (.2) of their speed back, in steps of any length, as shows where the restitution
  /// is less.
  std::optional<double> push_m_per_s = {};
  friend bool operator==(const TruthSettings&, const TruthSettings&) = default;
};

/// The ground truth: ODE.
Method make_truth(const DropJob& job, const TruthSettings& settings = {});

/// Whether `make_methods` knows it: one of method_names(), or full_2 to full_64, the full level at
/// that many substeps.
bool is_method_name(const std::string& name);

/// The names without a number of substeps. `full` is the full level with its default substeps, `full_1` ODE
/// itself in one step, `waiting` is `support` while the shape's signature is being measured.
std::vector<std::string> method_names();

/// The shape's signature, from the cache or measured now as `measuring` says on `threads` threads (0: all
/// cores).
std::shared_ptr<const Signature> find_signature(const DropJob& job, const SignatureSettings& measuring,
                                                int threads, const Progress& progress);

/// The methods of these names; `statistical` gives one for each model, `tables` as published and as it is,
/// with the signature that `find_signature` finds. Throws InputError for an unknown name.
std::vector<Method> make_methods(const std::vector<std::string>& names, const DropJob& job,
                                 const SignatureSettings& measuring, int threads, const Progress& progress);

}  // namespace lodestone
