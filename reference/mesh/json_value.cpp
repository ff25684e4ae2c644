#include "reference/mesh/json_value.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>

#include "reference/error.h"

namespace lodestone {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Recursive descent, no deeper than the limit.
class JsonParser {
 public:
  JsonParser(std::string_view text, const JsonLimits& limits) : text_(text), limits_(limits) {}

  JsonValue parse_all() {
    JsonValue value = parse_value(0);
    skip_space();
    if (at_ < text_.size()) fail("the end");
    return value;
  }

 private:
  [[noreturn]] void fail(std::string_view expected) const {
    const std::string found =
        at_ < text_.size() ? fmt::format("byte {:#04x}", std::uint8_t(text_[at_])) : "the end";
    throw InputError(fmt::format("found {} at byte {} of the JSON, expected {}", found, at_, expected));
  }

  void skip_space() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
  }

  /// Whether `c` is next, which is then passed.
  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  bool take_word(std::string_view word) {
    if (!text_.substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }

  JsonValue parse_value(int depth) {
    if (++values_ > limits_.values)
      throw InputError(fmt::format("found more than {0} JSON values, expected at most {0}", limits_.values));
    skip_space();
    if (take('{')) return parse_object(depth + 1);
    if (take('[')) return parse_list(depth + 1);
    JsonValue value;
    if (take('"')) {
      value.kind = JsonValue::Kind::text;
      value.text = parse_text();
    } else if (take_word("true") || take_word("false")) {
      value.kind = JsonValue::Kind::boolean;
      value.number = text_[at_ - 2] == 'u';
    } else if (!take_word("null")) {
      value.kind = JsonValue::Kind::number;
      value.number = parse_number();
    }
    return value;
  }

  void check_depth(int depth) const {
    if (depth > limits_.depth)
      throw InputError(fmt::format("found JSON nested {} deep, expected at most {}", depth, limits_.depth));
  }

  JsonValue parse_object(int depth) {
    check_depth(depth);
    JsonValue object;
    object.kind = JsonValue::Kind::object;
    skip_space();
    if (take('}')) return object;
    do {
      skip_space();
      if (!take('"')) fail("a key");
      object.keys.push_back(parse_text());
      skip_space();
      if (!take(':')) fail("':'");
      object.items.push_back(parse_value(depth));
      skip_space();
    } while (take(','));
    if (!take('}')) fail("',' or '}'");
    return object;
  }

  JsonValue parse_list(int depth) {
    check_depth(depth);
    JsonValue list;
    list.kind = JsonValue::Kind::list;
    skip_space();
    if (take(']')) return list;
    do {
      list.items.push_back(parse_value(depth));
      skip_space();
    } while (take(','));
    if (!take(']')) fail("',' or ']'");
    return list;
  }

  /// From the backslash to the escape's last letter.
  void pass_escape() {
    constexpr std::string_view kHexadecimal = "0123456789abcdefABCDEF";
    if (++at_ >= text_.size()) return;
    if (std::string_view("\"\\/bfnrtu").find(text_[at_]) == std::string_view::npos) fail("an escape");
    if (text_[at_] != 'u') return;
    for (int digit = 0; digit < 4; ++digit)
      if (++at_ < text_.size() && kHexadecimal.find(text_[at_]) == std::string_view::npos)
        fail("four hexadecimal digits");
  }

  /// After the opening quote, up to the closing one.
  std::string_view parse_text() {
    const std::size_t first = at_;
    for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (std::uint8_t(text_[at_]) < 0x20) fail("no control character in a text");
      if (text_[at_] == '\\') pass_escape();
      if (at_ >= text_.size()) break;
    }
    if (at_ >= text_.size()) fail("'\"'");
    return text_.substr(first, at_++ - first);
  }

  /// Passes digits; fails where there is none.
  void take_digits() {
    if (at_ >= text_.size() || !is_digit(text_[at_])) fail("a digit");
    while (at_ < text_.size() && is_digit(text_[at_])) ++at_;
  }

  double parse_number() {
    const std::size_t first = at_;
    if (!take('-') && (at_ >= text_.size() || !is_digit(text_[at_]))) fail("a value");
    if (!take('0')) take_digits();  // no zeros in front
    if (take('.')) take_digits();
    if (take('e') || take('E')) {
      if (!take('+')) take('-');
      take_digits();
    }
    double number = 0.0;
    const auto [stop, error] = std::from_chars(text_.data() + first, text_.data() + at_, number);
    if (error != std::errc() || !std::isfinite(number)) fail("a number of double precision");
    return number;
  }

  std::string_view text_;
  JsonLimits limits_;
  std::size_t at_ = 0;
  int values_ = 0;
};

/// Of the four hexadecimal digits at `at`.
unsigned code_at(std::string_view text, std::size_t at) {
  unsigned code = 0;
  const char* end = text.data() + std::min(at + 4, text.size());
  if (at + 4 > text.size() || std::from_chars(text.data() + at, end, code, 16).ptr != end)
    throw InputError("found \\u without four hexadecimal digits in the JSON, expected \\uXXXX");
  return code;
}

void append_utf8(std::string& out, unsigned code) {
  if (code < 0x80) {
    out += char(code);
  } else if (code < 0x800) {
    out += {char(0xc0 | code >> 6), char(0x80 | (code & 0x3f))};
  } else if (code < 0x10000) {
    out += {char(0xe0 | code >> 12), char(0x80 | (code >> 6 & 0x3f)), char(0x80 | (code & 0x3f))};
  } else {
    out += {char(0xf0 | code >> 18), char(0x80 | (code >> 12 & 0x3f)), char(0x80 | (code >> 6 & 0x3f)),
            char(0x80 | (code & 0x3f))};
  }
}

}  // namespace

const JsonValue* JsonValue::find(std::string_view key) const {
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i] == key) return &items[i];
  return nullptr;
}

JsonValue parse_json(std::string_view text, const JsonLimits& limits) {
  return JsonParser(text, limits).parse_all();
}

std::string unescape_json(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      out += text[i];
      continue;
    }
    const char c = text[++i];
    if (c != 'u') {
      constexpr std::string_view kLetters = "bfnrt", kMeanings = "\b\f\n\r\t";
      const std::size_t place = kLetters.find(c);
      out += place == kLetters.npos ? c : kMeanings[place];
      continue;
    }
    unsigned code = code_at(text, i + 1);
    i += 4;
    if (code >= 0xd800 && code < 0xe000) {  // a pair of surrogates
      const unsigned low = text.substr(i + 1).starts_with("\\u") ? code_at(text, i + 3) : 0;
      if (code >= 0xdc00 || low < 0xdc00 || low >= 0xe000)
        throw InputError("found half a pair of surrogates in the JSON, expected both");
      code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
      i += 6;
    }
    append_utf8(out, code);
  }
  return out;
}

}  // namespace lodestone
