#include "lod/support/support_level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "lod/ground/ground.h"
#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

constexpr double kSupportStep = 1.0 / 60;

struct OneSupportLevel {
  explicit OneSupportLevel(const Vec3& gravity = Vec3::Zero()) : settings{.gravity = gravity} {}
  int add(std::uint32_t owner, const RigidState& state, bool asleep = false, double mass = 2.0) {
    return level.add(owner, kinds.take(StatisticalModel::support, box, 0, nullptr), mass, state, asleep,
                     false);
  }
  void step(double dt = kSupportStep) {
    level.begin_step(dt, tally);
    level.end_search();
    const std::vector<std::int32_t> awake(level.awake().begin(), level.awake().end());
    for (const std::int32_t slot : awake) {
      ContactTally own;
      level.move_alone(slot, {}, dt, own);
      tally += own;
    }
    level.end_step();
  }
  const std::shared_ptr<const Shape> box = testing::box_shape({0.2, 0.3, 0.4});
  MaterialTable materials;
  Ground ground;
  Kinds kinds;
  Sleepers sleepers;
  StatisticalSettings settings;
  ContactTally tally;
  SupportLevel level{settings, ground, materials, kinds, sleepers};
};

// Random calls and steps against a plain list of where each body is and whether it sleeps.
TEST(SupportLevel, IsAsAPlainListOfBodies) {
  struct Known {
    Vec3 at, velocity;
    bool asleep;
  };
  OneSupportLevel s;
  std::vector<std::uint32_t> owner_of;  // by slot
  std::map<std::uint32_t, Known> known;
  RandomStream random(7, 0, 0);
  std::uint32_t next = 100;
  const auto slot_of = [&](std::uint32_t owner) {
    return int(std::ranges::find(owner_of, owner) - owner_of.begin());
  };
  for (int i = 0; i < 600; ++i) {
    const double what = random.uniform();
    if (what < 0.25 || known.empty()) {
      const Known one{10.0 * random.direction(), random.direction() + Vec3(2, 0, 0), random.uniform() < 0.3};
      const int slot = s.add(next, testing::at(one.at, one.velocity), one.asleep);
      ASSERT_EQ(slot, int(owner_of.size()));
      owner_of.push_back(next);
      known[next++] = one.asleep ? Known{one.at, Vec3::Zero(), true} : one;
      continue;
    }
    auto which = known.begin();
    std::advance(which, int(random.uniform(0, double(known.size()))));
    auto& [owner, body] = *which;
    const int slot = slot_of(owner);
    if (what < 0.4) {
      const auto moved = s.level.remove(slot);
      ASSERT_EQ(moved.has_value(), slot + 1 != int(owner_of.size()));
      if (moved) {
        EXPECT_EQ(*moved, owner_of.back());
      }
      owner_of[std::size_t(slot)] = owner_of.back();
      owner_of.pop_back();
      known.erase(which);
    } else if (what < 0.5) {
      s.level.put_to_sleep(slot), body.asleep = true, body.velocity.setZero();
    } else if (what < 0.6) {
      s.level.wake(slot), body.asleep = false;
    } else if (what < 0.7) {
      body = {10.0 * random.direction(), random.direction() + Vec3(2, 0, 0), false};
      s.level.set_state(slot, testing::at(body.at, body.velocity));
    } else if (what < 0.8) {
      const Vec3 force = 30.0 * random.direction();
      s.level.add_force(slot, force, Vec3::Zero());
      body.asleep = false, body.velocity += force * kSupportStep / 2.0;
      body.at -= 0.5 * kSupportStep * kSupportStep * force / 2.0;  // it acts through the whole step
      s.step();
      for (auto& [other, b] : known) b.at += kSupportStep * b.velocity;
    } else {
      s.step();
      for (auto& [other, b] : known) b.at += kSupportStep * b.velocity;
    }
    ASSERT_EQ(s.level.size(), int(known.size()));
    int asleep = 0;
    for (int k = 0; k < s.level.size(); ++k) {
      const Known& expected = known.at(owner_of[std::size_t(k)]);
      EXPECT_EQ(s.level.body(k).owner, owner_of[std::size_t(k)]);
      EXPECT_LT((s.level.state(k).position - expected.at).norm(), 1e-9);
      EXPECT_LT((s.level.state(k).velocity - expected.velocity).norm(), 1e-9);
      EXPECT_EQ(s.level.asleep(k), expected.asleep);
      EXPECT_EQ(s.level.is_among_awake(k), !expected.asleep);
      asleep += expected.asleep;
    }
    EXPECT_EQ(s.level.asleep_count(), asleep);
    EXPECT_EQ(s.sleepers.of(StatisticalModel::support).empty(), asleep == 0);
    std::set<std::int32_t> awake(s.level.awake().begin(), s.level.awake().end());
    EXPECT_EQ(awake.size(), s.level.awake().size());
    EXPECT_EQ(int(awake.size()) + asleep, s.level.size());
  }
}

// A state that was given is read back to the bit until the next step, and its turn with it.
TEST(SupportLevel, AStateIsReadBackToTheBit) {
  OneSupportLevel s;
  RandomStream random(8, 0, 0);
  for (int i = 0; i < 20; ++i) {
    const RigidState state =
        testing::at(random.direction(), random.direction(), 9.0 * random.direction(), random.orientation());
    const int slot = s.add(std::uint32_t(i), state);
    EXPECT_TRUE(testing::same_bits(s.level.state(slot), state));
  }
  s.step();
  const RigidState other = testing::at({1, 2, 3}, {4, 5, 6}, {7, 8, 9});
  s.level.set_state(3, other);
  EXPECT_TRUE(testing::same_bits(s.level.state(3), other));
  s.level.remove(1);  // the last takes its place
  EXPECT_TRUE(testing::same_bits(s.level.state(3), other));
}

// Laid to sleep between the two, and given one again.
TEST(SupportLevel, AStateOfWhoWasLaidToSleepIsReadBackToo) {
  OneSupportLevel s;
  const RigidState state = testing::at({1, 2, 3}, {4, 5, 6}, {7, 8, 9});
  for (int i = 0; i < 200; ++i) {
    const int slot = i == 0 ? s.add(0, state) : 0;
    s.level.put_to_sleep(slot);
    EXPECT_TRUE(s.level.state(slot).angular_velocity.isZero(0.0));
    s.level.set_state(slot, state);
    EXPECT_TRUE(testing::same_bits(s.level.state(slot), state));
  }
  s.level.put_to_sleep(0);
  s.step();
  EXPECT_TRUE(s.level.asleep(0));
  EXPECT_TRUE(s.level.state(0).angular_velocity.isZero(0.0));
}

// Who fell asleep in the step, and who was woken since that was asked.
TEST(SupportLevel, TellsWhoWokeAndWhoFellAsleep) {
  OneSupportLevel s({0, 0, -9.81});
  s.ground.add_plane({});
  const int lying = s.add(11, testing::at({0, 0, 0.2})), asleep = s.add(12, testing::at({3, 0, 0.2}), true);
  std::vector<std::uint32_t> woke;
  s.level.take_woke(woke);
  EXPECT_TRUE(woke.empty());
  s.level.wake(asleep), s.level.wake(asleep);
  s.level.take_woke(woke);
  EXPECT_EQ(woke, std::vector<std::uint32_t>{12});
  int fell = 0;
  for (int i = 0; i < 120; ++i) {
    s.step();
    for (const std::uint32_t owner : s.level.fell_asleep()) {
      ++fell;
      EXPECT_TRUE(owner == 11 || owner == 12);
    }
  }
  EXPECT_EQ(fell, 2);
  EXPECT_TRUE(s.level.asleep(lying));
  EXPECT_EQ(s.level.state(lying).velocity, Vec3(Vec3::Zero()));
}

// What no level can hold is put back at rest within its bounds, and counted.
TEST(SupportLevel, WhatIsNotSoundIsPutBackAndCounted) {
  OneSupportLevel s;
  const int slot = s.add(1, testing::at({1, 2, 3}, {1, 0, 0}));
  s.step();
  for (const Vec3& force : {Vec3(1e300, 0, 0), Vec3(INFINITY, 0, 0), Vec3(0, NAN, 0)}) {
    const std::int64_t before = s.tally.states_recovered;
    s.level.add_force(slot, force, Vec3::Zero());
    s.step();
    EXPECT_GT(s.tally.states_recovered, before);
    EXPECT_TRUE(s.level.state(slot).position.allFinite());
    EXPECT_TRUE(s.level.state(slot).velocity.allFinite());
    EXPECT_LE(s.level.state(slot).velocity.norm(), 2e8);
  }
}

// Guests follow the bodies for a step and are gone after it.
TEST(SupportLevel, GuestsFollowItsBodies) {
  OneSupportLevel s;
  s.add(1, testing::at({0, 0, 0})), s.add(2, testing::at({1, 0, 0}), true);
  StatisticalBody guest = s.level.body(0), sleeper = guest;
  guest.owner = 50, sleeper.owner = 51, sleeper.motion = Motion::asleep;
  s.level.begin_step(kSupportStep, s.tally);
  const StatisticalBody guests[] = {guest, sleeper};
  s.level.admit_guests(guests);
  EXPECT_EQ(s.level.bodies().size(), 4U);
  EXPECT_TRUE(s.level.is_guest(2) && s.level.is_guest(3) && !s.level.is_guest(1));
  EXPECT_EQ(std::vector<std::int32_t>(s.level.awake_with_guests().begin(), s.level.awake_with_guests().end()),
            (std::vector<std::int32_t>{0, 2}));
  s.level.wake(3);
  s.level.dismiss_guests();
  EXPECT_EQ(s.level.bodies().size(), 2U);
  EXPECT_EQ(s.level.awake().size(), 1U);
  s.level.end_step();
}

TEST(SupportLevel, AnArchiveGoesOnAlike) {
  OneSupportLevel one({0, 0, -9.81}), other({0, 0, -9.81});
  for (OneSupportLevel* s : {&one, &other}) s->ground.add_plane({});
  RandomStream random(9, 0, 0);
  for (std::uint32_t i = 0; i < 6; ++i)
    one.add(i, testing::at({2.0 * i, 0, 0.5}, random.direction(), random.direction(), random.orientation()));
  for (int i = 0; i < 20; ++i) one.step();
  for (std::uint32_t i = 0; i < 6; ++i) other.kinds.take(StatisticalModel::support, other.box, 0, nullptr);
  StateArchive out;
  one.level.archive(out), one.sleepers.archive(out);
  StateArchive in(out.bytes(), {});
  other.level.archive(in), other.sleepers.archive(in);
  EXPECT_TRUE(in.at_end());
  for (int i = 0; i < 200; ++i) one.step(), other.step();
  for (int slot = 0; slot < 6; ++slot)
    EXPECT_TRUE(testing::same_bits(one.level.state(slot), other.level.state(slot)));
}

}  // namespace
}  // namespace lodestone
