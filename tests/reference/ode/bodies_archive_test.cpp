#include <gtest/gtest.h>
#include <ode/ode.h>

#include "reference/random.h"
#include "reference/state_archive.h"
#include "tests/message_of.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

struct ArchivedScene {
  explicit ArchivedScene(bool quick = false) : world({.quick_step = quick, .auto_disable = true}, materials) {
    world.add_plane(Vec3::UnitZ(), 0.0, 0);
  }
  void fill() {
    RandomStream random(9, 0, 0);
    for (int i = 0; i < 8; ++i)
      bodies.push_back(
          world.add_body({.shape = i % 2 ? box() : ball(),
                          .mass = 1.0 + i,
                          .state = at({0.15 * i, 0.1 * (i % 3), 0.3 + 0.2 * i}, random.direction(),
                                      random.direction(), random.orientation())}));
    world.remove_body(bodies[2]);
    bodies.erase(bodies.begin() + 2);
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) world.step(1.0 / 60, 2);
  }
  std::vector<RigidState> states() const {
    std::vector<RigidState> states;
    for (const OdeBodyId body : bodies) states.push_back(world.state(body));
    return states;
  }
  static const std::shared_ptr<const Shape>& box() {
    static const auto shape = box_shape({0.2, 0.3, 0.25});
    return shape;
  }
  static const std::shared_ptr<const Shape>& ball() {
    static const auto shape = sphere_shape(0.12);
    return shape;
  }
  MaterialTable materials = material(0.4, 0.5);
  OdeWorld world;
  std::vector<OdeBodyId> bodies;
};

void expect_same(const ArchivedScene& a, const ArchivedScene& b) {
  const auto there = a.states(), here = b.states();
  ASSERT_EQ(there.size(), here.size());
  for (std::size_t i = 0; i < there.size(); ++i) {
    EXPECT_TRUE(same_bits(there[i], here[i])) << i;
    EXPECT_EQ(a.world.asleep(a.bodies[i]), b.world.asleep(b.bodies[i]));
  }
}

// Read by a world that has other bodies, or none, or the same: it goes on as the writer does, to the bit.
TEST(BodiesArchive, AReaderGoesOnAsTheWriter) {
  for (const bool quick : {false, true})
    for (int reader_has = 0; reader_has < 3; ++reader_has) {
      ArchivedScene writer(quick), reader(quick);
      writer.fill();
      writer.run(40);
      if (reader_has == 1) reader.fill(), reader.run(7);
      if (reader_has == 2) reader.world.add_body({.shape = ArchivedScene::ball(), .state = at({9, 9, 9})});
      StateArchive out;
      writer.world.archive(out);
      StateArchive in(out.bytes(), out.shapes());
      reader.world.archive(in);
      EXPECT_TRUE(in.at_end());
      reader.bodies = writer.bodies;  // ids are the writer's
      expect_same(writer, reader);
      writer.run(60), reader.run(60);
      expect_same(writer, reader);
    }
}

// Another world's ids are the same though its bodies are of other shapes, masses or materials: they are made
// anew, not kept.
TEST(BodiesArchive, BodiesOfTheSameIdsThatAreOthersAreNotKept) {
  for (int differs = 0; differs < 4; ++differs) {
    ArchivedScene writer, reader;
    for (ArchivedScene* scene : {&writer, &reader}) {
      const bool other = scene == &reader;
      scene->materials.add({.restitution = 0.9, .friction = 0.0});
      OdeBodyDefinition definition{
          .shape = ArchivedScene::box(), .mass = 2.0, .state = at({0, 0, 0.6}, {1, 0, 0})};
      if (other && differs == 0) definition.shape = ArchivedScene::ball();
      if (other && differs == 1) definition.mass = 9.0;
      if (other && differs == 2) definition.material = 1;
      if (other && differs == 3) definition.geometry = OdeGeometry::sphere;
      scene->bodies.push_back(scene->world.add_body(definition));
      scene->bodies.push_back(
          scene->world.add_body({.shape = ArchivedScene::box(), .mass = 1.0, .state = at({0, 0, 0.2})}));
    }
    ASSERT_EQ(writer.bodies[0], reader.bodies[0]);
    StateArchive out;
    writer.world.archive(out);
    StateArchive in(out.bytes(), out.shapes());
    reader.world.archive(in);
    writer.run(60), reader.run(60);
    expect_same(writer, reader);
  }
}

TEST(BodiesArchive, WritingChangesNothing) {
  ArchivedScene one, other;
  one.fill(), other.fill();
  for (int i = 0; i < 10; ++i) {
    one.run(4), other.run(4);
    StateArchive out;
    one.world.archive(out);
  }
  expect_same(one, other);
}

// One of those that would have to be made anew hangs on a joint: it is said, and nothing has changed.
TEST(BodiesArchive, ABodyOnAJointIsNotMadeAnew) {
  ArchivedScene writer, reader;
  writer.fill();
  StateArchive out;
  writer.world.archive(out);
  const OdeBodyId held = reader.world.add_body({.shape = ArchivedScene::ball(), .state = at({0, 0, 5})});
  const dJointID joint = dJointCreateBall(reader.world.ode_world(), nullptr);
  dJointAttach(joint, reader.world.ode_body(held), nullptr);
  StateArchive in(out.bytes(), out.shapes());
  EXPECT_NE(message_of([&] { reader.world.archive(in); }), kNothingThrown);
  EXPECT_EQ(reader.world.state(held).position, Vec3(0, 0, 5));
  EXPECT_EQ(dBodyGetNumJoints(reader.world.ode_body(held)), 1);
  dJointDestroy(joint);
}

TEST(BodiesArchive, ATruncationAnywhereIsAnError) {
  ArchivedScene writer;
  writer.fill();
  writer.run(5);
  StateArchive out;
  writer.world.archive(out);
  for (std::size_t length = 0; length < out.bytes().size(); length += 53) {
    ArchivedScene reader;
    StateArchive in({out.bytes().data(), length}, out.shapes());
    EXPECT_NE(message_of([&] { reader.world.archive(in); }), kNothingThrown) << length;
  }
}

}  // namespace
}  // namespace lodestone
