// The settings that a signature is measured with, as bytes: every field that is part of its identity.
#pragma once

#include "signature/byte_archive.h"
#include "signature/signature.h"

namespace lodestone {

template <class Archive>
void archive(Archive& a, Archived<SignatureSettings> auto& s) {
  a(s.law.restitution, s.law.friction, s.trial_end, s.paper_grid, s.n_theta, s.n_phi, s.n_alpha, s.n_psi);
  a(s.draw, s.trials_per_cell, s.table_error, s.most_trials_per_cell, s.held_out_conditions);
  a(s.height_samples, s.height_trials, s.settling_trials, s.clips, s.rest_pose_frequency_min, s.seed);
}

}  // namespace lodestone
