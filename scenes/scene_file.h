// Loads scenes from YAML. Every error reads `file:line: key: found …, expected …`.
#pragma once

#include "scenes/scene.h"

namespace lodestone {

struct SceneLoadSettings {
  std::vector<std::filesystem::path> mesh_paths;  ///< searched after the scene's own folder
  std::optional<std::uint64_t> seed;              ///< replaces the scene's, for scatters too
  int max_bodies = 2'000'000;
  bool untrusted = false;  ///< read mesh files in a child process with limits of memory and time
};

/// Throws InputError, and loads nothing, for anything that is not a valid scene (unknown keys are errors).
Scene load_scene(const std::filesystem::path& file, const SceneLoadSettings& settings = {});

}  // namespace lodestone
