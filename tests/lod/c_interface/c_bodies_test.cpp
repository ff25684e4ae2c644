#include <gtest/gtest.h>

#include "tests/lod/c_interface/c_scene.h"

namespace lodestone {
namespace {

using namespace testing;

// Whatever is done to bodies by either interface: the same states to the bit.
TEST(CBodies, EachCallDoesWhatTheClassesDo) {
  CScene s;
  for (int i = 0; i < 6; ++i)
    s.add({0.25 * i, 0.1, 0.3 + 0.1 * i}, i % 2 ? LevelChoice::full : LevelChoice::automatic);
  s.step(10);
  s.expect_same();
  const lodestone_body body = s.c_bodies[1];
  const BodyId id = s.bodies[1];
  EXPECT_EQ(lodestone_add_force(s.c, body, {10, 0, 300}, {1, 0, 0}), LODESTONE_OK);
  s.manager.add_force(id, {10, 0, 300}, {1, 0, 0});
  EXPECT_EQ(lodestone_add_force_at(s.c, body, {0, 50, 0}, {0.2, 0, 0.5}), LODESTONE_OK);
  s.manager.add_force_at(id, {0, 50, 0}, {0.2, 0, 0.5});
  s.step(3), s.expect_same();
  EXPECT_EQ(lodestone_add_impulse(s.c, s.c_bodies[0], {1, 2, 30}, {0, 0, 0.3}), LODESTONE_OK);
  s.manager.add_impulse(s.bodies[0], {1, 2, 30}, {0, 0, 0.3});
  EXPECT_EQ(lodestone_sleep(s.c, s.c_bodies[2]), LODESTONE_OK);
  s.manager.sleep(s.bodies[2]);
  s.step(3), s.expect_same();
  EXPECT_EQ(lodestone_wake(s.c, s.c_bodies[2]), LODESTONE_OK);
  s.manager.wake(s.bodies[2]);
  EXPECT_EQ(lodestone_set_level(s.c, s.c_bodies[3], LODESTONE_CHOOSE_SUPPORT), LODESTONE_OK);
  s.manager.set_level(s.bodies[3], LevelChoice::support);
  EXPECT_EQ(lodestone_set_rung_range(s.c, s.c_bodies[4], LODESTONE_SUPPORT, LODESTONE_FULL), LODESTONE_OK);
  s.manager.set_rung_range(s.bodies[4], Rung::support, Rung::full);
  lodestone_properties damped = lodestone_default_properties();
  damped.linear_damping = 0.5;
  EXPECT_EQ(lodestone_set_properties(s.c, s.c_bodies[5], &damped), LODESTONE_OK);
  s.manager.set_properties(s.bodies[5], {.linear_damping = 0.5});
  s.step(10), s.expect_same();
  const lodestone_state state{{3, 1, 2}, {1, 0, 0, 0}, {0, 0, 1}, {0, 2, 0}};
  EXPECT_EQ(lodestone_set_state(s.c, body, &state), LODESTONE_OK);
  s.manager.set_state(id, at({3, 1, 2}, {0, 0, 1}, {0, 2, 0}));
  EXPECT_EQ(lodestone_remove_body(s.c, s.c_bodies[0]), LODESTONE_OK);
  s.manager.remove_body(s.bodies[0]);
  s.step(10), s.expect_same();
  EXPECT_FALSE(lodestone_is_valid(s.c, s.c_bodies[0]));
  EXPECT_TRUE(lodestone_is_valid(s.c, body));
  EXPECT_FALSE(lodestone_is_valid(nullptr, body));
}

TEST(CBodies, AreReadAsTheClassesReadThem) {
  CScene s;
  s.add({0, 0, 0.5}), s.add({2, 0, 0.5}, LevelChoice::full);
  s.step(5);
  for (std::size_t i = 0; i < 2; ++i) {
    lodestone_state state;
    double mass = 0;
    lodestone_rung rung;
    bool asleep = true;
    dxBody* ode = nullptr;
    ASSERT_EQ(lodestone_get_state(s.c, s.c_bodies[i], &state), LODESTONE_OK);
    ASSERT_EQ(lodestone_get_mass(s.c, s.c_bodies[i], &mass), LODESTONE_OK);
    ASSERT_EQ(lodestone_get_rung(s.c, s.c_bodies[i], &rung), LODESTONE_OK);
    ASSERT_EQ(lodestone_is_asleep(s.c, s.c_bodies[i], &asleep), LODESTONE_OK);
    ASSERT_EQ(lodestone_get_ode_body(s.c, s.c_bodies[i], &ode), LODESTONE_OK);
    const RigidState expected = s.manager.state(s.bodies[i]);
    EXPECT_EQ(state.position.z, expected.position.z());
    EXPECT_EQ(state.velocity.z, expected.velocity.z());
    EXPECT_EQ(state.orientation.w, expected.orientation.w());
    EXPECT_EQ(mass, s.manager.mass(s.bodies[i]));
    EXPECT_EQ(int(rung), int(s.manager.rung(s.bodies[i])));
    EXPECT_EQ(asleep, s.manager.asleep(s.bodies[i]));
    EXPECT_EQ(ode != nullptr, rung == LODESTONE_FULL);
  }
  float positions[6], orientations[8], expected[6], turned[8];
  ASSERT_EQ(lodestone_read_poses(s.c, s.c_bodies.data(), 2, positions, orientations), LODESTONE_OK);
  s.manager.read_poses(s.bodies, expected, turned);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(positions[i], expected[i]);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(orientations[i], turned[i]);
}

TEST(CBodies, UserDataAndReasonsComeBack) {
  CScene s;
  s.add({0, 0, 0.5});
  s.step();
  ASSERT_EQ(lodestone_set_user_data(s.c, s.c_bodies[0], 77), LODESTONE_OK);
  std::uintptr_t data = 0;
  ASSERT_EQ(lodestone_get_user_data(s.c, s.c_bodies[0], &data), LODESTONE_OK);
  EXPECT_EQ(data, 77U);
  lodestone_reason reason;
  ASSERT_EQ(lodestone_explain(s.c, s.c_bodies[0], &reason), LODESTONE_OK);
  const Why why = s.manager.explain(s.bodies[0]);
  EXPECT_EQ(int(reason.rule), int(why.rule));
  EXPECT_EQ(int(reason.rung), int(why.rung));
  EXPECT_EQ(reason.cost_work, why.cost_work);
  EXPECT_EQ(reason.placed, why.placed);
}

// A text is cut to the room that there is, ends with a zero, and says how long it is.
TEST(CBodies, WhyFitsTheRoomThatThereIs) {
  CScene s;
  s.add({0, 0, 0.5});
  s.step();
  const std::string whole = s.manager.why(s.bodies[0]);
  for (std::size_t room : {std::size_t(0), std::size_t(1), std::size_t(5), whole.size(), whole.size() + 1}) {
    std::string text(whole.size() + 3, '#');
    std::size_t length = 0;
    ASSERT_EQ(lodestone_why(s.c, s.c_bodies[0], text.data(), room, &length), LODESTONE_OK);
    EXPECT_EQ(length, whole.size());
    if (room > 0) {
      EXPECT_EQ(std::string(text.c_str()), whole.substr(0, room - 1));
    }
    EXPECT_EQ(text.substr(room), std::string(text.size() - room, '#'));  // nothing beyond
  }
}

TEST(CBodies, AGroupEndsWithItsLastBody) {
  CScene scene;
  scene.add({0, 0, 1});
  lodestone_group group{};
  EXPECT_FALSE(lodestone_is_valid_group(scene.c, group));
  ASSERT_EQ(lodestone_make_group(scene.c, scene.c_bodies.data(), 1, nullptr, nullptr, nullptr, &group),
            LODESTONE_OK);
  EXPECT_TRUE(lodestone_is_valid_group(scene.c, group));
  EXPECT_FALSE(lodestone_is_valid_group(nullptr, group));
  ASSERT_EQ(lodestone_remove_body(scene.c, scene.c_bodies[0]), LODESTONE_OK);
  EXPECT_FALSE(lodestone_is_valid_group(scene.c, group));
}

TEST(CBodies, BadCallsAreRefusedAndChangeNothing) {
  CScene s;
  s.add({0, 0, 0.5});
  s.step();
  const std::uint64_t before = s.c_hash();
  const lodestone_body stale{5, 5}, body = s.c_bodies[0];
  lodestone_state state{};
  EXPECT_EQ(lodestone_get_state(s.c, stale, &state), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_get_state(nullptr, body, &state), LODESTONE_BAD_INPUT);
  EXPECT_STREQ(lodestone_error(), "manager: found null, expected an address");
  EXPECT_EQ(lodestone_set_state(s.c, body, nullptr), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_set_state(s.c, body, &state), LODESTONE_BAD_INPUT);  // a quaternion of zeros
  EXPECT_EQ(lodestone_set_level(s.c, body, lodestone_level_choice(9)), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_set_rung_range(s.c, body, LODESTONE_FULL, LODESTONE_TABLES), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_set_importance(s.c, body, 0), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_add_force(s.c, body, {NAN, 0, 0}, {0, 0, 0}), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_set_properties(s.c, body, nullptr), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_remove_body(s.c, stale), LODESTONE_BAD_INPUT);
  lodestone_body_definition definition = lodestone_default_body(nullptr);
  EXPECT_EQ(lodestone_add_body(s.c, &definition, nullptr), LODESTONE_BAD_INPUT);
  EXPECT_EQ(lodestone_add_body(s.c, nullptr, nullptr), LODESTONE_BAD_INPUT);
  EXPECT_EQ(s.c_hash(), before);
}

}  // namespace
}  // namespace lodestone
