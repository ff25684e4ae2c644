#include "reference/output_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public ::testing::Test {
 protected:
  const testing::TemporaryFolder own_;
  const fs::path& folder_ = own_.path();
};

TEST_F(OutputFileTest, NamesOfOneFileAreOneFile) {
  own_.write("a", "");
  own_.write("b", "");
  fs::create_symlink(folder_ / "a", folder_ / "link");
  EXPECT_TRUE(is_one_file(folder_ / "a", folder_ / "./a"));
  EXPECT_TRUE(is_one_file(folder_ / "link", folder_ / "a"));
  EXPECT_FALSE(is_one_file(folder_ / "a", folder_ / "b"));
  EXPECT_TRUE(is_one_file(folder_ / "new", folder_ / "x/../new"));
  EXPECT_FALSE(is_one_file(folder_ / "new", folder_ / "a"));
  EXPECT_FALSE(is_one_file("/dev/null", "/dev/null"));
  EXPECT_FALSE(is_one_file("", ""));
}

TEST_F(OutputFileTest, WritesWhatItIsGiven) {
  const fs::path file = folder_ / "inner" / "a.csv";  // whose folder is made
  const std::string large(200'000, 'x');
  OutputFile out(file);
  out.write("one\n");
  out.write(large);
  out.write("two\n");
  out.close();
  EXPECT_EQ(testing::bytes_of(file), "one\n" + large + "two\n");
  OutputFile(file).close();
  EXPECT_EQ(testing::bytes_of(file), "");
}

TEST_F(OutputFileTest, AFullDeviceIsAnErrorOfTheFlush) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  OutputFile out("/dev/full", "room");
  out.write("a line\n");
  EXPECT_EQ(testing::message_of([&] { out.close(); }),
            "/dev/full: found no space left on device, expected room");
  OutputFile again("/dev/full", "room");
  EXPECT_EQ(testing::message_of([&] { again.write(std::string(1 << 20, 'x')); }),
            "/dev/full: found no space left on device, expected room");
}

TEST_F(OutputFileTest, AFolderIsNoFile) {
  EXPECT_EQ(testing::message_of([&] { OutputFile out(folder_, "a table"); }),
            folder_.string() + ": found a folder, expected a table");
  EXPECT_EQ(find_reading_fault(folder_), "a folder");
  EXPECT_EQ(find_reading_fault(folder_ / "none"), "no such file or directory");
}

// Files may grow to 1,000 bytes in the child: the lines that fit are there, whole.
TEST_F(OutputFileTest, WhatIsWholeIsKept) {
  const fs::path file = folder_ / "lines";
  const std::string line = "a line of thirty-one characters\n";
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    OutputFile out(file);
    const std::string message = testing::message_of([&] {
      for (int i = 0; i < 5; ++i) out.write(line);
      out.flush();
      for (int i = 0; i < 10'000; ++i) out.write(line);
    });
    ::_exit(message.find("file too large") != message.npos ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  std::string lines;
  for (int i = 0; i < 31; ++i) lines += line;  // 992 bytes
  EXPECT_EQ(testing::bytes_of(file), lines);
}

}  // namespace
}  // namespace lodestone
