// replay_scene: a recording, done again.
#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <string_view>

#include "reference/error.h"
#include "reference/output_file.h"
#include "scenes/runner.h"
#include "scenes/scene_manager.h"

namespace lodestone {
namespace {

std::vector<std::byte> bytes_of(const std::filesystem::path& file) {
  if (const std::string fault = find_reading_fault(file); !fault.empty())
    throw_input_error(file.string(), fault, "a recording");
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw_input_error(file.string(), "an error of reading", "a recording");
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

}  // namespace

ReplayResult replay_scene(const Scene& scene, const RunSettings& settings,
                          const std::filesystem::path& recording) {
  Manager manager = make_manager(scene, settings, settings.signatures);
  std::vector<std::shared_ptr<const Shape>> shapes;
  for (const auto& [name, shape] : scene.shapes) shapes.push_back(shape);
  const auto bytes = bytes_of(recording);
  try {
    return manager.replay(bytes, shapes);
  } catch (const InputError& error) {
    // The recording, and the snapshot that it begins with, are this file.
    const std::string_view text = error.what();
    for (const std::string_view where : {"recording: ", "snapshot: ", "state: "})
      if (text.starts_with(where))
        throw InputError(fmt::format("{}: {}", recording.string(), text.substr(where.size())));
    throw;
  }
}

}  // namespace lodestone
