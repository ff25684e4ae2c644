#include <array>
#include <cmath>

#include "tools/bench/body_cases.h"
#include "tools/bench/contact_cases.h"
#include "tools/bench/engine_cases.h"
#include "tools/bench/ensemble_cases.h"
#include "tools/bench/hard_case.h"
#include "tools/bench/lone_body_cases.h"
#include "tools/bench/pair_cases.h"
#include "tools/bench/response_cases.h"
#include "tools/bench/simbenchmark_cases.h"

namespace lodestone {

bool passes(const HardCaseRow& row) {
  return row.side == BoundSide::at_most ? row.value <= row.bound : row.value >= row.bound;
}

std::span<const HardCase> hard_cases() {
  static constexpr std::array kCases = {
      HardCase{"F1", measure_bouncing},
      HardCase{"F2", measure_ball_cube},
      HardCase{"F3", measure_elastic_ball_cube},
      HardCase{"F4", measure_rolling},
      HardCase{"F5", measure_slopes},
      HardCase{"F6", measure_rebounds},
      HardCase{"F7", measure_stacks},
      HardCase{"F8", measure_piles},
      HardCase{"F9", measure_contact_depths},
      HardCase{"F10", measure_heavy_on_light},
      HardCase{"F11", measure_free_top},
      HardCase{"F12", measure_slender_bodies},
      HardCase{"F13", measure_fast_bodies},
      HardCase{"F14", measure_far_stacks},
      HardCase{"F15", measure_far_coordinates},
      HardCase{"F16", measure_sleeping_pile, true},
      HardCase{"F17", measure_step_lengths},
      HardCase{"F18", measure_head_on},
      HardCase{"F19", measure_concave},
      HardCase{"S1", measure_motionless_hits},
      HardCase{"S2", measure_contact_frames},
      HardCase{"S3", measure_odd_directions},
      HardCase{"S4", measure_beyond_tables},
      HardCase{"S5", measure_random_hits},
      HardCase{"S6", measure_draws},
      HardCase{"S7", measure_first_rebounds},
      HardCase{"S8", measure_fast_hits},
      HardCase{"S9", measure_rest_on_slopes},
      HardCase{"S10", measure_great_pile},
      HardCase{"S11", measure_rest_poses_of_drops},
      HardCase{"S12", measure_long_flight},
      HardCase{"S13", measure_square_heights},
      HardCase{"S14", measure_orders},
      HardCase{"S15", measure_flat_landings},
      HardCase{"S16", measure_frozen_in_air},
  };
  return kCases;
}

}  // namespace lodestone
