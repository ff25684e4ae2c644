// The paper's figure 3: the height of the middle of a square of side 1 when it first touches the line that it
// falls on, the faster it spins the higher.
#pragma once

namespace lodestone {

/// Exact mean over all phases, in sides. `ratio`: ‖ω‖/‖v‖ in radians a side, ≥ 0.
///
/// Let φ be the angle from a corner straight down, −π/4 to π/4: the middle is at h = √½ cos φ when the corner
/// touches. What falls at v and turns at ω keeps u = φ + (ω/v) z, and u is uniform; it touches at the first φ
/// at which φ + (ω/v) h(φ) reaches its u. Up to ω/v = 2 that sum rises with φ, every φ is met, and the mean
/// is 2/π as without spin. Beyond, it rises only up to φ₂ = asin(√2 v/ω), and again where it exceeds that a
/// quarter of a turn later, from φ₁ on: the mean is (2/π) ∫ h (1 + (ω/v) h′) dφ from φ₁ to φ₂.
double mean_square_height(double ratio);

/// The same by Lodestone's own search for the first contact: a prism of square section that turns about its
/// level axis, mean of `trials`.
double measure_square_height(double ratio, int trials);

}  // namespace lodestone
