#include "reference/simplified_shapes.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <optional>

#include "reference/error.h"

namespace lodestone {
namespace {

constexpr int kAttempts = 12;

/// About the middle of the bounding box, its longest side 1: copies at any scale then simplify alike.
struct Normalized {
  Mesh mesh;
  Vec3 middle = Vec3::Zero();
  double size = 1.0;
};

Normalized normalize(Mesh mesh, MeshReport& report) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  if (mesh.vertices.empty() || !(box.sizes().maxCoeff() > 0.0)) throw InputError("mesh: found no extent, expected a solid to simplify");
  const Vec3 middle = box.center();
  const double size = box.sizes().maxCoeff();
  for (Vec3& vertex : mesh.vertices) vertex = (vertex - middle) / size;
  return {repair_mesh(std::move(mesh), "mesh to simplify", &report), middle, size};
}

/// What meshoptimizer makes of a mesh, as it comes: it may hold a fin or a pinched edge.
struct Simplified {
  Mesh mesh;
  double error = 0.0;
};

Simplified simplify_once(const Mesh& mesh, int faces) {
  std::vector<float> positions;
  for (const Vec3& vertex : mesh.vertices) positions.insert(positions.end(), {float(vertex.x()), float(vertex.y()), float(vertex.z())});
  std::vector<unsigned> indices;
  for (const auto& face : mesh.faces) indices.insert(indices.end(), face.begin(), face.end());
  std::vector<unsigned> kept(indices.size());
  float error = 0.0f;
  kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), positions.data(), mesh.vertices.size(), 3 * sizeof(float),
                               3 * std::size_t(faces), 1.0f, 0, &error));
  Simplified simplified{{mesh.vertices, {}}, error};
  for (std::size_t i = 0; i < kept.size(); i += 3) simplified.mesh.faces.push_back({int(kept[i]), int(kept[i + 1]), int(kept[i + 2])});
  return simplified;
}

/// Repaired, and nothing where that tore it open or apart.
std::optional<Mesh> repair_simplified(Mesh mesh, const MeshReport& whole) {
  try {
    MeshReport report;
    Mesh repaired = repair_mesh(std::move(mesh), "simplified mesh", &report);
    const bool is_sound = report.components <= whole.components && report.open_edges <= whole.open_edges && report.non_manifold_edges <= whole.non_manifold_edges;
    if (is_sound) return repaired;
  } catch (const InputError&) {
    // so few faces bound nothing: as good as torn
  }
  return std::nullopt;
}

}  // namespace

Mesh simplify_mesh(const Mesh& mesh, int faces, double* error_m) {
  if (faces < 4) throw InputError(fmt::format("faces: found {}, expected at least 4", faces));
  if (error_m) *error_m = 0.0;
  if (int(mesh.faces.size()) <= faces) return mesh;
  MeshReport whole;
  const Normalized normalized = normalize(mesh, whole);

  // Repair takes fins away, two faces each: ask for a few more until exactly as many as wanted are left.
  std::optional<Mesh> best;
  for (int attempt = 0; attempt < kAttempts && (!best || int(best->faces.size()) < faces); ++attempt) {
    const Simplified simplified = simplify_once(normalized.mesh, faces + 2 * attempt);
    auto repaired = repair_simplified(simplified.mesh, whole);
    if (!repaired || int(repaired->faces.size()) > faces || (best && repaired->faces.size() <= best->faces.size())) continue;
    best = std::move(repaired);
    if (error_m) *error_m = simplified.error * normalized.size;
  }
  if (!best || int(best->faces.size()) < 0.9 * faces)
    throw InputError(fmt::format("faces: found {} that a simplified mesh cannot keep to, expected more (it has {})", faces, mesh.faces.size()));
  for (Vec3& vertex : best->vertices) vertex = normalized.middle + normalized.size * vertex;
  return *best;
}

}  // namespace lodestone
