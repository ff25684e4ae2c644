// How far a shape's bodies are from the truth on each rung, as single drops beside converged ODE have shown
// (tools/compare/rung_errors.h measures it). The errors are kept beside the signature in the cache; for a
// shape without measured ones the averages of box, L and bunny are used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace lodestone {

/// The errors of one rung, ≥ 0.
struct RungError {
  double score = 0.0;  ///< as in "What the speed costs" in tools/README.md; 0 is the truth itself
  double drift = 0.0;  ///< mean distance after 1 s from where the truth has the body, over the shape's size
  friend bool operator==(const RungError&, const RungError&) = default;
};

/// The errors of all rungs for one shape.
struct RungErrors {
  /// Averages of box, L and bunny, by `lodestone compare errors SHAPE` (600, 600 and 300 drops; their drifts:
  /// tables .055, .090, .535; support .040, .074, .530; full .094, .227, .540).
  RungError tables{0.066, 0.227}, support{0.064, 0.215}, full{0.072, 0.287};
  std::uint32_t drops = 0;  ///< from which they were measured; 0: these are the averages
  friend bool operator==(const RungErrors&, const RungErrors&) = default;
};

/// How far a body that touches others is out of place in addition, over its size, because they overlap: the
/// average of the greatest overlaps of poured boxes and L-shapes, by `lodestone compare pile SHAPE --bodies
/// 100
/// --side 1.6 --seeds 2 --methods full,statistical` (tables .225, .217; support .011, .017; full .113, .137).
struct RungOverlaps {
  double tables = 0.22, support = 0.015, full = 0.125;
};

/// Writes the file whole or not at all, with a version and a checksum. Throws InputError if it cannot be
/// written.
void save_rung_errors(const RungErrors& errors, const std::filesystem::path& file);
/// None if there is no file, or one that is damaged or of another version.
std::optional<RungErrors> load_rung_errors(const std::filesystem::path& file);

}  // namespace lodestone
