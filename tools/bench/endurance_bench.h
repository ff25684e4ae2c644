// A small world for as many steps as anyone can wait for: whether its memory stays, its energy is bounded and
// its steps keep their pace.
#pragma once

#include <cstdint>
#include <optional>

#include "scenes/scene.h"
#include "signature/signature_source.h"

namespace lodestone {

struct EnduranceSettings {
  std::int64_t steps = 1'000'000;   ///< of 1/60 s, at least 2 · kEnduranceRound
  std::optional<Scene> scene = {};  ///< else crates
  int bodies = 12;                  ///< crates
  int threads = 1;
  std::uint64_t seed = 1;
  Progress progress = {};
};

/// Steps after which all bodies are put back in the air, each turned and moving in another way.
inline constexpr int kEnduranceRound = 600;

/// Steps of a scene after which its viewpoint has gone round once.
inline constexpr int kEnduranceCircle = 1200;

/// Crates fall on a plane while a viewpoint circles them once in 7 s, so that they go up and down the rungs.
/// Memory is read at the end of each round; the first tenth of the rounds is for arrays to grow in. A scene
/// goes on from round to round as it is, a viewpoint circling where its first one looks, and its energy is
/// over that at its start.
struct EnduranceFigures {
  std::int64_t steps = 0;
  std::int64_t changes = 0;  ///< of rung
  std::int64_t states_recovered = 0;
  double heap_growth_bytes = 0;      ///< greatest after the first tenth, over that at its end
  double resident_growth_bytes = 0;  ///< the same of what the process holds
  /// Greatest of any step over that at its round's start, kinetic and potential; 1: never above.
  double energy_over_start = 0;
  /// Processor time of a step: medians over the rounds of the second and of the last tenth.
  double first_step_us = 0, last_step_us = 0;
  bool finite = true;
};

/// Bounds of the figures.
inline constexpr double kEnduranceMemory = 1 << 20;  ///< bytes
/// Over the start's: the support map's and the substeps' errors.
inline constexpr double kEnduranceEnergy = 1.01;
/// Last over first step: a machine's clock and neighbours change by less.
inline constexpr double kEnduranceSlower = 1.5;

bool endures(const EnduranceFigures& figures);

/// Where it is interrupted the figures so far.
EnduranceFigures bench_endurance(const EnduranceSettings& settings);

}  // namespace lodestone
