// The style guide's two rules on includes: nothing includes upward, and no public header shows ODE, assimp or
// yaml-cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;

// From the lowest to the highest: each may include itself and what stands before it.
constexpr std::array<std::string_view, 5> kRooms = {"reference", "signature", "lod", "scenes", "tools"};

struct Include {
  std::string file;    // relative to the source folder
  std::string target;  // as written between the quotes or brackets
};

// What `#include "…"` or `#include <…>` names; empty for any other line.
std::string included_by(const std::string& line) {
  if (!line.starts_with("#include")) return {};
  const auto begin = line.find_first_of("\"<");
  const auto end = line.find_first_of("\">", begin + 1);
  return begin < end ? line.substr(begin + 1, end - begin - 1) : std::string();
}

std::vector<Include> includes_of(const fs::path& file) {
  std::vector<Include> found;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (std::string target = included_by(line); !target.empty())
      found.push_back({fs::relative(file, LODESTONE_SOURCE_DIR).generic_string(), std::move(target)});
  return found;
}

std::vector<Include> includes_of_every_room() {
  std::vector<Include> found;
  for (const std::string_view room : kRooms)
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(LODESTONE_SOURCE_DIR) / room))
      if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
        std::ranges::copy(includes_of(entry.path()), std::back_inserter(found));
  return found;
}

// Height of the room in which a path begins; −1 for a path outside the rooms.
int room_height(std::string_view path) {
  const auto room = std::ranges::find(kRooms, path.substr(0, path.find('/')));
  return room == kRooms.end() ? -1 : static_cast<int>(room - kRooms.begin());
}

bool starts_with_any(std::string_view text, std::initializer_list<std::string_view> beginnings) {
  return std::ranges::any_of(beginnings,
                             [&](std::string_view beginning) { return text.starts_with(beginning); });
}

// The rules, one function each: true where the include breaks it.
bool points_upward(const Include& include) { return room_height(include.target) > room_height(include.file); }

bool reaches_into_the_tests(const Include& include) { return include.target.starts_with("tests/"); }

bool relative_to_its_folder(const Include& include) {
  return include.target.starts_with("./") || include.target.find("../") != std::string::npos;
}

bool shows_a_library(const Include& include) {
  return include.file.ends_with(".h") && !include.file.ends_with("_ode.h") &&
         starts_with_any(include.target, {"ode/", "assimp/", "yaml-cpp/"});
}

bool takes_ode_outside_reference(const Include& include) {
  return include.target.starts_with("ode/") && !include.file.starts_with("reference/");
}

void expect_none(bool (*breaks_rule)(const Include&)) {
  const std::vector<Include> includes = includes_of_every_room();
  ASSERT_GT(includes.size(), 20U) << "the sources were not found in " LODESTONE_SOURCE_DIR;
  for (const Include& include : includes)
    EXPECT_FALSE(breaks_rule(include)) << include.file << " includes " << include.target;
}

TEST(IncludeDirection, NothingIncludesUpward) { expect_none(points_upward); }
TEST(IncludeDirection, NothingIncludesTheTests) { expect_none(reaches_into_the_tests); }
TEST(IncludeDirection, EveryIncludeNamesItsRoom) { expect_none(relative_to_its_folder); }
TEST(IncludeDirection, PublicHeadersHideOdeAssimpAndYaml) { expect_none(shows_a_library); }
TEST(IncludeDirection, OnlyTheReferenceIncludesOde) { expect_none(takes_ode_outside_reference); }

TEST(IncludeDirection, IncludesAreRead) {
  EXPECT_EQ(included_by("#include \"lod/manager.h\""), "lod/manager.h");
  EXPECT_EQ(included_by("#include <ode/ode.h>  // as \"dWorldID\""), "ode/ode.h");
  EXPECT_EQ(included_by("int include;"), "");
}

// The rules themselves can fail.
TEST(IncludeDirection, EachRuleCatchesItsOffence) {
  EXPECT_TRUE(points_upward({"reference/a.cpp", "lod/manager.h"}));
  EXPECT_FALSE(points_upward({"lod/a.cpp", "reference/mesh/mesh.h"}));
  EXPECT_TRUE(reaches_into_the_tests({"tools/a.cpp", "tests/fixture.h"}));
  EXPECT_TRUE(relative_to_its_folder({"lod/a.cpp", "../scenes/scene.h"}));
  EXPECT_TRUE(shows_a_library({"scenes/scene.h", "yaml-cpp/yaml.h"}));
  EXPECT_FALSE(shows_a_library({"scenes/scene.cpp", "yaml-cpp/yaml.h"}));
  EXPECT_TRUE(takes_ode_outside_reference({"lod/full_level.cpp", "ode/ode.h"}));
}

}  // namespace
