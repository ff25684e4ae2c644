#include "tools/shape_arguments.h"

#include <CLI/CLI.hpp>
#include <limits>

namespace lodestone {
namespace {

const CLI::Validator kPositive = CLI::Range(1e-9, 1e9, "POSITIVE");

}  // namespace

void add_material_arguments(CLI::App& command, Material& material) {
  command.add_option("--restitution", material.restitution, "coefficient of restitution, 0 to 1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--friction", material.friction, "coefficient of friction")
      ->check(CLI::Range(0.0, 1e6, "NONNEGATIVE"))
      ->capture_default_str();
  command.add_option("--density", material.density, "kg/m3")->check(kPositive)->capture_default_str();
}

void add_shape_arguments(CLI::App& command, ShapeArguments& arguments) {
  command
      .add_option("SHAPE", arguments.shape,
                  "in metres: box:X,Y,Z  sphere:R  l:A,B,W,T  plate:X,Y,Z  needle:L,R  bunny, or a mesh file")
      ->required();
  command.add_option("--size", arguments.options.size_m, "longest side of a mesh's bounding box, m")
      ->check(kPositive);
  command.add_option("--faces", arguments.options.faces, "simplify a mesh to this many faces")
      ->check(CLI::Range(4, 1'000'000));
  command.add_option("--mesh-path", arguments.options.search, "folders in which mesh files are looked up")
      ->delimiter(':')
      ->allow_extra_args(false);
  command.add_flag(
      "--untrusted", arguments.options.untrusted,
      "read mesh files, which may come from strangers, in a child process with limits of memory and time");
  add_material_arguments(command, arguments.material);
}

std::shared_ptr<const Shape> make_shape_from_arguments(const ShapeArguments& arguments, MeshReport* report) {
  ShapeOptions options = arguments.options;
  options.search.insert(options.search.begin(), ".");
  return std::make_shared<const Shape>(make_shape_from_text(arguments.shape, options, {}, report));
}

}  // namespace lodestone
