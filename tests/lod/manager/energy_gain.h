// By how much a scene's energy rises.
#pragma once

#include <algorithm>
#include <span>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::testing {

/// The greatest rise of the bodies' energy above an earlier frame's within so many frames, over what they
/// have at first.
inline double greatest_gain(Manager& manager, std::span<const BodyId> bodies, int frames) {
  const auto energy_of_all = [&] {
    double sum = 0.0;
    for (const BodyId body : bodies) sum += energy(manager, body);
    return sum;
  };
  const double at_first = energy_of_all();
  double least = at_first, gain = 0.0;
  for (int i = 0; i < frames; ++i) {
    manager.step(kFrame);
    const double now = energy_of_all();
    least = std::min(least, now), gain = std::max(gain, now - least);
  }
  return gain / at_first;
}

}  // namespace lodestone::testing
