#include "lod/tables/spheres.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reference/random.h"

namespace lodestone {
namespace {

// Owners by slot: what the arrays must say, however bodies were moved about in them.
void expect_sound(const Spheres& spheres, const std::vector<std::uint32_t>& owner_of_slot,
                  const std::vector<bool>& asleep) {
  ASSERT_EQ(spheres.size(), std::int64_t(owner_of_slot.size()));
  std::int64_t awake = 0;
  for (std::size_t slot = 0; slot < owner_of_slot.size(); ++slot) {
    const std::uint32_t place = spheres.place_of_slot[slot];
    ASSERT_LT(place, spheres.x.size());
    EXPECT_EQ(spheres.slot[place], std::int32_t(slot));
    EXPECT_EQ(spheres.owner[place], owner_of_slot[slot]);
    EXPECT_EQ(spheres.x[place], double(owner_of_slot[slot]));  // moves with it
    EXPECT_EQ(spheres.motion[place] == Motion::asleep, bool(asleep[slot]));
    EXPECT_EQ(std::int64_t(place) >= spheres.awake, bool(asleep[slot]));
    awake += !asleep[slot];
  }
  EXPECT_EQ(spheres.awake, awake);
}

TEST(Spheres, KeepTheirSlotsWhileTheyComeGoSleepAndWake) {
  Spheres spheres;
  std::vector<std::uint32_t> owners;
  std::vector<bool> asleep;
  RandomStream random(21, 0, 0);
  std::vector<double> scratch(1'000);
  for (std::uint32_t step = 0; step < 2'000; ++step) {
    const double what = random.uniform();
    const auto slot = std::uint32_t(random.uniform() * double(owners.size()));
    if (owners.empty() || (what < 0.3 && owners.size() < 60)) {
      const std::int64_t place = spheres.add(step);
      spheres.x[place] = step;
      owners.push_back(step), asleep.push_back(false);
    } else if (what < 0.5) {
      spheres.remove(slot);
      owners[slot] = owners.back(), asleep[slot] = asleep.back();  // the last slot's takes it over
      owners.pop_back(), asleep.pop_back();
    } else if (what < 0.7) {
      if (!asleep[slot]) spheres.put_to_sleep(spheres.place_of_slot[slot]);
      asleep[slot] = true;
    } else if (what < 0.9) {
      spheres.wake(slot);
      asleep[slot] = false;
    } else {
      std::vector<std::uint32_t> order(std::size_t(spheres.awake));
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = std::uint32_t(order.size() - 1 - i);
      spheres.reorder_awake(order, scratch.data());
    }
    expect_sound(spheres, owners, asleep);
    if (HasFailure()) return;
  }
}

TEST(Spheres, SleepTakesVelocityAndSpin) {
  Spheres spheres;
  spheres.add(0);
  spheres.vx[0] = spheres.lz[0] = 1.0;
  spheres.known_count[0] = 3;
  spheres.put_to_sleep(0);
  EXPECT_EQ(spheres.velocity(0), Vec3::Zero());
  EXPECT_EQ(spheres.spin(0), Vec3::Zero());
  EXPECT_EQ(spheres.known_count[0], 0);
}

TEST(Spheres, ABodyPutInComesOutAgain) {
  Spheres spheres;
  spheres.add(4);
  StatisticalBody body;
  body.position = {1, 2, 3}, body.velocity = {4, 5, 6}, body.spin = {7, 8, 9};
  body.orientation = rotation_from_vector(Vec3(0.1, 0.2, 0.3));
  body.sphere_radius = 0.25f, body.quiet_time = 0.5f, body.owner = 4, body.events = 11;
  body.motion = Motion::settling, body.support_hint = 6;
  spheres.put(0, body);
  spheres.inverse_mass[0] = 0.125;
  spheres.since_crowded[0] = 40, spheres.eased[0] = 2;
  const StatisticalBody out = spheres.body(0);
  EXPECT_EQ(out.position, body.position);
  EXPECT_EQ(out.velocity, body.velocity);
  EXPECT_EQ(out.spin, body.spin);
  EXPECT_LT(out.orientation.angularDistance(body.orientation), 1e-6);
  EXPECT_NEAR(out.orientation.norm(), 1.0, 1e-15);
  EXPECT_EQ(out.sphere_radius, 0.25f);
  EXPECT_EQ(out.quiet_time, 0.5f);
  EXPECT_EQ(out.owner, 4U);
  EXPECT_EQ(out.events, 11U);
  EXPECT_EQ(out.mass, 8.0);
  EXPECT_EQ(out.motion, Motion::settling);
  EXPECT_EQ(out.support_hint, 6);
  EXPECT_FLOAT_EQ(out.since_crowded, 0.04f);
  EXPECT_FLOAT_EQ(out.eased, 0.016f);
}

TEST(Spheres, ASnapshotHasAllOfThem) {
  Spheres spheres;
  for (std::uint32_t i = 0; i < 5; ++i) spheres.x[spheres.add(i)] = i;
  spheres.put_to_sleep(2);
  StateArchive writer;
  spheres.archive(writer);
  Spheres copy;
  StateArchive reader(writer.bytes(), {});
  copy.archive(reader);
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(copy.awake, 4);
  copy.each_array([](auto& array) { EXPECT_EQ(array.size(), 5U); });
  EXPECT_EQ(copy.x, spheres.x);
  EXPECT_EQ(copy.slot, spheres.slot);
  EXPECT_EQ(copy.place_of_slot, spheres.place_of_slot);
}

}  // namespace
}  // namespace lodestone
