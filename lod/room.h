// Capacity of large vectors: where they must grow, they get a quarter more than is needed, and 64. The
// standard library would double them.
#pragma once

#include <cstddef>
#include <vector>

namespace lodestone {

/// Reserves for `size` elements, and some more if the vector has to grow for it.
template <class T>
void make_room(std::vector<T>& values, std::size_t size) {
  constexpr std::size_t kLeast = 64;
  if (size > values.capacity()) values.reserve(size + size / 4 + kLeast);
}

/// As values.resize(size), with that capacity.
template <class T>
void resize_in_room(std::vector<T>& values, std::size_t size) {
  make_room(values, size);
  values.resize(size);
}

/// A new element at the end, default-made; as values.emplace_back(), with that capacity.
template <class T>
T& append_in_room(std::vector<T>& values) {
  make_room(values, values.size() + 1);
  return values.emplace_back();
}

}  // namespace lodestone
