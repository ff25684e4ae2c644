// A scene in a temporary folder, and the error that loading it gives.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "reference/error.h"
#include "scenes/scene_file.h"

namespace lodestone {

class SceneFixture : public ::testing::Test {
 protected:
  SceneFixture() : folder_(std::filesystem::path(::testing::TempDir()) / ("scene_" + name_of_test())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~SceneFixture() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& text, const std::string& name = "s.yaml") const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  Scene load(const std::string& text, const SceneLoadSettings& settings = {}) const {
    return load_scene(write(text), settings);
  }

  /// The message without the folder, or "no error".
  std::string error_of(const std::string& text, const SceneLoadSettings& settings = {}) const {
    const std::filesystem::path file = write(text);
    try {
      load_scene(file, settings);
    } catch (const InputError& error) {
      const std::string what = error.what(), prefix = folder_.string() + "/";
      return what.starts_with(prefix) ? what.substr(prefix.size()) : "no file: " + what;
    }
    return "no error";
  }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  static std::string name_of_test() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    return std::string(info->test_suite_name()) + "_" + info->name();
  }
  std::filesystem::path folder_;
};

/// A tetrahedron as an OBJ file.
inline std::string tetrahedron_obj() {
  return "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
}

}  // namespace lodestone
