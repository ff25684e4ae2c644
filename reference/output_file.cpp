#include "reference/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <utility>

#include "reference/error.h"

namespace lodestone {
namespace {

constexpr std::size_t kKeptBack = 1 << 16;  // bytes

// "Permission denied" within a sentence, as what is found.
std::string words_for(int error_number) {
  if (error_number == EISDIR) return "a folder";
  std::string words = std::strerror(error_number);
  if (!words.empty()) words[0] = char(std::tolower(static_cast<unsigned char>(words[0])));
  return words;
}

}  // namespace

void throw_file_error(const std::filesystem::path& file, int error_number, std::string_view expected) {
  throw_input_error(file.string(), words_for(error_number), expected);
}

std::string find_reading_fault(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return words_for(errno);
  struct stat status {};
  const bool is_folder = ::fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode);
  ::close(descriptor);
  return is_folder ? words_for(EISDIR) : "";
}

std::string find_writing_fault(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) return words_for(EISDIR);
    return ::access(file.c_str(), W_OK) == 0 ? "" : words_for(errno);
  }
  if (errno != ENOENT) return words_for(errno);
  std::filesystem::path folder = file;
  do {
    folder = folder.has_parent_path() && folder.parent_path() != folder ? folder.parent_path() : ".";
  } while (::stat(folder.c_str(), &status) != 0 && errno == ENOENT && folder != ".");
  if (!S_ISDIR(status.st_mode)) return words_for(ENOTDIR);
  return ::access(folder.c_str(), W_OK | X_OK) == 0 ? "" : words_for(errno);
}

bool is_one_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code error;  // there is none of that name
  if (std::filesystem::exists(a, error))
    return std::filesystem::is_regular_file(a, error) && std::filesystem::equivalent(a, b, error);
  const std::filesystem::path place = std::filesystem::weakly_canonical(a, error);
  return !place.empty() && place == std::filesystem::weakly_canonical(b, error);
}

OutputFile::OutputFile(const std::filesystem::path& file, std::string expected)
    : file_(file), expected_(std::move(expected)) {
  std::error_code error;  // what it is shows when the file is opened
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw_file_error(file_, errno, expected_);
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  put(kept_);
  ::close(descriptor_);
}

bool OutputFile::put(std::string_view records) {
  std::size_t done = 0;
  int reason = 0;
  while (done < records.size() && reason == 0) {
    const ssize_t count = ::write(descriptor_, records.data() + done, records.size() - done);
    if (count >= 0)
      done += std::size_t(count);
    else if (errno != EINTR)
      reason = errno;
  }
  if (reason != 0) {
    const auto cut = std::ranges::upper_bound(ends_, done);
    done = cut == ends_.begin() ? 0 : *std::prev(cut);
    // A device has no end to take back.
    if (::ftruncate(descriptor_, off_t(written_ + done)) == 0) ::lseek(descriptor_, 0, SEEK_END);
  }
  written_ += done;
  kept_.clear(), ends_.clear();
  errno = reason;
  return reason == 0;
}

void OutputFile::write(std::string_view record) {
  if (record.size() >= kKeptBack) {  // not worth a copy
    flush();
    ends_ = {record.size()};
    if (!put(record)) throw_file_error(file_, errno, expected_);
    return;
  }
  kept_ += record;
  ends_.push_back(kept_.size());
  if (kept_.size() >= kKeptBack) flush();
}

void OutputFile::flush() {
  if (!put(kept_)) throw_file_error(file_, errno, expected_);
}

void OutputFile::close() {
  if (descriptor_ < 0) return;
  const bool is_put = put(kept_);
  const int reason = errno;
  const bool is_closed = ::close(std::exchange(descriptor_, -1)) == 0;
  if (!is_put) throw_file_error(file_, reason, expected_);
  if (!is_closed) throw_file_error(file_, errno, expected_);
}

}  // namespace lodestone
