// Measures a signature with ODE as the ground truth (section 3.2).
#pragma once

#include <stop_token>

#include "reference/shape.h"
#include "signature/measure/measurement.h"
#include "signature/signature.h"
#include "signature/signature_source.h"

namespace lodestone {

/// Throws InputError for an impossible law and for numbers by which nothing can be measured.
void check_settings(const SignatureSettings& settings);

/// The signature of `shape`: collision heights, response tables, rest poses and settling clips. Every trial
/// is keyed by (seed, cell, trial), so the result is the same for any number of threads (0: all cores).
Signature measure_signature(const Shape& shape, const SignatureSettings& settings, int threads = 0,
                            const Progress& progress = {});

class MeasurementJournal;

struct MeasureOptions {
  int threads = 0;  ///< 0: all cores
  Progress progress = {};
  std::stop_token stop = {};              ///< once stopped, the units that are left stay empty
  MeasurementJournal* journal = nullptr;  ///< units in it are taken from there; those measured are noted
};

/// The trials of `share`, raw.
Measurement measure_units(const Shape& shape, const SignatureSettings& settings, const Share& share,
                          const MeasureOptions& options = {});

/// The signature that all the units give. A pure function; `measuring_seconds` is left 0.
Signature make_signature(const Shape& shape, const SignatureSettings& settings,
                         const Measurement& measurement);

}  // namespace lodestone
