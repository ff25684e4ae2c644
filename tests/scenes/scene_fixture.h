// A scene in a temporary folder, and the error that loading it gives.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "scenes/scene_file.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone {

class SceneFixture : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text, const std::string& name = "s.yaml") const {
    return folder_.write(name, text);
  }
  Scene load(const std::string& text, const SceneLoadSettings& settings = {}) const {
    return load_scene(write(text), settings);
  }

  /// The message without the folder, or that there is none.
  std::string error_of(const std::string& text, const SceneLoadSettings& settings = {}) const {
    const std::filesystem::path file = write(text);
    return testing::after_head(testing::message_of([&] { load_scene(file, settings); }),
                               folder().string() + "/");
  }
  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  testing::TemporaryFolder folder_;
};

/// A tetrahedron as an OBJ file.
inline std::string tetrahedron_obj() {
  return "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
}

}  // namespace lodestone
