// Distance between two one-dimensional samples: by how much, on average, values must be moved to turn one
// sample into the other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lodestone {

/// Two samples sorted together once, so that each resample of a bootstrap costs one pass.
class SamplePair {
 public:
  /// Neither may be empty.
  SamplePair(std::span<const double> first, std::span<const double> second);

  /// Wasserstein-1, ∫ |F_first − F_second| dx: exact, for unequal sizes too. `first_counts` and
  /// `second_counts` say how often each value counts, in the order in which the samples were given.
  double wasserstein(std::span<const std::uint32_t> first_counts,
                     std::span<const std::uint32_t> second_counts) const;

 private:
  struct Value {
    double value;
    std::uint32_t index;  // into its sample
    bool in_first;
  };
  std::vector<Value> sorted_;
};

/// Wasserstein-1 of the samples as they are.
double wasserstein_distance(std::span<const double> first, std::span<const double> second);

}  // namespace lodestone
