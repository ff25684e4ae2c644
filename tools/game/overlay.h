// What is written over the picture: the budget as a bar and a curve, figures, and the keys.
#pragma once

#include <lodestone/lodestone.h>

#include <array>
#include <string>
#include <vector>

namespace game {

/// By Rung.
inline constexpr std::array<lodestone::DebugColor, lodestone::kRungs> kRungColors{
    {{0.10f, 0.62f, 0.42f}, {0.35f, 0.70f, 0.90f}, {0.95f, 0.60f, 0.05f}}};

struct OverlayState {
  const lodestone::StepReport& report;
  std::string policy;
  double budget_ms = 0.0;  ///< 0: the policy has none
  double spent_ms = 0.0;   ///< of this frame
  const std::vector<double>& history_ms;
  bool paused = false;
};

/// Over a picture of so many pixels; leaves OpenGL's matrices as they were.
void draw_overlay(const OverlayState& state, int width, int height);

}  // namespace game
