// A small JSON reader for files of strangers: bounded in depth and in number of values, nothing copied.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lodestone {

/// A value of a JSON text, which must outlive it: texts and keys are views into it.
struct JsonValue {
  enum class Kind { null, boolean, number, text, list, object };
  Kind kind = Kind::null;
  double number = 0.0;                 ///< finite; of a boolean 0 or 1
  std::string_view text;               ///< as written between its quotes; see unescape_json
  std::vector<JsonValue> items;        ///< of a list, or the values of an object
  std::vector<std::string_view> keys;  ///< of an object, beside `items`; as written

  /// The first value under `key`; null where there is none, or where this is no object.
  const JsonValue* find(std::string_view key) const;
};

struct JsonLimits {
  int depth = 64;
  int values = 1'000'000;
};

/// Throws InputError, without the name of a file, for what is no JSON (RFC 8259) or is beyond `limits`.
JsonValue parse_json(std::string_view text, const JsonLimits& limits = {});

/// A text of a JSON value with its escapes resolved, as UTF-8. Throws InputError for a lone surrogate.
std::string unescape_json(std::string_view text);

}  // namespace lodestone
