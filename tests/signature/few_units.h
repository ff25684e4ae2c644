// What a signature of very few trials is measured with: in a twentieth of a second.
#pragma once

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone::testing {

inline SignatureSettings few_trials() {
  SignatureSettings settings;
  settings.n_theta = 2, settings.n_phi = 2, settings.n_alpha = 2, settings.trials_per_cell = 4;
  settings.held_out_conditions = 2, settings.height_samples = 3, settings.height_trials = 10;
  settings.settling_trials = 6, settings.clips = 1;
  return settings;
}

inline Shape measured_box() { return make_shape("box", make_box({0.2, 0.3, 0.4})); }

}  // namespace lodestone::testing
