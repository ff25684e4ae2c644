// Closed meshes thinner than what bodies sink in within a substep.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <utility>

#include "lod/manager.h"
#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone {
namespace {

using namespace testing;

// A table top of 2 cm, to which bodies come that sink through it within a substep: as a mesh of the
// manager's, and as one of the caller's on a kinematic body.
class ThinMesh : public ::testing::TestWithParam<bool> {
 protected:
  static constexpr double kThickness = 0.02, kHeight = 3.0, kGravity = 9.81;  // m, m/s²

  // How many of `count` end under it, and how many have more energy than they came with on the way.
  std::pair<int, int> drop(const std::shared_ptr<const Shape>& shape, std::uint32_t count) {
    int under = 0, gained = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      RandomStream random(91, i, 0);
      const CallersTable table(GetParam());
      Manager manager(table.world, table.space, {});
      manager.materials().replace(0, {.restitution = 0.4, .friction = 0.5});
      if (!GetParam()) manager.add_static_mesh(table.mesh);
      const BodyId body =
          manager.add_body({.shape = shape,
                            .state = {.position = {0, 0, kHeight},
                                      .orientation = random.orientation(),
                                      .angular_velocity = random.uniform(0, 8) * random.direction()},
                            .level = LevelChoice::full});
      const auto energy = [&] {  // over m g, m
        const RigidState state = manager.state(body);
        const Vec3 own = state.orientation.conjugate() * state.angular_velocity;
        return state.position.z() +
               0.5 * (state.velocity.squaredNorm() + own.dot(shape->inertia_per_mass * own)) / kGravity;
      };
      const double before = energy();
      bool has_gained = false;
      for (int step = 0; step < 90; ++step) {
        manager.step(1.0 / 60);
        has_gained |= energy() > before + 0.02;
      }
      gained += has_gained;
      under += manager.state(body).position.z() < 0.0;
    }
    return {under, gained};
  }

 private:
  struct CallersTable {
    explicit CallersTable(bool of_caller) {
      dInitODE2(0);
      dAllocateODEDataForThread(dAllocateMaskAll);
      world = dWorldCreate();
      space = dHashSpaceCreate(nullptr);
      data = dGeomTriMeshDataCreate();
      dWorldSetGravity(world, 0, 0, -kGravity);
      if (!of_caller) return;
      for (const Vec3& v : mesh.vertices) corners.insert(corners.end(), {v.x(), v.y(), v.z()});
      for (const auto& f : mesh.faces)
        indices.insert(indices.end(), {dTriIndex(f[0]), dTriIndex(f[1]), dTriIndex(f[2])});
      dGeomTriMeshDataBuildDouble(data, corners.data(), 3 * sizeof(double), int(mesh.vertices.size()),
                                  indices.data(), int(indices.size()), 3 * sizeof(dTriIndex));
      const dBodyID body = dBodyCreate(world);
      dBodySetKinematic(body);
      dGeomSetBody(dCreateTriMesh(space, data, nullptr, nullptr, nullptr), body);
    }
    ~CallersTable() {
      dSpaceDestroy(space);
      dWorldDestroy(world);
      dGeomTriMeshDataDestroy(data);
    }
    CallersTable(const CallersTable&) = delete;
    CallersTable& operator=(const CallersTable&) = delete;

    const Mesh mesh = make_box({8, 8, kThickness});
    std::vector<double> corners;
    std::vector<dTriIndex> indices;
    dWorldID world;
    dSpaceID space;
    dTriMeshDataID data;
  };
};

TEST_P(ThinMesh, HoldsWhatSinksThroughItWithinASubstep) {
  for (const Vec3& sides : {Vec3(0.3, 0.3, 0.02), Vec3(0.04, 0.1, 0.6), Vec3(0.2, 0.3, 0.4)}) {
    const auto [under, gained] = drop(box_shape(sides), 40);
    EXPECT_EQ(under, 0) << sides.transpose();
    EXPECT_EQ(gained, 0) << sides.transpose();
  }
  const auto [under, gained] =
      drop(std::make_shared<const Shape>(make_shape("L", make_l(0.3, 0.2, 0.08, 0.1))), 40);
  EXPECT_EQ(under, 0);
  EXPECT_EQ(gained, 0);
}

INSTANTIATE_TEST_SUITE_P(OfWhom, ThinMesh, ::testing::Bool(),
                         [](const auto& of) { return of.param ? "caller" : "manager"; });

}  // namespace
}  // namespace lodestone
