#include "lod/statistical/step_world.h"

#include <gtest/gtest.h>

#include "reference/random.h"

namespace lodestone {
namespace {

// Up is against gravity, whichever way that points, within 0.8° of it.
TEST(StepWorld, HorizontalIsAcrossGravity) {
  RandomStream random(53, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const Vec3 up = random.direction();
    StepWorld world;
    world.gravity = -random.uniform(0.1, 30.0) * up;
    EXPECT_TRUE(world.is_horizontal({.normal = up}));
    EXPECT_FALSE(world.is_horizontal({.normal = -up}));
    const Vec3 side = up.unitOrthogonal();
    for (const double angle : {0.005, 0.03}) {
      const HalfSpace tilted{.normal = std::cos(angle) * up + std::sin(angle) * side};
      EXPECT_EQ(world.is_horizontal(tilted), angle < 0.0141) << angle;
    }
  }
}

TEST(StepWorld, WithoutGravityNothingIsHorizontal) {
  StepWorld world;
  world.gravity.setZero();
  EXPECT_FALSE(world.is_horizontal({}));
  EXPECT_EQ(world.gravity_strength(), 0.0);
}

TEST(StepWorld, LawsAreOfTheTwoMaterials) {
  MaterialTable materials;
  const MaterialId ice = materials.add({.restitution = 0.1, .friction = 0.02});
  const MaterialId rubber = materials.add({.restitution = 0.9, .friction = 2.0});
  StepWorld world;
  world.materials = &materials;
  BodyKind kind;
  kind.material = rubber;
  const HalfSpace plane{.material = ice};
  EXPECT_EQ(world.law(kind, plane), materials.law(ice, rubber));
  EXPECT_NEAR(world.law(kind, plane).friction, 0.2, 1e-12);
}

TEST(StepWorld, PropertiesAreTheUsualOnesUnlessABodyHasItsOwn) {
  OwnProperties own;
  BodyProperties light;
  light.gravity = false;
  own.set(7, light);
  StepWorld world;
  EXPECT_EQ(world.properties_of(7), BodyProperties{});
  world.properties = &own;
  EXPECT_EQ(world.properties_of(7), light);
  EXPECT_EQ(world.properties_of(8), BodyProperties{});
}

TEST(ContactTally, AddsUp) {
  const ContactTally one{.contacts = 1, .energy_clamps = 2, .table_extrapolations = 3, .states_recovered = 4};
  ContactTally sum = one;
  sum += one;
  EXPECT_EQ(sum.contacts, 2);
  EXPECT_EQ(sum.energy_clamps, 4);
  EXPECT_EQ(sum.table_extrapolations, 6);
  EXPECT_EQ(sum.states_recovered, 8);
}

}  // namespace
}  // namespace lodestone
