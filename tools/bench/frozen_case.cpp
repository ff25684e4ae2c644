// S16.
#include <cmath>
#include <fmt/format.h>

#include "reference/random.h"
#include "tools/bench/ensemble_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr int kBodies = 300, kFrames = 24;  // up to a little after the top
constexpr double kThrow = 3.0, kInward = 1.5;  // m/s up, 1/s: near the top the cloud is dense, and many are slow
constexpr double kStill = 0.05;                // m/s

RigidState start_of(std::uint32_t seed, int i) {
  RandomStream random(118 + seed, std::uint64_t(i), 0);
  const Vec3 place = 0.36 * (Vec3(i % 7, i / 7 % 7, i / 49) - Vec3(3, 3, 3));
  return {.position = place, .orientation = random.orientation(), .velocity = kThrow * Vec3::UnitZ() - kInward * place,
          .angular_velocity = random.uniform(0.0, 5.0) * random.direction()};
}

/// Of a run without ground: frames of bodies in which one is pushed while it stands still, among all.
struct Count {
  std::int64_t frozen = 0, hit = 0, all = 0;
  void add(const Vec3& before, const Vec3& after, double dt) {
    const bool pushed = ((after - before) / dt + kCaseGravity * Vec3::UnitZ()).norm() > 0.5 * kCaseGravity;
    hit += pushed, frozen += pushed && after.norm() < kStill, ++all;
  }
  double fraction() const { return double(frozen) / double(all); }
};

template <typename Step, typename Velocity>
void count_frames(Count& count, Step step, Velocity velocity) {
  std::vector<Vec3> before;
  for (int i = 0; i < kBodies; ++i) before.push_back(velocity(i));
  for (int frame = 0; frame < kFrames; ++frame) {
    step();
    for (int i = 0; i < kBodies; ++i) {
      const Vec3 after = velocity(i);
      count.add(before[i], after, kCaseStep);
      before[i] = after;
    }
  }
}

Count count_under_ode(const std::shared_ptr<const Shape>& shape, std::uint32_t clouds) {
  const MaterialTable materials;
  Count count;
  for (std::uint32_t seed = 0; seed < clouds; ++seed) {
    OdeWorld world({.gravity = {0, 0, -kCaseGravity}}, materials);
    std::vector<OdeBodyId> bodies;
    for (int i = 0; i < kBodies; ++i) bodies.push_back(world.add_body({.shape = shape, .state = start_of(seed, i)}));
    count_frames(count, [&] { world.step(kCaseStep, 8); }, [&](int i) { return world.state(bodies[std::size_t(i)]).velocity; });
  }
  return count;
}

Count count_under(StatisticalModel model, const std::shared_ptr<const Shape>& shape, std::uint32_t clouds) {
  Count count;
  for (std::uint32_t seed = 0; seed < clouds; ++seed) {
    Manager manager = make_case_manager({.model = model, .plane_normals = {}, .seed = seed + 1, .signature = find_case_signature(*shape)});
    std::vector<BodyId> bodies;
    for (int i = 0; i < kBodies; ++i) bodies.push_back(add_case_body(manager, shape, start_of(seed, i)));
    count_frames(count, [&] { manager.step(kCaseStep); }, [&](int i) { return manager.state(bodies[std::size_t(i)]).velocity; });
  }
  return count;
}

}  // namespace

std::vector<HardCaseRow> measure_frozen_in_air(const HardCaseSettings& settings) {
  const std::uint32_t clouds = settings.quick ? 3 : 12;
  const auto l = share(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)));
  const Count ode = count_under_ode(l, clouds);
  // A short run counts a handful of frames: their difference from twice ODE's is a sum of rare events, uncertain by the root of its variance.
  const double uncertain = settings.quick ? 2.0 * std::sqrt(6.0 * double(ode.frozen)) / double(ode.all) : 0.0;
  const std::string what = fmt::format("{} x cloud of {} L-shapes in the air, ", clouds, kBodies);
  std::vector<HardCaseRow> rows = {{.what = what + "ODE: frames of bodies that are hit", .value = double(ode.hit), .bound = 300.0 * clouds, .side = BoundSide::at_least}};
  for (const auto& [model, name] : kBothModels) {
    const Count count = count_under(model, l, clouds);
    rows.push_back({.what = what + fmt::format("{}: fraction of frames in which one is pushed and stands still", name), .value = count.fraction(), .bound = 2.0 * ode.fraction() + uncertain});
  }
  return rows;
}

}  // namespace lodestone
