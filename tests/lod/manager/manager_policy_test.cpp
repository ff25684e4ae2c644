// What is said of a body's rung, and of wrong groups, viewpoints and policies.
#include <gtest/gtest.h>

#include <set>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

using namespace testing;

Manager still_world(const PolicySettings& policy) {
  ManagerSettings settings = unmeasured(policy);
  settings.gravity = Vec3::Zero();
  return Manager(settings);
}

TEST(Explain, BeforeItsFirstStepNothingIsSaidYet) {
  Manager manager = still_world({});
  const BodyId body = manager.add_body({.shape = sphere_shape(0.5)});
  EXPECT_FALSE(manager.explain(body).placed);
  EXPECT_EQ(manager.why(body), "at no level yet: the next step chooses one");
  manager.step(kFrame);
  EXPECT_TRUE(manager.explain(body).placed);
  EXPECT_EQ(manager.why(body), "support: there is no viewpoint");
}

// Of a policy that has none nobody would know why no body is full.
TEST(Explain, ThatThereIsNoViewpointIsLoggedOnce) {
  Manager manager = still_world({});
  std::vector<std::string> lines;
  manager.set_log([&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) lines.emplace_back(text);
  });
  manager.add_body({.shape = sphere_shape(0.5), .level = LevelChoice::full});
  manager.step(kFrame);  // nothing is the policy's
  EXPECT_TRUE(lines.empty());
  const BodyId body = manager.add_body({.shape = sphere_shape(0.5), .state = testing::at({3, 0, 0})});
  for (int i = 0; i < 3; ++i) manager.step(kFrame);
  EXPECT_EQ(lines,
            std::vector<std::string>{"step 2: there is no viewpoint, so to the policy every body is far"});
  view_from(manager, Vec3(100, 0, 0));
  manager.step(kFrame);
  EXPECT_EQ(manager.why(body), "support: far from every viewpoint");
  EXPECT_EQ(lines.size(), 1U);
}

// The size in the picture, by hand: diameter over distance, in pixels of the field of view.
TEST(Explain, PixelsAreThoseOfThePicture) {
  RandomStream random(4, 0, 0);
  for (int i = 0; i < 40; ++i) {
    Manager manager = still_world({});
    const double radius = random.uniform(0.1, 1.0), fov = random.uniform(0.3, 2.0),
                 height = random.uniform(200, 2000);
    const Vec3 place = random.uniform(3, 40) * random.direction();
    const BodyId body = manager.add_body({.shape = sphere_shape(radius), .state = testing::at(place)});
    manager.set_viewpoints(
        {Viewpoint{.position = {0, 0, 0}, .direction = place, .vertical_fov_rad = fov, .height_px = height}});
    manager.step(kFrame);
    const Why why = manager.explain(body);
    EXPECT_NEAR(why.pixels, 2 * radius / place.norm() * height / (2 * std::tan(fov / 2)), 1e-6 * why.pixels);
    EXPECT_NEAR(why.distance_m, place.norm() - radius, 1e-9);
    EXPECT_TRUE(why.in_view);
    manager.set_viewpoints({Viewpoint{.position = {0, 0, 0}, .direction = -place}});
    manager.step(kFrame);
    EXPECT_FALSE(manager.explain(body).in_view);
  }
}

// A sleeper is looked at again where any view zooms, not only the one with the coarsest picture.
TEST(Policies, EveryViewMayZoom) {
  for (const bool scope_first : {true, false}) {
    PolicySettings policy;
    policy.policy = ProjectedSizePolicy{200.0};
    Manager manager = still_world(policy);
    const BodyId body = manager.add_body({.shape = sphere_shape(0.2), .state = testing::at({10, 0, 0})});
    const auto look = [&](double fov) {
      const Viewpoint eye{.direction = Vec3::UnitX(), .vertical_fov_rad = 1.0},
          scope{.direction = Vec3::UnitX(), .vertical_fov_rad = fov};
      manager.set_viewpoints({scope_first ? scope : eye, scope_first ? eye : scope});
    };
    look(0.9);
    manager.sleep(body);
    for (int i = 0; i < 5; ++i) manager.step(kFrame);
    ASSERT_EQ(manager.rung(body), Rung::support);
    ASSERT_TRUE(manager.asleep(body));
    look(0.05);
    for (int i = 0; i < 5; ++i) manager.step(kFrame);
    EXPECT_GT(manager.explain(body).pixels, 200.0);
    EXPECT_EQ(manager.rung(body), Rung::full);
  }
}

TEST(Explain, TheDwellThatIsLeftCountsDown) {
  PolicySettings policy;
  policy.policy = DistancePolicy{3.0}, policy.min_dwell_frames = 10;
  Manager manager = still_world(policy);
  const BodyId body = manager.add_body({.shape = sphere_shape(0.5)});
  view_from(manager, {50, 0, 0});
  for (int i = 0; i < 20; ++i) manager.step(kFrame);
  EXPECT_EQ(manager.explain(body).dwell_left_frames, 0);
  view_from(manager, {1, 0, 0});
  manager.step(kFrame);
  ASSERT_EQ(manager.rung(body), Rung::full);
  view_from(manager, {50, 0, 0});
  int left = manager.explain(body).dwell_left_frames;
  EXPECT_GE(left, 9);
  for (; manager.rung(body) == Rung::full && left > -5; --left) {
    EXPECT_LE(manager.explain(body).dwell_left_frames, std::max(0, left));
    manager.step(kFrame);
  }
  EXPECT_NE(manager.rung(body), Rung::full);
  EXPECT_NEAR(left, 0, 1);
}

// A body costs more on a higher rung, and nothing that could be told of while it sleeps.
TEST(Explain, CostsRiseWithTheRung) {
  Manager manager = still_world({});
  const auto box = box_shape({0.3, 0.3, 0.3});
  const BodyId support = add(manager, box, testing::at({0, 0, 0}, {1, 0, 0})),
               full = add(manager, box, testing::at({9, 0, 0}, {1, 0, 0}), LevelChoice::full);
  manager.step(kFrame);
  EXPECT_GT(manager.explain(full).cost_work, manager.explain(support).cost_work);
  EXPECT_GT(manager.explain(support).cost_work, 0.0);
  const double awake = manager.explain(support).cost_work;
  manager.sleep(support);
  EXPECT_LT(manager.explain(support).cost_work, awake);
  EXPECT_EQ(manager.explain(support).predicted_error, 0.0);
  EXPECT_GT(manager.explain(full).predicted_error, 0.0);
}

// What touches another is out of place by how deep the two are in each other, too: most at `tables`.
TEST(Explain, ErrorsAreGreaterAmongOthers) {
  const auto error = [](LevelChoice level, double apart) {
    Manager manager({.sleeping = false, .signatures = testing::coarse_signature});
    manager.add_plane(Vec3::UnitZ(), 0.0);
    manager.set_viewpoints({Viewpoint{.position = {0, -3, 1}, .direction = Vec3(0, 1, 0)}});
    const auto box = box_shape({0.3, 0.3, 0.3});
    const BodyId body = add(manager, box, testing::at({0, 0, 0.15}), level);
    add(manager, box, testing::at({0, 0, 0.45 + apart}), level);
    for (int i = 0; i < 3; ++i) manager.step(kFrame);
    return manager.explain(body).predicted_error_pixels;
  };
  const double tables = error(LevelChoice::tables, 0.0) - error(LevelChoice::tables, 5.0),
               support = error(LevelChoice::support, 0.0) - error(LevelChoice::support, 5.0);
  EXPECT_GT(support, 0.0);
  EXPECT_GT(tables, 4.0 * support);
}

// Neither the dwell nor the cap on changes keeps a body on a rung that its caller has closed.
TEST(LevelChoices, WhatIsNotToBeFullLeavesInTheNextStep) {
  const auto refused = [](Manager& manager, BodyId body, bool range) {
    if (range)
      manager.set_rung_range(body, Rung::tables, Rung::support);
    else
      manager.set_level(body, LevelChoice::statistical);
  };
  for (const bool range : {false, true}) {
    Manager manager =
        on_floor({.policy = {.policy = DistancePolicy{.full_within = 4.0, .support_within = 10.0},
                             .max_transitions_per_frame = 1},
                  .signatures = coarse_signature});
    view_from(manager, {0, 0, 1});
    std::vector<BodyId> bodies;
    for (int i = 0; i < 10; ++i)
      bodies.push_back(
          add(manager, box_shape({0.3, 0.3, 0.3}), testing::at({0.5 * (i % 5), 0.5 * (i / 5), 0.2})));
    manager.step(kFrame);
    for (const BodyId body : bodies) ASSERT_EQ(manager.level(body), Level::full);
    for (const BodyId body : bodies) refused(manager, body, range);
    manager.step(kFrame);
    for (const BodyId body : bodies) EXPECT_EQ(manager.level(body), Level::statistical) << range;
  }
}

TEST(RuleTexts, EachIsItsOwn) {
  std::set<std::string_view> texts;
  for (int rule = 0; rule <= int(Rule::paused); ++rule) {
    EXPECT_FALSE(text_of(Rule(rule)).empty()) << rule;
    EXPECT_TRUE(texts.insert(text_of(Rule(rule))).second) << text_of(Rule(rule));
  }
  EXPECT_EQ(text_of(Why{.rung = Rung::full, .rule = Rule::near, .placed = true}), "full: near a viewpoint");
}

TEST(ManagerGroups, WrongOnesAreRefusedByWords) {
  Manager manager = still_world({});
  const auto box = box_shape({0.3, 0.3, 0.3});
  const std::vector<BodyId> bodies = {add(manager, box, testing::at({0, 0, 0})),
                                      add(manager, box, testing::at({2, 0, 0}))};
  const std::vector<BodyId> twice = {bodies[0], bodies[0]};
  const auto refused = [](const std::string& found) {
    return "a group: found " + found + ", expected at least one body, none twice and none in another group";
  };
  EXPECT_EQ(message_of([&] { manager.make_group({}); }), refused("no body"));
  EXPECT_EQ(message_of([&] { manager.make_group(twice); }), refused("body 0 twice"));
  GroupJoints half;
  half.before_demotion = [](GroupId) {};
  EXPECT_EQ(message_of([&] { manager.make_group(bodies, half); }),
            "a group's joints: found one function alone, expected both or none");
  const GroupId group = manager.make_group(bodies);
  EXPECT_EQ(manager.explain(bodies[0]).group, group);
  EXPECT_EQ(message_of([&] { manager.make_group(bodies); }), refused("body 0, which is in a group already"));
  manager.dissolve_group(group);
  EXPECT_FALSE(manager.explain(bodies[0]).group);
  EXPECT_EQ(
      message_of([&] { manager.dissolve_group(group); }),
      "a group's id: found index 0, generation 1, expected one that make_group returned and that was not "
      "dissolved");
  EXPECT_NO_THROW(manager.make_group(bodies));
}

TEST(ManagerViewpoints, OneThatIsWrongChangesNone) {
  Manager manager = still_world({});
  const BodyId body = manager.add_body({.shape = sphere_shape(0.5), .state = testing::at({3, 0, 0})});
  view_from(manager, {0, 0, 0});
  manager.step(kFrame);
  const Vec3 bad[] = {{1, 0, 0}, {NAN, 0, 0}};
  EXPECT_THROW(manager.set_viewpoints(bad), InputError);
  EXPECT_THROW(manager.set_viewpoints({Viewpoint{.up = {0, 0, 0}}}), InputError);
  manager.step(kFrame);
  EXPECT_NEAR(manager.explain(body).distance_m, 2.5, 1e-9);
  PolicySettings policy;
  policy.hysteresis = NAN;
  EXPECT_THROW(manager.set_policy(policy), InputError);
  policy.hysteresis = 0.1, policy.policy = DistancePolicy{1.0};
  manager.set_policy(policy);
  for (int i = 0; i < 40; ++i) manager.step(kFrame);
  EXPECT_EQ(manager.rung(body), Rung::support);
}

}  // namespace
}  // namespace lodestone
