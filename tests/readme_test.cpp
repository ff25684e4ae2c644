// README and the pages of its rooms show only what there is: code that is built and run, links that lead
// somewhere, commands and options that the program has, files that exist, a scene that loads.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/scene_file.h"
#include "tests/tools/cli_fixture.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using testing::quoted;
using testing::run_shell;

const fs::path kSource = LODESTONE_SOURCE_DIR;
const std::array<std::string, 10> kPages = {
    "README.md",           "lod/README.md",       "lod/limits.md",    "lod/words.md",    "lod/findings.md",
    "signature/README.md", "reference/README.md", "scenes/README.md", "tools/README.md", "tests/README.md"};

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

// What stands between a line ```language and the next ```.
std::vector<std::string> code_blocks_of(const std::string& markdown, const std::string& language) {
  const std::string opening = "\n```" + language + "\n", closing = "\n```\n";
  std::vector<std::string> blocks;
  for (auto at = markdown.find(opening); at != std::string::npos; at = markdown.find(opening, at)) {
    at += opening.size();
    blocks.push_back(markdown.substr(at, markdown.find(closing, at) - at));
  }
  return blocks;
}

// A page without its fenced blocks, and what stands there between backticks.
struct Prose {
  std::vector<std::string> lines;
  std::vector<std::string> code;  // spans, also those that go over a line's end, and indented lines
};

// Appends the spans of one paragraph.
void add_spans(const std::string& paragraph, std::vector<std::string>& code) {
  for (auto at = paragraph.find('`'); at != std::string::npos; at = paragraph.find('`', at + 1)) {
    const auto end = paragraph.find('`', at + 1);
    if (end == std::string::npos) return;
    code.push_back(paragraph.substr(at + 1, end - at - 1));
    at = end;
  }
}

Prose prose_of(const std::string& markdown) {
  Prose prose;
  std::string paragraph;
  bool fenced = false;
  for (const std::string& line : lines_of(markdown)) {
    if (line.starts_with("```")) fenced = !fenced;
    if (fenced || line.starts_with("```")) continue;
    prose.lines.push_back(line);
    const bool starts_anew =
        line.empty() || line.starts_with("|") || line.starts_with("- ") || line.starts_with("    ");
    if (starts_anew) add_spans(std::exchange(paragraph, {}), prose.code);
    if (line.starts_with("    "))
      prose.code.push_back(line);
    else
      paragraph += line + ' ';
  }
  add_spans(paragraph, prose.code);
  return prose;
}

// As GitHub makes it of a heading: in lower case, blanks to hyphens, only letters, digits, hyphens and
// underscores.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading.substr(heading.find_first_not_of("# "))) {
    if (c == ' ')
      anchor += '-';
    else if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
      anchor += char(std::tolower(c));
  }
  return anchor;
}

std::set<std::string> anchors_of(const fs::path& page) {
  std::set<std::string> anchors;
  for (const std::string& line : prose_of(text_of(page)).lines)
    if (line.starts_with("#")) anchors.insert(anchor_of(line));
  return anchors;
}

std::vector<std::string> links_of(const std::string& markdown) {
  std::vector<std::string> links;
  for (auto at = markdown.find("]("); at != std::string::npos; at = markdown.find("](", at)) {
    at += 2;
    links.push_back(markdown.substr(at, markdown.find(')', at) - at));
  }
  return links;
}

// Where a link of `page` goes: to a file that is there, and to a heading of it.
bool leads_somewhere(const fs::path& page, const std::string& link) {
  if (link.starts_with("http")) return true;
  const auto hash = link.find('#');
  const fs::path file = hash == 0 ? page : page.parent_path() / link.substr(0, hash);
  if (!fs::exists(file)) return false;
  return hash == std::string::npos || anchors_of(file).contains(link.substr(hash + 1));
}

// A call of the program: `lodestone compare drop box:1,1,1 --dt 1/60` has the command "compare drop" and one
// option.
struct Call {
  std::string command;
  std::vector<std::string> options;
};

bool is_end_of_call(const std::string& word) {
  return word == "&&" || word == "|" || word == ":::" || word == ";";
}

void add_option(const std::string& word, Call& call) {
  if (word.size() < 2 || word[0] != '-' ||
      !std::isalpha(static_cast<unsigned char>(word[word.size() > 2 && word[1] == '-' ? 2 : 1])))
    return;
  const auto end = std::ranges::find_if(word, [](unsigned char c) { return !std::isalnum(c) && c != '-'; });
  call.options.emplace_back(word.begin(), end);
}

Call call_of(const std::vector<std::string>& words, std::size_t first) {
  Call call;
  for (std::size_t i = first; i < words.size() && !is_end_of_call(words[i]); ++i) {
    const bool is_command =
        i == first || (i == first + 1 && (call.command == "compare" || call.command == "bench"));
    if (is_command && !words[i].starts_with("-"))
      call.command += (i == first ? "" : " ") + words[i];
    else
      add_option(words[i], call);
  }
  return call;
}

// Where the program is named by its place, or at the beginning by its name.
std::vector<Call> calls_in(const std::string& code) {
  std::vector<Call> calls;
  const std::vector<std::string> words = words_of(code);
  for (std::size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i] == "build/lodestone" || (i == 0 && words[i] == "lodestone"))
      calls.push_back(call_of(words, i + 1));
  return calls;
}

// The cells of a row of a table, without the escapes of bars.
std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells(1);
  for (std::size_t i = 1; i < row.size(); ++i) {
    if (row[i] == '|' && row[i - 1] != '\\')
      cells.emplace_back();
    else if (row[i] != '\\')
      cells.back() += row[i];
  }
  return cells;
}

std::vector<std::string> spans_of(const std::string& text) {
  std::vector<std::string> spans;
  add_spans(text, spans);
  return spans;
}

// The rows of the table of commands: each command of the first cell with all options of the third.
std::vector<Call> calls_of_table(const std::string& markdown) {
  std::vector<Call> calls;
  bool inside = false;
  for (const std::string& line : lines_of(markdown)) {
    if (line.starts_with("| command |"))
      inside = true;
    else if (!line.starts_with("|"))
      inside = false;
    const std::vector<std::string> cells = cells_of(line);
    if (!inside || cells.size() < 3) continue;
    for (const std::string& span : spans_of(cells[0])) {
      calls.push_back(call_of(words_of(span), 0));
      for (const std::string& option : spans_of(cells[2])) add_option(option, calls.back());
    }
  }
  return calls;
}

// The names under "Subcommands:" in a help.
std::vector<std::string> subcommands_in(const std::string& help) {
  std::vector<std::string> names;
  const auto at = help.find("ubcommands:");
  if (at == std::string::npos) return names;
  for (const std::string& line : lines_of(help.substr(at)))
    if (line.starts_with("  ") && line.size() > 2 && line[2] != ' ') names.push_back(words_of(line).front());
  return names;
}

// What the program says of a command.
const std::string& help_of(const std::string& command) {
  static std::map<std::string, std::string> known;
  const auto [entry, is_new] = known.try_emplace(command);
  if (is_new) entry->second = run_shell(quoted(LODESTONE_CLI) + ' ' + command + " --help 2>&1").out;
  return entry->second;
}

// Each word of it among the subcommands of what stands before; help alone is printed after any words.
bool is_command(const std::string& command) {
  std::string before;
  for (const std::string& word : words_of(command)) {
    const std::vector<std::string> known = subcommands_in(help_of(before));
    if (std::ranges::find(known, word) == known.end()) return false;
    before += (before.empty() ? "" : " ") + word;
  }
  return true;
}

bool has_option(const std::string& help, const std::string& option) {
  for (auto at = help.find(option); at != std::string::npos; at = help.find(option, at + 1)) {
    const char next = at + option.size() < help.size() ? help[at + option.size()] : '\n';
    if ((at == 0 || !std::isalnum(static_cast<unsigned char>(help[at - 1]))) &&
        !std::isalnum(static_cast<unsigned char>(next)) && next != '-')
      return true;
  }
  return false;
}

void expect_in_program(const Call& call, const std::string& page) {
  EXPECT_TRUE(is_command(call.command)) << page << ": lodestone " << call.command;
  const std::string& help = help_of(call.command);
  for (const std::string& option : call.options)
    EXPECT_TRUE(has_option(help, option)) << page << ": lodestone " << call.command << ' ' << option;
}

// A path of the project, as `lod/manager.h` or `tools/run SCENE.yaml` begins with; empty for other code.
std::string path_in(const std::string& code) {
  const std::vector<std::string> words = words_of(code);
  if (words.empty()) return {};
  const std::string& path = words.front();
  const std::string room = path.substr(0, path.find('/'));
  constexpr std::array<std::string_view, 6> kRooms = {"lod",    "signature", "reference",
                                                      "scenes", "tools",     "tests"};
  const bool is_plain = std::ranges::all_of(
      path, [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '.' || c == '/'; });
  return is_plain && room.size() < path.size() && std::ranges::find(kRooms, room) != kRooms.end()
             ? path
             : std::string();
}

TEST(Readme, ItsCodeIsInTheProgramThatTheInstallTestRuns) {
  const std::vector<std::string> blocks = code_blocks_of(text_of(kSource / "README.md"), "cpp");
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_NE(blocks.front().find("Manager manager("), std::string::npos);
  const std::string program = text_of(kSource / "tests/install/consumer.cpp");
  for (const std::string& page : kPages)
    for (const std::string& block : code_blocks_of(text_of(kSource / page), "cpp"))
      EXPECT_NE(program.find(block), std::string::npos) << page << '\n' << block;
}

TEST(Readme, TheFirstPageIsShort) { EXPECT_LE(lines_of(text_of(kSource / "README.md")).size(), 120U); }

TEST(Readme, EveryRoomIsLinkedFromTheFirstPageAndItsOtherPagesFromItsOwn) {
  for (std::size_t i = 1; i < kPages.size(); ++i) {
    const fs::path page = kPages[i];
    const bool is_room = page.filename() == "README.md";
    const fs::path from = is_room ? fs::path("README.md") : page.parent_path() / "README.md";
    const std::string link = is_room ? kPages[i] : page.filename().string();
    EXPECT_GE(std::ranges::count(links_of(text_of(kSource / from)), link), 1) << from << ": " << link;
  }
}

TEST(Readme, EveryLinkLeadsSomewhere) {
  for (const std::string& page : kPages)
    for (const std::string& link : links_of(text_of(kSource / page)))
      EXPECT_TRUE(leads_somewhere(kSource / page, link)) << page << ": " << link;
}

TEST(Readme, TheProgramHasEveryCommandAndOptionThatIsNamed) {
  int calls = 0;
  for (const std::string& page : kPages) {
    const std::string markdown = text_of(kSource / page);
    std::vector<Call> named = calls_of_table(markdown);
    for (const std::string& code : prose_of(markdown).code)
      std::ranges::copy(calls_in(code), std::back_inserter(named));
    calls += int(named.size());
    for (const Call& call : named) expect_in_program(call, page);
  }
  EXPECT_GT(calls, 50);
}

TEST(Readme, EveryCommandOfTheProgramIsNamed) {
  std::set<std::string> named;
  for (const Call& call : calls_of_table(text_of(kSource / "tools/README.md"))) named.insert(call.command);
  ASSERT_FALSE(subcommands_in(help_of("")).empty());
  for (const std::string& command : subcommands_in(help_of(""))) {
    const std::vector<std::string> parts = subcommands_in(help_of(command));
    EXPECT_TRUE(!parts.empty() || named.contains(command)) << command;
    for (const std::string& part : parts)
      EXPECT_TRUE(named.contains(command + ' ' + part)) << command << ' ' << part;
  }
}

TEST(Readme, EveryFileThatIsNamedExists) {
  int files = 0;
  for (const std::string& page : kPages)
    for (const std::string& code : prose_of(text_of(kSource / page)).code)
      if (const std::string path = path_in(code); !path.empty()) {
        ++files;
        EXPECT_TRUE(fs::exists(kSource / path)) << page << ": " << path;
      }
  EXPECT_GT(files, 20);
}

TEST(Readme, TheSceneThatIsShownLoads) {
  const std::vector<std::string> blocks = code_blocks_of(text_of(kSource / "scenes/README.md"), "yaml");
  ASSERT_EQ(blocks.size(), 1U);
  const fs::path file = fs::path(::testing::TempDir()) / "readme_scene.yaml";
  std::ofstream(file) << blocks.front() << '\n';
  const Scene scene = load_scene(file, {});
  EXPECT_EQ(scene.bodies.size(), 101U);
  EXPECT_EQ(scene.shapes.size(), 2U);
  fs::remove(file);
}

// What the tests above go by can fail.
TEST(Readme, OtherCodeIsNoticed) {
  const std::string markdown = "Text\n```cpp\nint a;\nint b;\n```\nmore\n```sh\nls `x`\n```\n";
  ASSERT_EQ(code_blocks_of(markdown, "cpp").size(), 1U);
  EXPECT_EQ(code_blocks_of(markdown, "cpp").front(), "int a;\nint b;");
  EXPECT_TRUE(prose_of(markdown).code.empty());
}

TEST(Readme, DeadLinksAreNoticed) {
  const fs::path page = kSource / "README.md";
  EXPECT_EQ(anchor_of("## Who is `full`: \"lod\", now"), "who-is-full-lod-now");
  EXPECT_TRUE(leads_somewhere(page, "#limits"));
  EXPECT_TRUE(leads_somewhere(page, "lod/README.md#limits"));
  EXPECT_TRUE(leads_somewhere(kSource / "lod/README.md", "../tools/README.md"));
  EXPECT_FALSE(leads_somewhere(page, "#nowhere"));
  EXPECT_FALSE(leads_somewhere(page, "lod/README.md#nowhere"));
  EXPECT_FALSE(leads_somewhere(page, "nowhere.md"));
}

TEST(Readme, CallsAreRead) {
  const std::vector<Call> calls = calls_in(
      "build/lodestone run a.yaml --out city && build/lodestone compare drop l:1,2 --dt=1/60 -o x -4 --model "
      "tables|support");
  ASSERT_EQ(calls.size(), 2U);
  EXPECT_EQ(calls[0].command, "run");
  EXPECT_EQ(calls[0].options, std::vector<std::string>{"--out"});
  EXPECT_EQ(calls[1].command, "compare drop");
  EXPECT_EQ(calls[1].options, (std::vector<std::string>{"--dt", "-o", "--model"}));
  EXPECT_TRUE(calls_in("$(pkg-config --libs lodestone ode)").empty());
  EXPECT_TRUE(is_command("compare drop"));
  EXPECT_FALSE(is_command("nonsense"));
  EXPECT_FALSE(is_command("compare nonsense"));
  EXPECT_FALSE(has_option(help_of("run"), "--bud"));
  EXPECT_TRUE(has_option(help_of("run"), "--budget-ms"));
  EXPECT_EQ(path_in("lod/manager.h"), "lod/manager.h");
  EXPECT_EQ(path_in("models/*.obj"), "");
}

}  // namespace
}  // namespace lodestone
