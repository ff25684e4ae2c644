// Bodies of `support`, `tables` and the full level in one world: they meet, momentum is exact, no energy comes of it, and who is on which rung or came first does not matter.
#include <gtest/gtest.h>

#include <cmath>

#include "lod/rungs/statistical_level.h"
#include "reference/free_rotation.h"
#include "reference/random.h"
#include "signature/measure/measure.h"
#include "tests/allocations.h"

namespace lodestone {
namespace {

constexpr double kFrame = 1.0 / 60, kMass = 24.0;
constexpr auto kSupport = StatisticalModel::support, kTables = StatisticalModel::tables;

std::shared_ptr<const Shape> box() {
  static const auto shape = std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  return shape;
}

std::shared_ptr<const Signature> box_signature() {
  static const auto signature = [] {
    SignatureSettings settings;
    settings.n_theta = 4, settings.n_phi = 4, settings.n_alpha = 6, settings.trials_per_cell = 16;
    settings.height_trials = 200, settings.settling_trials = 60, settings.clips = 30;
    return std::make_shared<const Signature>(measure_signature(*box(), settings, 2));
  }();
  return signature;
}

struct Motions {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();  // over the mass of a box
  double energy = 0.0;

  void add(const RigidState& s) {
    const Vec3 spin = spin_of(s.orientation, s.angular_velocity, *box());
    linear += s.velocity;
    angular += s.position.cross(s.velocity) + spin;
    energy += 0.5 * (s.velocity.squaredNorm() + s.angular_velocity.dot(spin));
  }
};

class Meeting : public ::testing::Test {
 protected:
  StatisticalPlace add(StatisticalLevel& level, StatisticalModel model, const RigidState& state, bool asleep = false) {
    return level.add(model, std::uint32_t(level.size()), box(), kMass, 0, state, asleep, box_signature(), asleep);
  }
  static FullNeighbor full_box(std::uint32_t owner, const RigidState& state) {
    FullNeighbor neighbor;
    neighbor.owner = owner, neighbor.shape = box().get(), neighbor.mass = kMass, neighbor.state = state;
    return neighbor;
  }
  /// What the full level does with what it is given, without gravity and contacts of its own.
  static void move(FullNeighbor& full) {
    RigidState& s = full.state;
    for (Impulse* impulse : {&full.hit, &full.push}) {
      s.velocity += impulse->linear / kMass;
      s.angular_velocity += s.orientation * (box()->inverse_inertia_per_mass * (s.orientation.conjugate() * impulse->angular)) / kMass;
      *impulse = {};
    }
    s.position += full.shift + s.velocity * kFrame;
    full.shift.setZero();
  }

  static RigidState thrown(std::uint32_t trial, double side) {
    RandomStream random(11, trial, side > 0.0);
    RigidState s;
    s.position = {0.45 * side, 0.1 * random.uniform(), 0.1 * random.uniform()};
    s.orientation = random.orientation();
    s.velocity = {-2.0 * side, 0, 0};
    s.angular_velocity = random.uniform(0.0, 4.0) * random.direction();
    return s;
  }

  StatisticalSettings settings_ = [] {
    StatisticalSettings settings;
    settings.gravity.setZero();
    return settings;
  }();
  StaticGround none_, floor_ = [] {
    StaticGround ground;
    ground.planes.push_back({});
    return ground;
  }();
  MaterialTable materials_;
};

TEST_F(Meeting, ContactsOfAnyTwoRungsKeepMomentumAndAddNoEnergy) {
  int met = 0;
  for (std::uint32_t trial = 0; trial < 60; ++trial)
    for (const StatisticalModel second : {kSupport, kTables}) {
      StatisticalLevel level(settings_, none_, materials_);
      const StatisticalPlace places[] = {add(level, kTables, thrown(trial, -1.0)), add(level, second, thrown(trial, 1.0))};
      const auto measure = [&] {
        Motions sum;
        for (const StatisticalPlace place : places) sum.add(level.state(place));
        return sum;
      };
      const Motions before = measure();
      int contacts = 0;
      for (int i = 0; i < 30; ++i) {
        StepReport report;
        level.step(kFrame, {}, report);
        contacts += report.contacts;
      }
      const Motions after = measure();
      met += contacts > 0;
      EXPECT_LT((after.linear - before.linear).norm(), 2e-6) << trial;  // tables keep some of it in floats
      EXPECT_LE(after.energy, before.energy * (1.0 + 1e-5)) << trial;
    }
  EXPECT_GT(met, 100);
}

TEST_F(Meeting, AFullBodyAndASphereExchangeMomentumToRounding) {
  for (std::uint32_t trial = 0; trial < 60; ++trial) {
    StatisticalLevel level(settings_, none_, materials_);
    const StatisticalPlace sphere = add(level, kTables, thrown(trial, -1.0));
    FullNeighbor full = full_box(7, thrown(trial, 1.0));
    Motions before, after;
    before.add(level.state(sphere)), before.add(full.state);
    int contacts = 0;
    for (int i = 0; i < 30; ++i) {
      StepReport report;
      level.step(kFrame, {&full, 1}, report);
      move(full);
      contacts += report.contacts;
    }
    after.add(level.state(sphere)), after.add(full.state);
    EXPECT_GT(contacts, 0) << trial;
    EXPECT_LT((after.linear - before.linear).norm(), 1e-12) << trial;
    EXPECT_LE(after.energy, before.energy * (1.0 + 1e-9)) << trial;
  }
}

TEST_F(Meeting, WhoCameFirstDoesNotMatter) {
  for (std::uint32_t trial = 0; trial < 30; ++trial) {
    RigidState ends[2][2];
    for (const int swapped : {0, 1}) {
      StatisticalLevel level(settings_, none_, materials_);
      StatisticalPlace hull, sphere;
      const auto add_as = [&](StatisticalModel model, double side, std::uint32_t owner) {
        return level.add(model, owner, box(), kMass, 0, thrown(trial, side), false, box_signature());
      };
      if (swapped) sphere = add_as(kTables, 1.0, 5), hull = add_as(kSupport, -1.0, 3);
      else hull = add_as(kSupport, -1.0, 3), sphere = add_as(kTables, 1.0, 5);
      for (int i = 0; i < 30; ++i) {
        StepReport report;
        level.step(kFrame, {}, report);
      }
      ends[swapped][0] = level.state(hull), ends[swapped][1] = level.state(sphere);
    }
    for (const int body : {0, 1}) {
      EXPECT_EQ(ends[0][body].position, ends[1][body].position) << trial;
      EXPECT_EQ(ends[0][body].velocity, ends[1][body].velocity) << trial;
    }
  }
}

// A mirrored pair with its rungs exchanged goes the mirrored way, as far as a sphere's floats allow.
TEST_F(Meeting, SwappedRolesMeetAlike) {
  RigidState left, right;
  left.position = {-0.45, 0, 0}, right.position = {0.45, 0, 0};
  left.velocity = {2, 0, 0}, right.velocity = {-2, 0, 0};
  double speeds[2][2];
  for (const int swapped : {0, 1}) {
    StatisticalLevel level(settings_, none_, materials_);
    const StatisticalPlace a = add(level, swapped ? kTables : kSupport, left), b = add(level, swapped ? kSupport : kTables, right);
    for (int i = 0; i < 30; ++i) {
      StepReport report;
      level.step(kFrame, {}, report);
    }
    speeds[swapped][0] = level.state(a).velocity.x(), speeds[swapped][1] = level.state(b).velocity.x();
  }
  EXPECT_LT(speeds[0][0], 0.0);
  EXPECT_NEAR(speeds[0][0], -speeds[1][1], 1e-6);
  EXPECT_NEAR(speeds[0][1], -speeds[1][0], 1e-6);
}

// A sleeper of one rung wakes when one of the other strikes it, and lies on when nobody does.
TEST_F(Meeting, SleepersAreWokenFromEitherRung) {
  settings_.gravity = Vec3(0, 0, -9.81);
  for (const StatisticalModel sleeping : {kSupport, kTables}) {
    StatisticalLevel level(settings_, floor_, materials_);
    RigidState lying, falling, far;
    lying.position = {0, 0, 0.2}, falling.position = {0, 0, 1.2}, far.position = {5, 0, 0.2};
    const StatisticalPlace struck = add(level, sleeping, lying, true), spared = add(level, sleeping, far, true);
    const StatisticalPlace striker = add(level, sleeping == kSupport ? kTables : kSupport, falling);
    bool woke = false;
    for (int i = 0; i < 60; ++i) {
      StepReport report;
      level.step(kFrame, {}, report);
      woke |= !level.asleep(struck);
      EXPECT_TRUE(level.asleep(spared));
    }
    EXPECT_TRUE(woke) << int(sleeping);
    EXPECT_GT(level.position(striker).z(), 0.1) << int(sleeping);
  }
}

// Heaps of both rungs, mixed: nothing passes through anything, all comes to rest, and a warm step allocates nothing.
TEST_F(Meeting, AMixedHeapComesToRest) {
  settings_.gravity = Vec3(0, 0, -9.81);
  StatisticalLevel level(settings_, floor_, materials_);
  std::vector<StatisticalPlace> places;
  for (int i = 0; i < 48; ++i) {
    RandomStream random(3, std::uint64_t(i), 0);
    RigidState s;
    s.position = {0.42 * (i % 4), 0.42 * (i / 4 % 4), 0.4 + 0.55 * (i / 16)};
    s.orientation = random.orientation();
    places.push_back(add(level, i % 3 ? kTables : kSupport, s));
  }
  StepReport report;
  for (int i = 0; i < 900; ++i) report = {}, level.step(kFrame, {}, report);
  for (const StatisticalPlace place : places) {
    EXPECT_GT(level.position(place).z(), 0.05);
    EXPECT_LT(level.state(place).velocity.norm(), 0.3);
  }
  EXPECT_GT(level.asleep_count(), 40);
}

// Who touched another lately leans on it still, and sleeps soon once it is still: by seconds, whatever the step. Counted in steps, that ended four times too early at 240 Hz, and the
// body lay awake for half a second.
TEST_F(Meeting, LeaningOnOthersIsCountedInSeconds) {
  settings_.gravity = Vec3(0, 0, -9.81);
  for (const StatisticalModel model : {kSupport, kTables})
    for (const double dt : {kFrame, kFrame / 4}) {
      StatisticalLevel level(settings_, floor_, materials_);
      RigidState lying, beside;
      lying.position = {0, 0, 0.2}, beside.position = {model == kTables ? 0.4 : 0.2, 0, 0.2};  // spheres are as high as the box, .2 m
      const auto arrive = [&](const RigidState& state) {
        return level.add(model, std::uint32_t(level.size()), box(), kMass, 0, state, false, box_signature(), true);
      };
      const StatisticalPlace body = arrive(lying), other = arrive(beside);
      StepReport report;
      for (int i = 0; i < std::lround(0.02 / dt); ++i) level.step(dt, {}, report);
      ASSERT_FALSE(level.asleep(body));
      level.remove(other);
      int steps = 0;
      for (; steps < 1000 && !level.asleep(body); ++steps) level.step(dt, {}, report);
      EXPECT_LT(steps * dt, 0.2) << int(model) << ", " << dt;
    }
}

}  // namespace
}  // namespace lodestone
