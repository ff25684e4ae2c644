// The state of a running simulation as bytes, and back to the bit. Each owner of state names what it holds
// once, in a function `archive(StateArchive&)` beside its members, for both ways. Values go as they lie in
// memory: only the build that wrote them reads them, which whoever keeps the bytes must check.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "reference/error.h"
#include "reference/shape.h"

namespace lodestone {

class StateArchive;

template <class T>
concept ArchivesItself = requires(T& value, StateArchive& archive) {
  value.archive(archive);
};
/// Holds no memory of its own. Pointers are no values.
template <class T>
concept PlainState = std::is_trivially_destructible_v<T> && !std::is_pointer_v<T> && !ArchivesItself<T>;

class StateArchive {
 public:
  /// Writes, most likely no more than so many bytes.
  explicit StateArchive(std::size_t expected = 0) { bytes_.reserve(expected); }
  /// Reads; `shapes` are those of the writer, in its order.
  StateArchive(std::span<const std::byte> bytes, std::vector<std::shared_ptr<const Shape>> shapes)
      : reading_(true), left_(bytes), shapes_(std::move(shapes)) {}

  bool reading() const { return reading_; }
  template <class... T>
  void operator()(T&... values) {
    (take(values), ...);
  }

  const std::vector<std::byte>& bytes() const { return bytes_; }                       ///< written
  bool at_end() const { return left_.empty(); }                                        ///< of what is read
  const std::vector<std::shared_ptr<const Shape>>& shapes() const { return shapes_; }  ///< that were met

 private:
  void take_bytes(void* at, std::size_t count) {
    if (!reading_) {
      const std::size_t before = bytes_.size();
      bytes_.resize(before + count);
      if (count > 0) std::memcpy(bytes_.data() + before, at, count);
      return;
    }
    if (count > left_.size()) throw_input_error("state", "its end in the middle of a value", "more bytes");
    if (count > 0) std::memcpy(at, left_.data(), count);
    left_ = left_.subspan(count);
  }
  std::size_t take_count(std::size_t count) {
    auto wide = std::uint64_t(count);
    take_bytes(&wide, sizeof wide);
    if (reading_ && wide > left_.size())
      throw_input_error("state", "a list of " + std::to_string(wide),
                        "one of at most the " + std::to_string(left_.size()) + " bytes that follow");
    return std::size_t(wide);
  }

  /// A value in a union: of any other, GCC 12 clears bytes of a member that is an array of classes of more
  /// than 64 bytes, in place of what lies behind it.
  template <class T>
  union Cleared {
    explicit Cleared(const T& given) : value(given) {}
    ~Cleared() {}
    T value;
  };
  /// What lies between members goes as zeros, where the compiler can tell.
  template <PlainState T>
  void take(T& value) {
#if __has_builtin(__builtin_clear_padding)
    if constexpr (!std::is_arithmetic_v<T>) {
      if (!reading_) {
        Cleared<T> copy(value);
        __builtin_clear_padding(&copy);
        return take_bytes(static_cast<void*>(&copy), sizeof(T));
      }
    }
#endif
    take_bytes(static_cast<void*>(&value), sizeof(T));
  }
  template <ArchivesItself T>
  void take(T& value) {
    value.archive(*this);
  }
  /// Of an empty one no more than that: what lies there instead of a value differs from run to run.
  template <class T>
  void take(std::optional<T>& value) {
    auto there = std::uint8_t(value.has_value());
    take(there);
    if (reading_) value.reset();
    if (there) take(reading_ ? value.emplace() : *value);
  }
  template <class T>
  void take(std::vector<T>& values) {
    const std::size_t count = take_count(values.size());
    if (reading_) values.resize(count);
    if constexpr (std::is_arithmetic_v<T>)
      take_bytes(static_cast<void*>(values.data()), count * sizeof(T));
    else
      for (T& value : values) take(value);
  }
  /// Maps, the values of a hash map in the order of the keys.
  template <class Map>
  requires requires { typename Map::mapped_type; }
  void take(Map& map) {
    const std::size_t count = take_count(map.size());
    if (reading_) {
      map.clear();
      for (std::size_t i = 0; i < count; ++i) {
        typename Map::key_type key{};
        take(key);
        take(map[key]);
      }
      return;
    }
    std::vector<typename Map::key_type> keys;
    for (const auto& entry : map) keys.push_back(entry.first);
    std::ranges::sort(keys);
    for (auto& key : keys) take(key), take(map.find(key)->second);
  }
  /// Hash sets, in order.
  template <class Set>
  requires(
      requires { typename Set::hasher; } && !requires { typename Set::mapped_type; }) void take(Set& set) {
    std::vector<typename Set::key_type> keys(set.begin(), set.end());
    std::ranges::sort(keys);
    take(keys);
    if (reading_) set = Set(keys.begin(), keys.end());
  }
  void take(std::shared_ptr<const Shape>& shape) {
    auto number = std::uint32_t(0);  // 0: none
    if (!reading_ && shape) {
      const auto known = std::ranges::find(shapes_, shape);
      number = std::uint32_t(known - shapes_.begin()) + 1;
      if (known == shapes_.end()) shapes_.push_back(shape);
    }
    take(number);
    if (number > shapes_.size())
      throw_input_error("state", "shape " + std::to_string(number), "0 … " + std::to_string(shapes_.size()));
    if (reading_) shape = number == 0 ? nullptr : shapes_[number - 1];
  }

  bool reading_ = false;
  std::vector<std::byte> bytes_;
  std::span<const std::byte> left_;
  std::vector<std::shared_ptr<const Shape>> shapes_;
};

}  // namespace lodestone
