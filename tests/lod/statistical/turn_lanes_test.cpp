// Bodies that turn side by side, against each by itself.
#include "lod/statistical/turn_lanes.h"

#include <gtest/gtest.h>

#include "lod/statistical/flight.h"
#include "reference/random.h"

namespace lodestone {
namespace {

TEST(TurnLanes, GiveWhatEachBodyHasAloneToTheBitByEveryInstructionSet) {
  Mesh turned = make_box({0.1, 0.2, 0.35});
  for (Vec3& v : turned.vertices) v = rotation_from_vector({0.4, 0.9, -0.3}) * v;
  const BodyKind kinds[] = {
      make_body_kind(std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})))),
      make_body_kind(std::make_shared<const Shape>(make_shape("turned box", turned)))};
  ASSERT_TRUE(kinds[0].along_principal_axes);
  ASSERT_FALSE(kinds[1].along_principal_axes);
  constexpr double kStep = 1.0 / 60;
  for (const Simd simd : {Simd::portable, Simd::avx2, Simd::avx512}) {
    if (simd > find_simd()) continue;
    RandomStream random(7, 0, 0);
    TurnLanes lanes(simd);
    int known = 0, fast = 0;
    for (int round = 0; round < 200; ++round) {
      StatisticalBody bodies[TurnLanes::kBodies];
      const auto kind_of = [&](int i) -> const BodyKind& { return kinds[(i + round) % 2]; };
      for (int i = 0; i < TurnLanes::kBodies; ++i) {
        bodies[i].orientation = random.orientation();
        const double speed = i == 0 ? 0.0 : std::pow(10.0, random.uniform(-4.0, 2.5));  // rad/s
        bodies[i].spin = spin_of(bodies[i].orientation, speed * random.direction(), *kind_of(i).shape);
        lanes.put(i, bodies[i], kind_of(i));
      }
      lanes.turn(kStep, TurnLanes::kBodies);
      for (int i = 0; i < TurnLanes::kBodies; ++i) {
        const auto found = lanes.orientation(i);
        ++(found ? known : fast);
        if (!found) continue;
        advance_flight(bodies[i], kind_of(i), Vec3::Zero(), kStep);
        ASSERT_EQ(found->coeffs(), bodies[i].orientation.coeffs()) << round << ' ' << i;
      }
    }
    EXPECT_GT(known, 4000);
    EXPECT_GT(fast, 100);
  }
}

}  // namespace
}  // namespace lodestone
