#include "lod/full/full_level.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

class FullLevelOfBoxes : public ::testing::Test {
 protected:
  OdeBodyId add(std::uint32_t owner, const Vec3& place, bool asleep = false) {
    return level_.add(owner, {.shape = box_, .mass = 8.0, .state = testing::at(place)}, asleep);
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) level_.step(1.0 / 60, counters_);
  }
  const std::shared_ptr<const Shape> box_ = box_shape({0.2, 0.2, 0.2});
  MaterialTable materials_ = material(0.0, 0.5);
  FullLevel level_{FullSettings{}, materials_};
  Counters counters_;
};

TEST_F(FullLevelOfBoxes, ThereIsNoWorldBeforeAFirstBody) {
  level_.add_plane({1, 1}, HalfSpace{});
  run(3);
  EXPECT_EQ(level_.world(), nullptr);
  EXPECT_EQ(counters_.ode_bodies_created, 0);
  add(7, {0, 0, 1});
  ASSERT_NE(level_.world(), nullptr);
  run(1);
  EXPECT_EQ(counters_.ode_bodies_created, 1);
}

// Ground that came before the world, and was moved or removed before it, is as it was left.
TEST_F(FullLevelOfBoxes, GroundIsLaidAsItWasLeft) {
  level_.add_static_box({1, 1}, {2, 2, 0.2}, {0, 0, 0.9}, Quat::Identity(), 0);
  level_.add_static_box({2, 1}, {2, 2, 0.2}, {0, 0, 2.9}, Quat::Identity(), 0);
  level_.add_plane({3, 1}, HalfSpace{});
  level_.move_ground({1, 1}, testing::at({0, 0, 0.4}));
  level_.remove_ground({2, 1});
  const OdeBodyId body = add(0, {0, 0, 3});
  run(120);
  EXPECT_NEAR(level_.world()->state(body).position.z(), 0.6, 2e-3);
  level_.remove_ground({1, 1});
  run(60);
  EXPECT_NEAR(level_.world()->state(body).position.z(), 0.1, 2e-3);
}

// Of many pieces, of which some went and others came in their places, each moves by its own id.
TEST_F(FullLevelOfBoxes, GroundIsKnownByItsIdsAsItComesAndGoes) {
  const OdeBodyId body = add(0, {5, 0, 0.4});
  const auto add_table = [&](std::uint32_t i, std::uint32_t generation) {
    level_.add_static_box({i, generation}, {1, 1, 0.2}, {1.0 * i, 0, 0.1}, Quat::Identity(), 0);
  };
  for (std::uint32_t i = 0; i < 10; ++i) add_table(i, 1);
  for (const std::uint32_t i : {3u, 0u, 5u, 9u}) level_.remove_ground({i, 1});
  for (const std::uint32_t i : {5u, 0u}) add_table(i, 2);
  level_.move_ground({5, 2}, testing::at({5, 0, 0.2}));
  run(60);
  EXPECT_NEAR(level_.world()->state(body).position.z(), 0.4, 2e-3);
  level_.remove_ground({5, 2});
  level_.move_ground({4, 1}, testing::at({5, 0, -0.1}));
  run(60);
  EXPECT_NEAR(level_.world()->state(body).position.z(), 0.1, 2e-3);
}

// As bodies come and go members are those that are there, each where index_of says.
TEST_F(FullLevelOfBoxes, MembersAreThoseThatAreThere) {
  RandomStream random(2, 0, 0);
  std::vector<std::pair<std::uint32_t, OdeBodyId>> there;
  std::vector<OdeBodyId> gone;
  for (std::uint32_t i = 0; i < 120; ++i) {
    if (random.uniform() < 0.6 || there.empty()) {
      there.emplace_back(100 + i, add(100 + i, {1.0 * i, 0, 5}));
    } else {
      const auto which = std::size_t(random.uniform(0, double(there.size())));
      level_.remove(there[which].second);
      gone.push_back(there[which].second);
      there.erase(there.begin() + std::ptrdiff_t(which));
    }
    ASSERT_EQ(level_.members().size(), there.size());
    for (const auto& [owner, id] : there) {
      const std::int32_t index = level_.index_of(id);
      ASSERT_GE(index, 0);
      EXPECT_EQ(level_.members()[std::size_t(index)].owner, owner);
      EXPECT_EQ(level_.members()[std::size_t(index)].id, id);
    }
    for (const OdeBodyId id : gone) EXPECT_EQ(level_.index_of(id), -1);
  }
}

TEST_F(FullLevelOfBoxes, SleepersAreCounted) {
  add(0, {0, 0, 5}, true), add(1, {1, 0, 5}, true);
  const OdeBodyId awake = add(2, {2, 0, 5});
  EXPECT_EQ(level_.asleep_count(), 2);
  run(5);
  EXPECT_EQ(level_.asleep_count(), 2);
  EXPECT_LT(level_.world()->state(awake).position.z(), 5.0);
}

TEST_F(FullLevelOfBoxes, TouchingIsNotedOfBodiesThatDo) {
  level_.add_plane({1, 1}, HalfSpace{});
  const OdeBodyId low = add(0, {0, 0, 0.1}), high = add(1, {0, 0, 0.299}), alone = add(2, {3, 0, 0.1});
  run(2);
  level_.note_touching();
  EXPECT_TRUE(level_.touches(low) && level_.touches(high));
  EXPECT_FALSE(level_.touches(alone));  // the ground is no body
  level_.note_touching(std::size_t(level_.index_of(alone)));
  EXPECT_TRUE(level_.touches(alone));
}

// One that stays where it is, on another rung, leaves what lay on it asleep.
TEST_F(FullLevelOfBoxes, RemovalWakesWhatTouchedItUnlessItStays) {
  level_.add_plane({1, 1}, HalfSpace{});
  for (const bool stays : {true, false}) {
    const double x = stays ? 0.0 : 5.0;
    const OdeBodyId low = add(0, {x, 0, 0.1}), high = add(1, {x, 0, 0.3});
    run(120);
    ASSERT_TRUE(level_.world()->asleep(high));
    level_.remove(low, stays);
    EXPECT_EQ(level_.world()->asleep(high), stays);
  }
}

TEST_F(FullLevelOfBoxes, GravityIsThatOfTheNextStep) {
  const OdeBodyId body = add(0, {0, 0, 5});
  level_.set_gravity({3, 0, 0});
  run(60);
  EXPECT_NEAR(level_.world()->state(body).velocity.x(), 3.0, 1e-6);
  EXPECT_NEAR(level_.world()->state(body).velocity.z(), 0.0, 1e-9);
}

// More substeps while something thin is near something else.
TEST_F(FullLevelOfBoxes, ThinBodiesAmongOthersTakeMoreSubsteps) {
  const auto plate = box_shape({0.4, 0.4, 0.004});
  double fall[2];
  for (const bool near : {false, true}) {
    FullLevel level(FullSettings{.substeps = 1}, materials_);
    const OdeBodyId thin =
        level.add(0, {.shape = plate, .mass = 1.0, .state = testing::at({0, 0, 5})}, false);
    level.add(1, {.shape = plate, .mass = 1.0, .state = testing::at({near ? 0.05 : 9.0, 0, 5.02})}, false);
    level.step(1.0 / 60, counters_);
    fall[near] = 5.0 - level.world()->state(thin).position.z();
  }
  // Semi-implicit Euler falls g h² n (n + 1) / 2: with n substeps (1 + 1/n) times half of g t².
  EXPECT_NEAR(fall[0], kGravity / 3600, 1e-9);
  EXPECT_NEAR(fall[1], 0.5 * kGravity / 3600 * (1 + 1.0 / 16), 1e-9);
}

// A snapshot goes on alike, to the bit.
TEST_F(FullLevelOfBoxes, AnArchiveGoesOnAlike) {
  level_.add_plane({1, 1}, HalfSpace{});
  FullLevel other(FullSettings{}, materials_);
  other.add_plane({1, 1}, HalfSpace{});
  std::vector<OdeBodyId> bodies;
  for (std::uint32_t i = 0; i < 5; ++i) bodies.push_back(add(i, {0.07 * i, 0, 0.2 + 0.22 * i}));
  run(20);
  StateArchive out;
  level_.archive(out);
  StateArchive in(out.bytes(), out.shapes());
  other.archive(in);
  ASSERT_EQ(other.members().size(), 5U);
  for (int i = 0; i < 40; ++i) level_.step(1.0 / 60, counters_), other.step(1.0 / 60, counters_);
  for (const OdeBodyId body : bodies)
    EXPECT_TRUE(same_bits(level_.world()->state(body), other.world()->state(body)));
}

}  // namespace
}  // namespace lodestone
