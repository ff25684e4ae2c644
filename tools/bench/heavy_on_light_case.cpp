#include <fmt/format.h>

#include <algorithm>

#include "tools/bench/case_parts.h"
#include "tools/bench/pair_cases.h"

namespace lodestone {
namespace {

constexpr double kSide = 0.2, kLightMass = 1.0, kSeconds = 10.0, kSettling = 1.0;

struct Sinking {
  double depth = 0.0;  ///< over the side, the deepest of the two contacts after the first second
  std::int64_t counted = 0;
};

Sinking sinking_of(double ratio, double dt, bool quick_step) {
  const MaterialTable materials = materials_of(0.0, 0.5);
  OdeWorld world({.gravity = {0, 0, -kCaseGravity}, .quick_step = quick_step}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto cube = box_of(Vec3::Constant(kSide));
  const OdeBodyId light = world.add_body({.shape = cube, .mass = kLightMass, .state = {.position = {0, 0, 0.5 * kSide}}});
  const OdeBodyId heavy = world.add_body({.shape = cube, .mass = ratio * kLightMass, .state = {.position = {0.05 * kSide, 0, 1.5 * kSide}}});
  Sinking sinking;
  for (int i = 0; i < int(kSeconds / dt); ++i) {
    world.step(dt);
    if (i * dt < kSettling) continue;
    const double below = world.state(light).position.z(), above = world.state(heavy).position.z();
    sinking.depth = std::max({sinking.depth, 0.5 - below / kSide, 1.0 - (above - below) / kSide});
  }
  sinking.counted = world.counters().uneven_contacts;
  return sinking;
}

constexpr const char* kQuickStepYields = "QuickStep's iterations do not carry the weight through the light body. The full level steps with dWorldStep, which does, up to 150 contacts that hang together; beyond, full_uneven_contacts counts";

}  // namespace

std::vector<HardCaseRow> measure_heavy_on_light(const HardCaseSettings& settings) {
  std::vector<HardCaseRow> rows;
  for (const int steps_per_s : {60, 240})
    for (const double ratio : {10.0, 100.0, 1e3, 1e4})
      rows.push_back({.what = fmt::format("cube on one {:g} times lighter, 10 s, dt 1/{} s: penetration over side", ratio, steps_per_s),
                      .value = sinking_of(ratio, 1.0 / steps_per_s, false).depth,
                      .bound = 0.02});
  for (const double ratio : settings.quick ? std::vector{1e3} : std::vector{1e3, 1e4}) {
    const std::string what = fmt::format("cube on one {:g} times lighter, QuickStep, dt 1/240 s: ", ratio);
    const Sinking sinking = sinking_of(ratio, 1.0 / 240, true);
    rows.push_back({.what = what + "penetration over side",
                    .value = sinking.depth,
                    .bound = 0.02,
                    .odes_own = kQuickStepYields});
    rows.push_back({.what = what + "uneven contacts counted", .value = double(sinking.counted), .bound = 1.0, .side = BoundSide::at_least});
  }
  return rows;
}

}  // namespace lodestone
