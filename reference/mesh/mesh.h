// Triangle meshes: the type, loading one from a file, checking and repairing it, and solids that need no
// file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

/// Vertices (m), and triangles, each of three indices into `vertices`, counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> faces;
};

/// What repair_mesh found and mended.
struct MeshReport {
  int vertices_welded = 0;
  int degenerate_faces_dropped = 0;
  int duplicate_faces_dropped = 0;
  int faces_flipped = 0;  ///< turned, so that neighbours agree and normals point out of the solid
  int unused_vertices_dropped = 0;
  int open_edges = 0;          ///< edges with only one face
  int non_manifold_edges = 0;  ///< edges with more than two faces
  int components = 0;          ///< pieces of faces that are connected through edges
  bool closed() const { return open_edges == 0 && non_manifold_edges == 0; }
};

/// Which files load_mesh accepts.
struct MeshLoadSettings {
  std::uintmax_t max_bytes = 256u << 20;  ///< of the file
  int max_faces = 1'000'000;              ///< triangles; and at most three times as many vertices
  /// Whether the file is read in a child process with limits of memory and time; if that dies, it is an
  /// InputError.
  bool untrusted = false;
};

/// Reads a mesh file, whose extension is obj, ply, stl, gltf, glb or 3ds. All meshes in the file are joined;
/// vertices are in the file's own units. Every index and coordinate is checked. Throws InputError, which
/// names the file and what is wrong with it.
Mesh load_mesh(const std::filesystem::path& file, const MeshLoadSettings& settings = {});

/// Welds vertices within 1e-7 × size, drops degenerate and duplicate faces and unused vertices, and turns
/// faces so that they agree and look out of the solid; a closed piece inside another bounds a cavity. Open
/// edges and edges with more than two faces are counted and left as they are. Throws InputError, which begins
/// with `name`, for coordinates that are not finite, indices out of range, an extent outside 1e-4 … 1e4 m,
/// fewer than four faces left, a one-sided surface, more than 1,000 pieces, or a closed mesh without a
/// volume.
Mesh repair_mesh(Mesh mesh, const std::string& name, MeshReport* report = nullptr);

/// Scales about the origin so that the longest side of the bounding box is `size_m`. Throws InputError unless
/// `size_m` and the extent of the mesh are positive and finite.
Mesh scale_to_size(Mesh mesh, double size_m);

// Solids, the middle of whose bounding box is the origin. They throw InputError unless every length is
// positive and finite.
Mesh make_box(const Vec3& sides_m);  ///< whole edge lengths
/// An icosphere of 20 · 4ⁿ faces for n `subdivisions`, 0 … 7 (else InputError).
Mesh make_sphere(double radius_m, int subdivisions = 3);
/// An L whose outer legs lie along x (a) and y (b), extruded along z. InputError unless the width is less
/// than both legs.
Mesh make_l(double leg_a_m, double leg_b_m, double width_m, double thickness_m);
/// A hexagonal prism along z, `length_m` long, of circumradius `radius_m`.
Mesh make_needle(double length_m, double radius_m);

/// Hash of the bytes of vertices and faces (xxHash).
std::uint64_t hash_of(const Mesh& mesh);

}  // namespace lodestone
