#include "lod/contact/ground_meetings.h"

#include <gtest/gtest.h>

#include "reference/random.h"
#include "tests/lod/contact/crowd_scene.h"

namespace lodestone {
namespace {

using testing::at;
using testing::box_shape;

constexpr double kMeetingStep = 0.01, kMeetingMargin = 0.002;

struct GroundScene : testing::CrowdScene {
  Participant add_cube(const RigidState& state) {
    const Participant p = add(box_shape({0.2, 0.2, 0.2}), 1.0, state);
    participants.push_back(p);
    solver_bodies.push_back({state.velocity, state.angular_velocity});
    return p;
  }
  void find(int threads = 1) {
    world.planes = planes;
    meetings.find(scene(), participants, solver_bodies, faces, kMeetingStep, kMeetingMargin,
                  make_job_runner(threads));
  }

  std::vector<HalfSpace> planes = {{Vec3::UnitZ(), 0.0}};
  std::vector<Participant> participants;
  std::vector<SolverBody> solver_bodies;
  GroundMeetings meetings;
};

TEST(GroundMeetings, WhoLiesOnThePlaneMeetsItInFourPoints) {
  GroundScene scene;
  scene.add_cube(at({0, 0, 0.1}));
  scene.find();
  const auto met = scene.meetings.of(0);
  ASSERT_EQ(met.size(), 1U);
  EXPECT_EQ(met[0].plane, &scene.planes[0]);
  EXPECT_NEAR(met[0].height, 0.1, 1e-12);
  EXPECT_EQ(met[0].found.count, 4);
  for (const HullContact& contact : met[0].found.contact) EXPECT_NEAR(contact.gap, 0.0, 1e-12);
}

// Within R of it, and what it falls and turns in the step.
TEST(GroundMeetings, WhoIsFarMeetsNoneUnlessHeComesDown) {
  const double radius = box_shape({0.2, 0.2, 0.2})->radius;
  for (const double speed : {0.0, 5.0}) {
    GroundScene scene;
    scene.add_cube(at({0, 0, radius + 0.04}, {0, 0, -speed}));
    scene.find();
    EXPECT_EQ(scene.meetings.of(0).size(), speed > 0.0 ? 1U : 0U);
  }
}

TEST(GroundMeetings, InACornerEachPlaneIsMet) {
  GroundScene scene;
  scene.planes.push_back({Vec3::UnitX(), 0.0});
  scene.faces.faces = {{Vec3::UnitY(), 0.0}};
  scene.faces.run = {{0, 1}};
  scene.add_cube(at({0.1, 0.1, 0.1}));
  scene.find();
  const auto met = scene.meetings.of(0);
  ASSERT_EQ(met.size(), 3U);
  EXPECT_EQ(met[0].number, 0U);
  EXPECT_EQ(met[1].number, 1U);
  EXPECT_EQ(met[2].number, kFirstFace);
}

TEST(GroundMeetings, WhoSleepsOrIsFullOrCameAfterMeetsNone) {
  GroundScene scene;
  scene.add_cube(at({0, 0, 0.1}));
  scene.add_cube(at({1, 0, 0.1}));
  scene.bodies[0].motion = Motion::asleep;
  scene.participants.push_back(scene.add_full(box_shape({0.2, 0.2, 0.2}), 1.0, at({2, 0, 0.1})));
  scene.solver_bodies.emplace_back();
  scene.find();
  EXPECT_TRUE(scene.meetings.of(0).empty());
  EXPECT_EQ(scene.meetings.of(1).size(), 1U);
  EXPECT_TRUE(scene.meetings.of(2).empty());
  EXPECT_TRUE(scene.meetings.of(3).empty());
}

TEST(GroundMeetings, AnyNumberOfThreadsFindsTheSamePoints) {
  GroundScene one, two;
  for (GroundScene* scene : {&one, &two}) {
    scene->planes.push_back({Vec3(0, 0.6, 0.8), 0.0});
    for (std::uint64_t i = 0; i < 500; ++i) {
      RandomStream random(8, i, 0);
      const Quat turned = random.orientation();
      scene->add_cube(at({double(i), 0, random.uniform(0.0, 0.3)}, Vec3::Zero(), Vec3::Zero(), turned));
    }
  }
  one.find(1), two.find(2);
  int points = 0;
  for (std::size_t i = 0; i < one.participants.size(); ++i) {
    const auto by_one = one.meetings.of(i), by_two = two.meetings.of(i);
    ASSERT_EQ(by_one.size(), by_two.size());
    for (std::size_t k = 0; k < by_one.size(); ++k) {
      ASSERT_EQ(by_one[k].found.count, by_two[k].found.count);
      for (std::size_t c = 0; c < std::size_t(by_one[k].found.count); ++c, ++points)
        EXPECT_EQ(by_one[k].found.contact[c].arm, by_two[k].found.contact[c].arm);
    }
  }
  EXPECT_GT(points, 300);
}

}  // namespace
}  // namespace lodestone
