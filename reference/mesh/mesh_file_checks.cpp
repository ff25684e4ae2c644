#include "reference/mesh/mesh_file_checks.h"

#include <fmt/format.h>
#include <locale.h>
#include <stdlib.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "reference/error.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxHeaderLines = 1000;  // of a PLY file

[[noreturn]] void refuse(const std::string& found, const std::string& expected) {
  throw InputError(fmt::format("found {}, expected {}", found, expected));
}

std::string read_whole(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) refuse("a file that cannot be read", "its bytes");
  return bytes;
}

/// Passes the next word of `line`, which ends where the line does; empty at the end.
std::string_view take_word(std::string_view& line) {
  constexpr std::string_view kSpace = " \t\r\f\v";
  line.remove_prefix(std::min(line.find_first_not_of(kSpace), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kSpace));
  line.remove_prefix(word.size());
  return word;
}

/// Passes the next line of `text`, without its end.
std::optional<std::string_view> take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  if (end == text.npos) return std::nullopt;
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return line;
}

/// Digits alone, as assimp reads counts; none for anything else or beyond 32 bits.
std::optional<std::uint32_t> count_in(std::string_view word) {
  std::uint32_t count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return count;
}

struct PlyType {
  std::string_view name;
  std::size_t bytes;
  bool is_integer;
};
constexpr PlyType kPlyTypes[] = {
    {"char", 1, true},   {"int8", 1, true},     {"uchar", 1, true},   {"uint8", 1, true},
    {"short", 2, true},  {"int16", 2, true},    {"ushort", 2, true},  {"uint16", 2, true},
    {"int", 4, true},    {"int32", 4, true},    {"uint", 4, true},    {"uint32", 4, true},
    {"float", 4, false}, {"float32", 4, false}, {"double", 8, false}, {"float64", 8, false}};

const PlyType& ply_type(std::string_view name) {
  const auto* type = std::ranges::find(kPlyTypes, name, &PlyType::name);
  if (type == std::end(kPlyTypes)) refuse(fmt::format("a property of type \"{}\"", name), "a type of PLY");
  return *type;
}

struct PlyProperty {
  const PlyType* count = nullptr;  ///< of a list; null of a single number
  const PlyType* value = nullptr;
};

struct PlyElement {
  std::string_view name;
  std::uint32_t count = 0;
  std::vector<PlyProperty> properties = {};
  bool has_list() const {
    return std::ranges::any_of(properties,
                               [](const PlyProperty& property) { return property.count != nullptr; });
  }
};

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
};

PlyFormat ply_format(std::string_view name) {
  if (name == "ascii") return PlyFormat::ascii;
  if (name == "binary_little_endian") return PlyFormat::little_endian;
  if (name == "binary_big_endian") return PlyFormat::big_endian;
  refuse(fmt::format("format \"{}\"", name), "ascii, binary_little_endian or binary_big_endian");
}

PlyProperty ply_property(std::string_view words) {
  PlyProperty property;
  std::string_view type = take_word(words);
  if (type == "list") {
    property.count = &ply_type(take_word(words));
    if (!property.count->is_integer) refuse("a list that is counted in fractions", "integers");
    type = take_word(words);
  }
  property.value = &ply_type(type);
  if (take_word(words).empty() || !take_word(words).empty())
    refuse("a property without a name of one word", "it");
  return property;
}

/// Assimp looks for `end_header` for ever, and sets aside room for all elements before it reads the first. It
/// takes a line of another kind within an element for that element's end: such files are refused, lest the
/// two of us read different ones.
PlyHeader take_ply_header(std::string_view& bytes) {
  const std::size_t all = bytes.size();
  std::uint64_t promised = 0;
  PlyHeader header;
  for (int i = 0; i < kMaxHeaderLines; ++i) {
    const std::optional<std::string_view> line = take_line(bytes);
    if (!line) break;
    std::string_view words = *line;
    const std::string_view keyword = take_word(words);
    if (i == 0 && keyword != "ply") break;
    if (keyword == "end_header") return header;
    if (keyword == "comment" || (i == 0 && keyword == "ply") ||
        (keyword == "obj_info" && header.elements.empty()))
      continue;
    if (keyword == "format") {
      header.format = ply_format(take_word(words));
    } else if (keyword == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(ply_property(words));
    } else if (keyword == "element") {
      const std::string_view name = take_word(words);
      const std::optional<std::uint32_t> count = count_in(take_word(words));
      if (count) promised += *count;
      if (!count || promised > all || !take_word(words).empty())
        refuse(fmt::format("\"{}\" in a file of {} bytes", *line, all), "a count of elements that fits");
      header.elements.push_back({name, *count});
    } else {
      refuse(fmt::format("\"{}\" in a header", line->substr(0, 80)),
             "format, comment, element, property or end_header");
    }
  }
  refuse("a header without end_header", "a PLY header");
}

/// Each element has a line of its own, and each list as many numbers as it says.
void check_ply_lines(const PlyElement& element, std::string_view& text) {
  for (std::uint32_t i = 0; i < element.count; ++i) {
    std::optional<std::string_view> line = take_line(text);
    if (!line && !text.empty()) line = std::exchange(text, {});  // the last one need not end
    if (!line) refuse(fmt::format("{} of {} lines of {}", i, element.count, element.name), "all of them");
    for (const PlyProperty& property : element.properties) {
      const std::string_view word = take_word(*line);
      const std::optional<std::uint32_t> count = property.count ? count_in(word) : 0;
      // Two bytes a number, at least.
      if (word.empty() || !count || *count > line->size() / 2)
        refuse(
            fmt::format("a {} of \"{}\" with {} bytes after it in {} {}", property.count ? "list" : "number",
                        word.substr(0, 40), line->size(), element.name, i),
            "as many numbers as it says");
      for (std::uint32_t k = 0; k < *count; ++k)
        if (take_word(*line).empty())
          refuse(fmt::format("{} of {} numbers of a list in {} {}", k, *count, element.name, i),
                 "all of them");
    }
  }
}

std::uint64_t count_at(std::string_view bytes, const PlyType& type, PlyFormat format) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < type.bytes; ++i)
    count = count << 8 | std::uint8_t(bytes[format == PlyFormat::big_endian ? i : type.bytes - 1 - i]);
  return count;
}

void check_ply_bytes(const PlyElement& element, PlyFormat format, std::string_view& bytes) {
  const auto pass = [&](std::uint64_t needed, std::uint32_t i) {
    if (needed > bytes.size())
      refuse(fmt::format("{} bytes for {} {}, where {} are left", needed, element.name, i, bytes.size()),
             "a file that has them");
    bytes.remove_prefix(needed);
  };
  if (!element.has_list()) {
    std::uint64_t size = 0;
    for (const PlyProperty& property : element.properties) size += property.value->bytes;
    return pass(size * element.count, 0);
  }
  for (std::uint32_t i = 0; i < element.count; ++i)
    for (const PlyProperty& property : element.properties) {
      std::uint64_t count = 1;
      if (property.count) {
        const std::string_view before = bytes;
        pass(property.count->bytes, i);
        count = count_at(before, *property.count, format);
      }
      pass(count * property.value->bytes, i);
    }
}

void check_ply(std::string_view bytes) {
  const PlyHeader header = take_ply_header(bytes);
  for (const PlyElement& element : header.elements)
    if (header.format == PlyFormat::ascii)
      check_ply_lines(element, bytes);
    else
      check_ply_bytes(element, header.format, bytes);
}

/// 80 bytes, a count, then 50 bytes a triangle; a text begins with "solid".
void check_stl(const fs::path& file) {
  constexpr std::uintmax_t kHeader = 84, kTriangle = 50;
  const std::uintmax_t bytes = fs::file_size(file);
  char head[kHeader] = {};
  std::ifstream(file, std::ios::binary).read(head, kHeader);
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, head + 80, sizeof triangles);
  const bool fits = bytes >= kHeader && (bytes - kHeader) / kTriangle >= triangles;
  std::string_view text(head, std::min<std::uintmax_t>(bytes, kHeader));
  if (!fits && take_word(text) != "solid" && std::string_view(head, 5) != "solid")
    refuse(fmt::format("{} triangles in {} bytes", triangles, bytes), "50 bytes for each after the first 84");
}

/// Each line with its number; one that ends in a backslash goes on in the next.
template <class Act>
void for_each_obj_line(std::string_view text, const Act& act) {
  std::string joined;
  for (int number = 1, first = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, text.size()));
    if (joined.empty()) first = number;
    if (line.ends_with('\\')) {
      joined += line.substr(0, line.size() - 1);
      if (!text.empty()) continue;
      line = {};
    }
    if (!joined.empty()) line = joined += line;
    act(first, line);
    joined.clear();
  }
}

/// In single precision, as assimp reads it: a comma may stand for the point, whatever the program's locale.
bool is_finite_number(std::string_view word) {
  static const locale_t kWithPoint = newlocale(LC_ALL_MASK, "C", nullptr);
  std::string number(word);
  std::ranges::replace(number, ',', '.');
  char* end = nullptr;
  const float value = strtof_l(number.c_str(), &end, kWithPoint);
  return !number.empty() && end == number.c_str() + number.size() && std::isfinite(value);
}

/// To assimp a byte order mark is a part of the first word, which it then does not know: a vertex would be
/// lost. Before a comment it does no harm.
void check_mark(std::string_view text, std::string& where) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (!text.starts_with(kMark)) return;
  text.remove_prefix(kMark.size());
  const std::string_view word = take_word(text);
  if (word.empty() || word[0] == '#' || word[0] == '\n') return;
  where += ":1";
  refuse(fmt::format("a byte order mark before '{}'", word.substr(0, word.find('\n')).substr(0, 40)),
         "a file without it");
}

/// Lines v are three numbers that are finite, and lines f name vertices that there are: assimp passes over a
/// vertex that is none, and says neither where it was nor which face has another than it should. `where` has
/// the line of what is refused.
void check_obj(std::string_view text, std::string& where) {
  const std::string file = where;
  check_mark(text, where);
  int vertices = 0;
  for_each_obj_line(text, [&](int number, std::string_view line) {
    if (take_word(line) != "v") return;
    ++vertices;
    for (int i = 0; i < 3; ++i)
      if (const std::string_view word = take_word(line); !is_finite_number(word)) {
        where = fmt::format("{}:{}: v", file, number);
        refuse(word.empty() ? fmt::format("{} numbers", i) : fmt::format("'{}'", word.substr(0, 40)),
               word.empty() ? "three" : "a finite number");
      }
  });
  int above = 0;  // vertices so far, which negative numbers count back from
  for_each_obj_line(text, [&](int number, std::string_view line) {
    const std::string_view keyword = take_word(line);
    above += keyword == "v";
    if (keyword != "f") return;
    const auto refuse_here = [&](const std::string& found, const std::string& expected) {
      where = fmt::format("{}:{}: f", file, number);
      refuse(found, expected);
    };
    for (std::string_view word = take_word(line); !word.empty() && word[0] != '#'; word = take_word(line)) {
      const std::string_view corner = word.substr(0, word.find('/'));
      std::int64_t vertex = 0;
      const auto [end, error] = std::from_chars(corner.data(), corner.data() + corner.size(), vertex);
      if (error != std::errc() || end != corner.data() + corner.size())
        refuse_here(fmt::format("'{}'", word.substr(0, 40)), "the number of a vertex");
      if (vertex < 0 ? -vertex > above : vertex == 0 || vertex > vertices)
        refuse_here(fmt::format("vertex {}", vertex), vertex < 0 ? fmt::format("one of the {} above", above)
                                                      : vertices > 0 ? fmt::format("1 … {}", vertices)
                                                                     : "lines v with vertices");
    }
  });
}

}  // namespace

void require_safe_for_assimp(const fs::path& file, const std::string& extension) {
  std::string where = file.string();
  try {
    if (extension == "obj") check_obj(read_whole(file), where);
    if (extension == "ply") check_ply(read_whole(file));
    if (extension == "stl") check_stl(file);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", where, error.what()));
  }
}

}  // namespace lodestone
