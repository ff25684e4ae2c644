#include "signature/file_bytes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>

#include "reference/error.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class FileBytes : public ::testing::Test {
 protected:
  static std::vector<std::byte> some(std::size_t count, int first = 1) {
    std::vector<std::byte> bytes(count);
    for (std::size_t i = 0; i < count; ++i) bytes[i] = std::byte(first + int(i * i));
    return bytes;
  }
  std::size_t files() const {
    return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }
  const testing::TemporaryFolder own;
  const fs::path& folder = own.path();
};

TEST_F(FileBytes, WhatIsWrittenIsReadAndMapped) {
  for (const std::size_t count : {0, 1, 4096, 100'001}) {
    const fs::path file = folder / "file";
    write_atomically(some(count), file);
    EXPECT_EQ(read_file(file, "bytes"), some(count));
    const MappedFile mapped(file, "bytes");
    EXPECT_TRUE(std::ranges::equal(mapped.bytes(), some(count)));
  }
  EXPECT_EQ(files(), 1U);
}

TEST_F(FileBytes, WhoHasTheOldFileKeepsIt) {
  const fs::path file = folder / "file";
  write_atomically(some(5000, 1), file);
  const MappedFile before(file, "bytes");
  write_atomically(some(5000, 2), file);
  EXPECT_TRUE(std::ranges::equal(before.bytes(), some(5000, 1)));
  EXPECT_EQ(read_file(file, "bytes"), some(5000, 2));
}

// Each writer's file is whole; nobody's partial one is left.
TEST_F(FileBytes, WritersAtOnceDoNotMix) {
  const fs::path file = folder / "file";
  std::vector<std::jthread> writers;
  for (int writer = 0; writer < 4; ++writer)
    writers.emplace_back([&, writer] {
      for (int i = 0; i < 25; ++i) write_atomically(some(20'000, writer), file);
    });
  writers.clear();
  const std::vector<std::byte> left = read_file(file, "bytes");
  int whose = -1;
  for (int writer = 0; writer < 4; ++writer)
    if (left == some(20'000, writer)) whose = writer;
  EXPECT_GE(whose, 0);
  EXPECT_EQ(files(), 1U);
}

TEST_F(FileBytes, WhatIsMissingOrNoFileIsNamed) {
  const std::string missing = testing::message_of([&] { read_file(folder / "none", "a signature"); });
  EXPECT_NE(missing.find("none: found no such file, expected a signature"), std::string::npos) << missing;
  EXPECT_EQ(testing::message_of([&] { MappedFile(folder / "none", "a signature"); }), missing);
  EXPECT_NE(testing::message_of([&] { read_file(folder, "a signature"); }), testing::kNothingThrown);
  EXPECT_THROW(read_file(folder / "none" / "deeper", "a signature"), InputError);
}

TEST_F(FileBytes, AFailedWriteLeavesTheOldFileAndNoOther) {
  const fs::path place = folder / "place";
  fs::create_directories(place / "inside");  // a folder that is not empty: nothing can take its name
  const std::string message = testing::message_of([&] { write_atomically(some(10), place); });
  EXPECT_TRUE(message.starts_with(place.string() + ": ")) << message;
  EXPECT_TRUE(fs::is_directory(place / "inside"));
  EXPECT_EQ(files(), 1U);
}

TEST_F(FileBytes, FoldersAreMadeOnTheWay) {
  write_atomically(some(10), folder / "one" / "two" / "file");
  EXPECT_EQ(read_file(folder / "one" / "two" / "file", "bytes"), some(10));
}

// Nothing is put in a pipe's place: the bytes go through it.
TEST_F(FileBytes, APipeIsWrittenTo) {
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string through;
  std::jthread reader([&] {
    std::ifstream in(pipe, std::ios::binary);
    through.assign(std::istreambuf_iterator<char>(in), {});
  });
  write_atomically(some(1000), pipe);
  reader.join();
  EXPECT_EQ(through.size(), 1000U);
  EXPECT_TRUE(fs::is_fifo(pipe));
}

// As /dev/stdout is one to whatever the shell sent it to: it was replaced, and its file got nothing.
TEST_F(FileBytes, ASymbolicLinkIsWrittenThrough) {
  const fs::path link = folder / "link", file = folder / "file";
  write_atomically(some(50, 1), file);
  fs::create_symlink(file, link);
  for (const std::size_t count : {1000, 10}) {
    write_atomically(some(count, 2), link);
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(read_file(file, "bytes"), some(count, 2));
  }
  EXPECT_EQ(files(), 2U);
}

}  // namespace
}  // namespace lodestone
