// Room in the arrays that every body of a heap fills: where they must grow, by a quarter beyond what is
// needed. The standard library would double them.
#pragma once

#include <cstddef>
#include <vector>

namespace lodestone {

template <class T>
void make_room(std::vector<T>& values, std::size_t size) {
  constexpr std::size_t kLeast = 64;
  if (size > values.capacity()) values.reserve(size + size / 4 + kLeast);
}

template <class T>
void resize_in_room(std::vector<T>& values, std::size_t size) {
  make_room(values, size);
  values.resize(size);
}

/// A new element at the end.
template <class T>
T& append_in_room(std::vector<T>& values) {
  make_room(values, values.size() + 1);
  return values.emplace_back();
}

}  // namespace lodestone
