// The style guide's rules on includes: nothing includes upward, folders inside a room include each other in
// no circle, and no public header shows ODE, assimp or yaml-cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
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

// The example game is a caller's program: ODE's world is its own.
bool is_of_the_game(const Include& include) { return include.file.starts_with("tools/game/"); }

bool shows_a_library(const Include& include) {
  return include.file.ends_with(".h") && !is_of_the_game(include) && !include.file.ends_with("_ode.h") &&
         starts_with_any(include.target, {"ode/", "assimp/", "yaml-cpp/"});
}

bool takes_ode_outside_reference(const Include& include) {
  return include.target.starts_with("ode/") && !include.file.starts_with("reference/") &&
         !is_of_the_game(include);
}

// A caller has the installed headers and nothing else.
bool takes_the_game_behind_the_scenes(const Include& include) {
  const int height = room_height(include.target);
  return is_of_the_game(include) && height >= 0 && !include.target.starts_with("tools/game/");
}

std::string folder_of(std::string_view path) { return std::string(path.substr(0, path.rfind('/'))); }
std::string room_of(std::string_view path) { return std::string(path.substr(0, path.find('/'))); }

// A header that everybody sees shows none of what its room keeps in folders, and nothing but headers is
// beside it.
bool is_no_public_header_alone(const Include& include) {
  if (folder_of(include.file) != "lod") return false;
  return !include.file.ends_with(".h") ||
         (room_of(include.target) == "lod" && folder_of(include.target) != "lod");
}

// Of folders, to those that they include.
using FolderGraph = std::map<std::string, std::set<std::string>>;

// The folders of one room. Its own folder is one of them only where `with_top`: headers at the top may stand
// below and above the rest.
FolderGraph folders_of(std::string_view room, const std::vector<Include>& includes, bool with_top) {
  FolderGraph graph;
  for (const Include& include : includes) {
    const std::string from = folder_of(include.file), to = folder_of(include.target);
    if (room_of(from) != room || room_of(to) != room || from == to) continue;
    if (with_top || (from != room && to != room)) graph[from].insert(to);
  }
  return graph;
}

std::string text_of_circle(const std::vector<std::string>& way, const std::string& folder) {
  std::string text;
  for (auto step = std::ranges::find(way, folder); step != way.end(); ++step) text += *step + " -> ";
  return text + folder;
}

// The first circle that `folder` leads to, as a -> b -> a; empty where there is none. `way` led here; folders
// that lead to no circle are `clear`.
std::string find_circle_from(const std::string& folder, const FolderGraph& graph,
                             std::vector<std::string>& way, std::set<std::string>& clear) {
  if (clear.contains(folder)) return {};
  if (std::ranges::find(way, folder) != way.end()) return text_of_circle(way, folder);
  way.push_back(folder);
  if (const auto found = graph.find(folder); found != graph.end())
    for (const std::string& next : found->second)
      if (std::string circle = find_circle_from(next, graph, way, clear); !circle.empty()) return circle;
  way.pop_back();
  clear.insert(folder);
  return {};
}

std::string find_circle(const FolderGraph& graph) {
  std::set<std::string> clear;
  for (const auto& [folder, others] : graph) {
    std::vector<std::string> way;
    if (std::string circle = find_circle_from(folder, graph, way, clear); !circle.empty()) return circle;
  }
  return {};
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

TEST(IncludeDirection, TheGameIncludesWhatCallersMay) { expect_none(takes_the_game_behind_the_scenes); }

TEST(IncludeDirection, PublicHeadersOfTheEngineShowNoFolderOfIt) { expect_none(is_no_public_header_alone); }

TEST(IncludeDirection, FoldersOfARoomIncludeEachOtherInNoCircle) {
  const std::vector<Include> includes = includes_of_every_room();
  EXPECT_GT(folders_of("lod", includes, true).size(), 3U);
  // At the top of the reference and of signatures are both what their folders stand on and what stands on
  // them.
  for (const std::string_view room : kRooms)
    EXPECT_EQ(find_circle(folders_of(room, includes, room != "reference" && room != "signature")), "")
        << room;
}

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
  EXPECT_FALSE(takes_ode_outside_reference({"tools/game/game_world.h", "ode/ode.h"}));
  EXPECT_TRUE(takes_the_game_behind_the_scenes({"tools/game/game.cpp", "lod/manager/manager_impl.h"}));
  EXPECT_FALSE(takes_the_game_behind_the_scenes({"tools/game/game.cpp", "lodestone/lodestone.h"}));
  EXPECT_TRUE(is_no_public_header_alone({"lod/manager.h", "lod/support/rest.h"}));
  EXPECT_TRUE(is_no_public_header_alone({"lod/manager.cpp", "lod/manager.h"}));
  EXPECT_FALSE(is_no_public_header_alone({"lod/manager.h", "reference/mesh/mesh.h"}));
}

TEST(IncludeDirection, ACircleOfFoldersIsFoundAndNamed) {
  const std::vector<Include> includes = {{"lod/manager/step.cpp", "lod/support/level.h"},
                                         {"lod/support/level.h", "lod/contact/pair.h"},
                                         {"lod/contact/pair.h", "lod/body.h"},
                                         {"lod/contact/pair.cpp", "lod/tables/model.h"},
                                         {"lod/tables/model.cpp", "reference/shape.h"}};
  EXPECT_EQ(find_circle(folders_of("lod", includes, true)), "");
  const auto with = [&](const Include& one) {
    std::vector<Include> more = includes;
    more.push_back(one);
    return more;
  };
  EXPECT_EQ(find_circle(folders_of("lod", with({"lod/tables/model.cpp", "lod/support/level.h"}), true)),
            "lod/contact -> lod/tables -> lod/support -> lod/contact");
  EXPECT_EQ(find_circle(folders_of("lod", with({"lod/body.h", "lod/contact/pair.h"}), true)),
            "lod -> lod/contact -> lod");
  EXPECT_EQ(find_circle(folders_of("lod", with({"lod/body.h", "lod/contact/pair.h"}), false)), "");
}

}  // namespace
