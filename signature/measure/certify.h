// How good a table is: from its own trials, and from trials that are not in it.
#pragma once

#include <span>
#include <vector>

#include "signature/measure/measurement.h"
#include "signature/signature.h"

namespace lodestone {

enum class TableKind { bouncing, non_bouncing, by_speed };

/// `signature` holds the table already.
TableCertificate certify_table(const TableUnits& units, TableKind kind, const Signature& signature);

/// Greatest distance between the distribution functions of two samples (Kolmogorov–Smirnov), 0 … 1; 0 where one is empty.
double kolmogorov_smirnov(std::vector<double> a, std::vector<double> b);

}  // namespace lodestone
