#include "tools/shape_arguments.h"

namespace lodestone {

void add_material_arguments(Command& command, Material& material) {
  command.add_option("--restitution", material.restitution, "coefficient of restitution, 0 to 1")
      .within(0.0, 1.0);
  command.add_option("--friction", material.friction, "coefficient of friction").from_zero(1e6);
  command.add_option("--density", material.density, "kg/m3").above_zero();
}

void add_shape_arguments(Command& command, ShapeArguments& arguments) {
  command
      .add_option("SHAPE", arguments.shape,
                  "in metres: box:X,Y,Z  sphere:R  l:A,B,W,T  plate:X,Y,Z  needle:L,R  bunny, or a mesh file")
      .required();
  command.add_option("--size", arguments.options.size_m, "longest side of a mesh's bounding box, m")
      .above_zero();
  command.add_option("--faces", arguments.options.faces, "simplify a mesh to this many faces")
      .within(4, 1'000'000);
  add_mesh_arguments(command, arguments.options.search, arguments.options.untrusted);
  add_material_arguments(command, arguments.material);
}

void add_mesh_arguments(Command& command, std::vector<std::filesystem::path>& folders, bool& untrusted) {
  command.add_option("--mesh-path", folders, "folders in which mesh files are looked up").several(':');
  command.add_flag(
      "--untrusted", untrusted,
      "read mesh files, which may come from strangers, in a child process with limits of memory and time");
}

std::shared_ptr<const Shape> make_shape_from_arguments(const ShapeArguments& arguments, MeshReport* report) {
  ShapeOptions options = arguments.options;
  options.search.insert(options.search.begin(), ".");
  return std::make_shared<const Shape>(make_shape_from_text(arguments.shape, options, {}, report));
}

}  // namespace lodestone
