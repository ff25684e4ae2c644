// Values as little-endian bytes, one after the other, and back. A struct takes part by `archive(a, value)`,
// which names its fields once for both ways.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "reference/geometry.h"

static_assert(std::endian::native == std::endian::little,
              "files are little-endian: add byte swapping for other machines");

namespace lodestone {

/// `T` is `Value` or const `Value`: one `archive` serves writing and reading.
template <class T, class Value>
concept Archived = std::is_same_v<std::remove_const_t<T>, Value>;

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class ByteWriter {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  std::vector<std::byte> bytes;

 private:
  void put_bytes(const void* from, std::size_t count) {
    const auto* first = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), first, first + count);
  }
  template <Plain T>
  void put(const T& value) {
    put_bytes(&value, sizeof(T));
  }
  template <class Scalar, int Rows, int Columns>
  void put(const Eigen::Matrix<Scalar, Rows, Columns>& m) {
    put_bytes(m.data(), sizeof(Scalar) * Rows * Columns);
  }
  void put(const Quat& q) { (*this)(q.w(), q.x(), q.y(), q.z()); }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& values) {
    for (const T& value : values) put(value);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  void put(const std::string& text) {
    put(std::uint64_t(text.size()));
    put_bytes(text.data(), text.size());
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(std::uint64_t(values.size()));
    for (const T& value : values) put(value);
  }
  template <class T>
  requires std::is_class_v<T>
  void put(const T& value) { archive(*this, value); }
};

/// Reads what a ByteWriter wrote. Past the end, or where a list is longer than the bytes left, it gives zeros
/// and nothing is allocated; `whole()` tells.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  /// Whether there was a byte for everything asked for, and none is left.
  bool whole() const { return !short_ && bytes_.empty(); }
  /// Whether there was a byte for everything asked for so far.
  bool good() const { return !short_; }
  std::size_t left() const { return bytes_.size(); }

 private:
  void get_bytes(void* to, std::size_t count) {
    short_ = short_ || count > bytes_.size();
    if (short_) return;
    std::memcpy(to, bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
  }
  template <Plain T>
  void get(T& value) {
    value = T{};
    get_bytes(&value, sizeof(T));
  }
  void get(bool& value) {
    std::uint8_t byte = 0;
    get(byte);
    short_ = short_ || byte > 1;
    value = byte == 1;
  }
  template <class Scalar, int Rows, int Columns>
  void get(Eigen::Matrix<Scalar, Rows, Columns>& m) {
    m.setZero();
    get_bytes(m.data(), sizeof(Scalar) * Rows * Columns);
  }
  void get(Quat& q) {
    double w = 1, x = 0, y = 0, z = 0;
    (*this)(w, x, y, z);
    q = Quat(w, x, y, z);
  }
  template <class T, std::size_t N>
  void get(std::array<T, N>& values) {
    for (T& value : values) get(value);
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool there = false;
    get(there);
    value.reset();
    if (there) get(value.emplace());
  }
  // No value takes less than a byte, so a longer list is damage.
  std::size_t get_count() {
    std::uint64_t count = 0;
    get(count);
    short_ = short_ || count > bytes_.size();
    return short_ ? 0 : std::size_t(count);
  }
  void get(std::string& text) {
    text.resize(get_count());
    get_bytes(text.data(), text.size());
  }
  template <class T>
  void get(std::vector<T>& values) {
    values.clear();
    for (std::size_t left = get_count(); left > 0 && !short_; --left) get(values.emplace_back());
  }
  template <class T>
  requires std::is_class_v<T>
  void get(T& value) { archive(*this, value); }

  std::span<const std::byte> bytes_;
  bool short_ = false;
};

}  // namespace lodestone
