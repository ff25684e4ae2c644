// The signatures that a scene needs, had before its first step, so that measuring one is not taken for a slow
// step.
#pragma once

#include "scenes/runner.h"
#include "tools/progress.h"

namespace lodestone {

/// Finds (where the cache is used) or measures, shows the measuring on `line`, which outlives it, and
/// remembers.
SignatureFunction make_signature_function(ProgressLine& line, bool use_cache = true);

/// Asks `settings.signatures` for what the bodies of `scene` need that are not full for good.
void fetch_signatures(const Scene& scene, const RunSettings& settings);

}  // namespace lodestone
