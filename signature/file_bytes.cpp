#include "signature/file_bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <fstream>

#include "reference/error.h"

namespace lodestone {
namespace {

// Of this process and of this call, so that two threads do not share one.
std::filesystem::path temporary_beside(const std::filesystem::path& file) {
  static std::atomic<unsigned> calls{0};
  std::filesystem::path temporary = file;
  temporary += fmt::format(".{}.{}.partial", ::getpid(), calls++);
  return temporary;
}

}  // namespace

std::vector<std::byte> read_file(const std::filesystem::path& file, const std::string& what) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(fmt::format("{}: found no such file, expected {}", file.string(), what));
  std::vector<std::byte> bytes(std::filesystem::file_size(file, error));
  std::ifstream in(file, std::ios::binary);
  if (error || !in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size())))
    throw InputError(fmt::format("{}: found a file that cannot be read, expected {}", file.string(), what));
  return bytes;
}

MappedFile::MappedFile(const std::filesystem::path& file, const std::string& what) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(fmt::format("{}: found no such file, expected {}", file.string(), what));
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status{};
  void* mapped = MAP_FAILED;
  if (descriptor >= 0 && ::fstat(descriptor, &status) == 0 && status.st_size > 0)
    mapped = ::mmap(nullptr, std::size_t(status.st_size), PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (descriptor >= 0) ::close(descriptor);
  if (mapped != MAP_FAILED) bytes_ = {static_cast<const std::byte*>(mapped), std::size_t(status.st_size)};
  else if (descriptor < 0 || status.st_size > 0) throw InputError(fmt::format("{}: found a file that cannot be read, expected {}", file.string(), what));
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

void write_atomically(std::span<const std::byte> bytes, const std::filesystem::path& file) {
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  const std::filesystem::path temporary = temporary_beside(file);
  std::ofstream out(temporary, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  out.close();
  if (out) std::filesystem::rename(temporary, file, error);
  if (!out || error) {
    std::filesystem::remove(temporary, error);
    throw InputError(fmt::format("{}: found a place that cannot be written, expected a writable folder", file.string()));
  }
}

}  // namespace lodestone
