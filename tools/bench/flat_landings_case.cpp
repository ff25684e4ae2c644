// S15.
#include <fmt/format.h>

#include <numbers>

#include "reference/random.h"
#include "reference/trial.h"
#include "tools/bench/lone_body_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr int kTrials = 200;
constexpr double kSeconds = 4.0;
constexpr int kTruthSubsteps = 34;
const double kFlat = std::cos(std::numbers::pi / 180.0);

/// On one of its faces, level, its heading drawn, .3 to .8 m above the plane, without any motion.
RigidState start_of(const Shape& shape, std::uint32_t trial) {
  static const Vec3 kDown[] = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  RandomStream random(114, trial, 0);
  RigidState state;
  state.orientation = Quat(Eigen::AngleAxisd(random.uniform(0.0, 2.0 * std::numbers::pi), Vec3::UnitZ())) * Quat::FromTwoVectors(kDown[trial % 3], Vec3::UnitZ());
  state.position.z() = resting_height(shape, state.orientation) + random.uniform(0.3, 0.8);
  return state;
}

/// Still on the face that was below.
bool lies_flat(const RigidState& start, const RigidState& end) {
  return (end.orientation.conjugate() * Vec3::UnitZ()).dot(start.orientation.conjugate() * Vec3::UnitZ()) > kFlat;
}

double flat_under_ode(const std::shared_ptr<const Shape>& shape) {
  const MaterialTable materials;
  int flat = 0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    OdeWorld world({}, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    const RigidState start = start_of(*shape, trial);
    const OdeBodyId body = world.add_body({.shape = shape, .state = start});
    for (int i = 0; i < int(kSeconds / kObservationStep); ++i) world.step(kObservationStep, kTruthSubsteps);
    flat += lies_flat(start, world.state(body));
  }
  return double(flat) / kTrials;
}

double flat_under(StatisticalModel model, const std::shared_ptr<const Shape>& shape, const std::shared_ptr<const Signature>& signature) {
  int flat = 0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    Manager manager = make_case_manager({.model = model, .seed = trial + 1, .signature = signature});
    const RigidState start = start_of(*shape, trial);
    const BodyId body = add_case_body(manager, shape, start);
    for (int i = 0; i < int(kSeconds / kCaseStep); ++i) manager.step(kCaseStep);
    flat += lies_flat(start, manager.state(body));
  }
  return double(flat) / kTrials;
}

}  // namespace

std::vector<HardCaseRow> measure_flat_landings(const HardCaseSettings&) {
  const auto box = box_of({0.2, 0.3, 0.4});
  const auto signature = find_case_signature(*box);
  const double ode = flat_under_ode(box);
  std::vector<HardCaseRow> rows = {{.what = fmt::format("{} x box let down flat, ODE: fraction that lies on that face", kTrials), .value = ode, .bound = 1.0, .side = BoundSide::at_least}};
  for (const auto& [model, name] : kBothModels)
    rows.push_back({.what = fmt::format("{} x box let down flat, {}: fraction that lies on that face", kTrials, name),
                    .value = flat_under(model, box, signature), .bound = ode - 0.05, .side = BoundSide::at_least});
  return rows;
}

}  // namespace lodestone
