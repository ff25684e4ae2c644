// The size at which shapes are measured.
#pragma once

#include <memory>

#include "reference/shape.h"

namespace lodestone {

inline constexpr double kMeasurementRadius =
    0.2;  ///< m: a signature is the same for all sizes because it is measured at this one

inline std::shared_ptr<const Shape> make_measurement_shape(const Shape& shape) {
  return std::make_shared<const Shape>(scale_shape(shape, kMeasurementRadius / shape.radius));
}

}  // namespace lodestone
