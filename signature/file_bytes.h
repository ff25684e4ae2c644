// Whole files, read and written.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lodestone {

/// Throws InputError where `file` is missing or unreadable; `what` it should be is named.
std::vector<std::byte> read_file(const std::filesystem::path& file, const std::string& what);

/// A file's bytes, mapped for reading.
class MappedFile {
 public:
  /// Throws as read_file does.
  MappedFile(const std::filesystem::path& file, const std::string& what);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

/// Written to a temporary file beside `file` and renamed: readers see the old file or the new one, whole.
/// Straight to what is no file, such as a pipe, and to what a symbolic link leads to. Throws InputError where
/// it cannot be written.
void write_atomically(std::span<const std::byte> bytes, const std::filesystem::path& file);
/// The same of what `write` writes to the place that it is given, which may be the temporary file's; it
/// throws InputError where it cannot.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write);

}  // namespace lodestone
