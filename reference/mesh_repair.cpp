// Checking and repairing a mesh: weld, drop what bounds nothing, orient.
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "reference/error.h"
#include "reference/mass_properties.h"
#include "reference/mesh.h"
#include "reference/mesh_orient.h"

namespace lodestone {
namespace {

constexpr double kWeldDistance = 1e-7;           // × size: a unit in the last place of a float coordinate
constexpr double kLeastVolume = 1e-12;           // × size³: below it is rounding
constexpr double kMinExtent = 1e-4, kMaxExtent = 1e4;  // m

double extent_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  return mesh.vertices.empty() ? 0.0 : box.sizes().maxCoeff();
}

void require_sound_numbers(const Mesh& mesh, const std::string& name) {
  const auto bad = std::count_if(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& v) { return !v.allFinite(); });
  if (bad > 0) throw InputError(fmt::format("{}: found {} vertices that are not finite", name, bad));
  const auto is_outside = [&](int i) { return i < 0 || i >= int(mesh.vertices.size()); };
  const auto wrong = std::count_if(mesh.faces.begin(), mesh.faces.end(), [&](const auto& f) { return std::any_of(f.begin(), f.end(), is_outside); });
  if (wrong > 0) throw InputError(fmt::format("{}: found {} faces with indices out of range, expected 0 … {}", name, wrong, int(mesh.vertices.size()) - 1));
}

void require_sound_extent(double extent, const std::string& name) {
  if (!(extent >= kMinExtent && extent <= kMaxExtent))
    throw InputError(fmt::format("{}: found an extent of {:g} m, expected {:g} … {:g} m (wrong unit?)", name, extent, kMinExtent, kMaxExtent));
}

/// For each vertex the first one within `distance`, on a grid of cells twice that wide.
std::vector<int> find_twins(std::span<const Vec3> vertices, double distance) {
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const { return XXH3_64bits(cell.data(), sizeof(cell)); }
  };
  const Vec3 origin = std::accumulate(vertices.begin(), vertices.end(), Vec3(vertices.front()), [](const Vec3& a, const Vec3& b) { return Vec3(a.cwiseMin(b)); });
  const auto cell_of = [&](const Vec3& point, int i) { return std::int64_t(std::floor((point[i] - origin[i]) / (2.0 * distance))); };
  std::unordered_multimap<Cell, int, CellHash> seen;
  seen.reserve(vertices.size());

  std::vector<int> twins(vertices.size());
  for (int i = 0; i < int(vertices.size()); ++i) {
    const Vec3 low = vertices[i].array() - distance, high = vertices[i].array() + distance;
    int twin = i;
    for (auto x = cell_of(low, 0); x <= cell_of(high, 0); ++x)
      for (auto y = cell_of(low, 1); y <= cell_of(high, 1); ++y)
        for (auto z = cell_of(low, 2); z <= cell_of(high, 2); ++z)
          for (auto [place, end] = seen.equal_range(Cell{x, y, z}); place != end; ++place)
            if ((vertices[place->second] - vertices[i]).norm() <= distance) twin = std::min(twin, place->second);
    twins[i] = twin;
    if (twin == i) seen.emplace(Cell{cell_of(vertices[i], 0), cell_of(vertices[i], 1), cell_of(vertices[i], 2)}, i);
  }
  return twins;
}

void weld(Mesh& mesh, double distance, MeshReport& report) {
  const std::vector<int> twins = find_twins(mesh.vertices, distance);
  for (int i = 0; i < int(twins.size()); ++i) report.vertices_welded += twins[i] != i;
  for (auto& face : mesh.faces)
    for (int& i : face) i = twins[i];
}

/// Drops the faces for which `is_dropped`, and counts them.
template <typename Predicate>
int drop_faces(Mesh& mesh, Predicate is_dropped) {
  return int(std::erase_if(mesh.faces, is_dropped));
}

/// Faces on the same three corners, whichever way round: how many there are, and their forward less their backward ones.
struct Duplicates {
  int count = 0, net = 0;
};

struct CornersHash {
  std::size_t operator()(const std::array<int, 3>& face) const { return XXH3_64bits(face.data(), sizeof(face)); }
};
using DuplicatesByCorners = std::unordered_map<std::array<int, 3>, Duplicates, CornersHash>;

/// The corners in ascending order, and whether the face runs round them that way (+1) or the other (−1).
std::pair<std::array<int, 3>, int> sorted_corners(std::array<int, 3> face) {
  const int sense = (face[0] < face[1]) + (face[1] < face[2]) + (face[2] < face[0]) == 2 ? 1 : -1;
  std::sort(face.begin(), face.end());
  return {face, sense};
}

DuplicatesByCorners find_duplicates(const Mesh& mesh) {
  DuplicatesByCorners duplicates;
  duplicates.reserve(mesh.faces.size());
  for (const auto& face : mesh.faces) {
    const auto [corners, sense] = sorted_corners(face);
    Duplicates& found = duplicates[corners];
    ++found.count;
    found.net += sense;
  }
  return duplicates;
}

int count_defects(const Mesh& mesh) {
  int defects = 0;
  const std::vector<EdgeUse> uses = find_edge_uses(mesh);
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].low == uses[begin].low && uses[end].high == uses[begin].high) ++end;
    defects += end - begin != 2;
  }
  return defects;
}

/// Of faces on the same corners keeps the first, or none where two back to back (a fin, an inner wall) are better both gone.
int drop_duplicate_faces(Mesh& mesh) {
  DuplicatesByCorners duplicates = find_duplicates(mesh);
  if (duplicates.size() == mesh.faces.size()) return 0;
  Mesh without_pairs = mesh;
  const int in_pairs = drop_faces(without_pairs, [&](const auto& face) {
    const Duplicates& found = duplicates[sorted_corners(face).first];
    return found.count > 1 && found.net == 0;
  });
  const auto drop_all_but_first = [&](Mesh& from) {
    auto left = duplicates;
    return drop_faces(from, [&](const auto& face) { return std::exchange(left[sorted_corners(face).first].count, 0) == 0; });
  };
  const int repeated_beside = drop_all_but_first(without_pairs), repeated = drop_all_but_first(mesh);
  if (count_defects(mesh) <= count_defects(without_pairs)) return repeated;
  mesh = std::move(without_pairs);
  return in_pairs + repeated_beside;
}

/// Drops faces whose three corners lie in a line, unless that would tear the surface open: such slivers may fill a seam.
int drop_flat_faces(Mesh& mesh, double distance) {
  const auto is_flat = [&](const std::array<int, 3>& face) {
    const Vec3 ab = mesh.vertices[face[1]] - mesh.vertices[face[0]], ac = mesh.vertices[face[2]] - mesh.vertices[face[0]];
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    return ab.cross(ac).norm() <= distance * longest;  // height above the longest side within `distance`
  };
  Mesh without = mesh;
  const int dropped = drop_faces(without, is_flat);
  if (dropped == 0 || count_defects(without) > count_defects(mesh)) return 0;
  mesh = std::move(without);
  return dropped;
}

int drop_unused_vertices(Mesh& mesh) {
  std::vector<int> new_index(mesh.vertices.size(), -1);
  for (const auto& face : mesh.faces)
    for (int i : face) new_index[i] = 0;
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    if (new_index[i] < 0) continue;
    new_index[i] = int(kept.size());
    kept.push_back(mesh.vertices[i]);
  }
  const int dropped = int(mesh.vertices.size() - kept.size());
  mesh.vertices = std::move(kept);
  for (auto& face : mesh.faces)
    for (int& i : face) i = new_index[i];
  return dropped;
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

  weld(mesh, kWeldDistance * extent, found);
  found.degenerate_faces_dropped = drop_faces(mesh, [](const auto& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
  found.duplicate_faces_dropped = drop_duplicate_faces(mesh);
  found.degenerate_faces_dropped += drop_flat_faces(mesh, kWeldDistance * extent);
  found.unused_vertices_dropped += drop_unused_vertices(mesh) - found.vertices_welded;
  if (mesh.faces.size() < 4) throw InputError(fmt::format("{}: found {} faces, expected at least 4", name, mesh.faces.size()));

  orient_faces(mesh, name, found);
  require_volume(mesh, name, found);
  if (report) *report = found;
  return mesh;
}

Mesh scale_to_size(Mesh mesh, double size_m) {
  if (!(size_m > 0.0) || !std::isfinite(size_m)) throw InputError(fmt::format("size: found {} m, expected a positive, finite length", size_m));
  const double extent = extent_of(mesh);
  if (!(extent > 0.0) || !std::isfinite(extent)) throw InputError(fmt::format("mesh: found an extent of {}, expected a positive, finite one to scale", extent));
  for (Vec3& vertex : mesh.vertices) vertex *= size_m / extent;
  return mesh;
}

std::uint64_t hash_of(const Mesh& mesh) {
  const std::uint64_t vertices = XXH3_64bits(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3));
  return XXH3_64bits_withSeed(mesh.faces.data(), mesh.faces.size() * sizeof(mesh.faces[0]), vertices);
}

}  // namespace lodestone
