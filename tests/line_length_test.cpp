// No line is longer than .clang-format allows, but in raw strings: scenes and scripts that tests give to
// programs.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr std::ptrdiff_t kColumns = 110;

// Of UTF-8: bytes that continue no character.
std::ptrdiff_t columns_of(std::string_view line) {
  return std::ranges::count_if(line, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; });
}

// Numbers of the lines that are too long.
std::vector<int> long_lines(std::istream& in) {
  std::vector<int> found;
  std::string end_of_raw;  // of the raw string that a line begins in; empty outside
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const bool began_in_raw = !end_of_raw.empty();
    std::size_t at = 0;
    bool has_raw = began_in_raw;
    while (at != std::string::npos) {
      if (!end_of_raw.empty()) {
        at = line.find(end_of_raw, at);
        if (at == std::string::npos) break;
        at += end_of_raw.size();
        end_of_raw.clear();
      }
      at = line.find("R\"", at);
      if (at == std::string::npos) break;
      const std::size_t open = line.find('(', at);
      if (open == std::string::npos) break;
      end_of_raw = ")" + line.substr(at + 2, open - at - 2) + "\"";
      has_raw = true;
      at = open + 1;
    }
    if (!has_raw && columns_of(line) > kColumns) found.push_back(number);
  }
  return found;
}

TEST(LineLength, IsCountedInCharactersAndNotInRawStrings) {
  std::string text = std::string(110, 'x') + "\n" + std::string(111, 'x') + "\n";
  for (int i = 0; i < 110; ++i) text += "µ";
  text += "\nauto a = R\"(\n" + std::string(200, 'x') + "\n)\";\n" + std::string(111, 'y') + "\n";
  std::istringstream in(text);
  EXPECT_EQ(long_lines(in), (std::vector<int>{2, 7}));
}

TEST(LineLength, IsThatOfTheFormatFile) {
  for (const char* room : {"lod", "reference", "signature", "scenes", "tests", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(LODESTONE_SOURCE_DIR) / room)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      std::ifstream in(entry.path());
      for (const int line : long_lines(in)) ADD_FAILURE() << entry.path().string() << ":" << line;
    }
}

}  // namespace
