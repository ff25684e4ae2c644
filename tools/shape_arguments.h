// The arguments that say which shape, of which material: SHAPE and its options, alike for every command.
#pragma once

#include <memory>
#include <string>

#include "reference/material.h"
#include "scenes/shape_source.h"
#include "tools/command.h"

namespace lodestone {

struct ShapeArguments {
  std::string shape;
  ShapeOptions options;
  Material material;
  ContactLaw law() const { return {material.restitution, material.friction}; }
};

/// Adds --restitution, --friction and --density to `command`. `material` outlives the parsing.
void add_material_arguments(Command& command, Material& material);

/// Adds SHAPE, --size, --faces, --mesh-path and those of the material to `command`. `arguments` outlives the
/// parsing.
void add_shape_arguments(Command& command, ShapeArguments& arguments);

/// Adds --mesh-path and --untrusted to `command`; what they fill outlives the parsing.
void add_mesh_arguments(Command& command, std::vector<std::filesystem::path>& folders, bool& untrusted);

/// Throws InputError for a shape that does not exist. `report`: what was mended of a mesh, where one is read.
std::shared_ptr<const Shape> make_shape_from_arguments(const ShapeArguments& arguments,
                                                       MeshReport* report = nullptr);

}  // namespace lodestone
