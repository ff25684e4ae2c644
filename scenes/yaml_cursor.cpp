#include "scenes/yaml_cursor.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <utility>

#include "reference/error.h"

namespace lodestone {
namespace {

/// How many letters must be inserted, dropped, changed or swapped with their neighbour to turn `a` into `b`.
int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> before(b.size() + 1), previous(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(previous, row);
    row[0] = int(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({previous[j] + 1, row[j - 1] + 1, previous[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

/// `010` would be eight to some readers of YAML and ten to others.
bool has_leading_zero(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9';
}

template <class Number>
std::optional<Number> parse(std::string_view text) {
  if (has_leading_zero(text)) return std::nullopt;
  if (text.starts_with('+')) text.remove_prefix(1);
  Number number{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return number;
}

template <class Number>
std::optional<Number> parse(const YamlValue& value) {
  return value.kind == YamlValue::Kind::scalar && !value.quoted ? parse<Number>(std::string_view(value.text))
                                                                : std::nullopt;
}

/// Of a number, or of two with a slash between them.
std::optional<double> parse_quotient(const YamlValue& value) {
  const std::size_t slash = value.text.find('/');
  if (slash == std::string::npos || value.quoted) return parse<double>(value);
  const std::string_view text = value.text;
  const auto above = parse<double>(text.substr(0, slash)), below = parse<double>(text.substr(slash + 1));
  return above && below ? std::optional(*above / *below) : std::nullopt;
}

std::string text_of(const NumberRange& range) {
  if (range.low_excluded && range.high == kFarthest)
    return fmt::format("a number above {} (at most {})", range.low, range.high);
  return fmt::format("a number in {}{}, {}]", range.low_excluded ? '(' : '[', range.low, range.high);
}

bool contains(const NumberRange& range, double x) {
  return std::isfinite(x) && x <= range.high && (range.low_excluded ? x > range.low : x >= range.low);
}

std::vector<std::string> strings(std::initializer_list<std::string_view> views) {
  return {views.begin(), views.end()};
}

}  // namespace

std::string suggestion(std::string_view word, std::span<const std::string> known) {
  const auto distance = [&](const std::string& candidate) { return edit_distance(word, candidate); };
  const auto nearest = std::ranges::min_element(known, {}, distance);
  if (nearest == known.end()) return "";
  // A forgotten or doubled unit (`mass` for `mass_kg`) counts as near, whatever its length.
  const bool is_part = word.size() > 1 && (nearest->starts_with(word) || word.starts_with(*nearest));
  const auto longer = std::ranges::find_if(
      known, [&](const std::string& k) { return word.size() > 2 && k.starts_with(word); });
  if (is_part || distance(*nearest) <= std::max<int>(1, int(word.size()) / 3))
    return fmt::format(" (did you mean \"{}\"?)", *nearest);
  return longer == known.end() ? "" : fmt::format(" (did you mean \"{}\"?)", *longer);
}

void YamlCursor::fail(std::string_view found, std::string_view expected) const {
  throw InputError(fmt::format("{}:{}: {}: found {}, expected {}", *file_, value_->line,
                               key_.empty() ? "scene" : key_, found, expected));
}

std::string YamlCursor::found() const {
  switch (value_->kind) {
    case YamlValue::Kind::null:
      return "nothing";
    case YamlValue::Kind::sequence:
      return fmt::format("a list of {}", value_->items.size());
    case YamlValue::Kind::map:
      return "a map";
    case YamlValue::Kind::scalar:
      break;
  }
  std::string shown = value_->text.substr(0, 60) + (value_->text.size() > 60 ? "…" : "");
  return value_->quoted ? fmt::format("the text \"{}\"", shown) : shown;
}

void YamlCursor::expect_keys(std::initializer_list<std::string_view> known) const {
  if (!is_map()) fail(found(), fmt::format("a map with {}", fmt::join(known, ", ")));
  for (const YamlEntry& entry : value_->entries) {
    if (std::ranges::find(known, entry.key) != known.end()) continue;
    YamlValue place;
    place.line = entry.line;
    const std::vector<std::string> names = strings(known);
    inner(place, key_.empty() ? entry.key : key_ + "." + entry.key)
        .fail("an unknown key",
              fmt::format("one of {}{}", fmt::join(known, ", "), suggestion(entry.key, names)));
  }
}

std::string_view YamlCursor::one_key_of(std::initializer_list<std::string_view> choices) const {
  std::vector<std::string_view> present;
  for (std::string_view name : choices)
    if (has(name)) present.push_back(name);
  const std::string expected = fmt::format("one of {}", fmt::join(choices, ", "));
  if (present.empty()) fail("none", expected);
  if (present.size() > 1) fail(fmt::format("{}", fmt::join(present, " and ")), "only " + expected);
  return present.front();
}

std::optional<YamlCursor> YamlCursor::find(std::string_view name) const {
  if (!is_map()) fail(found(), "a map");
  for (const YamlEntry& entry : value_->entries)
    if (entry.key == name) return inner(entry.value, key_.empty() ? entry.key : key_ + "." + entry.key);
  return std::nullopt;
}

YamlCursor YamlCursor::at(std::string_view name) const {
  if (auto cursor = find(name)) return *cursor;
  inner(*value_, key_.empty() ? std::string(name) : fmt::format("{}.{}", key_, name))
      .fail("no such key", "it to be given");
}

std::vector<YamlCursor> YamlCursor::items() const {
  if (value_->kind != YamlValue::Kind::sequence) fail(found(), "a list");
  std::vector<YamlCursor> cursors;
  for (const YamlValue& item : value_->items)
    cursors.push_back(inner(item, fmt::format("{}[{}]", key_, cursors.size())));
  return cursors;
}

std::vector<YamlCursor> YamlCursor::items(std::size_t count) const {
  if (value_->kind != YamlValue::Kind::sequence || value_->items.size() != count)
    fail(found(), fmt::format("a list of {}", count));
  return items();
}

std::vector<std::pair<std::string, YamlCursor>> YamlCursor::entries() const {
  if (!is_map()) fail(found(), "a map");
  std::vector<std::pair<std::string, YamlCursor>> cursors;
  for (const YamlEntry& entry : value_->entries)
    cursors.emplace_back(entry.key, inner(entry.value, key_.empty() ? entry.key : key_ + "." + entry.key));
  return cursors;
}

std::string YamlCursor::text() const {
  if (value_->kind != YamlValue::Kind::scalar || value_->text.empty()) fail(found(), "a text");
  return value_->text;
}

double YamlCursor::number(const NumberRange& range) const {
  const std::optional<double> number = parse<double>(*value_);
  if (!number || !contains(range, *number)) fail(found(), text_of(range));
  return *number;
}

double YamlCursor::quotient(const NumberRange& range) const {
  const std::optional<double> number = parse_quotient(*value_);
  if (!number || !contains(range, *number)) fail(found(), text_of(range) + ", or such a quotient as 1/60");
  return *number;
}

std::int64_t YamlCursor::integer(std::int64_t low, std::int64_t high) const {
  const std::optional<std::int64_t> number = parse<std::int64_t>(*value_);
  if (!number || *number < low || *number > high)
    fail(found(), fmt::format("a whole number from {} to {}", low, high));
  return *number;
}

std::vector<double> YamlCursor::numbers(std::size_t count, const NumberRange& range) const {
  std::vector<double> values;
  for (const YamlCursor& item : items(count)) values.push_back(item.number(range));
  return values;
}

Vec3 YamlCursor::vector(const NumberRange& range) const {
  const std::vector<double> v = numbers(3, range);
  return {v[0], v[1], v[2]};
}

Vec3 YamlCursor::direction() const {
  const Vec3 v = vector();
  if (v.norm() < 1e-12) fail("[0, 0, 0]", "a direction of any length but 0");
  return v.normalized();
}

Quat YamlCursor::rotation() const {
  const std::vector<double> q = numbers(4, {});
  const Quat rotation(q[0], q[1], q[2], q[3]);
  if (rotation.norm() < 1e-12) fail("[0, 0, 0, 0]", "a quaternion w, x, y, z of any length but 0");
  return rotation.normalized();
}

bool YamlCursor::truth() const {
  static const std::array<std::string, 2> kTruths{"false", "true"};
  if (value_->quoted) fail(found(), "false or true");  // a text, as the schema has it
  return choice(kTruths) == 1;
}

std::size_t YamlCursor::choice(std::span<const std::string> names) const {
  const std::string word = text();
  const auto place = std::ranges::find(names, word);
  if (place == names.end())
    fail(word, fmt::format("one of {}{}", fmt::join(names, ", "), suggestion(word, names)));
  return std::size_t(place - names.begin());
}

}  // namespace lodestone
