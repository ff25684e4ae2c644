// A shape by description, as the command line and scenes give it: `box:X,Y,Z`, `sphere:R`, `l:A,B,W,T`,
// `plate:X,Y,Z`, `needle:L,R`, `bunny` or a mesh file.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "reference/shape.h"

namespace lodestone {

struct ShapeOptions {
  std::optional<double> size_m = {};               ///< longest side of the bounding box (meshes; bunny: .2)
  std::optional<int> faces = {};                   ///< simplify to this many (meshes; bunny: 4,698)
  std::vector<std::filesystem::path> search = {};  ///< folders that a mesh file is looked up in, in order
  /// Refuse a mesh file outside those folders (scenes, which may come from strangers).
  bool stay_in_search = false;
  bool untrusted = false;  ///< read mesh files in a child process with limits
};

/// A solid given by a few lengths (m).
enum class SolidKind { box, sphere, l, plate, needle };

/// How a solid is written: `box:X,Y,Z` on the command line, `box_m: [X, Y, Z]` in a scene.
struct SolidForm {
  SolidKind kind;
  std::string_view name, scene_key, lengths;
  int length_count;
};
std::span<const SolidForm> solid_forms();

/// `lengths_m` as the form lists them. Throws InputError where they make no solid.
Shape make_solid(SolidKind kind, std::span<const double> lengths_m, const MassOverride& mass = {});

/// `bunny`, or a mesh file found by find_mesh_file. `report`, when given, says what was mended.
Shape make_mesh_shape(const std::string& mesh, const ShapeOptions& options, const MassOverride& mass = {},
                      MeshReport* report = nullptr);

/// Where `name` is, in the first of `options.search` that has it (no folders: the working folder). Throws
/// InputError saying where it was looked for, or that it leaves the folders.
std::filesystem::path find_mesh_file(const std::string& name, const ShapeOptions& options);

/// Throws InputError saying what was found and which forms there are; for a missing mesh, where it was looked
/// for. ArgumentError for a size or a number of faces of what is no mesh.
Shape make_shape_from_text(const std::string& text, const ShapeOptions& options = {},
                           const MassOverride& mass = {}, MeshReport* report = nullptr);

}  // namespace lodestone
