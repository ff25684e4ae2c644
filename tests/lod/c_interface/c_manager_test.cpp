#include <gtest/gtest.h>

#include <algorithm>

#include "tests/lod/c_interface/c_scene.h"

namespace lodestone {
namespace {

using namespace testing;

TEST(CManager, DefaultsAreThoseOfTheClasses) {
  const lodestone_settings settings = lodestone_default_settings();
  const ManagerSettings expected;
  EXPECT_EQ(settings.gravity.z, expected.gravity.z());
  EXPECT_EQ(settings.seed, expected.seed);
  EXPECT_EQ(settings.threads, expected.threads);
  EXPECT_EQ(settings.full_substeps, expected.full_substeps);
  EXPECT_EQ(settings.sleeping, expected.sleeping);
  EXPECT_EQ(settings.sleep_speed, expected.sleep.speed);
  EXPECT_EQ(settings.sleep_time, expected.sleep.time);
  EXPECT_EQ(settings.audit_ms, expected.audit_ms);
  const lodestone_policy policy = lodestone_default_policy();
  const PolicySettings usual;
  EXPECT_EQ(policy.kind, LODESTONE_POLICY_DISTANCE);
  EXPECT_EQ(policy.full_within, std::get<DistancePolicy>(usual.policy).full_within);
  EXPECT_EQ(policy.support_within, std::get<DistancePolicy>(usual.policy).support_within);
  EXPECT_EQ(policy.hysteresis, usual.hysteresis);
  EXPECT_EQ(policy.min_dwell_frames, usual.min_dwell_frames);
  EXPECT_EQ(policy.max_transitions_per_frame, usual.max_transitions_per_frame);
  EXPECT_EQ(policy.most_full, usual.most_full);
  EXPECT_EQ(policy.out_of_view_factor, usual.out_of_view_factor);
  const lodestone_viewpoint view = lodestone_default_viewpoint({1, 2, 3});
  const Viewpoint plain;
  EXPECT_EQ(view.position.z, 3.0);
  EXPECT_EQ(view.vertical_fov_rad, plain.vertical_fov_rad);
  EXPECT_EQ(view.height_px, plain.height_px);
  EXPECT_EQ(view.aspect, plain.aspect);
}

// Ground, gravity, materials, viewpoints, policies: the same by either interface.
TEST(CManager, SceneCallsDoWhatTheClassesDo) {
  CScene s;
  for (int i = 0; i < 8; ++i) s.add({0.3 * i, 0.02 * i, 0.4 + 0.05 * i});
  lodestone_viewpoint eye = lodestone_default_viewpoint({0, 0, 1});
  EXPECT_EQ(lodestone_set_viewpoints(s.c, &eye, 1), LODESTONE_OK);
  s.manager.set_viewpoints({Viewpoint{.position = {0, 0, 1}}});
  s.step(10), s.expect_same();
  lodestone_ground ramp;
  EXPECT_EQ(lodestone_add_static_box(s.c, {1, 1, 0.3}, {2, 0, 0.1}, {1, 0, 0, 0}, 0, &ramp), LODESTONE_OK);
  const GroundId box = s.manager.add_static_box({1, 1, 0.3}, {2, 0, 0.1}, Quat::Identity());
  s.step(10), s.expect_same();
  const lodestone_state moved{{2, 0.2, 0.2}, {1, 0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  EXPECT_EQ(lodestone_move_ground(s.c, ramp, &moved), LODESTONE_OK);
  s.manager.move_ground(box, at({2, 0.2, 0.2}));
  EXPECT_EQ(lodestone_set_gravity(s.c, {0, 1, -5}), LODESTONE_OK);
  s.manager.set_gravity({0, 1, -5});
  EXPECT_EQ(lodestone_set_full_substeps(s.c, 2), LODESTONE_OK);
  s.manager.set_full_substeps(2);
  s.step(10), s.expect_same();
  EXPECT_TRUE(lodestone_is_valid_ground(s.c, ramp));
  EXPECT_EQ(lodestone_remove_ground(s.c, ramp), LODESTONE_OK);
  s.manager.remove_ground(box);
  EXPECT_FALSE(lodestone_is_valid_ground(s.c, ramp));
  lodestone_policy policy = lodestone_default_policy();
  policy.kind = LODESTONE_POLICY_BUDGET_WORK, policy.budget = 500.0;
  EXPECT_EQ(lodestone_set_policy(s.c, &policy), LODESTONE_OK);
  s.manager.set_policy({.policy = WorkPolicy{500.0}});
  s.step(20), s.expect_same();
  lodestone_vec3 gravity;
  ASSERT_EQ(lodestone_get_gravity(s.c, &gravity), LODESTONE_OK);
  EXPECT_EQ(gravity.z, -5.0);
}

TEST(CManager, ReportsAndListsAreThoseOfTheStep) {
  CScene s;
  for (int i = 0; i < 5; ++i) s.add({0.5 * i, 0, 0.21});
  lodestone_viewpoint eye = lodestone_default_viewpoint({0, 0, 1});
  lodestone_set_viewpoints(s.c, &eye, 1);
  s.manager.set_viewpoints({Viewpoint{.position = {0, 0, 1}}});
  for (int step = 0; step < 90; ++step) {
    lodestone_report report;
    ASSERT_EQ(lodestone_step(s.c, kFrame, &report), LODESTONE_OK);
    const StepReport& expected = s.manager.step(kFrame);
    EXPECT_EQ(report.step, expected.step);
    EXPECT_EQ(report.full, expected.full);
    EXPECT_EQ(report.support, expected.support);
    EXPECT_EQ(report.asleep, expected.asleep);
    EXPECT_EQ(report.promotions, expected.promotions);
    EXPECT_EQ(report.counters.levels_considered, expected.counters.levels_considered);
    const auto expect_list = [&](const auto& get, std::span<const BodyId> list) {
      const lodestone_body* bodies = nullptr;
      std::size_t count = 99;
      ASSERT_EQ(get(s.c, &bodies, &count), LODESTONE_OK);
      ASSERT_EQ(count, list.size());
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(bodies[i].index, list[i].index);
    };
    expect_list(lodestone_moved, s.manager.moved());
    expect_list(lodestone_fell_asleep, s.manager.fell_asleep());
    expect_list(lodestone_woke, s.manager.woke());
    const lodestone_rung_change* changes = nullptr;
    std::size_t count = 99;
    ASSERT_EQ(lodestone_rung_changes(s.c, &changes, &count), LODESTONE_OK);
    ASSERT_EQ(count, s.manager.rung_changes().size());
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_EQ(int(changes[i].to), int(s.manager.rung_changes()[i].to));
  }
}

TEST(CManager, ASnapshotFitsItsBufferAndGoesOnAlike) {
  CScene s;
  for (int i = 0; i < 4; ++i) s.add({0.3 * i, 0, 0.5});
  s.step(10);
  std::size_t size = 0;
  ASSERT_EQ(lodestone_snapshot(s.c, nullptr, 0, &size), LODESTONE_OK);
  std::vector<std::byte> bytes(size);
  EXPECT_EQ(lodestone_snapshot(s.c, bytes.data(), size - 1, &size), LODESTONE_BAD_INPUT);
  ASSERT_EQ(lodestone_snapshot(s.c, bytes.data(), bytes.size(), &size), LODESTONE_OK);
  s.step(20);
  const std::uint64_t then = s.c_hash();
  ASSERT_EQ(lodestone_restore(s.c, bytes.data(), bytes.size(), nullptr, 0), LODESTONE_OK)
      << lodestone_error();
  for (int i = 0; i < 20; ++i) lodestone_step(s.c, kFrame, nullptr);
  EXPECT_EQ(s.c_hash(), then);
  EXPECT_EQ(lodestone_restore(s.c, bytes.data(), bytes.size() / 2, nullptr, 0), LODESTONE_BAD_INPUT);
  EXPECT_EQ(s.c_hash(), then);
}

TEST(CManager, CallbacksAreGivenTheirContext) {
  struct Seen {
    int zones = 0, lines = 0, depth = 0;
  } seen;
  CScene s;
  s.add({0, 0, 0.5});
  ASSERT_EQ(
      lodestone_set_profile(
          s.c, [](void* c, const char*) { ++static_cast<Seen*>(c)->zones, ++static_cast<Seen*>(c)->depth; },
          [](void* c, const char*) { --static_cast<Seen*>(c)->depth; }, &seen),
      LODESTONE_OK);
  lodestone_step(s.c, kFrame, nullptr);
  EXPECT_GT(seen.zones, 3);
  EXPECT_EQ(seen.depth, 0);
  ASSERT_EQ(
      lodestone_draw(
          s.c,
          [](void* c, lodestone_vec3, lodestone_vec3, lodestone_color) { ++static_cast<Seen*>(c)->lines; },
          nullptr, &seen, nullptr),
      LODESTONE_OK);
  EXPECT_EQ(seen.lines, 18);  // the edges of a box, and a diagonal of each side
}

TEST(CManager, BadSettingsAreRefusedByName) {
  lodestone_manager* manager = nullptr;
  const auto refused = [&](const auto& change) {
    lodestone_settings settings = lodestone_default_settings();
    change(settings);
    EXPECT_EQ(lodestone_create(&settings, &manager), LODESTONE_BAD_INPUT);
    EXPECT_EQ(manager, nullptr);
    return std::string(lodestone_error());
  };
  EXPECT_EQ(refused([](lodestone_settings& s) { s.threads = 0; }), "threads: found 0, expected 1 or more");
  EXPECT_NE(refused([](lodestone_settings& s) { s.model = lodestone_model(7); }).find("found 7"),
            std::string::npos);
  EXPECT_NE(refused([](lodestone_settings& s) { s.policy.kind = lodestone_policy_kind(9); }).find("found 9"),
            std::string::npos);
  EXPECT_NE(refused([](lodestone_settings& s) { s.policy.hysteresis = -1; }).find("hysteresis"),
            std::string::npos);
  EXPECT_EQ(lodestone_create(nullptr, nullptr), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_step(nullptr, 0.01, nullptr), LODESTONE_BAD_INPUT);
  lodestone_destroy(nullptr);
}

}  // namespace
}  // namespace lodestone
