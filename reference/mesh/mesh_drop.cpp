#include "reference/mesh/mesh_drop.h"

#include <xxhash.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "reference/mesh/mesh_edges.h"

namespace lodestone {
namespace {

/// Drops the faces for which `is_dropped`, and counts them.
template <typename Predicate>
int drop_faces(Mesh& mesh, Predicate is_dropped) {
  return int(std::erase_if(mesh.faces, is_dropped));
}

/// Faces on the same three corners, whichever way round: how many there are, and their forward less their
/// backward ones.
struct Duplicates {
  int count = 0, net = 0;
};

struct CornersHash {
  std::size_t operator()(const std::array<int, 3>& face) const {
    return XXH3_64bits(face.data(), sizeof(face));
  }
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

/// Edges that do not join exactly two faces.
int count_defects(const Mesh& mesh) {
  int defects = 0;
  visit_edges(mesh, [&](std::span<const EdgeUse> uses) { defects += uses.size() != 2; });
  return defects;
}

}  // namespace

int drop_degenerate_faces(Mesh& mesh) {
  return drop_faces(mesh, [](const auto& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
}

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
    return drop_faces(from, [&](const auto& face) {
      return std::exchange(left[sorted_corners(face).first].count, 0) == 0;
    });
  };
  const int repeated_beside = drop_all_but_first(without_pairs), repeated = drop_all_but_first(mesh);
  const bool are_fins = !without_pairs.faces.empty() && count_defects(without_pairs) < count_defects(mesh);
  if (!are_fins) return repeated;
  mesh = std::move(without_pairs);
  return in_pairs + repeated_beside;
}

int drop_flat_faces(Mesh& mesh, double distance_m) {
  const auto is_flat = [&](const std::array<int, 3>& face) {
    const Vec3 ab = mesh.vertices[face[1]] - mesh.vertices[face[0]],
               ac = mesh.vertices[face[2]] - mesh.vertices[face[0]];
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    return ab.cross(ac).norm() <= distance_m * longest;  // height above the longest side within `distance_m`
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

}  // namespace lodestone
