#include "signature/measure/rest_poses.h"

#include <algorithm>
#include <cmath>

#include "reference/hull/resting_faces.h"
#include "reference/hull/spiral_directions.h"
#include "signature/measure/settling_trial.h"

namespace lodestone {
namespace {

struct Cluster {
  Vec3 first, normals = Vec3::Zero();
  double heights = 0.0;
  int count = 0;
};

std::vector<Cluster> cluster_normals(std::span<const SettlingRecord> records) {
  std::vector<Cluster> clusters;
  for (const SettlingRecord& r : records) {
    if (!r.rests) continue;
    auto same = std::find_if(clusters.begin(), clusters.end(),
                             [&](const Cluster& c) { return c.first.dot(r.normal) > std::cos(kSamePose); });
    if (same == clusters.end()) same = clusters.insert(clusters.end(), {r.normal});
    same->normals += r.normal;
    same->heights += r.height;
    ++same->count;
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Cluster& a, const Cluster& b) { return a.count > b.count; });
  return clusters;
}

void add_basins(const Shape& shape, std::vector<RestPose>& poses) {
  constexpr int kDirections = 5000;
  const RestingFaces resting(shape.hull);
  std::vector<int> of_face(resting.faces().size());
  for (int i = 0; i < kDirections; ++i)
    ++of_face[std::size_t(resting.find_quasistatic(spiral_direction(i, kDirections)))];
  for (std::size_t face = 0; face < of_face.size(); ++face) {
    const auto nearest = std::ranges::max_element(
        poses, {}, [&](const RestPose& p) { return p.normal.dot(resting.faces()[face].normal); });
    if (nearest != poses.end() && nearest->normal.dot(resting.faces()[face].normal) > std::cos(kSamePose))
      nearest->basin += double(of_face[face]) / kDirections;
  }
}

}  // namespace

std::vector<RestPose> find_rest_poses(std::span<const SettlingRecord> records, const Shape& shape,
                                      double frequency_min) {
  std::vector<RestPose> poses;
  for (const Cluster& c : cluster_normals(records)) {
    const double frequency = double(c.count) / double(records.size());
    if (frequency >= frequency_min)
      poses.push_back({c.normals.normalized(), c.heights / c.count / shape.radius, frequency, 0.0});
  }
  if (!shape.sphere_radius) add_basins(shape, poses);
  return poses;
}

}  // namespace lodestone
