#include "lod/manager/body_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "reference/error.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

class TableOfBodies : public ::testing::Test {
 protected:
  BodyId add(LevelChoice choice = LevelChoice::automatic) {
    return table_.add({.shape = ball_, .state = testing::at({1, 2, 3}), .level = choice}, 5.0);
  }
  std::shared_ptr<const Shape> ball_ = testing::sphere_shape(0.1);
  BodyTable table_;
};

// A stale id is never taken for that of the body which has the index now.
TEST_F(TableOfBodies, AnIndexIsGivenAgainWithAnotherGeneration) {
  const BodyId first = add(), second = add();
  table_.remove(first);
  EXPECT_FALSE(table_.valid(first));
  EXPECT_TRUE(table_.valid(second));
  const BodyId before_a_step = add();
  EXPECT_NE(before_a_step.index, first.index);  // what is remembered of contacts goes by it
  table_.reuse_indices();
  const BodyId again = add();
  EXPECT_EQ(again.index, first.index);
  EXPECT_NE(again.generation, first.generation);
  EXPECT_FALSE(table_.valid(first));
  EXPECT_THROW(table_.index_of(first), InputError);
  EXPECT_EQ(table_.index_of(again), again.index);
  EXPECT_EQ(table_.size(), 3);
  EXPECT_EQ(table_.indices(), 3U);
  EXPECT_THROW(table_.index_of({}), InputError);
  EXPECT_FALSE(table_.valid({99, 1}));
}

TEST_F(TableOfBodies, OrderOfCreationOutlivesIndices) {
  const BodyId a = add(), b = add();
  table_.remove(a);
  table_.reuse_indices();
  const BodyId c = add();
  ASSERT_EQ(c.index, a.index);
  EXPECT_EQ(table_.in_order_of_creation(), (std::vector<std::uint32_t>{b.index, c.index}));
}

TEST_F(TableOfBodies, ChoicesAreCounted) {
  const BodyId a = add(LevelChoice::full), b = add(LevelChoice::automatic);
  EXPECT_EQ(table_.count(LevelChoice::full), 1);
  table_.set_choice(b.index, LevelChoice::full);
  EXPECT_EQ(table_.count(LevelChoice::full), 2);
  EXPECT_EQ(table_.count(LevelChoice::automatic), 0);
  table_.remove(a);
  EXPECT_EQ(table_.count(LevelChoice::full), 1);
}

TEST_F(TableOfBodies, AShapeIsHeldForAsLongAsABodyHasIt) {
  const long before = ball_.use_count();
  const BodyId a = add(), b = add();
  EXPECT_EQ(table_.shape(a.index), ball_);
  table_.remove(a);
  EXPECT_GT(ball_.use_count(), before);
  table_.remove(b);
  EXPECT_EQ(ball_.use_count(), before);
}

TEST_F(TableOfBodies, ForcesAddUpUntilTheStepIsDone) {
  const BodyId a = add(), b = add();
  table_.add_force(b.index, {{1, 0, 0}, {0, 0, 1}});
  table_.add_force(a.index, {{0, 2, 0}, {0, 0, 0}});
  table_.add_force(b.index, {{1, 1, 0}, {0, 1, 0}});
  EXPECT_EQ(table_.force(b.index).force, Vec3(2, 1, 0));
  EXPECT_EQ(table_.force(b.index).torque, Vec3(0, 1, 1));
  EXPECT_EQ(table_.pushed(), (std::vector<std::uint32_t>{b.index, a.index}));
  const BodyTable::Forces held = table_.forces();
  table_.clear_forces();
  EXPECT_EQ(table_.force(b.index).force, Vec3::Zero());
  EXPECT_TRUE(table_.pushed().empty());
  table_.hold(held);
  EXPECT_EQ(table_.force(b.index).force, Vec3(2, 1, 0));
  table_.drop_force(b.index);
  EXPECT_EQ(table_.pushed(), (std::vector<std::uint32_t>{a.index}));
}

// Far more are dropped than are left; one gets another force, after all others.
TEST_F(TableOfBodies, ForcesKeepTheirOrderAsOthersAreDropped) {
  std::vector<std::uint32_t> bodies, left;
  for (int i = 0; i < 300; ++i) {
    bodies.push_back(add().index);
    table_.add_force(bodies.back(), {{double(i), 0, 0}, {0, 0, 0}});
  }
  for (int i = 0; i < 300; ++i)
    if (i % 10 != 7)
      table_.drop_force(bodies[std::size_t(299 - i)]);
    else
      left.insert(left.begin(), bodies[std::size_t(299 - i)]);
  table_.drop_force(bodies[0]);  // it has none
  table_.drop_force(left.front());
  table_.add_force(left.front(), {{1, 0, 0}, {0, 0, 0}});
  std::rotate(left.begin(), left.begin() + 1, left.end());
  EXPECT_EQ(table_.pushed(), left);
  StateArchive written;
  table_.archive(written);
  BodyTable read;
  StateArchive bytes(written.bytes(), {ball_});
  read.archive(bytes);
  EXPECT_EQ(read.pushed(), left);
  read.drop_force(left[1]);
  left.erase(left.begin() + 1);
  EXPECT_EQ(read.pushed(), left);
  for (const std::uint32_t body : left) EXPECT_EQ(read.force(body).force, table_.force(body).force);
}

TEST_F(TableOfBodies, ASumThatIsNotFiniteIsRefusedAndChangesNothing) {
  const BodyId a = add();
  const double most = std::numeric_limits<double>::max();
  table_.add_force(a.index, {{most, 0, 0}, {0, 0, 0}});
  EXPECT_THROW(table_.add_force(a.index, {{most, 0, 0}, {0, 0, 0}}), InputError);
  EXPECT_EQ(table_.force(a.index).force, Vec3(most, 0, 0));
}

TEST_F(TableOfBodies, NewcomersKeepTheirOrderAsOthersLeave) {
  const BodyId a = add(), b = add(), c = add();
  EXPECT_EQ(table_.newcomers().size(), 3U);
  EXPECT_EQ(table_.newcomer(b.index).state.position, Vec3(1, 2, 3));
  table_.remove(b);
  std::vector<std::uint32_t> waiting;
  for (std::size_t i = 0; i < table_.newcomers().size(); ++i)
    if (table_.waits_at(i)) waiting.push_back(table_.newcomers()[i].index);
  EXPECT_EQ(waiting, (std::vector<std::uint32_t>{a.index, c.index}));
}

}  // namespace
}  // namespace lodestone
