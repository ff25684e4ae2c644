// The pairs of near balls as ODE's own broad phases find them: what the statistical level's cells are
// compared with.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

enum class OdeSpaceKind { hash, sweep_and_prune };

/// Spheres in a space of ODE's, with nothing else.
class OdeSpacePairs {
 public:
  /// A sphere for each radius, m.
  OdeSpacePairs(OdeSpaceKind kind, std::span<const float> radii);
  ~OdeSpacePairs();
  OdeSpacePairs(const OdeSpacePairs&) = delete;
  OdeSpacePairs& operator=(const OdeSpacePairs&) = delete;

  /// One position a sphere, m.
  void place(std::span<const double> x, std::span<const double> y, std::span<const double> z);
  /// Adds the pairs whose spheres meet, each once: those that ODE hands to its callback and that overlap
  /// indeed.
  void find(std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
