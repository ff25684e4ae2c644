#include "tools/compare/pile_overlap.h"

#include <algorithm>

namespace lodestone {

PileOverlap::PileOverlap(const Shape& shape, std::vector<HalfSpace> planes)
    : shape_(shape), planes_(std::move(planes)) {
  if (!shape.convex && !shape.sphere_radius && shape.pieces.empty()) grid_ = DepthGrid(shape.mesh);
}

double PileOverlap::depth_of_pair(const RigidState& first, const RigidState& second) const {
  if ((first.position - second.position).norm() >= 2.0 * shape_.radius) return 0.0;
  const double depth = measure_pair_overlap(shape_, first, shape_, second);
  const bool of_vertices = !shape_.convex && !shape_.sphere_radius && shape_.pieces.empty() && depth > 0.0;
  return of_vertices ? std::max(depth_of_vertices(first, second), depth_of_vertices(second, first)) : depth;
}

double PileOverlap::depth_of_vertices(const RigidState& of, const RigidState& in) const {
  const Mat3 turn = (in.orientation.conjugate() * of.orientation).toRotationMatrix();
  const Vec3 shift = in.orientation.conjugate() * (of.position - in.position);
  double depth = 0.0;
  for (const Vec3& vertex : shape_.mesh.vertices) depth = std::max(depth, grid_.depth(turn * vertex + shift));
  return depth;
}

double PileOverlap::depth_in_planes(const RigidState& state) const {
  double depth = -1e300;
  for (const HalfSpace& plane : planes_)
    depth = std::max(depth, measure_plane_overlap(shape_, state, plane.normal, plane.offset));
  return depth;
}

double PileOverlap::deepest(std::span<const RigidState> states) const {
  double depth = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    depth = std::max(depth, depth_in_planes(states[i]));
    for (std::size_t k = i + 1; k < states.size(); ++k)
      depth = std::max(depth, depth_of_pair(states[i], states[k]));
  }
  return depth;
}

double PileOverlap::median_depth(std::span<const RigidState> states) const {
  std::vector<double> depths;
  for (std::size_t i = 0; i < states.size(); ++i)
    for (std::size_t k = i + 1; k < states.size(); ++k)
      if (const double depth = depth_of_pair(states[i], states[k]); depth > 0.0) depths.push_back(depth);
  if (depths.empty()) return 0.0;
  const auto middle = depths.begin() + std::ptrdiff_t(depths.size() / 2);
  std::ranges::nth_element(depths, middle);
  return *middle;
}

int PileOverlap::count_hovering(std::span<const RigidState> states, std::span<const char> at_rest,
                                double drop) const {
  int hovering = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!at_rest[i]) continue;
    RigidState lowered = states[i];
    lowered.position.z() -= drop;
    bool held = depth_in_planes(lowered) > 0.0;
    for (std::size_t k = 0; k < states.size() && !held; ++k)
      held = k != i && depth_of_pair(lowered, states[k]) > 0.0;
    hovering += !held;
  }
  return hovering;
}

int PileOverlap::count_escaped(std::span<const RigidState> states) const {
  return int(std::ranges::count_if(states, [&](const RigidState& state) {
    return std::ranges::any_of(planes_,
                               [&](const HalfSpace& plane) { return plane.height_of(state.position) < 0.0; });
  }));
}

}  // namespace lodestone
