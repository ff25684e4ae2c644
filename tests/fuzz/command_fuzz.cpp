// A command line, one argument a line. What follows the arguments is --help, so that they are read and
// checked but no command begins; and shapes are made of them. Arguments with a slash are left out, lest a
// mesh be looked for all over the disk.
#include <fcntl.h>
#include <unistd.h>

#include <sstream>
#include <vector>

#include "reference/error.h"
#include "scenes/shape_source.h"
#include "tests/fuzz/fuzz_input.h"
#include "tools/commands.h"

namespace lodestone {
namespace {

/// Sends both streams nowhere: help is long.
class Silence {
 public:
  Silence() {
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    dup2(nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    close(nothing);
  }
  ~Silence() {
    std::fflush(nullptr);
    for (int stream : {STDOUT_FILENO, STDERR_FILENO}) {
      dup2(kept_[stream - 1], stream);
      close(kept_[stream - 1]);
    }
  }

 private:
  int kept_[2] = {dup(STDOUT_FILENO), dup(STDERR_FILENO)};
};

}  // namespace
}  // namespace lodestone

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lodestone;
  if (size > 2000) return 0;
  std::vector<std::string> arguments{"lodestone"};
  std::istringstream text(std::string(data, data + size));
  for (std::string line; std::getline(text, line) && arguments.size() < 30;)
    if (line.find('/') == line.npos && line.find('\0') == line.npos) arguments.push_back(line);
  for (const std::string& argument : arguments) {
    try {
      make_shape_from_text(argument,
                           {.size_m = {}, .faces = {}, .search = {"no such folder"}, .stay_in_search = true});
    } catch (const InputError&) {
    }
  }
  arguments.push_back("--help");
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ExitCode exit_code = ExitCode::done;
  {
    const Silence silence;
    exit_code = run_lodestone(int(arguments.size()), pointers.data());
  }
  fuzz::require(
      exit_code == ExitCode::done || exit_code == ExitCode::usage || exit_code == ExitCode::bad_input,
      "an exit code that help cannot have");
  return 0;
}
