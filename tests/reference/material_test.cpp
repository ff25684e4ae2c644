#include "reference/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "reference/error.h"
#include "tests/allocations.h"

namespace lodestone {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Materials, APairTakesTheLowerRestitutionAndTheGeometricMeanOfFriction) {
  MaterialTable table;
  const MaterialId rubber = table.add({.restitution = 0.9, .friction = 0.8});
  const MaterialId ice = table.add({.restitution = 0.3, .friction = 0.02});
  EXPECT_EQ(table.law(rubber, ice), (ContactLaw{0.3, std::sqrt(0.8 * 0.02)}));
  EXPECT_EQ(table.law(ice, rubber), table.law(rubber, ice));
  EXPECT_EQ(table.law(rubber, rubber).restitution, 0.9);
  EXPECT_DOUBLE_EQ(table.law(rubber, rubber).friction, 0.8);
}

TEST(Materials, AListedPairIsListedBothWaysAndTheLastWordCounts) {
  MaterialTable table;
  const MaterialId other = table.add({});
  table.set_law(0, other, {.restitution = 1.0, .friction = 0.0});
  EXPECT_EQ(table.law(other, 0), (ContactLaw{1.0, 0.0}));
  table.set_law(other, 0, {.restitution = 0.1, .friction = 2.0});
  EXPECT_EQ(table.law(0, other), (ContactLaw{0.1, 2.0}));
  EXPECT_EQ(table.law(0, 0), (ContactLaw{0.4, 0.5}));
}

// As a game does that turns a knob in each frame.
TEST(Materials, APairThatIsListedAgainTakesNoMoreRoom) {
  MaterialTable table;
  const MaterialId ice = table.add({});
  table.set_law(0, ice, {});
  const std::int64_t before = bytes_held();
  for (int i = 1; i <= 1000; ++i)
    table.set_law(i % 2 ? ice : 0, i % 2 ? 0 : ice, {.restitution = 0.0, .friction = 1e-3 * i});
  EXPECT_EQ(bytes_held(), before);
  EXPECT_EQ(table.law(0, ice).friction, 1.0);
}

TEST(Materials, FrictionAsGreatAsItGetsIsANumberOfAPairToo) {
  const double greatest = std::numeric_limits<double>::max();
  MaterialTable table;
  table.replace(0, {.friction = greatest});
  const MaterialId rough = table.add({.friction = 1e160});
  EXPECT_NEAR(table.law(0, 0).friction / greatest, 1.0, 1e-15);
  EXPECT_NEAR(table.law(rough, rough).friction / 1e160, 1.0, 1e-15);
  EXPECT_TRUE(std::isfinite(table.law(0, rough).friction));
}

TEST(Materials, WhatIsListedStaysWhereOthersComeOrChange) {
  MaterialTable table(ContactLaw{0.7, 0.6});
  const MaterialId other = table.add({.restitution = 0.2});
  table.replace(0, {.restitution = 0.1, .friction = 0.1});
  EXPECT_EQ(table.law(0, 0), (ContactLaw{0.7, 0.6}));
  EXPECT_EQ(table.law(0, other).restitution, 0.1);
  EXPECT_EQ(table[0].friction, 0.1);
}

TEST(Materials, WhatIsOutOfRangeIsRefusedAndChangesNothing) {
  MaterialTable table;
  for (const Material& bad :
       {Material{.restitution = -0.01}, Material{.restitution = 1.01}, Material{.restitution = kNan},
        Material{.friction = -0.01}, Material{.friction = std::numeric_limits<double>::infinity()},
        Material{.density = 0.0}, Material{.density = kNan}}) {
    EXPECT_THROW(table.add(bad), InputError);
    EXPECT_THROW(table.replace(0, bad), InputError);
  }
  EXPECT_THROW(table.set_law(0, 0, {.restitution = 1.5}), InputError);
  EXPECT_THROW(table.set_law(0, 1, {}), InputError);
  EXPECT_THROW(table.set_law(-1, 0, {}), InputError);
  EXPECT_THROW(table.replace(1, {}), InputError);
  EXPECT_EQ(table.size(), 1);
  EXPECT_EQ(table.law(0, 0), (ContactLaw{}));
  EXPECT_FALSE(table.has(1));
  EXPECT_FALSE(table.has(-1));
}

}  // namespace
}  // namespace lodestone
