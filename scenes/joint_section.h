// The `joints:` of a scene.
#pragma once

#include "scenes/scene.h"
#include "scenes/yaml_cursor.h"

namespace lodestone {

/// Adds to `scene.joints`, between bodies of `scene.bodies` by their names, and makes these full.
void load_joints(const YamlCursor& root, Scene& scene);

}  // namespace lodestone
