#include "lod/statistical/blow_reach.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace lodestone::blow_reach_test {
namespace {

constexpr double kWakeSpeed = 0.1;  // m/s

/// Balls of a kilogram in a row along x that touch; the first comes at the second.
struct Row {
  BlowReach reach;

  explicit Row(int balls, double closing, double first_mass = 1.0) {
    for (int i = 0; i < balls; ++i) {
      reach.add_body({.mass = i == 0 ? first_mass : 1.0, .wake_speed = kWakeSpeed, .asleep = i + 1 == balls});
      if (i > 0) reach.add_contact(i, i - 1, Vec3::UnitX(), i == 1 ? closing : 0.0, 0.0);
    }
  }
  bool reaches_the_last() { return !reach.find().empty(); }
};

TEST(BlowReach, GoesThroughWhoIsAwakeToWhoSleeps) {
  Row row(4, 3.0);
  const std::span<const std::int32_t> found = row.reach.find();
  EXPECT_EQ(std::vector(found.begin(), found.end()), std::vector<std::int32_t>{3});
}

// All of them together have the momentum of the first: with n of them, its speed over n.
TEST(BlowReach, EndsWhereTheyAllWouldBeTooSlow) {
  EXPECT_TRUE(Row(9, 0.95).reaches_the_last());    // .95 / 9 = .106 m/s
  EXPECT_FALSE(Row(10, 0.95).reaches_the_last());  // .095
  EXPECT_TRUE(Row(60, 0.11, std::numeric_limits<double>::infinity()).reaches_the_last());
  EXPECT_FALSE(Row(2, 0.05, std::numeric_limits<double>::infinity()).reaches_the_last());
}

TEST(BlowReach, IsSharedByThoseThatOneStrikes) {
  for (const auto& [beside, reached] : {std::pair{1, true}, {6, false}}) {
    BlowReach reach;
    reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed});
    reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed});
    reach.add_contact(1, 0, Vec3::UnitX(), 0.4, 0.0);
    for (int i = 0; i < beside; ++i)
      reach.add_contact(reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed, .asleep = true}), 1,
                        Vec3::UnitX(), 0.0, 0.0);
    EXPECT_EQ(!reach.find().empty(), reached) << beside;
  }
}

TEST(BlowReach, GoesNeitherSidewaysNorBackNorThroughTheGround) {
  for (const Vec3& normal : {Vec3(Vec3::UnitY()), Vec3(-Vec3::UnitX())}) {
    BlowReach reach;
    reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed});
    reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed});
    reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed, .asleep = true});
    reach.add_contact(1, 0, Vec3::UnitX(), 3.0, 0.0);
    reach.add_contact(2, 1, normal, 0.0, 0.0);
    EXPECT_TRUE(reach.find().empty()) << normal.transpose();
  }
  BlowReach reach;
  reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed});
  reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed, .ground = Vec3::UnitZ()});
  reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed, .asleep = true});
  reach.add_contact(1, 0, -Vec3::UnitZ(), 3.0, 0.0);
  reach.add_contact(2, 1, Vec3(0.6, 0.0, -0.8), 0.0, 0.0);
  EXPECT_TRUE(reach.find().empty());
}

TEST(BlowReach, SleepersStrikeNobody) {
  BlowReach reach;
  reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed});
  reach.add_body({.mass = 1e6, .wake_speed = kWakeSpeed, .asleep = true});
  reach.add_body({.mass = 1.0, .wake_speed = kWakeSpeed, .asleep = true});
  reach.add_contact(1, 0, Vec3::UnitX(), 3.0, 0.0);  // too heavy to be moved
  reach.add_contact(0, 2, Vec3::UnitX(), 0.0, 0.0);  // behind who strikes
  EXPECT_TRUE(reach.find().empty());
}

}  // namespace
}  // namespace lodestone::blow_reach_test
