// The job behind table 1 of Hsu and Keyser: n bunnies fall on a plane, laid out so that figures compare
// across engines.
#pragma once

#include "tools/methods/method.h"

namespace lodestone {

inline constexpr double kTable1Step = 1.0 / 60;  // s
inline constexpr int kTable1Steps = 180;
inline constexpr int kTable1FirstTimed = 60;  // before it most bodies are still in the air

/// A bunny of .2 m, restitution .3, friction .5.
DropJob make_table1_job();

/// Where body `index` of `bodies` starts, at rest and turned at random: six layers of square cells, none
/// touching another.
RigidState table1_start(int index, int bodies, std::uint64_t seed);

/// What the paper printed, ms; 0 where it printed nothing.
struct PaperTimes {
  double step_ms = 0.0, collision_ms = 0.0, response_ms = 0.0;
};

/// Of the paper's four columns, by the name of the method that stands for each; all 0 for others.
PaperTimes paper_times(const std::string& method, int bodies);

}  // namespace lodestone
