#include "reference/mesh/simplified_shapes.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <optional>

#include "reference/error.h"
#include "reference/mesh/edge_collapse.h"

namespace lodestone {
namespace {

/// About the middle of the bounding box, its longest side 1: copies at any scale then simplify alike.
struct Normalized {
  Mesh mesh;
  Vec3 middle = Vec3::Zero();
  double size = 1.0;
};

Normalized normalize(Mesh mesh, MeshReport& report) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  if (mesh.vertices.empty() || !(box.sizes().maxCoeff() > 0.0))
    throw InputError("mesh: found no extent, expected a solid to simplify");
  const Vec3 middle = box.center();
  const double size = box.sizes().maxCoeff();
  for (Vec3& vertex : mesh.vertices) vertex = (vertex - middle) / size;
  return {repair_mesh(std::move(mesh), "mesh to simplify", &report), middle, size};
}

/// Simplified by meshoptimizer: fast, but thin parts may come out pinched or torn.
Mesh run_meshoptimizer(const Mesh& mesh, int faces, double& error) {
  std::vector<float> positions;
  for (const Vec3& vertex : mesh.vertices)
    for (double coordinate : vertex) positions.push_back(float(coordinate));
  std::vector<unsigned> indices;
  for (const auto& face : mesh.faces) indices.insert(indices.end(), face.begin(), face.end());
  std::vector<unsigned> kept(indices.size());
  float relative_error = 0.0f;
  kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), positions.data(),
                               mesh.vertices.size(), 3 * sizeof(float), 3 * std::size_t(faces), 1.0f,
                               meshopt_SimplifyLockBorder, &relative_error));
  error = relative_error;
  Mesh simplified{mesh.vertices, {}};
  for (std::size_t i = 0; i < kept.size(); i += 3)
    simplified.faces.push_back({int(kept[i]), int(kept[i + 1]), int(kept[i + 2])});
  return simplified;
}

/// Repaired, or nothing where it is more open or in more pieces than the whole mesh was.
std::optional<Mesh> repair_simplified(Mesh mesh, const MeshReport& whole) {
  MeshReport report;
  try {
    mesh = repair_mesh(std::move(mesh), "simplified mesh", &report);
  } catch (const InputError&) {
    return std::nullopt;  // so coarse that it bounds nothing
  }
  const bool is_sound = report.components <= whole.components && report.open_edges <= whole.open_edges &&
                        report.non_manifold_edges <= whole.non_manifold_edges;
  return is_sound ? std::optional(std::move(mesh)) : std::nullopt;
}

}  // namespace

Mesh simplify_mesh(const Mesh& mesh, int faces, double* error_m) {
  if (faces < 4) throw InputError(fmt::format("faces: found {}, expected at least 4", faces));
  if (error_m) *error_m = 0.0;
  if (int(mesh.faces.size()) <= faces) return mesh;
  MeshReport report;
  const Normalized whole = normalize(mesh, report);
  Mesh simplified = whole.mesh;

  // The coarsest sound mesh that meshoptimizer finds, and from there by collapses that cannot tear.
  double fast_error = 0.0, safe_error = 0.0;
  for (int target = faces; target < int(whole.mesh.faces.size()); target *= 2) {
    auto sound = repair_simplified(run_meshoptimizer(whole.mesh, target, fast_error), report);
    if (!sound || int(sound->faces.size()) < faces - 1) continue;
    simplified = std::move(*sound);
    break;
  }
  if (int(simplified.faces.size()) > faces) simplified = collapse_edges(simplified, faces, &safe_error);
  simplified = repair_mesh(std::move(simplified), "simplified mesh");
  if (int(simplified.faces.size()) > 1.1 * faces)
    throw InputError(
        fmt::format("faces: found {}, expected at least the {} with which this mesh keeps its form", faces,
                    simplified.faces.size()));
  for (Vec3& vertex : simplified.vertices) vertex = whole.middle + whole.size * vertex;
  if (error_m) *error_m = (fast_error + safe_error) * whole.size;
  return simplified;
}

}  // namespace lodestone
