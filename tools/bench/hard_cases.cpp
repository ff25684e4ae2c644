#include <array>
#include <cmath>

#include "tools/bench/body_cases.h"
#include "tools/bench/contact_cases.h"
#include "tools/bench/engine_cases.h"
#include "tools/bench/hard_case.h"
#include "tools/bench/pair_cases.h"
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
  };
  return kCases;
}

}  // namespace lodestone
