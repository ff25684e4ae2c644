// README shows only code that is built and run: its C++ is part of the install test's program.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

const std::filesystem::path kSource = LODESTONE_SOURCE_DIR;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// What stands between a line ```cpp and the next ```.
std::vector<std::string> code_blocks_of(const std::string& markdown) {
  const std::string opening = "\n```cpp\n", closing = "\n```\n";
  std::vector<std::string> blocks;
  for (auto at = markdown.find(opening); at != std::string::npos; at = markdown.find(opening, at)) {
    at += opening.size();
    blocks.push_back(markdown.substr(at, markdown.find(closing, at) - at));
  }
  return blocks;
}

bool shows_what_is_built(const std::string& markdown, const std::string& program) {
  for (const std::string& block : code_blocks_of(markdown))
    if (program.find(block) == std::string::npos) return false;
  return true;
}

TEST(Readme, ItsCodeIsInTheProgramThatTheInstallTestRuns) {
  const std::string readme = text_of(kSource / "README.md");
  ASSERT_EQ(code_blocks_of(readme).size(), 1U);
  EXPECT_NE(code_blocks_of(readme).front().find("Manager manager("), std::string::npos);
  EXPECT_TRUE(shows_what_is_built(readme, text_of(kSource / "tests/install/consumer.cpp")));
}

TEST(Readme, OtherCodeIsNoticed) {
  const std::string markdown = "Text\n```cpp\nint a;\nint b;\n```\nmore\n```sh\nls\n```\n";
  EXPECT_TRUE(shows_what_is_built(markdown, "// …\nint a;\nint b;\nint c;\n"));
  EXPECT_FALSE(shows_what_is_built(markdown, "int a;\nint c;\nint b;\n"));
}

// Every relative link and picture.
TEST(Readme, WhatItLinksToExists) {
  const std::string readme = text_of(kSource / "README.md");
  int links = 0;
  for (auto at = readme.find("]("); at != std::string::npos; at = readme.find("](", at)) {
    at += 2;
    const std::string target = readme.substr(at, readme.find(')', at) - at);
    if (target.starts_with("http") || target.starts_with("#")) continue;
    ++links;
    EXPECT_TRUE(std::filesystem::exists(kSource / target)) << target;
  }
  EXPECT_GT(links, 0);
}

}  // namespace
