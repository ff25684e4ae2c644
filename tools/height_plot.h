// The paper's figure 3: the collision height over ‖ω‖/‖v‖, drawn.
#pragma once

#include <string>

#include "signature/collision_heights.h"

namespace lodestone {

/// For a terminal: '*' the mean, ':' a deviation to both sides, over R‖ω‖/‖v‖ from 0 to infinity (evenly in
/// its arctangent).
std::string text_plot(const CollisionHeights& heights);

/// The same as an SVG document.
std::string svg_plot(const CollisionHeights& heights, const std::string& title);

}  // namespace lodestone
