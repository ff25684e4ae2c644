// The `shapes:` of a scene.
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "reference/error.h"
#include "scenes/scene.h"
#include "scenes/shape_source.h"
#include "scenes/yaml_cursor.h"

namespace lodestone {

/// A shape with what bodies of it have unless they say otherwise.
struct SceneShape {
  std::shared_ptr<const Shape> shape = {};
  MaterialId material = 0;
  std::optional<double> mass = {};  ///< kg
};

/// By name. `search`: the scene's folder, then the mesh paths.
std::map<std::string, SceneShape> load_shapes(const YamlCursor& root, const Scene& scene,
                                              const ShapeOptions& search);

/// Puts what a mesh's maker found (`name: found …, expected …`) where the scene asked for the mesh.
[[noreturn]] void fail_at(const YamlCursor& place, const InputError& error, const std::string& hint = "");

}  // namespace lodestone
