// Measures a signature with ODE as the ground truth (section 3.2).
#pragma once

#include "reference/shape.h"
#include "signature/signature.h"
#include "signature/signature_source.h"

namespace lodestone {

/// The signature of `shape`: collision heights, both response tables, rest poses and settling clips. Every trial is keyed by (seed, cell, trial), so the
/// result is the same for any number of threads (0: all cores).
Signature measure_signature(const Shape& shape, const SignatureSettings& settings, int threads = 0, const Progress& progress = {});

}  // namespace lodestone
