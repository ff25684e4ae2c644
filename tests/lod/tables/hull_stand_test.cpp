// Bodies of `tables` that touch no other stand on the height that their hulls have; the paper's model as
// published is an option.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lod/contact/hull_contacts.h"
#include "reference/random.h"
#include "signature/settling_clips.h"
#include "tests/lod/rungs/rung_fixture.h"

namespace lodestone::hull_stand_test {
namespace {

using testing::box, testing::box_signature, testing::OneRung;

constexpr double kFrame = 1.0 / 60;

// m, of the hull's lowest point over the plane z = 0.
double gap_of(const RigidState& s) {
  std::int32_t hint = 0;
  return find_lowest_point(*box(), s.orientation, Vec3::UnitZ(), s.position.z(), hint).gap;
}

bool lies_on_a_face(const RigidState& s) {
  return (s.orientation.conjugate() * Vec3::UnitZ()).cwiseAbs().maxCoeff() > 0.999;
}

RigidState falling(int number) {
  RandomStream random(11, std::uint64_t(number), 0);
  RigidState s;
  s.position = {2.0 * number, 0, 0.6};
  s.orientation = random.orientation();
  s.velocity = {random.uniform(-1, 1), random.uniform(-1, 1), 0};
  s.angular_velocity = random.uniform(0, 8) * random.direction();
  return s;
}

class HullStand : public ::testing::Test {
 protected:
  HullStand() { ground_.add_plane({}); }
  OneRung make(StatisticalModel model = StatisticalModel::tables) const {
    return {model, settings_, ground_, materials_};
  }
  static int add(OneRung& level, const RigidState& state) {
    return level.add(std::uint32_t(level.size()), box(), 24.0, 0, state, false, box_signature());
  }
  static void run(OneRung& level, int steps) {
    for (int i = 0; i < steps; ++i) {
      StepReport report;
      level.step(kFrame, {}, report);
    }
  }

  StatisticalSettings settings_;
  Ground ground_;
  MaterialTable materials_;
};

// A box that bounces without a turn to one and a third of its radius, and stops where it comes down.
std::shared_ptr<const Signature> hopping_signature(double along, double up) {
  Signature signature = *box_signature();
  const double radius = box()->radius, unit = std::sqrt(9.81 * radius), landing = 2.0 * up / 9.81;
  signature.clip_frame_interval = float(kFrame * unit / radius);
  const auto extent = float(along * landing / radius);
  signature.clip_frames.clear();
  for (int frame = 0; frame < 60; ++frame) {
    const double t = std::min(frame * kFrame, landing);
    ClipState state;
    state.position = Vec3(along * t, 0, 0.2 + up * t - 0.5 * 9.81 * t * t) / radius;
    if (t < landing) state.velocity = Vec3(along, 0, up - 9.81 * t) / unit;
    signature.clip_frames.push_back(encode_frame(state, extent));
  }
  signature.clips = {{.first_frame = 0, .frames = 60, .extent = extent}};
  signature.clip_entries = {{.clip = 0, .frame = 0}};
  return std::make_shared<const Signature>(signature);
}

// Above its bounding sphere's height, too, the clip goes on: else the box would fly by itself, and be put
// back once it comes down.
TEST_F(HullStand, AClipGoesOnHoweverHighItHops) {
  const double unit = std::sqrt(9.81 * box()->radius), along = 0.5 * unit, up = std::sqrt(1.2) * unit;
  constexpr double kRestitution = 0.6;
  materials_.replace(0, {.restitution = kRestitution, .friction = 0.0});
  OneRung level = make();
  RigidState s;
  s.position = {0, 0, 0.201}, s.velocity = {along, 0, -up / kRestitution};
  level.add(0, box(), 24.0, 0, s, false, hopping_signature(along, up));
  double highest = 0.0;
  for (int step = 0; step < 120; ++step) {
    const double before = level.state(0).position.x();
    run(level, 1);
    EXPECT_GT(level.state(0).position.x(), before - 1e-3) << step;
    highest = std::max(highest, level.state(0).position.z());
  }
  EXPECT_GT(highest, 1.2 * box()->radius);
  EXPECT_TRUE(level.asleep(0));
  EXPECT_NEAR(level.state(0).position.x(), along * 2.0 * up / 9.81, 0.05);
}

// The sphere of the mean height leaves hulls in the ground by a third of R, and over it by as much.
TEST_F(HullStand, ALoneBodySinksInByNothingAndLiesOnAFace) {
  constexpr int kBoxes = 20;
  OneRung level = make();
  for (int i = 0; i < kBoxes; ++i) add(level, falling(i));
  double deepest = 0.0;
  for (int step = 0; step < 600; ++step) {
    run(level, 1);
    for (int slot = 0; slot < kBoxes; ++slot) deepest = std::max(deepest, -gap_of(level.state(slot)));
  }
  EXPECT_LT(deepest, 0.01 * box()->radius);
  EXPECT_EQ(level.asleep_count(), kBoxes);
  for (int slot = 0; slot < kBoxes; ++slot) {
    EXPECT_TRUE(lies_on_a_face(level.state(slot))) << slot;
    EXPECT_NEAR(gap_of(level.state(slot)), 0.0, 0.002) << slot;
    EXPECT_NEAR(level.sphere_radius(slot), level.position(slot).z(), 1e-6) << slot;  // whom others meet
  }
}

// The closed-form impulse at the lowest vertex, not one drawn from the tables. Orientations are floats here.
TEST_F(HullStand, AFirstImpactIsThatOfSupport) {
  OneRung tables = make(), support = make(StatisticalModel::support);
  constexpr int kBoxes = 12;
  for (int i = 0; i < kBoxes; ++i) add(tables, falling(i)), add(support, falling(i));
  std::vector<bool> struck(kBoxes);
  for (int step = 0; step < 60; ++step) {
    run(tables, 1);
    run(support, 1);
    for (int slot = 0; slot < kBoxes; ++slot) {
      const RigidState s = tables.state(slot), t = support.state(slot);
      if (struck[std::size_t(slot)] || t.velocity.z() < -0.5) continue;
      struck[std::size_t(slot)] = true;
      EXPECT_LT((s.velocity - t.velocity).norm(), 2e-3) << slot;
      EXPECT_LT((s.angular_velocity - t.angular_velocity).norm(), 2e-2) << slot;
    }
  }
  EXPECT_EQ(std::ranges::count(struck, true), kBoxes);
}

TEST_F(HullStand, PublishedItIsTheSphereOfTheMeanHeight) {
  settings_.tables.published = true;
  OneRung level = make();
  const int slot = add(level, {.position = Vec3(0, 0, box()->radius),
                               .orientation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()))});
  double farthest = 0.0;  // m: of the hull's lowest point from the ground while the body is on it
  for (int step = 0; step < 60; ++step) {
    run(level, 1);
    farthest = std::max(farthest, -gap_of(level.state(slot)));
  }
  EXPECT_GT(farthest, 0.02 * box()->radius);
}

TEST_F(HullStand, AnyOfThePapersOptionsAsksForThePapersModel) {
  EXPECT_FALSE(TablesOptions{}.as_published());
  for (const TablesOptions& options : {TablesOptions{.interpolate = false},
                                       {.draw_height = true},
                                       {.radius_update_interval = 2},
                                       {.rest_poses = false},
                                       {.nearest_rest_pose = true},
                                       {.paper_pair_rule = true},
                                       {.published = true}})
    EXPECT_TRUE(options.as_published());
}

// Struck while a clip brings it to rest a body is a sphere among others: a clip has no rest pose for it.
// Bodies come and go meanwhile.
TEST_F(HullStand, ABodyThatIsStruckOrRemovedLeavesItsClip) {
  OneRung level = make();
  constexpr int kBoxes = 24;
  for (int i = 0; i < kBoxes; ++i) add(level, falling(i));
  for (int step = 0; step < 900; ++step) {
    run(level, 1);
    if (step >= 30 && step < 120 && step % 6 == 0) {
      const int target = (step / 6) % level.size();
      RigidState above = level.state(target);
      above.position.z() += 0.45;
      above.velocity = {0, 0, -2.0};
      add(level, above);
    }
    if (step >= 40 && step < 100 && step % 20 == 0) level.remove(step / 20);
  }
  EXPECT_EQ(level.asleep_count(), level.size());
  for (int slot = 0; slot < level.size(); ++slot) {
    EXPECT_TRUE(level.position(slot).allFinite()) << slot;
    EXPECT_GT(level.position(slot).z(), 0.05) << slot;
  }
}

}  // namespace
}  // namespace lodestone::hull_stand_test
