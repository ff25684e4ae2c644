#include "lod/contact/contact_impulse.h"

#include <gtest/gtest.h>

#include <memory>

#include "reference/free_rotation.h"
#include "reference/ode/ode_world.h"
#include "reference/random.h"

namespace lodestone {
namespace {

/// A body whose lowest hull vertex has just touched the plane z = 0, approaching it.
struct Touching {
  RigidState state;
  Vec3 arm;
};

Touching random_touch(const Shape& shape, RandomStream& random) {
  for (;;) {
    RigidState s;
    s.orientation = random.orientation();
    s.velocity = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 0.5)};
    s.angular_velocity = random.uniform(0, 15) * random.direction();
    const Vec3 down = s.orientation.conjugate() * Vec3(0, 0, -1);
    const int vertex = find_support(shape.hull, down);
    const Vec3 arm = s.orientation * shape.hull.vertices[vertex];
    s.position = {0, 0, -arm.z() - 1e-13};
    if ((s.velocity + s.angular_velocity.cross(arm)).z() < -0.1) return {s, arm};
  }
}

// The law that the closed form claims: dWorldStep's, with one contact (ODE sees the others only from the next
// step on).
TEST(ContactImpulse, MatchesDWorldStepInNearlyEveryRandomCase) {
  const auto shape = std::make_shared<const Shape>(make_shape("box", make_box({0.2, 0.3, 0.4})));
  int cases = 0, matches = 0;
  double worst = 0.0;
  for (const ContactLaw law :
       {ContactLaw{0.4, 0.5}, ContactLaw{0.0, 0.2}, ContactLaw{0.8, 1.0}, ContactLaw{0.3, 0.0}}) {
    MaterialTable materials;
    materials.set_law(0, 0, law);
    OdeSettings settings;
    settings.gravity.setZero();
    settings.max_contacts_per_pair = 1;
    settings.gyroscopic = false;
    settings.cfm = 1e-14;  // over the step it softens the contact: at the usual 1e-10 by some 1e-6
    OdeWorld world(settings, materials);
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
    RigidState start;
    start.position.z() = 1.0;
    const OdeBodyId body = world.add_body({.shape = shape,
                                           .mass = 1.0,
                                           .material = 0,
                                           .state = start,
                                           .geometry = OdeGeometry::trimesh,
                                           .spheres = {}});
    for (std::uint32_t i = 0; i < 2500; ++i) {
      RandomStream random(7, cases, 0);
      const Touching touching = random_touch(*shape, random);
      world.set_state(body, touching.state);
      world.step(1e-4);
      const RigidState by_ode = world.state(body);

      const RigidState& s = touching.state;
      const Mat3 inverse_inertia = inverse_inertia_world(s.orientation, *shape);
      const Mat3 response = contact_response_matrix(1.0, inverse_inertia, touching.arm);
      const Vec3 at_contact = s.velocity + s.angular_velocity.cross(touching.arm);
      const Vec3 impulse = respond_contact(response, Vec3::UnitZ(), at_contact, law);
      const Vec3 v = s.velocity + impulse,
                 w = s.angular_velocity + inverse_inertia * touching.arm.cross(impulse);
      const double speed = s.velocity.norm() + shape->radius * s.angular_velocity.norm();
      const double error =
          ((v - by_ode.velocity).norm() + shape->radius * (w - by_ode.angular_velocity).norm()) / speed;
      ++cases;
      matches += error < 1e-6;
      worst = std::max(worst, error);
    }
  }
  RecordProperty("worst_relative_error", std::to_string(worst));
  EXPECT_GE(matches, 0.999 * cases) << "worst relative error " << worst;
}

TEST(ContactImpulse, FrictionlessHitKeepsTangentialVelocityAndReversesTheNormalOne) {
  const Mat3 response = contact_response_matrix(2.0, Mat3::Zero(), {0.1, 0, -0.2});
  const Vec3 impulse = respond_contact(response, Vec3::UnitZ(), {3, 0, -1}, {0.5, 0.0});
  EXPECT_NEAR(impulse.x(), 0.0, 1e-15);
  EXPECT_NEAR(impulse.z(), 0.75, 1e-12);  // (1 + e) m v with m = 1/2
}

TEST(ContactImpulse, SlidingSphereLosesMuTimesItsNormalImpulse) {
  const double radius = 0.1, mu = 0.3, e = 0.5;
  const Mat3 inverse_inertia = Mat3::Identity() / (0.4 * radius * radius);
  const Vec3 arm(0, 0, -radius);
  const Vec3 hit =
      respond_contact(contact_response_matrix(1.0, inverse_inertia, arm), Vec3::UnitZ(), {5, 0, -1}, {e, mu});
  EXPECT_NEAR(hit.z(), 1.0 + e, 1e-12);
  EXPECT_NEAR(hit.x(), -mu * (1.0 + e), 1e-12);
}

TEST(ContactImpulse, SeparatingContactGetsNoResponse) {
  EXPECT_EQ(respond_contact(Mat3::Identity(), Vec3::UnitZ(), {1, 0, 0.1}, {0.5, 0.5}).norm(), 0.0);
  EXPECT_EQ(respond_contact(Mat3::Identity(), Vec3::UnitZ(), Vec3::Zero(), {0.5, 0.5}).norm(), 0.0);
}

// S2: nearly head-on hits.
TEST(ContactImpulse, FrameIsOrthonormalForEveryTilt) {
  for (double tilt = 0.1; tilt > 1e-17; tilt *= 0.1)
    for (const Vec3& normal :
         {Vec3::UnitX().eval(), Vec3::UnitZ().eval(), Vec3(1, 2, 3).normalized().eval()}) {
      const Mat3 frame = contact_frame(normal, -normal + tilt * normal.unitOrthogonal());
      EXPECT_LT((frame.transpose() * frame - Mat3::Identity()).norm(), 1e-12);
      EXPECT_NEAR(frame.determinant(), 1.0, 1e-12);
    }
}

}  // namespace
}  // namespace lodestone
