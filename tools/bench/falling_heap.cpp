#include "tools/bench/falling_heap.h"

#include <cmath>
#include <numbers>
#include <string>

#include "reference/error.h"
#include "scenes/scatter.h"

namespace lodestone {
namespace {

constexpr double kFilled = 0.18;  // of the cylinder, by bounding spheres
constexpr double kHeightOfRadius = 4.0;

}  // namespace

FallingHeap make_falling_heap(int bodies, double body_radius_m, std::uint64_t seed) {
  const double spheres = bodies * 4.0 / 3.0 * std::numbers::pi * std::pow(body_radius_m, 3);
  FallingHeap heap{.radius_m = std::cbrt(spheres / kFilled / (kHeightOfRadius * std::numbers::pi)),
                   .starts = {}};
  const ScatterCylinder cylinder{
      .base = {0, 0, body_radius_m}, .radius = heap.radius_m, .height = kHeightOfRadius * heap.radius_m};
  const Scatter scatter{.count = bodies, .region = cylinder, .seed = seed};
  PlacedSpheres placed(body_radius_m);
  const std::vector<Vec3> centers = place_scatter(scatter, body_radius_m, {}, placed);
  check_that(int(centers.size()) == bodies, "a heap's bodies have room:", std::to_string(centers.size()));
  for (int i = 0; i < bodies; ++i) {
    RigidState state;
    state.position = centers[std::size_t(i)];
    state.orientation = scatter_orientation(scatter, i);
    heap.starts.push_back(state);
  }
  return heap;
}

}  // namespace lodestone
