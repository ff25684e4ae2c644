// S12.
#include <fmt/format.h>

#include <limits>

#include "tools/bench/lone_body_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {

std::vector<HardCaseRow> measure_long_flight(const HardCaseSettings& settings) {
  const std::int64_t steps = settings.quick ? 300'000 : 10'000'000;
  constexpr double kStep = 1e-4;
  const double seconds = double(steps) * kStep;
  const auto box = box_of({0.2, 0.3, 0.4});
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels) {
    Manager manager = make_case_manager({.model = model, .plane_normals = {}, .signature = find_case_signature(*box)});
    const Vec3 velocity(3.0, -2.0, 0.5 * kCaseGravity * seconds);  // back at its height at the end
    const BodyId body = add_case_body(manager, box, {.velocity = velocity, .angular_velocity = {3.0, 9.0, -2.0}});
    const Vec3 momentum = angular_momentum(*box, 1.0, manager.state(body));
    double norm = 0.0;
    for (std::int64_t i = 0; i < steps; ++i) {
      manager.step(kStep);
      if (i % 1000 == 0) norm = worse(norm, std::abs(manager.state(body).orientation.norm() - 1.0));
    }
    const RigidState end = manager.state(body);
    const Vec3 expected = seconds * velocity - 0.5 * kCaseGravity * seconds * seconds * Vec3::UnitZ();
    // Each step rounds the place and the velocity to within half of their last bit.
    const double height = velocity.z() * velocity.z() / (2.0 * kCaseGravity), rounding = 0.5 * std::numeric_limits<double>::epsilon();
    const double allowed = rounding * double(steps) * (height + velocity.norm() * seconds);
    const std::string what = fmt::format("{:.0e} steps of free flight, {}: ", double(steps), name);
    rows.push_back({.what = what + "quaternion's norm off 1", .value = norm, .bound = 1e-12});
    rows.push_back({.what = what + "place off the parabola, over what rounding may add up to", .value = (end.position - expected).norm() / allowed, .bound = 1.0});
    rows.push_back({.what = what + "angular momentum changed, relative", .value = (angular_momentum(*box, 1.0, end) - momentum).norm() / momentum.norm(), .bound = 1e-9});
  }
  return rows;
}

}  // namespace lodestone
