// Checking and repairing a mesh: weld, drop what bounds nothing, orient.
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "reference/error.h"
#include "reference/mesh/mass_properties.h"
#include "reference/mesh/mesh.h"
#include "reference/mesh/mesh_drop.h"
#include "reference/mesh/mesh_orient.h"
#include "reference/mesh/mesh_weld.h"

namespace lodestone {
namespace {

constexpr double kWeldDistance = 1e-7;  // × size: a unit in the last place of a float coordinate
constexpr double kLeastVolume = 1e-12;  // × size³: below it is rounding
constexpr double kMinExtent = 1e-4, kMaxExtent = 1e4;  // m

double extent_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  return mesh.vertices.empty() ? 0.0 : box.sizes().maxCoeff();
}

void require_sound_numbers(const Mesh& mesh, const std::string& name) {
  const auto bad =
      std::count_if(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& v) { return !v.allFinite(); });
  if (bad > 0)
    throw InputError(fmt::format("{}: found {} vertices that are not finite, expected none", name, bad));
  const auto is_outside = [&](int i) { return i < 0 || i >= int(mesh.vertices.size()); };
  const auto wrong = std::count_if(mesh.faces.begin(), mesh.faces.end(), [&](const auto& f) {
    return std::any_of(f.begin(), f.end(), is_outside);
  });
  if (wrong > 0)
    throw InputError(fmt::format("{}: found {} faces with indices out of range, expected 0 … {}", name, wrong,
                                 int(mesh.vertices.size()) - 1));
}

void require_sound_extent(double extent, const std::string& name) {
  if (!(extent >= kMinExtent && extent <= kMaxExtent))
    throw InputError(fmt::format("{}: found an extent of {:g} m, expected {:g} … {:g} m (wrong unit?)", name,
                                 extent, kMinExtent, kMaxExtent));
}

void require_faces(const Mesh& mesh, const std::string& name, const MeshReport& report) {
  if (mesh.faces.size() >= 4) return;
  std::string besides;
  if (report.degenerate_faces_dropped > 0)
    besides += fmt::format(", beside {} without area", report.degenerate_faces_dropped);
  if (report.duplicate_faces_dropped > 0)
    besides += fmt::format(", beside {} on the same corners", report.duplicate_faces_dropped);
  throw InputError(
      fmt::format("{}: found {} faces{}, expected at least 4", name, mesh.faces.size(), besides));
}

void require_volume(const Mesh& mesh, const std::string& name, const MeshReport& report) {
  const double volume = measure_mass_properties(mesh).volume;
  if (report.closed() && !(volume > kLeastVolume * std::pow(extent_of(mesh), 3)))
    throw InputError(fmt::format("{}: found a volume of {:g} m³, expected a solid", name, volume));
}

}  // namespace

Mesh repair_mesh(Mesh mesh, const std::string& name, MeshReport* report) {
  MeshReport found;
  require_sound_numbers(mesh, name);
  if (mesh.faces.empty()) throw InputError(name + ": found no faces, expected at least 4");
  found.unused_vertices_dropped = drop_unused_vertices(mesh);
  const double extent = extent_of(mesh);
  require_sound_extent(extent, name);

  found.vertices_welded = weld_vertices(mesh, kWeldDistance * extent);
  found.degenerate_faces_dropped = drop_degenerate_faces(mesh);
  found.duplicate_faces_dropped = drop_duplicate_faces(mesh);
  found.degenerate_faces_dropped += drop_flat_faces(mesh, kWeldDistance * extent);
  found.unused_vertices_dropped += drop_unused_vertices(mesh) - found.vertices_welded;
  require_faces(mesh, name, found);

  orient_faces(mesh, name, found);
  require_volume(mesh, name, found);
  if (report) *report = found;
  return mesh;
}

Mesh scale_to_size(Mesh mesh, double size_m) {
  if (!(size_m > 0.0) || !std::isfinite(size_m))
    throw InputError(fmt::format("size: found {} m, expected a positive, finite length", size_m));
  const double extent = extent_of(mesh);
  if (!(extent > 0.0) || !std::isfinite(extent))
    throw InputError(
        fmt::format("mesh: found an extent of {}, expected a positive, finite one to scale", extent));
  for (Vec3& vertex : mesh.vertices) vertex *= size_m / extent;
  return mesh;
}

std::uint64_t hash_of(const Mesh& mesh) {
  const std::uint64_t vertices = XXH3_64bits(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3));
  return XXH3_64bits_withSeed(mesh.faces.data(), mesh.faces.size() * sizeof(mesh.faces[0]), vertices);
}

}  // namespace lodestone
