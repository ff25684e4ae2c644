#include "tools/compare/pile_start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reference/argument_error.h"
#include "reference/drop_trial.h"
#include "reference/random.h"

namespace lodestone {
namespace {

constexpr double kPileCell = 2.1;      // over R: the least that leaves a bounding sphere room
constexpr double kLowestCenter = 1.2;  // m
constexpr std::uint32_t kPileStream = 0x911e, kConvergingStream = 0x911f;

int cells_along(const Shape& shape, double side) {
  return int(std::floor(side / (kPileCell * shape.radius)));
}

Vec3 draw_within(const Vec3& half_room, RandomStream& random) {
  const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0), z = random.uniform(-1.0, 1.0);
  return half_room.cwiseProduct(Vec3(x, y, z));
}

}  // namespace

std::vector<HalfSpace> make_bin(double side) {
  std::vector<HalfSpace> planes = {{Vec3::UnitZ(), 0.0}};
  for (const Vec3& inward : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
    planes.push_back({inward, -0.5 * side});
  return planes;
}

void check_pile(const Shape& shape, const PileConditions& conditions) {
  if (cells_along(shape, conditions.side) < 1)
    throw ArgumentError(fmt::format("--side: found {:.4g} m, expected at least {:.4g} m for this shape",
                                    conditions.side, kPileCell * shape.radius));
}

std::vector<RigidState> make_pile_start(const Shape& shape, const PileConditions& conditions,
                                        std::uint64_t seed) {
  check_pile(shape, conditions);
  const int along = cells_along(shape, conditions.side);
  const double cell = conditions.side / along, layer = kPileCell * shape.radius;
  const Vec3 half_room = 0.5 * Vec3(cell, cell, layer) - Vec3::Constant(shape.radius);
  std::vector<RigidState> starts(static_cast<std::size_t>(conditions.bodies));
  for (int i = 0; i < conditions.bodies; ++i) {
    RandomStream random(seed, std::uint64_t(i), kPileStream);
    const Vec3 place((i % along + 0.5) * cell, (i / along % along + 0.5) * cell, i / (along * along) * layer);
    RigidState& start = starts[std::size_t(i)];
    start.position =
        place - Vec3(0.5 * conditions.side, 0.5 * conditions.side, -drop_scale(shape) * kLowestCenter);
    start.position += draw_within(half_room, random);
    start.orientation = random.orientation();
  }
  return starts;
}

std::vector<RigidState> make_converging_start(const Shape& shape, int bodies, std::uint64_t seed) {
  const int along = int(std::ceil(std::cbrt(double(bodies)) - 1e-9));
  const double cell = 1.5 * kPileCell * shape.radius;
  const Vec3 half_room = Vec3::Constant(0.5 * cell - shape.radius);
  std::vector<RigidState> starts(static_cast<std::size_t>(bodies));
  for (int i = 0; i < bodies; ++i) {
    RandomStream random(seed, std::uint64_t(i), kConvergingStream);
    RigidState& start = starts[std::size_t(i)];
    start.position =
        cell * (Vec3(i % along, i / along % along, i / (along * along)) - Vec3::Constant(0.5 * (along - 1)));
    start.position += draw_within(half_room, random);
    start.velocity = -start.position;
    start.orientation = random.orientation();
  }
  return starts;
}

}  // namespace lodestone
