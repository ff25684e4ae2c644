// Fitting a set of spheres to a solid: a usual cheap stand-in, and a baseline to compare with.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/error.h"
#include "reference/mesh/inside.h"
#include "reference/mesh/mass_properties.h"
#include "reference/mesh/simplified_shapes.h"

namespace lodestone {
namespace {

constexpr int kCells = 28;  // along the longest side
constexpr int kLloydRounds = 60;
constexpr int kRadiusRounds = 6;

Eigen::AlignedBox3d bounds_of(std::span<const Vec3> points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  return box;
}

Eigen::AlignedBox3d bounds_of(std::span<const Sphere> spheres) {
  Eigen::AlignedBox3d box;
  for (const Sphere& sphere : spheres) {
    box.extend(Vec3(sphere.center.array() - sphere.radius));
    box.extend(Vec3(sphere.center.array() + sphere.radius));
  }
  return box;
}

/// Points inside, at least `count`: on a finer grid where the solid is thin.
std::vector<Vec3> sample_inside(const Mesh& mesh, int count) {
  if (mesh.vertices.empty()) throw InputError("spheres: found an empty mesh, expected a solid");
  const double size = bounds_of(mesh.vertices).sizes().maxCoeff();
  for (int cells = kCells; cells <= 8 * kCells; cells *= 2) {
    std::vector<Vec3> points = find_inside_points(mesh, size / cells);
    if (int(points.size()) >= 8 * count) return points;
  }
  throw InputError("spheres: found no room inside the mesh, expected a closed solid");
}

int find_nearest(std::span<const Vec3> centers, const Vec3& point) {
  const auto nearer = [&](const Vec3& a, const Vec3& b) {
    return (a - point).squaredNorm() < (b - point).squaredNorm();
  };
  return int(std::min_element(centers.begin(), centers.end(), nearer) - centers.begin());
}

/// Starts for k-means, without chance: first the point farthest from the centroid, then always the one
/// farthest from all so far.
std::vector<Vec3> spread_centers(std::span<const Vec3> points, int count) {
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& point : points) centroid += point / double(points.size());
  std::vector<double> distances;
  for (const Vec3& point : points) distances.push_back((point - centroid).squaredNorm());
  std::vector<Vec3> centers;
  while (int(centers.size()) < count) {
    const Vec3 farthest = points[std::max_element(distances.begin(), distances.end()) - distances.begin()];
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = (points[i] - farthest).squaredNorm();
      distances[i] = centers.empty() ? distance : std::min(distances[i], distance);
    }
    centers.push_back(farthest);
  }
  return centers;
}

/// k-means by Lloyd's rounds. Each radius is that of a ball of its cluster's share of `volume`.
std::vector<Sphere> find_clusters(std::span<const Vec3> points, int count, double volume) {
  std::vector<Vec3> centers = spread_centers(points, count);
  std::vector<int> members(count);
  for (int round = 0; round < kLloydRounds; ++round) {
    std::vector<Vec3> sums(count, Vec3::Zero());
    std::fill(members.begin(), members.end(), 0);
    for (const Vec3& point : points) {
      const int nearest = find_nearest(centers, point);
      sums[nearest] += point;
      ++members[nearest];
    }
    for (int i = 0; i < count; ++i)
      if (members[i] > 0) centers[i] = sums[i] / members[i];
  }
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    const double share = volume * std::max(members[i], 1) / double(points.size());
    spheres.push_back({centers[i], std::cbrt(0.75 * share / std::numbers::pi)});
  }
  return spheres;
}

/// Volume of the union, by points of a grid.
double measure_union(std::span<const Sphere> spheres) {
  const Eigen::AlignedBox3d box = bounds_of(spheres);
  const double cell = box.sizes().maxCoeff() / kCells;
  const Eigen::Vector3i cells = (box.sizes() / cell).array().ceil().cast<int>();
  const auto covers = [](const Vec3& point) {
    return [&point](const Sphere& sphere) {
      return (point - sphere.center).squaredNorm() < sphere.radius * sphere.radius;
    };
  };
  int covered = 0;
  for (int i = 0; i < cells.x(); ++i)
    for (int j = 0; j < cells.y(); ++j)
      for (int k = 0; k < cells.z(); ++k) {
        const Vec3 point = box.min() + cell * (Vec3(i, j, k) + Vec3::Constant(0.5));
        covered += std::any_of(spheres.begin(), spheres.end(), covers(point));
      }
  return covered * cell * cell * cell;
}

/// How far the union is from the solid in volume (relative) and in each of the six sides of the bounding box
/// (over the size).
double measure_misfit(std::span<const Sphere> spheres, double volume, const Eigen::AlignedBox3d& bounds) {
  const Eigen::AlignedBox3d box = bounds_of(spheres);
  const double size = bounds.sizes().maxCoeff();
  const double extent_misfit =
      ((box.min() - bounds.min()).cwiseAbs() + (box.max() - bounds.max()).cwiseAbs()).sum() / size;
  return std::abs(measure_union(spheres) / volume - 1.0) + extent_misfit;
}

/// One radius at a time, up or down by `step`, while the fit improves.
void fit_radii(std::vector<Sphere>& spheres, double volume, const Eigen::AlignedBox3d& bounds) {
  double misfit = measure_misfit(spheres, volume, bounds), step = 0.2;
  for (int round = 0; round < kRadiusRounds; ++round, step *= 0.6)
    for (Sphere& sphere : spheres)
      for (double factor : {1.0 + step, 1.0 / (1.0 + step)}) {
        const double radius = sphere.radius;
        sphere.radius *= factor;
        const double changed = measure_misfit(spheres, volume, bounds);
        if (changed < misfit)
          misfit = changed;
        else
          sphere.radius = radius;
      }
}

}  // namespace

std::vector<Sphere> fit_spheres(const Mesh& mesh, int count) {
  if (count < 1 || count > 1000) throw_input_error("spheres", std::to_string(count), "1 … 1000");
  const std::vector<Vec3> points = sample_inside(mesh, count);
  const double volume = measure_mass_properties(mesh).volume;
  std::vector<Sphere> spheres = find_clusters(points, count, volume);
  fit_radii(spheres, volume, bounds_of(mesh.vertices));
  return spheres;
}

}  // namespace lodestone
