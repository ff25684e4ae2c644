// The program as a child process, in folders of a test's own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

#include "tests/temporary_folder.h"

namespace lodestone::testing {

struct Ended {
  int exit_code = -1;
  std::string out;
};

/// As one word to the shell.
inline std::string quoted(const std::string& path) {
  std::string word = "'";
  word.append(path).push_back('\'');
  return word;
}

inline Ended run_shell(const std::string& command) {
  Ended ended;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    ended.out.append(buffer.data(), count);
  const int status = pclose(pipe);
  ended.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;  // −1: killed by a signal
  return ended;
}

/// A folder that is removed at the end, with a cache of its own in it.
class CliTest : public ::testing::Test {
 protected:
  std::filesystem::path at(const std::string& name) const { return folder_.at(name); }
  /// The command as the shell takes it, its cache in folder `cache`.
  std::string command(const std::string& arguments, const std::string& cache = "cache") const {
    return "XDG_CACHE_HOME=" + quoted(at(cache).string()) + " exec " + quoted(LODESTONE_CLI) + ' ' +
           arguments;
  }
  /// With stderr joined.
  Ended run(const std::string& arguments, const std::string& cache = "cache") const {
    return run_shell(command(arguments, cache) + " 2>&1");
  }
  std::string name(const std::string& file) const { return quoted(at(file).string()); }

 private:
  const TemporaryFolder folder_;
};

}  // namespace lodestone::testing
