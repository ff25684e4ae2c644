#include "reference/mesh/mesh_orient.h"

#include <fmt/format.h>

#include <algorithm>

#include "reference/error.h"
#include "reference/mesh/inside.h"
#include "reference/mesh/mass_properties.h"
#include "reference/mesh/mesh_edges.h"

namespace lodestone {
namespace {

constexpr int kMaxPieces = 1000;

/// A face's neighbour across an edge that belongs to these two alone; `opposed` where their directions along
/// it disagree as they should.
struct Neighbor {
  int face = -1;
  bool opposed = true;
};
using Neighbors = std::vector<std::array<Neighbor, 3>>;

/// Also counts the edges that do not join exactly two faces.
Neighbors find_neighbors(const Mesh& mesh, MeshReport& report) {
  Neighbors neighbors(mesh.faces.size());
  std::vector<int> found(mesh.faces.size(), 0);
  visit_edges(mesh, [&](std::span<const EdgeUse> uses) {
    if (uses.size() == 1) ++report.open_edges;
    if (uses.size() > 2) ++report.non_manifold_edges;
    if (uses.size() != 2) return;
    const EdgeUse &a = uses[0], &b = uses[1];
    neighbors[a.face][found[a.face]++] = {b.face, a.forward != b.forward};
    neighbors[b.face][found[b.face]++] = {a.face, a.forward != b.forward};
  });
  return neighbors;
}

/// Faces joined through their edges. `open` where some edge of theirs does not join exactly two faces.
struct Piece {
  std::vector<int> faces;
  bool open = false;
};

/// The pieces, and in `flipped` the faces to turn so that each piece agrees with its own first face.
std::vector<Piece> find_pieces(const Neighbors& neighbors, const std::string& name,
                               std::vector<bool>& flipped) {
  std::vector<Piece> pieces;
  std::vector<bool> reached(neighbors.size(), false);
  flipped.assign(neighbors.size(), false);
  for (int first = 0; first < int(neighbors.size()); ++first) {
    if (reached[first]) continue;
    if (int(pieces.size()) == kMaxPieces)
      throw InputError(
          fmt::format("{}: found over {} separate pieces, expected one solid", name, kMaxPieces));
    reached[first] = true;
    Piece piece{{first}};
    for (std::size_t next = 0; next < piece.faces.size(); ++next) {
      const int face = piece.faces[next];
      for (const auto& [other, opposed] : neighbors[face]) {
        if (other < 0) piece.open = true;
        if (other < 0) continue;
        const bool turned = flipped[face] == opposed;
        if (reached[other] && flipped[other] != turned)
          throw InputError(name + ": found a one-sided surface, expected one with an inside and an outside");
        if (reached[other]) continue;
        reached[other] = true;
        flipped[other] = turned;
        piece.faces.push_back(other);
      }
    }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

Mesh extract(const Mesh& mesh, const Piece& piece) {
  Mesh part;
  for (int face : piece.faces) {
    for (int& vertex : part.faces.emplace_back(mesh.faces[face])) {
      part.vertices.push_back(mesh.vertices[vertex]);
      vertex = int(part.vertices.size()) - 1;
    }
  }
  return part;
}

Eigen::AlignedBox3d bounds_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

// Vertices that are asked whether they lie inside, spread over a piece.
constexpr std::size_t kAskedVertices = 64;

// What sticks in another with one end alone bounds no cavity of it.
bool contains(const Mesh& outer, const Mesh& inner) {
  const std::size_t vertices = inner.vertices.size(), asked = std::min(vertices, kAskedVertices);
  for (std::size_t i = 0; i < asked; ++i)
    if (winding_number(outer, inner.vertices[i * vertices / asked]) == 0) return false;
  return true;
}

/// For each piece, whether an odd number of closed pieces contain it: it then bounds a cavity.
std::vector<bool> find_cavities(const std::vector<Mesh>& parts, const std::vector<Piece>& pieces) {
  std::vector<bool> cavities(parts.size(), false);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const Mesh& part : parts) boxes.push_back(bounds_of(part));
  for (std::size_t outer = 0; outer < parts.size(); ++outer)
    for (std::size_t inner = 0; inner < parts.size(); ++inner)
      if (inner != outer && !pieces[outer].open && boxes[outer].contains(boxes[inner]) &&
          contains(parts[outer], parts[inner]))
        cavities[inner] = !cavities[inner];
  return cavities;
}

void flip(std::array<int, 3>& face) { std::swap(face[1], face[2]); }

}  // namespace

void orient_faces(Mesh& mesh, const std::string& name, MeshReport& report) {
  std::vector<bool> flipped;
  const std::vector<Piece> pieces = find_pieces(find_neighbors(mesh, report), name, flipped);
  report.components = int(pieces.size());
  for (std::size_t i = 0; i < flipped.size(); ++i)
    if (flipped[i]) flip(mesh.faces[i]);

  std::vector<Mesh> parts;
  for (const Piece& piece : pieces) parts.push_back(extract(mesh, piece));
  const std::vector<bool> cavities = find_cavities(parts, pieces);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const bool inwards = measure_mass_properties(parts[i]).volume < 0.0;
    if (inwards == cavities[i]) continue;
    for (int face : pieces[i].faces) {
      flip(mesh.faces[face]);
      flipped[face] = !flipped[face];
    }
  }
  report.faces_flipped += int(std::count(flipped.begin(), flipped.end(), true));
}

}  // namespace lodestone
