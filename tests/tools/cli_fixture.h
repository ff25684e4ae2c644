// The program as a child process, in folders of a test's own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

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

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A folder that is removed at the end, with a cache of its own in it.
class CliTest : public ::testing::Test {
 protected:
  CliTest() { std::filesystem::create_directories(folder_); }
  ~CliTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path at(const std::string& name) const { return folder_ / name; }
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
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                  ("lodestone-test-" + std::to_string(::getpid()) +
                                   ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

}  // namespace lodestone::testing
