// A plank over two blocks of the ground, with nothing below its middle.
#include <gtest/gtest.h>

#include "tests/lod/manager/manager_fixture.h"

namespace lodestone::bridge_test {
namespace {

using namespace testing;

constexpr double kTop = 1.0, kThick = 0.05, kSide = 0.3;  // m

double height_after_a_crate(LevelChoice level, double drop, double where) {
  Manager manager = on_floor({.signatures = coarse_signature});
  for (const double side : {-1.2, 1.2})
    manager.add_static_box({0.3, 1, kTop}, {side, 0, 0.5 * kTop}, Quat::Identity());
  const BodyId plank = add(manager, box_shape({3, 0.4, kThick}), at({0, 0, kTop + 0.5 * kThick}), level);
  run(manager, 1.0);
  add(manager, box_shape({kSide, kSide, kSide}), at({where, 0, kTop + kThick + 0.5 * kSide + drop}), level);
  run(manager, 5.0);
  return manager.state(plank).position.z();
}

// At `tables` it fell between them, and out aside by a third of a metre in a frame.
TEST(Bridge, HoldsACrateThatIsLetFallOnIt) {
  for (const LevelChoice level : {LevelChoice::support, LevelChoice::tables})
    for (const double drop : {0.02, 0.2})
      for (const double where : {0.0, -0.6})
        EXPECT_NEAR(height_after_a_crate(level, drop, where), kTop + 0.5 * kThick, 0.01)
            << int(level) << ", " << drop << " m, at " << where;
}

}  // namespace
}  // namespace lodestone::bridge_test
