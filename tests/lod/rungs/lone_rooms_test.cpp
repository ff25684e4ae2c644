// Rooms of bodies that are far apart (lone_rooms.h) save a search: what happens is the same without them.
#include "lod/rungs/lone_rooms.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/lod/rungs/rung_fixture.h"

namespace lodestone::lone_rooms_test {

using testing::box, testing::box_signature, testing::OneRung;

class Rooms : public ::testing::TestWithParam<StatisticalModel> {};

// Thrown about over a wide floor, some at sleepers. Beside it the same while two far away stay near each
// other: where anybody is near, everybody is looked for. (Spheres have another order then, and with it other
// roundings.)
TEST_P(Rooms, ChangeNothing) {
  Ground ground;
  ground.add_plane({});
  const MaterialTable materials;
  OneRung with(GetParam(), {}, ground, materials), without(GetParam(), {}, ground, materials);
  const auto add = [&](OneRung& level, const RigidState& state, bool asleep) {
    return level.add(std::uint32_t(level.size()), box(), 24.0, 0, state, asleep, box_signature());
  };
  RandomStream random(17, 0, 0);
  constexpr int kBodies = 40;
  for (int i = 0; i < kBodies; ++i) {
    const bool asleep = i % 4 == 0;
    RigidState state;
    state.position = {1.5 * (i % 8), 1.5 * (i / 8), asleep ? 0.2 : 1.0};
    if (!asleep) {
      state.orientation = random.orientation();
      state.velocity = i % 4 == 1 ? Vec3(-4.0, 0.0, 0.0) : random.uniform(0.0, 4.0) * random.direction();
    }
    add(with, state, asleep), add(without, state, asleep);
  }
  RigidState far, beside;
  far.position = {500.0, 0.0, 5.0};
  beside.position = far.position + Vec3(0.25, 0.0, 0.0);
  const int first = add(without, far, false), second = add(without, beside, false);
  const bool to_the_bit = GetParam() == StatisticalModel::support;
  const int steps = to_the_bit ? 400 : 60;
  int struck = 0;
  for (int step = 0; step < steps; ++step) {
    StepReport report;
    without.set_state(first, far), without.set_state(second, beside);
    with.step(1.0 / 60, {}, report), without.step(1.0 / 60, {}, report);
    for (int slot = 0; slot < kBodies; ++slot) {
      const RigidState a = with.state(slot), b = without.state(slot);
      ASSERT_LE((a.position - b.position).norm(), to_the_bit ? 0.0 : 1e-3) << step << ' ' << slot;
      ASSERT_LE((a.velocity - b.velocity).norm(), to_the_bit ? 0.0 : 1e-2) << step << ' ' << slot;
      struck += slot % 4 == 0 && step == steps - 1 && std::abs(a.position.x() - 1.5 * (slot % 8)) > 0.01;
    }
  }
  EXPECT_GT(struck, 0);
}

INSTANTIATE_TEST_SUITE_P(Models, Rooms,
                         ::testing::Values(StatisticalModel::tables, StatisticalModel::support));

}  // namespace lodestone::lone_rooms_test
