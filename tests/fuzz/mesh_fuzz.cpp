// A mesh file (its first byte chooses the format): refused, or repaired, made a body and simulated for ten
// steps.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "lod/manager.h"
#include "reference/error.h"
#include "tests/fuzz/fuzz_input.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

/// In a folder of this process's own, removed at its end.
struct Folder {
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  const fs::path path = fs::temp_directory_path() / ("lodestone_fuzz_" + std::to_string(getpid()));
};

void simulate(Shape made) {
  const auto shape = std::make_shared<const Shape>(scale_shape(made, 0.2 / made.radius));
  Manager manager({.signatures = [](const Shape&, const ContactLaw&) { return nullptr; }});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  RigidState state;
  BodyId bodies[2];
  for (int i = 0; i < 2; ++i) {
    state.position = {0.05 * i, 0.0, 0.18 + 0.3 * i};
    bodies[i] = manager.add_body(
        {.shape = shape, .state = state, .level = i == 0 ? LevelChoice::full : LevelChoice::support});
  }
  for (int i = 0; i < 10; ++i) manager.step(1.0 / 60.0);
  for (const BodyId body : bodies) {
    const RigidState end = manager.state(body);
    fuzz::require(end.position.allFinite() && end.velocity.allFinite() && end.angular_velocity.allFinite(),
                  "a state that is not finite");
    fuzz::require(end.position.norm() < 20.0, "a body thrown away");
  }
}

}  // namespace
}  // namespace lodestone

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  static const Folder folder;
  if (size < 2) return 0;
  constexpr const char* kNames[] = {"m.obj", "m.ply", "m.stl", "m.gltf", "m.glb", "m.3ds"};
  const fs::path file = folder.path / kNames[data[0] % 6];
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), std::streamsize(size - 1));
  try {
    Mesh mesh = scale_to_size(load_mesh(file, {.max_bytes = 1 << 16, .max_faces = 500}), 0.3);
    const std::size_t vertices = mesh.vertices.size();
    for (const auto& face : mesh.faces)
      for (const int i : face) fuzz::require(i >= 0 && std::size_t(i) < vertices, "an index out of range");
    simulate(make_shape("fuzz", std::move(mesh)));
  } catch (const InputError&) {
  }
  return 0;
}
