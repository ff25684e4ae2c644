#include "tools/hard_cases/scene_text.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>

#include "reference/error.h"
#include "scenes/scene_file.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

/// A file of this process's own, gone with it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text) {
    static std::atomic<int> count = 0;
    path_ = fs::temp_directory_path() / fmt::format("lodestone_case_{}_{}.yaml", getpid(), ++count);
    std::ofstream out(path_, std::ios::binary);
    out << text;
    if (!out.flush())
      throw_input_error(path_.string(), "a file that cannot be written", "room for it and leave to write it");
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

std::string scene_error_of(const std::string& text) {
  const TemporaryFile file(text);
  try {
    load_scene(file.path());
  } catch (const InputError& error) {
    const std::string message = error.what(), head = file.path().string() + ":";
    return message.starts_with(head) ? message.substr(head.size()) : "another file: " + message;
  }
  return "";
}

int count_unclear(std::span<const std::string> texts, const std::string& key) {
  int unclear = 0;
  for (const std::string& text : texts) {
    const std::string error = scene_error_of(text);  // line: key: found …, expected …
    const bool clear = !error.empty() && std::isdigit(static_cast<unsigned char>(error[0])) &&
                       error.find(key) != std::string::npos && error.find(": found ") != std::string::npos &&
                       error.find(", expected ") != std::string::npos;
    unclear += !clear;
  }
  return unclear;
}

}  // namespace lodestone
