#include "lod/contact/contact_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace lodestone::contact_memory_test {
namespace {

// Two pairs, the first with two manifolds, and one pair with the ground.
struct Touching {
  std::vector<ContactKey> keys;
  std::vector<CrowdManifold> manifolds;
  std::vector<CrowdPoint> points;
  std::size_t first_of(ContactKey key) const {
    return manifolds[std::size_t(std::ranges::find(keys, key) - keys.begin())].begin;
  }
  void add(ContactKey key, const std::vector<Vec3>& impulses) {
    keys.push_back(key);
    CrowdManifold& manifold = manifolds.emplace_back();
    manifold.begin = std::uint32_t(points.size()), manifold.count = std::uint32_t(impulses.size());
    for (const Vec3& impulse : impulses) {
      CrowdPoint& point = points.emplace_back();
      point.arm_first = Vec3(double(points.size() - first_of(key)), 0.0, -1.0);  // 1, 2, … m along x
      point.impulse = impulse;
    }
  }
};

Touching touching() {
  Touching t;
  t.add(contact_key(1, 2), {{0, 0, 1}, {0, 0, 2}});
  t.add(contact_key(1, 2), {{1, 0, 3}});
  t.add(contact_key(2, 3), {{0, 5, 0}});
  t.add(ground_key(3, 0), {{0, 0, 7}, {0, 0, 9}});
  return t;
}

ContactMemory memory_of(const Touching& t, double step) {
  ContactMemory memory;
  memory.remember(t.keys, t.manifolds, t.points, step);
  return memory;
}

TEST(ContactMemory, RecallsTheForcesPointByPoint) {
  const Touching before = touching();
  ContactMemory memory = memory_of(before, 0.02);
  Touching now = touching();
  memory.recall(now.keys, now.manifolds, now.points, 0.01,
                make_job_runner(1));  // half as long: half the impulses
  for (std::size_t i = 0; i < now.points.size(); ++i)
    EXPECT_EQ(now.points[i].guess, 0.5 * before.points[i].impulse) << i;
}

TEST(ContactMemory, RecallsAPairWhereverItIsInTheList) {
  ContactMemory memory = memory_of(touching(), 0.01);
  Touching now;
  now.add(ground_key(3, 0), {Vec3::Zero(), Vec3::Zero()});
  now.add(contact_key(2, 3), {Vec3::Zero()});
  memory.recall(now.keys, now.manifolds, now.points, 0.01, make_job_runner(1));
  EXPECT_EQ(now.points[1].guess, Vec3(0, 0, 9));
  EXPECT_EQ(now.points[2].guess, Vec3(0, 5, 0));
}

// Two that are in each other push each other both ways: what held one way, added to the other, grew from step
// to step.
TEST(ContactMemory, GivesNoForceToAPointThatItWouldPull) {
  Touching before;
  before.add(contact_key(1, 2), {{0, 0, 3}});
  before.points[0].frictionless = 4.0F;
  ContactMemory memory = memory_of(before, 0.01);
  Touching now;
  now.add(contact_key(1, 2), {Vec3::Zero()});
  now.add(contact_key(1, 2), {Vec3::Zero()});  // 1 m beside it
  now.manifolds[0].normal = -Vec3::UnitZ();
  memory.recall(now.keys, now.manifolds, now.points, 0.01, make_job_runner(1));
  EXPECT_EQ(now.points[0].guess, Vec3::Zero());
  EXPECT_LT(now.points[0].frictionless, 0.0F);
  EXPECT_EQ(now.points[1].guess, Vec3(0, 0, 3));
  EXPECT_FLOAT_EQ(now.points[1].frictionless, 4.0F);
}

TEST(ContactMemory, GivesEachForceToThePointNearestToWhereItWas) {
  Touching before;
  before.add(ground_key(3, 0), {{0, 0, 1}, {0, 0, 2}, {0, 0, 4}});  // at 1, 2 and 3 m along x
  ContactMemory memory = memory_of(before, 0.01);
  Touching now;
  now.add(ground_key(3, 0), {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()});
  std::swap(now.points[0].arm_first, now.points[2].arm_first);  // found in another order
  for (CrowdPoint& point : now.points) point.arm_first.x() += 0.1;
  memory.recall(now.keys, now.manifolds, now.points, 0.01, make_job_runner(1));
  EXPECT_EQ(now.points[0].guess, Vec3(0, 0, 4));
  EXPECT_EQ(now.points[1].guess, Vec3(0, 0, 2));
  EXPECT_EQ(now.points[2].guess, Vec3(0, 0, 1));
}

TEST(ContactMemory, KeepsTheWholeForceWhereThePointsAreFewer) {
  ContactMemory memory = memory_of(touching(), 0.01);
  Touching now;
  now.add(contact_key(1, 2), {Vec3::Zero(), Vec3::Zero()});
  memory.recall(now.keys, now.manifolds, now.points, 0.01, make_job_runner(1));
  EXPECT_LT((now.points[0].guess + now.points[1].guess - Vec3(1, 0, 6)).norm(), 1e-12);
}

TEST(ContactMemory, SaysWhichManifoldsItKnows) {
  ContactMemory memory = memory_of(touching(), 0.01);
  Touching now;
  now.add(contact_key(8, 9), {Vec3::Zero()});
  now.add(contact_key(2, 3), {Vec3::Zero()});
  memory.recall(now.keys, now.manifolds, now.points, 0.01, make_job_runner(1));
  EXPECT_FALSE(now.manifolds[0].known);
  EXPECT_TRUE(now.manifolds[1].known);
}

// A blow's impulse is no force that goes on.
TEST(ContactMemory, OfABlowRecallsWhatThePointBoreBefore) {
  Touching before = touching();
  before.points[0].in_blow = true, before.points[0].guess = Vec3(0, 0, 0.25);
  ContactMemory memory = memory_of(before, 0.01);
  Touching now = touching();
  memory.recall(now.keys, now.manifolds, now.points, 0.01, make_job_runner(1));
  EXPECT_EQ(now.points[0].guess, Vec3(0, 0, 0.25));
  EXPECT_EQ(now.points[1].guess, before.points[1].impulse);
}

TEST(ContactMemory, LeavesWhatIsNewAsItIs) {
  ContactMemory memory = memory_of(touching(), 0.01);
  Touching now;
  now.add(contact_key(2, 1), {Vec3::Zero()});  // another pair: the impulse's sign is that of the first
  now.points[0].guess = Vec3(4, 4, 4);
  memory.recall(now.keys, now.manifolds, now.points, 0.01, make_job_runner(1));
  EXPECT_EQ(now.points[0].guess, Vec3(4, 4, 4));
}

TEST(ContactMemory, ForgetsWhatWasBeforeTheLastStep) {
  ContactMemory memory = memory_of(touching(), 0.01);
  Touching other;
  other.add(contact_key(8, 9), {{0, 0, 1}});
  memory.remember(other.keys, other.manifolds, other.points, 0.01);
  Touching now = touching();
  memory.recall(now.keys, now.manifolds, now.points, 0.01, make_job_runner(1));
  for (const CrowdPoint& point : now.points) EXPECT_EQ(point.guess, Vec3::Zero());
}

// Two sets of islands, one after the other in two substeps each: the first recalls the last step, whichever
// set its pairs were in then, the second the first.
TEST(ContactMemory, OfIslandsIsTheirLastSubstepThenTheLastStep) {
  const auto once = [](ContactKey key, double force) {
    Touching t;
    t.add(key, {{0, 0, force}});
    return t;
  };
  const auto recalled = [](ContactMemory& memory, ContactKey key) {
    Touching t;
    t.add(key, {Vec3::Zero()});
    memory.recall(t.keys, t.manifolds, t.points, 1.0, make_job_runner(1));
    return t.points[0].guess.z();
  };
  const auto solve = [&](ContactMemory& memory, ContactKey key, double force) {
    const double guess = recalled(memory, key);
    const Touching t = once(key, force);
    memory.remember(t.keys, t.manifolds, t.points, 1.0);
    return guess;
  };
  const ContactKey one = contact_key(1, 2), other = contact_key(3, 4);
  ContactMemory memory;
  for (int step = 0; step < 3; ++step) {
    memory.begin_step(1.0);
    for (const ContactKey key : step % 2 == 0 ? std::vector{one, other} : std::vector{other, one}) {
      const double own = key == one ? 10.0 : 20.0, before = own + 100.0 * (step - 1);
      memory.begin_islands();
      EXPECT_EQ(solve(memory, key, 1.0), step == 0 ? 0.0 : before) << step;
      EXPECT_EQ(solve(memory, key, own + 100.0 * step), 1.0) << step;
      memory.end_islands();
    }
    memory.end_step();
  }
  memory.begin_step(1.0);  // in which nobody touches
  memory.end_step();
  memory.begin_step(1.0);
  memory.begin_islands();
  EXPECT_EQ(recalled(memory, one), 210.0);
  EXPECT_EQ(recalled(memory, other), 220.0);
}

}  // namespace
}  // namespace lodestone::contact_memory_test
