#include "lod/manager/checks.h"

#include <gtest/gtest.h>

#include <limits>

#include "reference/random.h"
#include "tests/message_of.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using testing::kNothingThrown;
using testing::message_of;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN(),
                 kEndless = std::numeric_limits<double>::infinity();

// Whatever state is let in can be held: finite, of unit orientation, no faster than the limit; what was fit
// before is the same after.
TEST(Checks, AStateIsFitAfterwardsOrRefused) {
  RandomStream random(65, 0, 0);
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    RigidState state = testing::at(random.uniform(0, 1e3) * random.direction(), random.direction(),
                                   random.direction(), random.orientation());
    const double odd[] = {kNoNumber, kEndless, -kEndless, 1e9, -1e9, 1e300, 0.0};
    const int which = i % 8;
    const double value = odd[int(random.uniform(0, 7))];
    if (which == 1) state.position[i % 3] = value;
    if (which == 2) state.velocity[i % 3] = value;
    if (which == 3) state.angular_velocity[i % 3] = value;
    if (which == 4) state.orientation.coeffs()[i % 4] = value;
    if (which == 5) state.orientation.coeffs() *= random.uniform(0.998, 1.002);
    RigidState sound;
    const std::string message = message_of([&] { sound = checked(state); });
    if (message != kNothingThrown) {
      ++refused;
      EXPECT_NE(message.find("found "), std::string::npos);
      EXPECT_NE(message.find("expected "), std::string::npos);
      EXPECT_NE(which, 0);
      continue;
    }
    EXPECT_TRUE(is_within_limit(sound.position));
    EXPECT_NEAR(sound.orientation.norm(), 1.0, 1e-15);
    EXPECT_LE(sound.velocity.norm(), 1.000001e6);
    EXPECT_LE(sound.angular_velocity.norm(), 1.000001e6);
    if (which == 0) {
      EXPECT_EQ(sound.velocity, state.velocity);
      EXPECT_EQ(sound.position, state.position);
    }
    const RigidState again = checked(sound);
    EXPECT_LT((again.velocity - sound.velocity).norm(), 1e-6 * (1e-9 + sound.velocity.norm()));
  }
  EXPECT_GT(refused, 80);
}

// Too fast is as fast as may be, the same way; also where the square of the speed is no number any more.
TEST(Checks, TooFastIsCutToTheLimitInItsDirection) {
  RandomStream random(66, 0, 0);
  for (const double speed : {1.1e6, 1e30, 1e200, 1e307}) {
    const Vec3 direction = random.direction();
    RigidState state;
    state.velocity = speed * direction;
    const RigidState sound = checked(state);
    EXPECT_NEAR(sound.velocity.norm(), 1e6, 1e-3);
    EXPECT_LT((sound.velocity.normalized() - direction).norm(), 1e-9) << speed;
  }
}

TEST(Checks, StepsAreZeroOrANanosecondToTenSeconds) {
  for (const double dt : {0.0, 1e-9, 1e-3, 1.0, 10.0}) EXPECT_NO_THROW(check_step(dt)) << dt;
  for (const double dt : {-1e-300, 9e-10, 10.001, kNoNumber, kEndless})
    EXPECT_THROW(check_step(dt), InputError) << dt;
  EXPECT_EQ(message_of([] { check_step(-1.0); }), "time step: found -1 s, expected 0 … 10 s");
}

TEST(Checks, PoliciesAreRefusedByTheNameOfWhatIsWrong) {
  const auto fault = [](const auto& change) {
    PolicySettings policy;
    change(policy);
    return message_of([&] { check_policy(policy); });
  };
  using P = PolicySettings;
  EXPECT_EQ(fault([](P&) {}), kNothingThrown);
  EXPECT_EQ(fault([](P& p) { p.hysteresis = -0.1; }), "hysteresis: found -0.1, expected 0 or more");
  EXPECT_EQ(fault([](P& p) { p.min_dwell_frames = -1; }), "min_dwell_frames: found -1, expected 0 or more");
  EXPECT_EQ(fault([](P& p) { p.max_transitions_per_frame = -1; }),
            "max_transitions_per_frame: found -1, expected 0 or more");
  EXPECT_EQ(fault([](P& p) { p.policy = DistancePolicy{kNoNumber}; }),
            "full_within: found nan, expected 0 or more");
  EXPECT_EQ(fault([](P& p) {
              p.policy = DistancePolicy{1.0, -1.0};
            }),
            "support_within: found -1, expected 0 or more");
  EXPECT_EQ(fault([](P& p) {
              p.policy = DistancePolicy{4.0, 2.0};
            }),
            "support_within: found 2, expected full_within (4) or more");
  EXPECT_EQ(fault([](P& p) {
              p.policy = ProjectedSizePolicy{50.0, 60.0};
            }),
            "support_above_px: found 60, expected full_above_px (50) or less");
  EXPECT_EQ(fault([](P& p) { p.policy = BudgetPolicy{-1.0}; }), "budget_ms: found -1, expected 0 or more");
  EXPECT_EQ(fault([](P& p) { p.policy = WorkPolicy{-1.0}; }), "budget_work: found -1, expected 0 or more");
  EXPECT_EQ(fault([](P& p) { p.policy = ErrorBudgetPolicy{.budget_ms = 1.0, .budget_work = -2.0}; }),
            "budget_work: found -2, expected 0 or more");
  EXPECT_EQ(fault([](P& p) { p.policy = ProjectedSizePolicy{-1.0}; }),
            "full_above_px: found -1, expected 0 or more");
  EXPECT_EQ(fault([](P& p) { p.out_of_view_factor = 0.9; }),
            "out_of_view_factor: found 0.9, expected 1 or more");
  EXPECT_EQ(fault([](P& p) { p.look_ahead_s = 11; }), "look_ahead_s: found 11, expected 10 s or less");
}

TEST(Checks, RungsBeginNoHigherThanTheyEnd) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const std::string message = message_of([&] { check_rung_range(Rung(a), Rung(b)); });
      EXPECT_EQ(message == kNothingThrown, a <= b);
    }
  EXPECT_EQ(message_of([] { check_rung_range(Rung::full, Rung::tables); }),
            "rungs: found full as the least, tables as the greatest, expected a least one no higher than the "
            "greatest");
}

TEST(Checks, RungsAndLevelsAreThoseThatThereAre) {
  EXPECT_EQ(message_of([] { check_rung_range(Rung::tables, Rung(9)); }), "rungs: found 9, expected 0 … 2");
  EXPECT_EQ(message_of([] { check_rung_range(Rung(3), Rung(3)); }), "rungs: found 3, expected 0 … 2");
  EXPECT_EQ(message_of([] { check_level_choice(LevelChoice::tables); }), kNothingThrown);
  EXPECT_EQ(message_of([] { check_level_choice(LevelChoice(5)); }), "level choice: found 5, expected 0 … 4");
}

TEST(Checks, ViewpointsNeedAPictureAndAPlace) {
  const auto fault = [](const auto& change) {
    Viewpoint view;
    change(view);
    return message_of([&] { checked(view); });
  };
  using V = Viewpoint;
  EXPECT_EQ(fault([](V&) {}), kNothingThrown);
  EXPECT_EQ(fault([](V& v) { v.position.x() = 1e12; }), kNothingThrown);
  EXPECT_NE(fault([](V& v) { v.position.x() = 1.1e12; }), kNothingThrown);
  EXPECT_EQ(fault([](V& v) { v.direction = Vec3::Zero(); }),
            "direction of a viewpoint: found (0, 0, 0), expected a vector other than 0");
  EXPECT_EQ(fault([](V& v) { v.up = Vec3::Zero(); }),
            "up of a viewpoint: found (0, 0, 0), expected a vector other than 0");
  EXPECT_EQ(fault([](V& v) { v.vertical_fov_rad = 3.2; }),
            "vertical_fov_rad: found 3.2, expected less than π");
  EXPECT_EQ(fault([](V& v) { v.height_px = 0; }), "height_px: found 0, expected a positive, finite number");
  EXPECT_EQ(fault([](V& v) { v.aspect = kEndless; }),
            "aspect: found inf, expected a positive, finite number");
}

TEST(Checks, MassesAreDensityTimesVolumeOrGivenAndFit) {
  MaterialTable materials;
  const auto box = testing::box_shape({1, 1, 1});
  EXPECT_NEAR(checked_mass({.shape = box}, materials), 1000.0, 1e-6);
  EXPECT_EQ(checked_mass({.shape = box, .mass = 3.0}, materials), 3.0);
  EXPECT_EQ(message_of([&] { checked_mass({}, materials); }), "shape: found none, expected one");
  for (const double mass : {0.0, -1.0, kNoNumber, kEndless, 1e-30, 1e30})
    EXPECT_THROW(checked_mass({.shape = box, .mass = mass}, materials), InputError) << mass;
  EXPECT_THROW(checked_mass({.shape = box, .material = 7}, materials), InputError);
  EXPECT_THROW(checked_mass({.shape = box, .importance = 0.0}, materials), InputError);
}

TEST(Checks, GroundMeshesHaveFacesWithAreaAndSoundIndices) {
  const Mesh box = make_box({1, 1, 1});
  EXPECT_NO_THROW(check_ground_mesh(box));
  Mesh mesh = box;
  mesh.faces[3][1] = 8;
  EXPECT_EQ(message_of([&] { check_ground_mesh(mesh); }),
            "face of a static mesh: found vertex 8, expected 0 … 7");
  mesh.faces[3][1] = -1;
  EXPECT_THROW(check_ground_mesh(mesh), InputError);
  mesh = box;
  mesh.vertices[2].y() = kNoNumber;
  EXPECT_THROW(check_ground_mesh(mesh), InputError);
  mesh = box;
  mesh.faces.resize(1);
  EXPECT_EQ(message_of([&] { check_ground_mesh(mesh); }),
            "static mesh: found 1 faces, expected two or more, with an area");
  for (Vec3& vertex : mesh.vertices) vertex = vertex.x() * Vec3::Ones();
  mesh.faces = box.faces;
  EXPECT_EQ(message_of([&] { check_ground_mesh(mesh); }),
            "static mesh: found 12 faces without area, expected two or more, with an area");
  // Of so little that they are no ground at `support` and `tables`.
  const Mesh slivers{{{-1, 0, 0}, {1, 0, 0}, {0, 1e-10, 0}, {0, -1e-10, 0}}, {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_EQ(message_of([&] { check_ground_mesh(slivers); }),
            "static mesh: found 2 faces without area, expected two or more, with an area");
}

TEST(Checks, NormalsAreOfUnitLengthWithinAThousandth) {
  EXPECT_EQ(checked_normal({0, 0, 1.0005}, "normal"), Vec3(0, 0, 1));
  EXPECT_EQ(message_of([] {
              checked_normal({0, 0, 1.01}, "plane's normal");
            }),
            "plane's normal: found (0, 0, 1.01), expected a vector of unit length");
  EXPECT_THROW(checked_normal({0, 0, kNoNumber}, "normal"), InputError);
}

TEST(Checks, PropertiesThatDampOrLimitArePositive) {
  for (const double bad : {-0.1, kNoNumber, kEndless}) {
    EXPECT_THROW(check_properties({.linear_damping = bad}), InputError);
    EXPECT_THROW(check_properties({.angular_damping = bad}), InputError);
  }
  for (const double bad : {0.0, -1.0, kNoNumber}) {
    BodyProperties slow;
    slow.max_angular_speed = bad;
    EXPECT_THROW(check_properties(slow), InputError);
  }
  EXPECT_NO_THROW(check_properties({}));
}

}  // namespace
}  // namespace lodestone
