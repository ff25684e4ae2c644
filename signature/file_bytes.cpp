#include "signature/file_bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <fstream>

#include "reference/error.h"
#include "reference/output_file.h"

namespace lodestone {
namespace {

// Of this process and of this call, so that two threads do not share one.
std::filesystem::path temporary_beside(const std::filesystem::path& file) {
  static std::atomic<unsigned> calls{0};
  std::filesystem::path temporary = file;
  temporary += fmt::format(".{}.{}.partial", ::getpid(), calls++);
  return temporary;
}

[[noreturn]] void throw_unreadable(const std::filesystem::path& file, const std::string& what) {
  const std::string fault = find_reading_fault(file);
  throw_input_error(file.string(), fault.empty() ? "a file that cannot be read" : fault, what);
}

void check_is_file(const std::filesystem::path& file, const std::string& what) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error)) return;
  const bool is_missing =
      !std::filesystem::exists(file, error) &&
      (!error || error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory);
  const std::string fault = is_missing ? "no such file" : find_reading_fault(file);
  throw_input_error(file.string(), fault.empty() ? "a special file" : fault, what);
}

// Something that bytes go through, such as a pipe: nothing may be put in its place. Nor in that of a symbolic
// link, though it leads to a file: /dev/stdout is one to whatever standard output was sent to.
bool is_special(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_symlink(file, error)) return true;
  return std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error) &&
         !std::filesystem::is_directory(file, error);
}

void write_to(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  OutputFile out(file, "a place with room for it");
  out.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  out.close();
}

}  // namespace

std::vector<std::byte> read_file(const std::filesystem::path& file, const std::string& what) {
  std::error_code error;
  check_is_file(file, what);
  std::vector<std::byte> bytes(std::filesystem::file_size(file, error));
  std::ifstream in(file, std::ios::binary);
  if (error || !in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size())))
    throw_unreadable(file, what);
  return bytes;
}

MappedFile::MappedFile(const std::filesystem::path& file, const std::string& what) {
  check_is_file(file, what);
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  void* mapped = MAP_FAILED;
  if (descriptor >= 0 && ::fstat(descriptor, &status) == 0 && status.st_size > 0)
    mapped = ::mmap(nullptr, std::size_t(status.st_size), PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (descriptor >= 0) ::close(descriptor);
  if (mapped != MAP_FAILED)
    bytes_ = {static_cast<const std::byte*>(mapped), std::size_t(status.st_size)};
  else if (descriptor < 0 || status.st_size > 0)
    throw_unreadable(file, what);
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

void write_atomically(std::span<const std::byte> bytes, const std::filesystem::path& file) {
  write_atomically(file, [&](const std::filesystem::path& place) { write_to(place, bytes); });
}

void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write) {
  if (is_special(file)) return write(file);
  const std::filesystem::path temporary = temporary_beside(file);
  std::error_code error;
  try {
    write(temporary);
  } catch (const InputError& fault) {
    std::filesystem::remove(temporary, error);
    const std::string message = fault.what(), name = temporary.string();
    throw InputError(message.starts_with(name) ? file.string() + message.substr(name.size()) : message);
  } catch (...) {  // too little memory to put it together
    std::filesystem::remove(temporary, error);
    throw;
  }
  std::filesystem::rename(temporary, file, error);
  if (!error) return;
  const int reason = error.value();
  std::filesystem::remove(temporary, error);
  throw_file_error(file, reason, "a place that can be written");
}

}  // namespace lodestone
