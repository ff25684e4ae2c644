// Friction of the footprint against pivoting, at `tables`: it takes energy from a leaning rod, too, whose
// angular momentum and velocity about the normal may have different signs.
#include <gtest/gtest.h>

#include "lod/tables/tables_model.h"
#include "reference/free_rotation.h"
#include "reference/random.h"
#include "tests/lod/rungs/rung_fixture.h"

namespace lodestone {
namespace {

TEST(Pivoting, TakesEnergyFromABodyThatLeans) {
  const auto shape = std::make_shared<const Shape>(make_shape("rod", make_box({0.04, 0.04, 0.6})));
  // Of another shape: none of it is looked up, as nothing bounces or comes to rest here.
  const BodyKind kind = make_body_kind(shape, testing::box_signature());
  const MaterialTable materials;
  const HalfSpace floor{};
  const StepWorld world{.planes = {&floor, 1}, .materials = &materials};
  int opposed = 0;
  for (int i = 0; i < 500; ++i) {
    RandomStream random(7, std::uint64_t(i), 0);
    StatisticalBody body;
    body.sphere_radius = 0.2f;
    body.position.z() = double(body.sphere_radius);
    body.orientation = random.orientation();
    const Vec3 omega = random.uniform(20.0, 60.0) * random.direction();  // rad/s: too fast to come to rest
    body.spin = spin_of(body.orientation, omega, *shape);
    body.velocity = -omega.cross(Vec3(0, 0, -double(body.sphere_radius)));  // it rolls: nothing slips
    opposed += omega.z() * body.spin.z() < 0.0;
    const double before = kinetic_energy(body, *shape);
    RestingRecord resting;
    step_tables_body(body, resting, kind, world, 1.0 / 60.0, {});
    EXPECT_LE(kinetic_energy(body, *shape), before * (1.0 + 1e-9)) << i;
  }
  EXPECT_GT(opposed, 50);
}

}  // namespace
}  // namespace lodestone
