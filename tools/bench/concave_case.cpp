// F19: concave meshes that hold each other where their convex hulls could not: an L hooked into an L and pulled, an L pushed into another's corner, a
// bunny dropped on a bunny.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/random.h"
#include "tools/bench/case_parts.h"
#include "tools/bench/contact_cases.h"

namespace lodestone {
namespace {

constexpr double kDensity = 1000.0, kGravity = 9.81, kStep = 1.0 / 240;
constexpr double kCorrectingVelocity = 1.0;  // m/s
constexpr double kSlack = 2e-3;  // m, between surfaces at first

struct Figures {
  double moved = 0.0, depth = 0.0, speed = 0.0, gain = 0.0;  // m, m, m/s, J
};

/// Legs of 1 m, .2 m wide and thick; in the mesh's frame the inner corner is at (−.3, −.3).
std::shared_ptr<const Shape> make_hook() { return std::make_shared<const Shape>(make_shape("l", make_l(1.0, 1.0, 0.2, 0.2))); }

/// The state in which the frame of the shape's mesh, turned by `orientation`, has its origin at `origin`.
RigidState place_mesh(const Shape& shape, const Vec3& origin, const Quat& orientation) {
  return {.position = origin + orientation * shape.center_of_mass_in_mesh, .orientation = orientation};
}

double deepest(const OdeWorld& world) {
  double depth = 0.0;
  for (const OdeContact& contact : world.contacts()) depth = std::max(depth, contact.depth);
  return depth;
}

/// Two L-shapes, the first all but immovable; the second feels `force` for 2 s. What it does in the last quarter second counts as its end.
Figures push(const Vec3& origin, const Quat& orientation, const Vec3& force) {
  const MaterialTable materials = materials_of(0.0, 0.3);
  OdeWorld world({.gravity = Vec3::Zero(), .max_correcting_velocity = kCorrectingVelocity}, materials);
  const auto hook = make_hook();
  const double mass = kDensity * hook->volume;
  world.add_body({.shape = hook, .mass = 1e6 * mass, .state = place_mesh(*hook, Vec3::Zero(), Quat::Identity())});
  const RigidState start = place_mesh(*hook, origin, orientation);
  const OdeBodyId pulled = world.add_body({.shape = hook, .mass = mass, .state = start});
  Figures figures;
  for (int i = 0; i < 480; ++i) {
    world.add_force(pulled, mass * kGravity * force, Vec3::Zero());
    world.step(kStep);
    if (i < 420) continue;
    figures.depth = std::max(figures.depth, deepest(world));
    figures.speed = std::max(figures.speed, world.state(pulled).velocity.norm());
  }
  figures.moved = (world.state(pulled).position - start.position).norm();
  return figures;
}

/// The second, half a turn round, has a leg in the first's corner and the other over the end of the first's leg.
Figures pull_hooked() { return push({-0.6 + kSlack, 0.2 + kSlack, 0.0}, Quat(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitZ())), {-10, 0, 0}); }

/// The second as it is, moved along the diagonal by the width of a leg: its outer corner in the first's inner corner.
Figures push_into_corner() { return push({0.2 + kSlack, 0.2 + kSlack, 0.0}, Quat::Identity(), {-10, -10, 0}); }

Figures drop_bunny_on_bunny(std::uint32_t trial) {
  RandomStream random(19, trial, 0);
  const MaterialTable materials = materials_of(0.0, 0.5);
  OdeWorld world({.max_correcting_velocity = kCorrectingVelocity}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto bunny = std::make_shared<const Shape>(make_bunny_shape(0.2));
  const double mass = kDensity * bunny->volume;
  std::vector<OdeBodyId> bodies;
  for (int i = 0; i < 2; ++i) {
    const Vec3 position(0.02 * random.uniform() * i, 0.02 * random.uniform() * i, bunny->radius * (1.1 + 2.1 * i));
    bodies.push_back(world.add_body({.shape = bunny, .mass = mass, .state = {.position = position, .orientation = random.orientation()}}));
  }
  Figures figures;
  const auto energy = [&] {
    double sum = 0.0;
    for (const OdeBodyId body : bodies) sum += kinetic_energy(*bunny, mass, world.state(body)) + mass * kGravity * world.state(body).position.z();
    return sum;
  };
  double least = energy();
  for (int i = 0; i < 960; ++i) {
    world.step(kStep);
    figures.gain = std::max(figures.gain, energy() - least);
    least = std::min(least, energy());
    if (i < 900) continue;
    for (const OdeContact& contact : world.contacts())
      if (contact.second) figures.depth = std::max(figures.depth, contact.depth);
  }
  return figures;
}

}  // namespace

std::vector<HardCaseRow> measure_concave(const HardCaseSettings& settings) {
  const Figures hooked = pull_hooked(), corner = push_into_corner();
  Figures bunnies;
  const int trials = settings.quick ? 2 : 12;
  const Shape bunny = make_bunny_shape(0.2);
  const double corrected = 0.5 * kDensity * bunny.volume * kCorrectingVelocity * kCorrectingVelocity;
  for (int i = 0; i < trials; ++i) {
    const Figures trial = drop_bunny_on_bunny(i);
    bunnies.depth = std::max(bunnies.depth, trial.depth);
    bunnies.gain = std::max(bunnies.gain, trial.gain);
  }
  return {{"L hooked into an L, pulled by 10 times its weight for 2 s: moved", 1e3 * hooked.moved, 2e3 * kSlack, "mm"},
          {"L hooked into an L: deepest contact at the end", 1e3 * hooked.depth, 1.0, "mm"},
          {"L hooked into an L: speed at the end", hooked.speed, 2e-3, "m/s"},
          {"L pushed into the corner of an L: moved", 1e3 * corner.moved, 2e3 * kSlack, "mm"},
          {"L pushed into the corner of an L: deepest contact at the end", 1e3 * corner.depth, 1.0, "mm"},
          {"L pushed into the corner of an L: speed at the end", corner.speed, 2e-3, "m/s"},
          {fmt::format("bunny dropped on bunny, {} times: deepest mutual contact after 3.75 s over the size", trials), bunnies.depth / bunny.size, 2.5e-3},
          {fmt::format("bunny dropped on bunny, {} times: energy gained in a step over what pushing a bunny out of an overlap may give it", trials), bunnies.gain / corrected, 1.0}};
}

}  // namespace lodestone
