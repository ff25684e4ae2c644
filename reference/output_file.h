// A file that is written record by record, every write checked.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lodestone {

/// Throws InputError `file: found …, expected …`, what is found being the system's words for `error_number`
/// (an errno): "permission denied", "no space left on device".
[[noreturn]] void throw_file_error(const std::filesystem::path& file, int error_number,
                                   std::string_view expected);

/// What the system says is in the way of reading `file`, in lower case; empty where it is a file that can be
/// opened.
std::string find_reading_fault(const std::filesystem::path& file);

/// What the system says will be in the way of writing `file`, as far as it can say so beforehand; empty where
/// nothing is. The folders on the way may be missing.
std::string find_writing_fault(const std::filesystem::path& file);

/// Whether what is written to one is found in the other: names of one file, or of one that is yet to be made.
/// Not what is no file, such as /dev/null or a pipe, which takes what comes.
bool is_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Records (lines, mostly) in a file that is begun anew. Where the place is full, the records that are there
/// whole stay, the one that was cut is taken back, and the write or close() that met it throws InputError
/// with the system's reason. The folder of the file is made where it is missing.
class OutputFile {
 public:
  /// `expected`: what a message says there should be room for.
  explicit OutputFile(const std::filesystem::path& file, std::string expected = "a file that can be written");
  /// Writes what is left, and is silent where it cannot be written: whoever wants to know calls close()
  /// before.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view record);  ///< kept back until 64 kB have come together
  void flush();
  void close();

 private:
  bool put(std::string_view records);  // that end at ends_; whether all are written, else errno says why
  std::filesystem::path file_;
  std::string expected_;
  int descriptor_ = -1;
  std::size_t written_ = 0;        // bytes of whole records in the file
  std::string kept_;               // records not yet written,
  std::vector<std::size_t> ends_;  // and where each of them ends
};

}  // namespace lodestone
