// A crate of .3 m, where to put it, and how long a frame is.
#pragma once

#include <memory>

#include "lod/manager.h"

inline constexpr double kFrame = 1.0 / 60.0;  // s
inline const auto crate = std::make_shared<const lodestone::Shape>(
    lodestone::make_shape("crate", lodestone::make_box({0.3, 0.3, 0.3})));
inline lodestone::RigidState at(double x, double z) { return {.position = {x, 0, z}}; }
