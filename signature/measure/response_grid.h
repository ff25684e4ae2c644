// The grids that settings ask for, their cells still empty.
#pragma once

#include "signature/measure/cell_trials.h"
#include "signature/signature.h"

namespace lodestone {

ResponseTable make_response_grid(const SignatureSettings& settings);

/// The paper's θ 7 × φ 10 × ‖V‖ 26 × ‖Ω‖ 16. It does not say which speeds: here .02 to 10 m/s, and for R‖Ω‖ 0
/// and .02 to 5 m/s, evenly in the logarithm, so on both sides of ODE's bounce_vel (.05 m/s).
SpeedTable make_speed_grid(const SignatureSettings& settings);

/// bounce_vel of the scale-free tables' trials, m/s: far below their speeds.
inline constexpr double kAlwaysBounces = 1e-9;

CellSampling make_cell_sampling(const SignatureSettings& settings);

}  // namespace lodestone
