// Triangle meshes: the value, loading from a file with checks and repair, and the solids that need no file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

/// Vertices (m) and counter-clockwise faces seen from outside (indices into `vertices`).
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> faces;
};

/// What was found and mended while a mesh was checked.
struct MeshReport {
  int vertices_welded = 0;
  int degenerate_faces_dropped = 0;
  int duplicate_faces_dropped = 0;
  int faces_flipped = 0;  ///< turned so that neighbours agree and normals point out of the solid
  int unused_vertices_dropped = 0;
  int open_edges = 0;          ///< edges with one face only
  int non_manifold_edges = 0;  ///< edges with more than two faces
  int components = 0;          ///< pieces connected through shared edges
  bool closed() const { return open_edges == 0 && non_manifold_edges == 0; }
};

struct MeshLoadSettings {
  std::uintmax_t max_bytes = 256u << 20;
  int max_faces = 1'000'000;
  /// Read in a child process with limits of memory and time, whose death is an InputError.
  bool untrusted = false;
};

/// Reads a mesh file (OBJ, PLY, STL, glTF or 3DS) with every mesh of the file joined, vertices in the file's
/// own units. Checks each index and coordinate. Throws InputError naming the file and the defect.
Mesh load_mesh(const std::filesystem::path& file, const MeshLoadSettings& settings = {});

/// Welds vertices within 1e-7 × size, drops degenerate and duplicate faces and unused vertices, orients faces
/// consistently and out of the solid: a piece inside another bounds a cavity. Open edges and edges with more
/// than two faces are counted and left. Throws InputError, with `name` at its head, where what is left bounds
/// no volume: fewer than four faces, coordinates not finite, indices out of range, an extent outside 1e-4 …
/// 1e4 m, a volume of zero; and for a one-sided surface or over 1,000 pieces.
Mesh repair_mesh(Mesh mesh, const std::string& name, MeshReport* report = nullptr);

/// Scales about the origin so that the longest side of the bounding box is `size_m`. Throws InputError unless
/// that is positive and finite, and for a mesh without an extent.
Mesh scale_to_size(Mesh mesh, double size_m);

/// Solids, centred on the middle of their bounding box. Full sides; throws InputError unless every length is
/// positive and finite.
Mesh make_box(const Vec3& sides_m);
Mesh make_sphere(double radius_m, int subdivisions = 3);  ///< icosphere; 0 … 7 subdivisions, 20 · 4ⁿ faces
/// Outer legs a along x, b along y, the width less than both; extruded along z.
Mesh make_l(double leg_a_m, double leg_b_m, double width_m, double thickness_m);
/// Hexagonal prism along z, `length_m` long, circumradius `radius_m`.
Mesh make_needle(double length_m, double radius_m);

/// Hash of vertices and faces (xxHash of their bytes).
std::uint64_t hash_of(const Mesh& mesh);

}  // namespace lodestone
