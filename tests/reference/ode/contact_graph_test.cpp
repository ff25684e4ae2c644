#include "reference/ode/contact_graph.h"

#include <gtest/gtest.h>

#include <vector>

namespace lodestone::ode {
namespace {

struct Joined {
  Joined() {
    prepare();
    world = dWorldCreate(), group = dJointGroupCreate(0);
    for (dBodyID& body : bodies) body = dBodyCreate(world);
  }
  ~Joined() { dJointGroupDestroy(group), dWorldDestroy(world); }
  Joined(const Joined&) = delete;
  Joined& operator=(const Joined&) = delete;

  dJointID join(dBodyID first, dBodyID second) const {
    const dJointID joint = dJointCreateBall(world, nullptr);
    dJointAttach(joint, first, second);
    return joint;
  }
  void touch(ContactGraph& graph, dBodyID first, dBodyID second, int points) const {
    const dContact contact{};
    for (int i = 0; i < points; ++i) dJointAttach(dJointCreateContact(world, group, &contact), first, second);
    graph.add(first, second, points);
  }

  dWorldID world{};
  dJointGroupID group{};
  dBodyID bodies[4]{};
};

std::vector<dJointID> other_joints(const ContactGraph& graph, dBodyID body) {
  std::vector<dJointID> joints;
  graph.any_other_joint(body, [&](dJointID joint) { return joints.push_back(joint), false; });
  return joints;
}

std::vector<dBodyID> met(const ContactGraph& graph, dBodyID body) {
  return {graph.met_by(body).begin(), graph.met_by(body).end()};
}

TEST(ContactGraph, TellsContactsFromTheJointsBeforeThem) {
  const Joined j;
  const auto [a, b, c, alone] = j.bodies;
  const dJointID first = j.join(a, b), second = j.join(nullptr, a);
  ContactGraph graph;
  j.touch(graph, a, c, 4);
  j.touch(graph, a, nullptr, 3);
  j.touch(graph, c, b, 1);
  EXPECT_EQ(met(graph, a), (std::vector<dBodyID>{c}));
  EXPECT_EQ(met(graph, c), (std::vector<dBodyID>{a, b}));
  EXPECT_EQ(other_joints(graph, a), (std::vector<dJointID>{second, first}));
  EXPECT_EQ(other_joints(graph, b), (std::vector<dJointID>{first}));
  EXPECT_TRUE(other_joints(graph, c).empty());
  EXPECT_TRUE(met(graph, alone).empty() && other_joints(graph, alone).empty());
}

TEST(ContactGraph, EndsAtTheFirstJointThatIsMeant) {
  const Joined j;
  const auto [a, b, c, d] = j.bodies;
  j.join(a, b), j.join(a, c), j.join(a, d);
  const ContactGraph graph;
  int asked = 0;
  EXPECT_TRUE(graph.any_other_joint(a, [&](dJointID) { return ++asked == 2; }));
  EXPECT_EQ(asked, 2);
}

TEST(ContactGraph, BeginsAnew) {
  const Joined j;
  ContactGraph graph;
  j.touch(graph, j.bodies[0], j.bodies[1], 2);
  dJointGroupEmpty(j.group), graph.clear();
  j.touch(graph, j.bodies[2], j.bodies[0], 1);
  EXPECT_EQ(met(graph, j.bodies[0]), (std::vector<dBodyID>{j.bodies[2]}));
  EXPECT_TRUE(met(graph, j.bodies[1]).empty());
  EXPECT_TRUE(other_joints(graph, j.bodies[0]).empty());
}

}  // namespace
}  // namespace lodestone::ode
