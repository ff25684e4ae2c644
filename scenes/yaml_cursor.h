// Typed, checked reading of a YamlValue. Every failure throws InputError as `file:line: key: found …,
// expected …`.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "reference/geometry.h"
#include "reference/mass_bounds.h"
#include "scenes/yaml_value.h"

namespace lodestone {

/// m, m/s, …: the largest magnitude of any number in a scene (beyond it ODE's hash space fails).
inline constexpr double kFarthest = 1e8;

/// Which numbers are accepted.
struct NumberRange {
  double low = -kFarthest, high = kFarthest;
  bool low_excluded = false;
};
inline constexpr NumberRange kPositive{0, kFarthest, true};
inline constexpr NumberRange kNotNegative{0, kFarthest};
inline constexpr NumberRange kFraction{0, 1};
inline constexpr NumberRange kMass{kLeastMass, kGreatestMass};  ///< kg
inline constexpr NumberRange kLength{1e-4, 1e4};                ///< m: the sizes a shape may have

/// A value, and the dotted key that led to it (`bodies[2].scatter.count`). Refers to the tree and the file
/// name: both must outlive it.
class YamlCursor {
 public:
  YamlCursor(const YamlValue& value, const std::string& file, std::string key = "")
      : value_(&value), file_(&file), key_(std::move(key)) {}

  [[noreturn]] void fail(std::string_view found, std::string_view expected) const;
  std::string found() const;  ///< what is here, as a message says it
  const std::string& key() const { return key_; }
  bool is_map() const { return value_->kind == YamlValue::Kind::map; }
  bool is_list() const { return value_->kind == YamlValue::Kind::sequence; }

  /// Fails unless this is a map with no other keys than these; suggests the nearest.
  void expect_keys(std::initializer_list<std::string_view> known) const;
  /// The one key of `choices` that is present; fails where none or several are.
  std::string_view one_key_of(std::initializer_list<std::string_view> choices) const;
  bool has(std::string_view name) const { return find(name).has_value(); }
  std::optional<YamlCursor> find(std::string_view name) const;
  YamlCursor at(std::string_view name) const;                       ///< fails where it is missing
  std::vector<YamlCursor> items() const;                            ///< of a list
  std::vector<YamlCursor> items(std::size_t count) const;           ///< of a list of that length
  std::vector<std::pair<std::string, YamlCursor>> entries() const;  ///< of a map

  std::string text() const;
  double number(const NumberRange& range = {}) const;
  double quotient(const NumberRange& range = {}) const;  ///< a number, or two as `1/60`
  std::int64_t integer(std::int64_t low, std::int64_t high) const;
  bool truth() const;  ///< false or true
  Vec3 vector(const NumberRange& range = {}) const;
  Vec3 direction() const;  ///< of any length but 0; normalised
  Quat rotation() const;   ///< w, x, y, z of any length but 0; normalised
  std::vector<double> numbers(std::size_t count, const NumberRange& range) const;
  /// Index of this text among `names`; suggests the nearest.
  std::size_t choice(std::span<const std::string> names) const;

 private:
  YamlCursor inner(const YamlValue& value, const std::string& key) const { return {value, *file_, key}; }
  const YamlValue* value_;
  const std::string* file_;
  std::string key_;
};

/// ` (did you mean "…"?)` for the nearest of `known`, or nothing where none is near.
std::string suggestion(std::string_view word, std::span<const std::string> known);

}  // namespace lodestone
