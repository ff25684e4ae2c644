// What is measured of a shape: a copy of one size, the same to the bit whatever the size of the shape that
// asked.
#pragma once

#include <memory>

#include "reference/shape.h"

namespace lodestone {

/// m: a signature is the same for all sizes because it is measured at this one.
inline constexpr double kMeasurementRadius = 0.2;

inline std::shared_ptr<const Shape> make_measurement_shape(const Shape& shape) {
  return std::make_shared<const Shape>(make_hashed_copy(shape, kMeasurementRadius));
}

}  // namespace lodestone
