// The box that drops are tested with.
#pragma once

#include "tools/methods/method.h"

namespace lodestone::testing {

inline DropJob box_job() {
  static const auto box = std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  return {.shape = box, .conditions = {}, .material = {}};
}

}  // namespace lodestone::testing
