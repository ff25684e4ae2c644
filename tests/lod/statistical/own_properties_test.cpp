#include "lod/statistical/own_properties.h"

#include <gtest/gtest.h>

namespace lodestone {
namespace {

TEST(OwnProperties, AreThoseOfTheFewThatHaveSome) {
  OwnProperties own;
  EXPECT_TRUE(own.empty());
  EXPECT_EQ(own.of(7), BodyProperties{});
  BodyProperties damped;
  damped.linear_damping = 0.5;
  own.set(7, damped);
  EXPECT_TRUE(own.has(7));
  EXPECT_EQ(own.of(7), damped);
  EXPECT_FALSE(own.has(8));
  EXPECT_EQ(own.of(8), BodyProperties{});
  own.set(7, {});  // as all others again: nothing is kept
  EXPECT_TRUE(own.empty());
  own.set(3, damped);
  own.forget(3), own.forget(4);
  EXPECT_TRUE(own.empty());
}

// dSpaceCollide's rule: either's category among what the other collides with.
TEST(OwnProperties, BitsLetMeetWhereEitherWouldCollide) {
  const auto bits = [](unsigned category, unsigned collide) {
    BodyProperties properties;
    properties.category = category, properties.collide = collide;
    return properties;
  };
  EXPECT_TRUE(may_meet(bits(1, 2), bits(2, 0)));
  EXPECT_TRUE(may_meet(bits(1, 0), bits(2, 1)));
  EXPECT_FALSE(may_meet(bits(1, 0), bits(2, 0)));
  EXPECT_FALSE(may_meet(bits(1, 4), bits(2, 4)));
  EXPECT_TRUE(may_meet(bits(0, 1), bits(1, 0)));
  EXPECT_TRUE(meets_ground(bits(1, 0)));  // which collides with everything
  EXPECT_FALSE(meets_ground(bits(0, 0)));
  for (unsigned a = 0; a < 16; ++a)
    for (unsigned b = 0; b < 16; ++b)
      EXPECT_EQ(may_meet(bits(a & 3, a >> 2), bits(b & 3, b >> 2)),
                may_meet(bits(b & 3, b >> 2), bits(a & 3, a >> 2)));
}

TEST(OwnProperties, AClipIsPlayedWhereGravityAloneMovesTheBody) {
  EXPECT_TRUE(moves_by_itself({}));
  BodyProperties bits;
  bits.category = 4;
  EXPECT_TRUE(moves_by_itself(bits));
  bits.category = bits.collide = 0;  // the ground lets it through
  EXPECT_FALSE(moves_by_itself(bits));
  for (const BodyProperties& other :
       {BodyProperties{.gravity = false}, BodyProperties{.linear_damping = 0.1},
        BodyProperties{.angular_damping = 0.1}, BodyProperties{.max_angular_speed = 9.0},
        BodyProperties{.kinematic = true}, BodyProperties{.allow_sleep = false}})
    EXPECT_FALSE(moves_by_itself(other));
}

}  // namespace
}  // namespace lodestone
