#include "lod/support/clip_player.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lod/contact/hull_contacts.h"
#include "lod/support/hull_motion.h"

namespace lodestone {
namespace {

constexpr double kGravity = 9.81, kSide = 0.2;
const HalfSpace kFloor{.normal = Vec3::UnitZ(), .offset = 0.3};

// A cube that slides to rest along x, its lower side on the plane, and turns a little as one that rocks.
// Lengths over R, speeds over √(gR).
class ClipPlayer : public ::testing::Test {
 protected:
  static constexpr int kFrames = 5;

  ClipPlayer() {
    auto signature = std::make_shared<Signature>();
    signature->clip_frame_interval = 0.1f;
    signature->clips = {{.first_frame = 0, .frames = kFrames, .extent = 1.0f}};
    const double places[kFrames] = {0.0, 0.02, 0.035, 0.045, 0.05},
                 speeds[kFrames] = {0.2, 0.15, 0.1, 0.05, 0.0};
    for (int i = 0; i < kFrames; ++i)
      signature->clip_frames.push_back(encode_frame({{places[i], 0, kHeight},
                                                     Quat::Identity(),
                                                     {speeds[i], 0, 0},
                                                     {0, kTurning * speeds[i] / speeds[0], 0}},
                                                    1.0f));
    signature->clip_entries = {{.clip = 0, .frame = 0}};
    kind_ = make_body_kind(std::make_shared<const Shape>(make_shape("cube", make_box({kSide, kSide, kSide}))),
                           signature);
    const double radius = kind_.shape->radius;
    kind_.clips =
        std::make_shared<const ClipIndex>(*signature, kind_.shape->inertia_per_mass / (radius * radius));
  }

  double radius() const { return kind_.shape->radius; }
  double speed_unit() const { return std::sqrt(kGravity * radius()); }
  double time_unit() const { return std::sqrt(radius() / kGravity); }
  double lowest_gap(const StatisticalBody& body) const {
    std::int32_t hint = 0;
    return find_lowest_point(*kind_.shape, body.orientation, kFloor.normal, kFloor.height_of(body.position),
                             hint)
        .gap;
  }
  /// As the clip begins, at another place and looking another way; tilted about its own y.
  StatisticalBody body_like_clip(double yaw, double tilt = 0.0) const {
    StatisticalBody body;
    body.orientation =
        Quat(Eigen::AngleAxisd(yaw, Vec3::UnitZ())) * Quat(Eigen::AngleAxisd(tilt, Vec3::UnitY()));
    body.position = {3, -2, kFloor.offset + 0.5 * kSide};
    body.position.z() -= lowest_gap(body);
    body.velocity = Quat(Eigen::AngleAxisd(yaw, Vec3::UnitZ())) * Vec3(0.2 * speed_unit(), 0, 0);
    body.spin =
        spin_of(body.orientation, body.orientation * Vec3(0, kTurning / time_unit(), 0), *kind_.shape);
    return body;
  }
  std::optional<ClipPlayback> find(const StatisticalBody& body) const {
    return find_clip(body, kind_, kFloor, kGravity, settings_);
  }
  bool advance(ClipPlayback& playback, StatisticalBody& body, double time) const {
    return advance_clip(playback, body, kind_, kGravity, time, settings_);
  }

  static constexpr double kTurning = 0.1;                     // rad, in √(R/g): how fast the clip begins
  static inline const double kHeight = 1.0 / std::sqrt(3.0);  // of a cube's middle, over R
  BodyKind kind_;
  ClipSettings settings_;
};

TEST_F(ClipPlayer, ABodyJoinsWithoutAJump) {
  for (const double tilt : {0.0, 0.02}) {
    StatisticalBody body = body_like_clip(0.7, tilt);
    const StatisticalBody before = body;
    std::optional<ClipPlayback> playback = find(body);
    ASSERT_TRUE(playback) << tilt;
    EXPECT_FALSE(advance(*playback, body, 0.0));
    EXPECT_LT((body.position - before.position).norm(), 1e-9) << tilt;
    EXPECT_LT(body.orientation.angularDistance(before.orientation), 1e-7) << tilt;
    EXPECT_LT((body.velocity - before.velocity).norm(), 1e-3 * speed_unit()) << tilt;  // 16 bits
  }
}

// Nothing recorded is as it goes on, and friction alone brings it to rest.
TEST_F(ClipPlayer, WhatSlidesFlatJoinsNone) {
  StatisticalBody body = body_like_clip(0.7);
  ASSERT_TRUE(find(body));
  body.spin.setZero();
  EXPECT_FALSE(find(body));
}

TEST_F(ClipPlayer, ItFollowsTheClipInItsOwnYawAndEndsAtRest) {
  const double yaw = 0.7;
  StatisticalBody body = body_like_clip(yaw);
  const Vec3 start = body.position;
  std::optional<ClipPlayback> playback = find(body);
  ASSERT_TRUE(playback);
  const Vec3 ahead = Quat(Eigen::AngleAxisd(yaw, Vec3::UnitZ())) * Vec3::UnitX();
  advance(*playback, body, 0.105 * time_unit());  // a twentieth beyond the next frame, whose velocity it has
  EXPECT_LT((body.position - start - 0.02075 * radius() * ahead).norm(), 1e-3 * radius());
  EXPECT_LT((body.velocity - 0.15 * speed_unit() * ahead).norm(), 1e-3 * speed_unit());
  int steps = 0;
  while (!advance(*playback, body, 0.1 * time_unit())) ASSERT_LT(++steps, 100);
  EXPECT_EQ(playback->residual_left, 0.0);
  EXPECT_LT((body.position - start - 0.05 * radius() * ahead).norm(), 1e-3 * radius());
  EXPECT_LT(body.velocity.norm() + body.spin.norm(), 1e-9);
  EXPECT_NEAR(lowest_gap(body), 0.0, 1e-3 * radius());
}

// A residual of .02 rad fades over .15 s at R = .2 m, and √(R/g) as long at others; meanwhile no corner dips
// into the floor.
TEST_F(ClipPlayer, WhatItDiffersByFadesAboveTheGround) {
  StatisticalBody body = body_like_clip(0.7, 0.02);
  std::optional<ClipPlayback> playback = find(body);
  ASSERT_TRUE(playback);
  const double fade = 0.15 * std::sqrt(radius() / 0.2);
  const auto tilt = [&] { return std::acos(std::min(1.0, (body.orientation * Vec3::UnitZ()).z())); };
  double before = tilt();
  for (int i = 0; i < 10; ++i) {
    advance(*playback, body, 0.0999 * fade);
    EXPECT_LE(tilt(), before + 1e-9);
    EXPECT_GT(lowest_gap(body), -1e-9);
    before = tilt();
    EXPECT_TRUE(i != 4 || std::abs(before - 0.01) < 1e-3) << before;  // half of it half-way
  }
  EXPECT_GT(playback->residual_left, 0.0);
  EXPECT_LT(playback->residual_left, 0.01);
}

// A clip was recorded where there is no wall: it plays as far as there is none.
TEST_F(ClipPlayer, AWallEndsIt) {
  const MaterialTable materials;
  for (const double ahead : {0.02, 0.06}) {  // over R: the clip goes .05 R
    StatisticalBody body = body_like_clip(0.0);
    const double face = body.position.x() + 0.5 * kSide, wall = face + ahead * radius();
    std::optional<ClipPlayback> playback = find(body);
    ASSERT_TRUE(playback);
    body.motion = Motion::settling;
    const HalfSpace planes[] = {kFloor, {.normal = -Vec3::UnitX(), .offset = -wall}};
    const StepWorld world{.gravity = {0, 0, -kGravity}, .planes = planes, .materials = &materials};
    double farthest = face;
    bool played_on = true;
    for (int i = 0; i < 20; ++i) {
      const HullMotion moved = move_on_hull(body, *playback, kind_, world, world.gravity, 0.05 * time_unit(),
                                            false, HullMotionSettings{.clips = settings_});
      played_on = played_on && moved.plays_clip;
      std::int32_t hint = 0;
      farthest = std::max(farthest, wall - find_lowest_point(*kind_.shape, body.orientation, planes[1].normal,
                                                             planes[1].height_of(body.position), hint)
                                               .gap);
    }
    EXPECT_LT(farthest, wall + 1e-6) << ahead;
    EXPECT_GT(farthest, face + 0.01 * radius()) << ahead;
    EXPECT_EQ(played_on, ahead > 0.05);
  }
}

TEST_F(ClipPlayer, NoneWhereItMovesTooFastOrOtherwise) {
  StatisticalBody fast = body_like_clip(0.0);
  fast.velocity *= 3.0;  // .18 g R of kinetic energy per mass
  EXPECT_FALSE(find(fast));
  StatisticalBody backwards = body_like_clip(0.0);
  backwards.velocity *= -1.0;
  EXPECT_FALSE(find(backwards));
  StatisticalBody on_its_side = body_like_clip(0.0);
  on_its_side.orientation = Quat(Eigen::AngleAxisd(0.5, Vec3::UnitY()));
  EXPECT_FALSE(find(on_its_side));
  StatisticalBody slower = body_like_clip(0.0);
  slower.velocity *= 0.5;  // a clip never gives it energy
  EXPECT_FALSE(find(slower));
}

}  // namespace
}  // namespace lodestone
