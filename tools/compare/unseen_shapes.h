// Shapes on which nothing in Lodestone was tuned, made by code: what its error is on a shape that a user
// brings.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "reference/shape.h"

namespace lodestone {

/// A letter, a chair, a gear ...: closed meshes.
struct UnseenShape {
  std::string_view name;
  Mesh (*mesh)();  ///< of any size
};

std::span<const UnseenShape> unseen_shapes();

/// Its longest side .3 m. `name` is one of unseen_shapes().
std::shared_ptr<const Shape> make_unseen_shape(std::string_view name);

}  // namespace lodestone
