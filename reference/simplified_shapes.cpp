#include "reference/simplified_shapes.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>

#include "reference/error.h"

namespace lodestone {
namespace {

/// Vertices over the longest side of the bounding box, about its middle: scaled copies then simplify alike.
std::vector<float> normalize_positions(const Mesh& mesh, double& scale) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  scale = box.sizes().maxCoeff();
  std::vector<float> positions;
  for (const Vec3& vertex : mesh.vertices)
    for (double coordinate : Vec3((vertex - box.center()) / scale)) positions.push_back(float(coordinate));
  return positions;
}

}  // namespace

Mesh simplify_mesh(const Mesh& mesh, int faces, double* error_m) {
  if (faces < 4) throw InputError(fmt::format("faces: found {}, expected at least 4", faces));
  if (error_m) *error_m = 0.0;
  if (int(mesh.faces.size()) <= faces) return mesh;
  double scale = 1.0;
  const std::vector<float> positions = normalize_positions(mesh, scale);
  std::vector<unsigned> indices, kept(3 * mesh.faces.size());
  for (const auto& face : mesh.faces) indices.insert(indices.end(), face.begin(), face.end());
  float error = 0.0f;
  kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), positions.data(), mesh.vertices.size(), 3 * sizeof(float), 3 * std::size_t(faces), 1.0f, 0, &error));
  Mesh simplified{mesh.vertices, {}};
  for (std::size_t i = 0; i < kept.size(); i += 3) simplified.faces.push_back({int(kept[i]), int(kept[i + 1]), int(kept[i + 2])});
  if (error_m) *error_m = error * scale;
  return simplified;
}

}  // namespace lodestone
