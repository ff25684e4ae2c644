// What a user's first program may look like: only the installed package, no ODE of its own.
#include <cmath>
#include <cstdio>

#include "reference/shape.h"

int main() {
  const lodestone::Shape crate = lodestone::make_shape("crate", lodestone::make_box({0.2, 0.3, 0.4}));
  std::printf("volume %.6f m³\n", crate.volume);
  return std::abs(crate.volume - 0.024) < 1e-9 ? 0 : 1;
}
