#include "signature/measure/collision_trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference/free_rotation.h"
#include "reference/random.h"

namespace lodestone {
namespace {

std::shared_ptr<const Shape> box() {
  static const auto shape = std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  return shape;
}

CollisionConfiguration random_configuration(RandomStream& random) {
  const double alpha = random.uniform(0.0, std::numbers::pi / 2);
  CollisionConfiguration c{.speed = std::cos(alpha), .spin = std::sin(alpha)};
  c.theta = random.uniform(0.0, 1.5), c.phi = random.uniform(0.0, std::numbers::pi),
  c.psi = random.uniform(0.0, 2.0 * std::numbers::pi);
  return c;
}

// Velocities after the trial over s, in (e1, e2, e3); the spin times R.
struct After {
  Vec3 linear, angular;
};

After after(const CollisionEnd& end, const CollisionConfiguration& c, double restitution) {
  const double speed = c.speed / c.speed_unit();
  return {Vec3(restitution * speed * std::cos(c.theta), speed * std::sin(c.theta), 0.0) +
              end.response.head<3>().cast<double>(),
          end.response.tail<3>().cast<double>()};
}

// A sphere's collision in closed form: one contact point below the centre.
TEST(CollisionTrial, SphereHasExactRestitutionAndFriction) {
  const auto sphere = std::make_shared<const Shape>(make_sphere_shape(0.1));
  const ContactLaw law{0.6, 0.25};
  CollisionTrial trial(sphere, law, TrialEnd::leaves_plane, 1e-9);
  for (std::uint32_t i = 0; i < 200; ++i) {
    RandomStream random(3, i, 0);
    const CollisionConfiguration c = random_configuration(random);
    const auto one = trial.run(c, random.orientation()), other = trial.run(c, random.orientation());
    ASSERT_TRUE(one && other);
    EXPECT_LT((one->end.response - other->end.response).norm(), 1e-5) << "no spread";
    EXPECT_EQ(one->impulses, 1);

    const double s = c.speed_unit(), v = c.speed / s, w = c.spin / s;
    const Vec3 along(-std::cos(c.theta), std::sin(c.theta), 0.0), across(0.0, 0.0, 1.0);
    const Vec3 axis = std::cos(c.phi) * along +
                      std::sin(c.phi) * (std::cos(c.psi) * across.cross(along) + std::sin(c.psi) * across);
    const Vec3 arm(-1.0, 0.0, 0.0), slip = v * along + (w * axis).cross(arm) - v * along.x() * Vec3::UnitX();
    const double normal_impulse = (1.0 + law.restitution) * v * std::cos(c.theta);
    const double tangential = std::min(law.friction * normal_impulse, slip.norm() / 3.5);  // 1/m + R²/I = 7/2
    const Vec3 impulse = normal_impulse * Vec3::UnitX() - tangential * slip.normalized();
    const After found = after(one->end, c, law.restitution);
    EXPECT_LT((found.linear - (v * along + impulse)).norm(), 1e-5) << i;
    EXPECT_LT((found.angular - (w * axis + 2.5 * arm.cross(impulse))).norm(), 1e-5) << i;
  }
}

// A vertex of a box strikes without friction: the impulse is (1 + e) u / (1/m + (r × n)·I⁻¹(r × n)).
TEST(CollisionTrial, BoxVertexWithoutFrictionFollowsTheClosedForm) {
  const ContactLaw law{0.5, 0.0};
  CollisionTrial trial(box(), law, TrialEnd::first_impulse, 1e-9);
  ContactTime contact_time(*box());
  const Vec3 n = Vec3::UnitZ();
  for (std::uint32_t i = 0; i < 200; ++i) {
    RandomStream random(4, i, 0);
    RigidState state;
    state.orientation = random.orientation();
    state.position.z() = box()->radius;
    state.velocity = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, -0.2)};
    state.angular_velocity = 4.0 * random.direction();
    RigidState before = state;
    ASSERT_TRUE(contact_time.advance(before));
    const Vec3 arm = contact_time.find_lowest(before).arm;
    const Mat3 inverse_inertia = inverse_inertia_world(before.orientation, *box());
    const Vec3 turning = inverse_inertia * arm.cross(n);
    const double approach = -(before.velocity + before.angular_velocity.cross(arm)).z();
    const double impulse = (1.0 + law.restitution) * approach / (1.0 + turning.cross(arm).dot(n));

    const auto outcome = trial.collide(state);
    ASSERT_TRUE(outcome);
    EXPECT_NEAR(outcome->approach,
                approach / std::hypot(before.velocity.norm(), box()->radius * before.angular_velocity.norm()),
                1e-9);
    EXPECT_LT((state.velocity - before.velocity - impulse * n).norm(), 1e-5) << i;
    EXPECT_LT((state.angular_velocity - before.angular_velocity - impulse * turning).norm(), 1e-4) << i;
  }
}

TEST(CollisionTrial, OneThatLeavesThePlaneNeverTouchesAgain) {
  CollisionTrial first(box(), {0.4, 0.5}, TrialEnd::first_impulse, 1e-9),
      leaves(box(), {0.4, 0.5}, TrialEnd::leaves_plane, 1e-9);
  ContactTime contact_time(*box());
  int into_plane_first = 0, touches_again = 0, more_impulses = 0;
  constexpr int kTrials = 400;
  for (std::uint32_t i = 0; i < kTrials; ++i) {
    RandomStream random(5, i, 0);
    const CollisionConfiguration c = random_configuration(random);
    const Quat orientation = random.orientation();
    const auto a = first.run(c, orientation), b = leaves.run(c, orientation);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->first.response, b->first.response);
    EXPECT_LE(b->end.energy_ratio, 1.0 + 1e-6);
    into_plane_first += a->end.moves_into_plane;
    touches_again += b->end.moves_into_plane;
    more_impulses += b->impulses > 1;
  }
  EXPECT_GT(into_plane_first, kTrials / 5);
  EXPECT_EQ(touches_again, 0);
  EXPECT_GE(more_impulses, into_plane_first);
}

// The response scales exactly above bounce_vel, which the three-dimensional tables rest on.
TEST(CollisionTrial, ResponseIsTheSameAtEverySpeed) {
  CollisionTrial trial(box(), {0.4, 0.5}, TrialEnd::first_impulse, 1e-9);
  for (std::uint32_t i = 0; i < 100; ++i) {
    RandomStream random(6, i, 0);
    CollisionConfiguration c = random_configuration(random);
    const Quat orientation = random.orientation();
    const auto slow = trial.run(c, orientation);
    c.speed *= 37.0, c.spin *= 37.0;
    const auto fast = trial.run(c, orientation);
    ASSERT_TRUE(slow && fast);
    EXPECT_LT((slow->end.response - fast->end.response).norm(), 1e-5)
        << i;  // the touch itself is found to 1e-6 R
  }
}

TEST(CollisionTrial, SlowApproachesDoNotBounce) {
  CollisionTrial odes(box(), {0.4, 0.0}, TrialEnd::first_impulse, 0.05),
      dead(box(), {0.0, 0.0}, TrialEnd::first_impulse, 0.05);
  CollisionConfiguration c{.speed = 0.04, .spin = 0.0};
  const Quat orientation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  EXPECT_LT((after(odes.run(c, orientation)->end, c, 0.4).linear -
             after(dead.run(c, orientation)->end, c, 0.0).linear)
                .norm(),
            1e-6);
  c.speed = 0.06;
  EXPECT_GT((after(odes.run(c, orientation)->end, c, 0.4).linear -
             after(dead.run(c, orientation)->end, c, 0.0).linear)
                .norm(),
            1e-2);
}

}  // namespace
}  // namespace lodestone
