// The `ragdolls:` of a scene: figures of six boxes on joints.
#pragma once

#include "scenes/scene.h"
#include "scenes/yaml_cursor.h"

namespace lodestone {

/// Adds each ragdoll's bodies, which are full throughout, its joints and its group to `scene`. Its bodies are
/// called `NAME torso`, `head`, `left arm`, `right arm`, `left leg`, `right leg`.
void load_ragdolls(const YamlCursor& root, Scene& scene);

}  // namespace lodestone
