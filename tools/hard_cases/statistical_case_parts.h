// What most hard cases of the statistical level are made of.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "lod/manager.h"
#include "scenes/run_measures.h"
#include "tools/hard_cases/case_parts.h"

namespace lodestone {

struct NamedModel {
  StatisticalModel model;
  const char* name;
};
inline constexpr std::array kBothModels = {NamedModel{StatisticalModel::support, "support"},
                                           NamedModel{StatisticalModel::tables, "tables"}};

inline constexpr double kCaseStep = 1.0 / 60;  // s

/// The default signature: from the user's cache, or measured now and kept there.
std::shared_ptr<const Signature> find_case_signature(const Shape& shape, const ContactLaw& law = {});

/// A world of the statistical level alone.
struct StatisticalCase {
  StatisticalModel model = StatisticalModel::support;
  ContactLaw law = {};  ///< everywhere
  Vec3 gravity{0, 0, -kCaseGravity};
  std::vector<Vec3> plane_normals = {Vec3::UnitZ()};  ///< of planes through the origin
  std::uint64_t seed = 1;
  int threads = 1;
  std::shared_ptr<const Signature> signature = {};  ///< of every body; may be null for `support`
  bool published = false;                           ///< `tables` as the paper has it
};
Manager make_case_manager(const StatisticalCase& settings);

/// Forced statistical.
BodyId add_case_body(Manager& manager, const std::shared_ptr<const Shape>& shape, const RigidState& state);

/// How far its centre of mass is from a plane that its lowest point touches, m.
double resting_height(const Shape& shape, const Quat& orientation, const Vec3& normal = Vec3::UnitZ());

}  // namespace lodestone
