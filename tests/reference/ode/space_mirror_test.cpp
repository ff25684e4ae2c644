// What a caller's space holds, whatever its type and whatever was done to it between two looks.
#include "reference/ode/space_mirror.h"

#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "reference/ode/box_tree.h"
#include "reference/state_archive.h"
#include "tests/reference/ode/space_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

class SpaceMirrorOf : public ::testing::TestWithParam<SpaceType> {
 protected:
  SpaceMirrorOf() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    world = dWorldCreate();
    space = make_space(GetParam());
  }
  ~SpaceMirrorOf() override {
    dSpaceDestroy(space);
    dWorldDestroy(world);
  }

  dGeomID ball(double x, double y = 0, double z = 0, dSpaceID in = nullptr) {
    const dGeomID geom = dCreateSphere(in ? in : space, 0.5);
    dGeomSetPosition(geom, x, y, z);
    return geom;
  }

  static std::set<dGeomID> held(const SpaceMirror& mirror) {
    std::set<dGeomID> geoms;
    for (const MirroredGeom& geom : mirror.geoms())
      if (geom.geom) geoms.insert(geom.geom);
    return geoms;
  }
  static std::vector<std::uint32_t> near(const SpaceMirror& mirror, const Vec3& at, double reach = 0.1) {
    std::vector<std::uint32_t> found;
    mirror.find_near({at - Vec3::Constant(reach), at + Vec3::Constant(reach)}, found);
    return found;
  }

  dWorldID world;
  dSpaceID space;
};

TEST_P(SpaceMirrorOf, HoldsWhatTheSpaceHolds) {
  const dGeomID box = dCreateBox(space, 1, 2, 3), plane = dCreatePlane(space, 0, 0, 1, -7),
                capsule = dCreateCapsule(space, 0.5, 2);
  dGeomSetPosition(box, 1, 2, 3);
  const dQuaternion turned = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  dGeomSetQuaternion(box, turned);
  dCreateRay(space, 1.0);
  dGeomDisable(ball(5));
  const dGeomID hidden = ball(6);
  dGeomSetCategoryBits(hidden, 0), dGeomSetCollideBits(hidden, 0);
  SpaceMirror mirror(space);
  mirror.refresh();
  EXPECT_EQ(held(mirror), (std::set{box, plane, capsule}));
  EXPECT_EQ(mirror.added().size(), 3u);
  for (const MirroredGeom& geom : mirror.geoms()) {
    if (geom.geom == box) {
      EXPECT_EQ(geom.kind, GeomKind::box);
      EXPECT_EQ(geom.position, Vec3(1, 2, 3));
      EXPECT_LT(geom.orientation.angularDistance(Quat(turned[0], 0, 0, turned[3])), 1e-12);
      EXPECT_TRUE(geom.bounds.isApprox(Eigen::AlignedBox3d(Vec3(0, 1.5, 1.5), Vec3(2, 2.5, 4.5)), 1e-12));
      EXPECT_EQ(geom.body, nullptr);
    }
    if (geom.geom == plane) {
      EXPECT_EQ(geom.normal, Vec3::UnitZ());
      EXPECT_EQ(geom.offset, -7.0);
    }
  }
  ASSERT_EQ(mirror.planes().size(), 1u);
  EXPECT_EQ(mirror.geoms()[mirror.planes()[0]].geom, plane);
}

TEST_P(SpaceMirrorOf, SpacesOfEveryTypeWithin) {
  std::set<dGeomID> all;
  double x = 0.0;
  for (const SpaceType type : {SpaceType::simple, SpaceType::hash, SpaceType::sweep, SpaceType::quadtree}) {
    const dSpaceID inner = make_space(type, space);
    const dSpaceID innermost = make_space(SpaceType::quadtree, inner);
    dSpaceSetCleanup(inner, type != SpaceType::hash);
    for (const dSpaceID in : {inner, innermost})
      for (int i = 0; i < 5; ++i) all.insert(ball(x += 1.5, 0, 0, in));
  }
  SpaceMirror mirror(space);
  mirror.refresh();
  EXPECT_EQ(held(mirror), all);
  mirror.refresh();
  EXPECT_EQ(held(mirror), all);
  EXPECT_TRUE(mirror.added().empty() && mirror.removed().empty() && mirror.moved().empty());
}

TEST_P(SpaceMirrorOf, BitsAreThoseThatTheSpacesAroundShare) {
  const dSpaceID inner = make_space(SpaceType::hash, space), excluded = make_space(SpaceType::hash, space),
                 hidden = make_space(SpaceType::hash, space);
  dGeomSetCategoryBits(reinterpret_cast<dGeomID>(inner), 6);
  dGeomSetCategoryBits(reinterpret_cast<dGeomID>(hidden), 0),
      dGeomSetCollideBits(reinterpret_cast<dGeomID>(hidden), 0);
  const dGeomID geom = ball(0, 0, 0, inner);
  dGeomSetCategoryBits(geom, 12), dGeomSetCollideBits(geom, 1);
  ball(0, 0, 0, excluded), ball(0, 0, 0, hidden);
  SpaceMirror mirror(space);
  mirror.exclude(excluded);
  mirror.refresh();
  ASSERT_EQ(held(mirror), std::set{geom});
  EXPECT_EQ(mirror.geoms()[0].category, 4u);
  EXPECT_EQ(mirror.geoms()[0].collide, 1u);
}

TEST_P(SpaceMirrorOf, TellsWhatCameWentAndMoved) {
  std::vector<dGeomID> balls;
  for (int i = 0; i < 20; ++i) balls.push_back(ball(2.0 * i));
  SpaceMirror mirror(space);
  mirror.refresh();
  EXPECT_EQ(mirror.added().size(), 20u);
  const auto slot_of = [&](dGeomID geom) {
    return std::uint32_t(std::ranges::find(mirror.geoms(), geom, &MirroredGeom::geom) -
                         mirror.geoms().begin());
  };
  const std::uint32_t third = slot_of(balls[3]), fifth = slot_of(balls[5]), seventh = slot_of(balls[7]),
                      ninth = slot_of(balls[9]);

  dGeomSetPosition(balls[3], 6, 4, 0);
  dGeomDestroy(balls[5]);
  dGeomSphereSetRadius(balls[7], 0.7);
  dGeomSetCategoryBits(balls[9], 2);
  const dGeomID late = dCreateBox(space, 1, 1, 1);  // often where the fifth was
  dGeomSetPosition(late, 0, 0, 20);
  mirror.refresh();
  EXPECT_EQ(std::vector(mirror.moved().begin(), mirror.moved().end()), std::vector{third});
  EXPECT_EQ(std::set(mirror.removed().begin(), mirror.removed().end()), (std::set{fifth, seventh, ninth}));
  EXPECT_EQ(std::set(mirror.added().begin(), mirror.added().end()),
            (std::set{slot_of(balls[7]), slot_of(balls[9]), slot_of(late)}));
  EXPECT_EQ(mirror.geoms()[third].position, Vec3(6, 4, 0));
  EXPECT_EQ(mirror.geoms()[third].previous_position, Vec3(6, 0, 0));
  EXPECT_EQ(mirror.geoms()[fifth].geom, nullptr);
  EXPECT_EQ(mirror.geoms()[fifth].bounds.center(), Vec3(10, 0, 0));  // for those who lay there
  EXPECT_TRUE(near(mirror, {6, 0, 0}).empty());
  EXPECT_TRUE(near(mirror, {10, 0, 0}).empty());
  EXPECT_EQ(near(mirror, {6, 4, 0}), std::vector{third});
  EXPECT_EQ(near(mirror, {0, 0, 20}), std::vector{slot_of(late)});
  mirror.refresh();
  EXPECT_TRUE(mirror.added().empty() && mirror.removed().empty() && mirror.moved().empty());
  EXPECT_EQ(mirror.geoms()[third].previous_position, Vec3(6, 4, 0));
}

// Put back to where it was, it goes on from there; another mirror's may be in another slot.
TEST_P(SpaceMirrorOf, AnArchiveTellsHowWhatMovedCameThere) {
  const dGeomID still = ball(9), goes = ball(0);
  SpaceMirror mirror(space);
  const auto go_to = [&](double x) { dGeomSetPosition(goes, x, 0, 0), mirror.refresh(); };
  for (const double x : {0.0, 0.1, 0.3}) go_to(x);
  StateArchive written;
  mirror.archive(written);
  go_to(0.7);
  dGeomSetPosition(still, 9, 1, 0);
  go_to(5.0);
  dGeomSetPosition(still, 9, 0, 0);
  SpaceMirror another(space);
  for (SpaceMirror* reader : {&mirror, &another}) {
    dGeomSetPosition(goes, 0.3, 0, 0);
    reader->refresh(), reader->refresh();
    StateArchive read(written.bytes(), {});
    reader->archive(read);
    EXPECT_TRUE(read.at_end());
    ASSERT_EQ(reader->moved().size(), 1U);
    const std::uint32_t slot = reader->moved()[0];
    EXPECT_EQ(reader->geoms()[slot].geom, goes);
    dGeomSetPosition(goes, 0.8, 0, 0);
    reader->refresh();
    EXPECT_NEAR(reader->way_on(slot), 0.2, 1e-12);
  }
}

TEST_P(SpaceMirrorOf, AnAddressUsedAgainIsAnotherGeom) {
  const dGeomID first = ball(1);
  SpaceMirror mirror(space);
  mirror.refresh();
  for (int i = 0; i < 50; ++i) {
    dGeomDestroy(i == 0 ? first : dGeomID(*held(mirror).begin()));
    const dGeomID next = dCreateSphere(space, 0.5 + 0.01 * (i + 1));
    dGeomSetPosition(next, 1, 0, 0);
    mirror.refresh();
    ASSERT_EQ(held(mirror), std::set{next});
    ASSERT_EQ(mirror.added().size(), 1u);
    ASSERT_EQ(mirror.removed().size(), 1u);
    ASSERT_EQ(near(mirror, {1, 0, 0}).size(), 1u);
  }
  EXPECT_LE(mirror.geoms().size(), 2u);  // slots are used again
}

// Its addresses may be those of the one before, its bounds the same, too.
TEST_P(SpaceMirrorOf, AMeshMadeAnewOrInPlaceIsAnother) {
  const std::array<dTriIndex, 6> corners{0, 1, 2, 0, 2, 3};
  std::array<float, 12> vertices{-3, -3, 0, 3, -3, 1, 3, 3, 0, -3, 3, 1};
  dTriMeshDataID data = nullptr;
  const auto build = [&] {
    dGeomTriMeshDataBuildSingle(data, vertices.data(), 3 * sizeof(float), 4, corners.data(), 6,
                                3 * sizeof(dTriIndex));
  };
  dGeomID mesh = nullptr;
  const auto make = [&] {
    data = dGeomTriMeshDataCreate();
    build();
    mesh = dCreateTriMesh(space, data, nullptr, nullptr, nullptr);
  };
  make();
  SpaceMirror mirror(space);
  mirror.refresh();
  mirror.refresh();
  EXPECT_TRUE(mirror.added().empty());
  for (const bool in_place : {false, true}) {
    if (in_place && dSpaceGetClass(space) == dQuadTreeSpaceClass) continue;  // ODE gives up there
    for (const int corner : {2, 5, 8, 11})
      vertices[std::size_t(corner)] = 1.0F - vertices[std::size_t(corner)];
    if (in_place) {
      build();
      dGeomTriMeshSetData(mesh, data);
    } else {
      dGeomDestroy(mesh);
      dGeomTriMeshDataDestroy(data);
      make();
    }
    mirror.refresh();
    EXPECT_EQ(mirror.added().size(), 1u) << in_place;
    EXPECT_EQ(mirror.removed().size(), 1u) << in_place;
  }
  dGeomSetPosition(mesh, 1, 0, 0);
  mirror.refresh();
  EXPECT_TRUE(mirror.added().empty());
  EXPECT_EQ(mirror.moved().size(), 1u);
  dGeomDestroy(mesh);
  dGeomTriMeshDataDestroy(data);
}

TEST_P(SpaceMirrorOf, BodiesThatBecomeKinematicOrAreTakenAway) {
  const dBodyID body = dBodyCreate(world);
  const dGeomID geom = ball(0);
  dGeomSetBody(geom, body);
  SpaceMirror mirror(space);
  mirror.refresh();
  const auto the_geom = [&] { return *std::ranges::find(mirror.geoms(), geom, &MirroredGeom::geom); };
  EXPECT_TRUE(the_geom().dynamic);
  EXPECT_EQ(the_geom().body, body);
  dBodySetKinematic(body);
  mirror.refresh();
  EXPECT_EQ(mirror.added().size(), 1u);
  EXPECT_FALSE(the_geom().dynamic);
  dGeomSetBody(geom, nullptr);
  mirror.refresh();
  EXPECT_EQ(mirror.removed().size(), 1u);
  EXPECT_EQ(the_geom().body, nullptr);
}

TEST_P(SpaceMirrorOf, FindsAsALookAtEachDoes) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-40, 40), step(-0.3, 0.3);
  std::vector<dGeomID> balls;
  for (int i = 0; i < 300; ++i) balls.push_back(ball(place(random), place(random), place(random)));
  SpaceMirror mirror(space);
  for (int round = 0; round < 40; ++round) {
    for (int i = 0; i < 100; ++i) {
      const dReal* p = dGeomGetPosition(balls[i]);
      dGeomSetPosition(balls[i], p[0] + step(random), p[1] + step(random), p[2] + step(random));
    }
    const std::size_t gone = std::size_t(100 + round);
    dGeomDestroy(balls[gone]);
    balls[gone] = ball(place(random), place(random), place(random));
    mirror.refresh();
    for (int i = 0; i < 20; ++i) {
      const Vec3 at(place(random), place(random), place(random));
      const Eigen::AlignedBox3d box(at - Vec3::Constant(6), at + Vec3::Constant(6));
      std::vector<std::uint32_t> found, expected;
      mirror.find_near(box, found);
      for (std::uint32_t slot = 0; slot < mirror.geoms().size(); ++slot)
        if (mirror.geoms()[slot].geom && mirror.geoms()[slot].bounds.intersects(box))
          expected.push_back(slot);
      ASSERT_EQ(found, expected);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryType, SpaceMirrorOf,
                         ::testing::Values(SpaceType::simple, SpaceType::hash, SpaceType::sweep,
                                           SpaceType::quadtree));

TEST(BoxTree, BoxesWithoutEndAreFoundAnywhere) {
  BoxTree tree;
  const double endless = std::numeric_limits<double>::infinity();
  const BoxTree::Entry entries[] = {{0, {Vec3(-endless, 0, 0), Vec3(endless, 1, 1)}},
                                    {1, {Vec3::Zero(), Vec3::Ones()}}};
  tree.add(entries);
  std::vector<std::uint32_t> found;
  tree.find({Vec3::Constant(50), Vec3::Constant(51)}, found);
  EXPECT_EQ(found, std::vector{0u});
  tree.remove(0);
  found.clear();
  tree.find({Vec3::Zero(), Vec3::Ones()}, found);
  EXPECT_EQ(found, std::vector{1u});
}

}  // namespace
}  // namespace lodestone
