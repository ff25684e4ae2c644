// The `bodies:` of a scene, scatters expanded.
#pragma once

#include <map>
#include <string>

#include "scenes/scene_file.h"
#include "scenes/shape_section.h"

namespace lodestone {

/// To `scene.bodies`, in the file's order. Scatters keep clear of the bodies placed one by one (wherever in
/// the list these are), of those that `scene` has, of earlier scatters and of the ground planes in
/// `scene.ground`.
void add_bodies(const YamlCursor& root, Scene& scene, const std::map<std::string, SceneShape>& shapes,
                const SceneLoadSettings& settings);

}  // namespace lodestone
