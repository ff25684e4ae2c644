#include "lod/support/contact_at_once.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "lod/support/support_model.h"
#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"

namespace lodestone {
namespace {

// Those of `support`, and the coarser ones of `tables`.
const SupportSettings kFine{}, kCoarse{.coarse = true,
                                       .step_at_once = 0.2,
                                       .solver = {.sweeps = 4, .tolerance = 1e-2},
                                       .energy_bounded = false};

// A box of .2 × .3 × .4 m and the plane z = 0.
class ContactAtOnce : public ::testing::TestWithParam<SupportSettings> {
 protected:
  static constexpr double kStrength = 9.81, kFrame = 1.0 / 60;

  ContactAtOnce() {
    materials_.replace(0, {.restitution = 0.4, .friction = 0.5});
    world_.planes = planes_;
    world_.materials = &materials_;
  }
  StatisticalBody lying() const {
    StatisticalBody body;
    body.position = {0, 0, 0.2};
    return body;
  }
  ContactTally step(StatisticalBody& body) const {
    return step_support_body(body, kind_, world_, kFrame, settings_);
  }
  // J/kg
  double energy(const StatisticalBody& body) const {
    return kinetic_energy(body, *kind_.shape) + kStrength * body.position.z();
  }
  double lowest(const StatisticalBody& body) const {
    double z = 1e300;
    for (const Vec3& vertex : kind_.shape->hull.vertices)
      z = std::min(z, (body.position + body.orientation * vertex).z());
    return z;
  }

  const SupportSettings settings_ = GetParam();
  const BodyKind kind_ =
      make_body_kind(std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4}))));
  MaterialTable materials_;
  const std::vector<HalfSpace> planes_{{.normal = Vec3::UnitZ(), .offset = 0.0}};
  StepWorld world_;
};

TEST_P(ContactAtOnce, WhatLiesStaysWhereItIs) {
  StatisticalBody body = lying();
  for (int i = 0; i < 600; ++i) step(body);
  EXPECT_LT((body.position - lying().position).norm(), 1e-9);
  EXPECT_LT(body.velocity.norm() + body.spin.norm(), 1e-9);
}

// v² / 2 μ g.
TEST_P(ContactAtOnce, WhatSlidesStopsWhereFrictionSays) {
  StatisticalBody body = lying();
  body.velocity.x() = 1.0;
  for (int i = 0; i < 60; ++i) EXPECT_GT(step(body).contacts, 0);
  EXPECT_LT(body.velocity.norm(), 1e-6);
  EXPECT_NEAR(body.position.x(), 1.0 / (2.0 * 0.5 * kStrength), 0.01);
}

// However it comes down it ends at rest on the plane, and at no time has more energy than it began with.
TEST_P(ContactAtOnce, ADropComesToRestOnThePlane) {
  for (std::uint32_t drop = 0; drop < 100; ++drop) {
    RandomStream random(83, drop, 0);
    StatisticalBody body;
    body.position = {0, 0, 1.0};
    body.orientation = random.orientation();
    body.velocity = random.uniform(0, 1) * random.direction();
    body.spin = spin_of(body.orientation, random.uniform(0, 4) * random.direction(), *kind_.shape);
    const double before = energy(body);
    for (int i = 0; i < 600; ++i) {
      step(body);
      ASSERT_LT(energy(body), 1.01 * before) << drop << ", step " << i;
      ASSERT_GT(lowest(body), -1e-4) << drop << ", step " << i;
    }
    EXPECT_LT(kinetic_energy(body, *kind_.shape), 2e-3) << drop;
  }
}

// Of boxes of 1 mm to 10 m that lose little or nothing, in steps of 1/30 to 1/240 s, none ends up with more
// energy, by a twentieth, than it came down with.
TEST_P(ContactAtOnce, GainsNoEnergyOfAnySize) {
  for (std::uint32_t drop = 0; drop < 600; ++drop) {
    RandomStream random(84, drop, 0);
    const double size = std::pow(10.0, random.uniform(-3.0, 1.0)), unit = std::sqrt(9.81 * size);
    const Vec3 sides = size * Vec3(random.uniform(0.25, 1.0), random.uniform(0.25, 1.0), 1.0);
    const BodyKind kind = make_body_kind(std::make_shared<const Shape>(make_shape("box", make_box(sides))));
    ASSERT_TRUE(kind.angular);
    MaterialTable materials;
    materials.replace(0,
                      {.restitution = drop % 2 ? 1.0 : 0.4, .friction = std::array{0.0, 0.3, 2.0}[drop % 3]});
    const std::vector<HalfSpace> planes{{.normal = Vec3::UnitZ(), .offset = 0.0}};
    StepWorld world;
    world.planes = planes, world.materials = &materials;
    StatisticalBody body;
    body.position.z() = random.uniform(1.0, 3.0) * size;
    body.orientation = random.orientation();
    body.velocity = random.uniform(0.0, 2.0) * unit * random.direction();
    body.spin =
        spin_of(body.orientation, random.uniform(0.0, 6.0) * unit / size * random.direction(), *kind.shape);
    const auto energy = [&] { return kinetic_energy(body, *kind.shape) + 9.81 * body.position.z(); };
    const double before = energy(), frame = 1.0 / (30 << drop % 4);
    for (int i = 0; i < 600; ++i) {
      step_support_body(body, kind, world, frame, settings_);
      ASSERT_LT(energy(), 1.05 * before) << drop << ", step " << i << ", size " << size;
    }
  }
}

// Off an edge it tips as far as in steps that are divided, to the face beside it.
TEST_P(ContactAtOnce, WhatStandsOnAnEdgeTipsToTheSideThatItLeansTo) {
  for (const double lean : {-0.1, 0.1}) {
    StatisticalBody body = lying();
    body.orientation = rotation_from_vector({0, std::atan2(0.1, 0.2) + lean, 0});
    body.position.z() -= lowest(body);
    for (int i = 0; i < 240; ++i) step(body);
    const double up = (body.orientation * Vec3::UnitZ()).z();
    EXPECT_NEAR(up, lean < 0.0 ? 1.0 : 0.0, 0.05) << lean;
  }
}

INSTANTIATE_TEST_SUITE_P(Settings, ContactAtOnce, ::testing::Values(kFine, kCoarse));

// The floor and both walls of a corner: what is pushed into it stays within all three.
TEST(InTheCornerOfARoom, ABoxMeetsEachWall) {
  for (const double push : {0.0, 500.0})  // N
    for (const double yaw : {0.1, 0.6}) {
      Manager manager(testing::unmeasured());
      manager.add_plane(Vec3::UnitZ(), 0.0);
      manager.add_plane(-Vec3::UnitX(), 0.0), manager.add_plane(-Vec3::UnitY(), 0.0);
      const auto box = testing::box_shape({0.4, 0.4, 0.4});
      const BodyId crate =
          manager.add_body({.shape = box,
                            .state = {.position = {-0.6, -0.7, 0.21},
                                      .orientation = Quat(Eigen::AngleAxisd(yaw, Vec3::UnitZ())),
                                      .velocity = {3, 3, 0}},
                            .level = LevelChoice::support});
      double deepest = 0.0;  // m
      for (int step = 0; step < 120; ++step) {
        if (push > 0.0) manager.add_force(crate, Vec3(push, push, 0.0));
        manager.step(testing::kFrame);
        const RigidState state = manager.state(crate);
        for (const Vec3& corner : box->hull.vertices) {
          const Vec3 at = state.position + state.orientation * corner;
          deepest = std::max({deepest, at.x(), at.y(), -at.z()});
        }
      }
      EXPECT_LT(deepest, 0.01) << push << ' ' << yaw;
    }
}

}  // namespace
}  // namespace lodestone
