// A YAML file as a plain value in which everything knows its line. Built from yaml-cpp's events and not from
// its nodes, which hide duplicate keys, drop further documents, recurse for ever on an alias cycle and give
// no line for what is missing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lodestone {

struct YamlEntry;  // incomplete here: an initializer = {} of a vector of them would not do for clang

struct YamlValue {
  enum class Kind { null, scalar, sequence, map };
  Kind kind = Kind::null;
  int line = 1;                       ///< counted from 1
  bool quoted = false;                ///< "1" is text, 1 is a number
  std::string text = {};              ///< of a scalar
  std::vector<YamlValue> items = {};  ///< of a sequence
  std::vector<YamlEntry> entries;     ///< of a map, in the file's order, no key twice
};

struct YamlEntry {
  std::string key;
  int line = 1;
  YamlValue value;
};

struct YamlLimits {
  std::uintmax_t max_bytes = 64u << 20;
  int max_depth = 32;
  int max_values = 2'000'000;  ///< after aliases are expanded
};

/// Reads the one document of a file. Throws InputError, `file:line: …`, for anything else: a missing file or
/// folder, bad syntax, a duplicate key, a second document, an alias cycle, a tag, nesting or size beyond the
/// limits.
YamlValue load_yaml(const std::filesystem::path& file, const YamlLimits& limits = {});

/// The same from text; `name` stands for the file in messages.
YamlValue make_yaml(const std::string& text, const std::string& name, const YamlLimits& limits = {});

}  // namespace lodestone
