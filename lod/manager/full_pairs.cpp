#include "lod/manager/full_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lodestone {
namespace {

// Faces of the mesh of which a pair counts 1.
constexpr double kFaces = 4698.0;
// Of a convex body, and of the simplest meshes: their hulls meet, or a few faces.
constexpr double kLeastWeight = 0.15;
// A pair of two such counts so much; for rounding, a little more.
constexpr double kOfSimplest = 1.001 * kLeastWeight * kLeastWeight;
// Bounding spheres meet before what is in them: within the first part of the sum of both radii bodies begin
// to be a pair, within the second they are a whole one.
constexpr double kMeetWithin = 1.0, kWholeWithin = 0.6;

double least_squared_distance(const FullPairs::Body& a, const FullPairs::Body& b) {
  const Vec3 apart = a.position - b.position, moved = a.motion - b.motion;
  const bool known = !a.motion.isZero(0.0) && !b.motion.isZero(0.0);
  return known ? std::min(apart.squaredNorm(), (apart + moved).squaredNorm()) : apart.squaredNorm();
}

}  // namespace

PairWeights& PairWeights::operator+=(const PairWeights& more) {
  awake += more.awake, asleep += more.asleep, dearest = std::max(dearest, more.dearest);
  return *this;
}

float mesh_weight(const Shape& shape) {
  return float(shape.convex ? kLeastWeight
                            : std::max(kLeastWeight, std::sqrt(double(shape.mesh.faces.size()) / kFaces)));
}

FullPairs::FullPairs(double most_radius)
    : cells_per_m_(1.0 / std::max(2.0 * kMeetWithin * most_radius, 1e-6)), first_(kBuckets, -1) {}

std::size_t FullPairs::bucket(std::int64_t x, std::int64_t y, std::int64_t z) const {
  return (std::uint64_t(x) * 73856093u ^ std::uint64_t(y) * 19349663u ^ std::uint64_t(z) * 83492791u) %
         kBuckets;
}

PairWeights FullPairs::meet(const Body& body) const {
  PairWeights pairs;
  if (bodies_.empty()) return pairs;
  const auto cell = [this](double x) { return std::int64_t(std::floor(x * cells_per_m_)); };
  const std::int64_t x = cell(body.position.x()), y = cell(body.position.y()), z = cell(body.position.z());
  std::array<std::size_t, 27> buckets;
  for (int i = 0; i < 27; ++i)
    buckets[std::size_t(i)] = bucket(x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1);
  for (std::size_t i = 0; i < 27; ++i) {
    if (first_[buckets[i]] < 0 || std::find(buckets.begin(), buckets.begin() + std::ptrdiff_t(i),
                                            buckets[i]) != buckets.begin() + std::ptrdiff_t(i))
      continue;
    for (std::int32_t other = first_[buckets[i]]; other >= 0; other = next_[std::size_t(other)]) {
      const Body& there = bodies_[std::size_t(other)];
      if (body.joined >= 0 && body.joined == there.joined) continue;
      const double reach = body.radius + there.radius, squared = least_squared_distance(there, body);
      if (squared >= kMeetWithin * kMeetWithin * reach * reach) continue;
      const double depth = (kMeetWithin - std::sqrt(squared) / reach) / (kMeetWithin - kWholeWithin);
      const double meshes = double(body.mesh) * double(there.mesh), weight = std::min(1.0, depth) * meshes;
      (body.asleep && there.asleep ? pairs.asleep : pairs.awake) += weight;
      if ((!body.asleep || !there.asleep) && meshes > kOfSimplest)
        pairs.dearest = std::max(pairs.dearest, weight);
    }
  }
  return pairs;
}

void FullPairs::add(const Body& body) {
  const auto cell = [this](double x) { return std::int64_t(std::floor(x * cells_per_m_)); };
  std::int32_t& first =
      first_[bucket(cell(body.position.x()), cell(body.position.y()), cell(body.position.z()))];
  next_.push_back(std::exchange(first, std::int32_t(bodies_.size())));
  bodies_.push_back(body);
}

}  // namespace lodestone
