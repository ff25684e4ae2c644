// The `ground:` of a scene.
#pragma once

#include <vector>

#include "scenes/scene.h"
#include "scenes/shape_source.h"
#include "scenes/yaml_cursor.h"

namespace lodestone {

/// `search`: the scene's folder, then the mesh paths.
std::vector<SceneGround> load_ground(const YamlCursor& root, const Scene& scene, const ShapeOptions& search);

}  // namespace lodestone
