// The `materials:` and `contacts:` of a scene.
#pragma once

#include "scenes/scene.h"
#include "scenes/yaml_cursor.h"

namespace lodestone {

/// Fills `scene.materials` and `material_names` (0 is `default`; what a material leaves out is as in
/// `default`).
void load_materials(const YamlCursor& root, Scene& scene);

/// The material that `place` names, or 0 where there is no `material:` key beside it.
MaterialId load_material_id(const YamlCursor& place, const Scene& scene, MaterialId otherwise = 0);

}  // namespace lodestone
