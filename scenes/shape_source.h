// A shape by description, as the command line and scenes give it: `box:X,Y,Z`, `sphere:R`, `l:A,B,W,T`, `plate:X,Y,Z`, `needle:L,R`, `bunny` or a mesh file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reference/shape.h"

namespace lodestone {

struct ShapeOptions {
  std::optional<double> size_m;  ///< longest side of the bounding box (meshes; bunny: .2)
  std::optional<int> faces;      ///< simplify to this many (meshes; bunny: 4,698)
  std::vector<std::filesystem::path> search;  ///< folders that a mesh file is looked up in, in order
};

/// Throws InputError saying what was found and which forms there are; for a missing mesh, where it was looked for.
Shape make_shape_from_text(const std::string& text, const ShapeOptions& options = {}, const MassOverride& mass = {});

}  // namespace lodestone
