// Rest poses as classes: which way up a body lies, whatever its heading.
#pragma once

#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

inline constexpr double kRestClassAngle = 12.0 * std::numbers::pi / 180.0;  ///< rad

/// Directions of "up" in body axes, one for each class, the most populous first.
using RestClasses = std::vector<Vec3>;

/// Classes such that each of `ups` (unit vectors) lies within kRestClassAngle of a class: again and again the
/// direction that has the most others near it becomes a class and takes these. Independent of the order of
/// `ups` but for ties.
RestClasses make_rest_classes(std::span<const Vec3> ups);

/// The class nearest to `up`; none where each is farther than kRestClassAngle.
std::optional<int> find_rest_class(const RestClasses& classes, const Vec3& up);

}  // namespace lodestone
