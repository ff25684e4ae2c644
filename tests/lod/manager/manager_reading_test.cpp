#include <gtest/gtest.h>

#include <algorithm>

#include "reference/random.h"
#include "tests/lod/manager/manager_fixture.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

using namespace testing;

class ReadScene : public ::testing::Test {
 protected:
  ReadScene() {
    RandomStream random(31, 0, 0);
    for (int i = 0; i < 12; ++i)
      bodies_.push_back(
          add(manager_, i % 2 ? box_ : ball_,
              at({1.0 * i, 0, 1.0}, random.direction(), random.direction(), random.orientation()),
              i % 3 ? LevelChoice::support : LevelChoice::full));
    for (int i = 0; i < 20; ++i) manager_.step(kFrame);
  }
  std::shared_ptr<const Shape> box_ = box_shape({0.2, 0.3, 0.4}), ball_ = sphere_shape(0.2);
  Manager manager_ = on_floor();
  std::vector<BodyId> bodies_;
};

TEST_F(ReadScene, ManyAtOnceAreAsOneByOne) {
  std::vector<BodyId> asked(bodies_.rbegin(), bodies_.rend());
  asked.push_back(bodies_[3]);  // twice is fine
  std::vector<RigidState> states(asked.size());
  std::vector<float> positions(3 * asked.size()), orientations(4 * asked.size());
  manager_.read_states(asked, states);
  manager_.read_poses(asked, positions, orientations);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const RigidState one = manager_.state(asked[i]);
    EXPECT_TRUE(same_bits(states[i], one));
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(positions[3 * i + std::size_t(axis)], float(one.position[axis]));
    const double wxyz[] = {one.orientation.w(), one.orientation.x(), one.orientation.y(),
                           one.orientation.z()};
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(orientations[4 * i + k], float(wxyz[k]));
  }
}

TEST_F(ReadScene, RoomForOthersIsRefusedAndNothingIsWritten) {
  std::vector<RigidState> states(bodies_.size() + 1);
  const std::string message = message_of([&] { manager_.read_states(bodies_, states); });
  EXPECT_EQ(message, "states: found room for 13 numbers, expected 12");
  std::vector<float> positions(36, -7.0f), orientations(48, -7.0f);
  EXPECT_THROW(manager_.read_poses(bodies_, std::span(positions).first(35), orientations), InputError);
  EXPECT_THROW(manager_.read_poses(bodies_, positions, std::span(orientations).first(47)), InputError);
  std::vector<BodyId> stale = bodies_;
  stale.back() = {99, 1};
  EXPECT_THROW(manager_.read_poses(stale, positions, orientations), InputError);
  EXPECT_TRUE(std::ranges::all_of(positions, [](float x) { return x == -7.0f; }));
}

TEST_F(ReadScene, RungsAreSaidAlikeByAll) {
  int full = 0;
  for (const BodyId body : bodies_) {
    const Rung rung = manager_.rung(body);
    EXPECT_EQ(manager_.level(body), level_of(rung));
    EXPECT_EQ(manager_.ode_body(body) != nullptr, rung == Rung::full);
    EXPECT_EQ(manager_.explain(body).rung, rung);
    EXPECT_TRUE(manager_.why(body).starts_with(name_of(rung))) << manager_.why(body);
    EXPECT_EQ(manager_.collision_radius(body), 0.0);  // nobody is at tables
    full += rung == Rung::full;
  }
  EXPECT_EQ(full, 4);
  EXPECT_EQ(manager_.report().full, full);
  EXPECT_EQ(manager_.report().support, 8);
}

// The hash tells any two states apart, whatever is changed in them, and only by them.
TEST_F(ReadScene, HashIsOfStatesAndLevelsAlone) {
  const std::uint64_t before = manager_.state_hash();
  manager_.set_user_data(bodies_[0], 3);
  manager_.set_importance(bodies_[0], 2.0);
  EXPECT_EQ(manager_.state_hash(), before);
  const RigidState kept = manager_.state(bodies_[5]);
  for (int what = 0; what < 4; ++what) {
    RigidState changed = kept;
    if (what == 0) changed.position.x() += 1e-9;
    if (what == 1) changed.velocity.y() += 1e-9;
    if (what == 2) changed.angular_velocity.z() += 1e-6;
    if (what == 3) changed.orientation = (changed.orientation * Quat(1, 1e-6, 0, 0)).normalized();
    manager_.set_state(bodies_[5], changed);
    EXPECT_NE(manager_.state_hash(), before) << what;
  }
  // Set again, it is the same; the one that it had to begin with but for rounding, of spin and angular
  // velocity.
  manager_.set_state(bodies_[5], kept);
  const std::uint64_t back = manager_.state_hash();
  manager_.set_state(bodies_[5], kept);
  EXPECT_EQ(manager_.state_hash(), back);
  manager_.sleep(bodies_[1]);
  EXPECT_NE(manager_.state_hash(), back);
}

TEST(NamesOfRungs, AreThree) {
  EXPECT_EQ(name_of(Rung::tables), "tables");
  EXPECT_EQ(name_of(Rung::support), "support");
  EXPECT_EQ(name_of(Rung::full), "full");
}

}  // namespace
}  // namespace lodestone
