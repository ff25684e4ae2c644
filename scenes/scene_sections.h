// What a scene file says of its bodies, in the order in which it is loaded; each section is a file of its own
// (material_section.cpp, …).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reference/error.h"
#include "scenes/scene.h"
#include "scenes/scene_file.h"
#include "scenes/shape_source.h"
#include "scenes/yaml_cursor.h"

namespace lodestone {

/// Fills `scene.materials` and `material_names` (0 is `default`; what a material leaves out is as in
/// `default`).
void load_materials(const YamlCursor& root, Scene& scene);

/// The material that `place` names, or 0 where there is no `material:` key beside it.
MaterialId load_material_id(const YamlCursor& place, const Scene& scene, MaterialId otherwise = 0);

/// A shape with what bodies of it have unless they say otherwise.
struct SceneShape {
  std::shared_ptr<const Shape> shape = {};
  MaterialId material = 0;
  std::optional<double> mass = {};  ///< kg
  std::filesystem::path file = {};  ///< of a mesh; empty: made by code
};

/// By name. `search`: the scene's folder, then the mesh paths.
std::map<std::string, SceneShape> load_shapes(const YamlCursor& root, const Scene& scene,
                                              const ShapeOptions& search);

/// Puts what a mesh's maker found (`name: found …, expected …`) where the scene asked for the mesh.
[[noreturn]] void fail_at(const YamlCursor& place, const InputError& error, const std::string& hint = "");

/// Fails at `place` where the mass of `body`, its own or what its material and size come to, is out of range.
void check_mass_at(const YamlCursor& place, const BodyDefinition& body, const Scene& scene);

/// `search`: the scene's folder, then the mesh paths.
std::vector<SceneGround> load_ground(const YamlCursor& root, const Scene& scene, const ShapeOptions& search);

/// To `scene.bodies`, in the file's order. Scatters keep clear of the bodies placed one by one (wherever in
/// the list these are), of those that `scene` has, of earlier scatters and of the ground planes in
/// `scene.ground`.
void add_bodies(const YamlCursor& root, Scene& scene, const std::map<std::string, SceneShape>& shapes,
                const SceneLoadSettings& settings);

/// As a scene names it.
std::string_view name_of(LevelChoice level);

/// Adds to `scene.joints`, between bodies of `scene.bodies` by their names, and makes these full.
void load_joints(const YamlCursor& root, Scene& scene);

/// Adds each ragdoll's bodies, which are full throughout, its joints and its group to `scene`. Its bodies are
/// called `NAME torso`, `head`, `left arm`, `right arm`, `left leg`, `right leg`.
void load_ragdolls(const YamlCursor& root, Scene& scene);

}  // namespace lodestone
