// The text of a scene: refused with an InputError that names its place, or loaded.
#include <sys/mman.h>
#include <unistd.h>

#include "reference/error.h"
#include "scenes/scene_file.h"
#include "tests/fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  if (size > 1 << 14) return 0;
  const int memory = memfd_create("scene", MFD_CLOEXEC);
  fuzz::require(memory >= 0 && write(memory, data, size) == ssize_t(size), "no file in memory");
  const std::string file = "/proc/self/fd/" + std::to_string(memory);
  try {
    const Scene scene = load_scene(file, {.mesh_paths = {}, .seed = {}, .max_bodies = 200});
    fuzz::require(scene.bodies.size() <= 200, "more bodies than asked for");
  } catch (const InputError& error) {
    const std::string message = error.what();
    fuzz::require(message.starts_with(file) && message.find("found ") != message.npos &&
                      message.find("expected ") != message.npos,
                  "a message without its place: " + message);
  }
  close(memory);
  return 0;
}
