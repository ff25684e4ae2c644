// How far a shape's bodies are from the truth on each rung, as single drops under converged ODE have shown
// (tools/compare/rung_errors.h measures it). Kept beside the signature in the cache; where it was not
// measured, what box, L and bunny have on average.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace lodestone {

struct RungError {
  double score = 0.0;  ///< of "What the speed costs" in tools/README.md: 0 is the truth
  double drift = 0.0;  ///< mean distance after 1 s from where the truth has the body, over the shape's size
  friend bool operator==(const RungError&, const RungError&) = default;
};

struct RungErrors {
  /// On average of box, L and bunny at 1/60 s: scores as in its table, drifts by `lodestone compare errors`
  /// (150, 150 and 60 drops: full .106, .254, .552; support .050, .090, .606; tables 1.27, 1.49, 2.55).
  RungError tables{0.318, 1.77}, support{0.062, 0.249}, full{0.074, 0.304};
  std::uint32_t drops = 0;  ///< that they were measured by; 0: the averages
  friend bool operator==(const RungErrors&, const RungErrors&) = default;
};

/// Written at once or not at all, with a version and a checksum. Throws InputError where it cannot be
/// written.
void save_rung_errors(const RungErrors& errors, const std::filesystem::path& file);
/// None where there is no file, or one that is damaged or of another version.
std::optional<RungErrors> load_rung_errors(const std::filesystem::path& file);

}  // namespace lodestone
