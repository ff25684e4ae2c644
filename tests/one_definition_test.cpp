// Two classes of one name in one namespace are one to the linker, which takes either's functions for both.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <utility>

namespace {

namespace fs = std::filesystem;

TEST(OneDefinition, NoClassOfAHeaderHasTheNameOfAnother) {
  const std::regex opens(R"(^namespace ([\w:]+) \{)"),
      defines(R"(^(?:class|struct|union|enum class) (\w+)(?: final)?(?: :[^;]*)? \{)");
  std::map<std::pair<std::string, std::string>, fs::path> known;  // namespace and name
  for (const char* room : {"reference", "signature", "lod", "scenes", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(LODESTONE_SOURCE_DIR) / room)) {
      if (entry.path().extension() != ".h") continue;
      std::ifstream in(entry.path());
      std::smatch found;
      std::string space;
      for (std::string line; std::getline(in, line);) {
        if (std::regex_search(line, found, opens)) space = found[1];
        if (!std::regex_search(line, found, defines)) continue;
        const auto [first, is_new] = known.try_emplace({space, found[1]}, entry.path());
        EXPECT_TRUE(is_new) << space << "::" << found[1] << " of " << entry.path() << " is in "
                            << first->second << ", too";
      }
    }
  EXPECT_GT(known.size(), 300u);
}

}  // namespace
