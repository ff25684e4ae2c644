// How good a table is: from its own trials, and from trials that are not in it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "signature/measure/measurement.h"
#include "signature/signature.h"

namespace lodestone {

enum class TableKind { bouncing, non_bouncing, by_speed };

/// `signature` holds the table already.
TableCertificate certify_table(const TableUnits& units, TableKind kind, const Signature& signature);

/// What of velocities after a collision is compared, over s: normal speed, speed, spin times R. Held-out
/// trials beside draws from the table, as many of each.
struct HeldOutComparison {
  std::array<std::vector<double>, 3> drawn, held_out;
  double error_of_mean = 0.0;  ///< root mean square of a number of the mean looked up, over s
};
HeldOutComparison compare_held_out(std::span<const HeldOutUnit> units, TableKind kind,
                                   const Signature& signature);

/// Greatest distance between the distribution functions of two samples (Kolmogorov–Smirnov), 0 … 1; 0 where
/// one is empty.
double kolmogorov_smirnov(std::vector<double> a, std::vector<double> b);

}  // namespace lodestone
