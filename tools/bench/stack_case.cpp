// F7: stacks of trimesh cubes, each turned and moved aside a little, beside the same stacks of ODE's box primitives.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reference/ode/ode_world.h"
#include "reference/random.h"
#include "tools/bench/contact_cases.h"

namespace lodestone {
namespace {

constexpr double kSide = 0.5, kDensity = 1000.0, kSeconds = 3.0;
constexpr double kDrop = 1e-3;  // × side: every cube's gap to the next

struct Stack {
  int cubes = 0;
  double dt = 0.0;  // s
};

struct Figures {
  double sag = 0.0, drift = 0.0, top_speed = 0.0;  // m, m, m/s
};

Mesh split_faces(const Mesh& mesh) {
  Mesh fine;
  for (const auto& face : mesh.faces) {
    const int first = int(fine.vertices.size());
    for (const int i : face) fine.vertices.push_back(mesh.vertices[i]);
    for (int i = 0; i < 3; ++i) fine.vertices.push_back(0.5 * (mesh.vertices[face[i]] + mesh.vertices[face[(i + 1) % 3]]));
    for (const auto& [a, b, c] : {std::array{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}) fine.faces.push_back({first + a, first + b, first + c});
  }
  return fine;
}

/// 12 × 4ⁿ triangles.
std::shared_ptr<const Shape> make_cube(int splits) {
  Mesh mesh = make_box(Vec3::Constant(kSide));
  for (int i = 0; i < splits; ++i) mesh = split_faces(mesh);
  return std::make_shared<const Shape>(make_shape("cube", mesh));
}

RigidState start_of(int cube) {
  RandomStream random(7, cube, 0);
  RigidState state;
  state.orientation = Quat(Eigen::AngleAxisd(random.uniform(-0.3, 0.3), Vec3::UnitZ()));
  state.position = {random.uniform(-0.03, 0.03) * kSide, 0.0, kSide * (0.5 + cube + kDrop * (cube + 1))};
  return state;
}

Figures measure(const Stack& stack, const std::shared_ptr<const Shape>& cube, OdeGeometry geometry) {
  MaterialTable materials;
  materials.replace(0, {.restitution = 0.0, .friction = 0.5});
  OdeWorld world({}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  std::vector<OdeBodyId> bodies;
  for (int i = 0; i < stack.cubes; ++i)
    bodies.push_back(world.add_body({.shape = cube, .mass = kDensity * cube->volume, .state = start_of(i), .geometry = geometry}));
  Figures figures;
  for (int i = 0; i < int(std::lround(kSeconds / stack.dt)); ++i) {
    world.step(stack.dt);
    for (const OdeBodyId body : bodies) figures.top_speed = std::max(figures.top_speed, world.state(body).velocity.norm());
  }
  for (int i = 0; i < stack.cubes; ++i) {
    const Vec3 moved = world.state(bodies[i]).position - start_of(i).position;
    figures.sag = std::max(figures.sag, kSide * (0.5 + i) - world.state(bodies[i]).position.z());
    figures.drift = std::max(figures.drift, moved.head<2>().norm());
  }
  return figures;
}

/// Where the primitive's own figure is next to nothing, `negligible` of ours is, too.
HardCaseRow row_of(const std::string& what, const char* figure, double ours, double primitive, double negligible, const char* unit) {
  return {fmt::format("{}: {} (primitives {:.3g})", what, figure, primitive), ours, std::max(2.0 * primitive, negligible), unit};
}

}  // namespace

std::vector<HardCaseRow> measure_stacks(const HardCaseSettings& settings) {
  const std::array<std::shared_ptr<const Shape>, 2> cubes = {make_cube(0), make_cube(3)};
  std::vector<HardCaseRow> rows;
  for (const int count : {2, 5, 10})
    for (const double dt : {1.0 / 60, 1.0 / 100, 1.0 / 500}) {
      if (settings.quick && (count == 10 || dt < 1.0 / 100)) continue;
      const Figures primitive = measure({count, dt}, cubes[0], OdeGeometry::box);
      for (const auto& cube : cubes) {
        const Figures ours = measure({count, dt}, cube, OdeGeometry::trimesh);
        const std::string what = fmt::format("{} cubes of {} triangles, 1/{:.0f} s", count, cube->mesh.faces.size(), 1.0 / dt);
        rows.push_back(row_of(what, "sag", 1e3 * ours.sag, 1e3 * primitive.sag, 0.1, "mm"));
        rows.push_back(row_of(what, "drift", 1e3 * ours.drift, 1e3 * primitive.drift, 1.0, "mm"));
        rows.push_back(row_of(what, "top speed", ours.top_speed, primitive.top_speed, 0.01, "m/s"));
      }
    }
  return rows;
}

}  // namespace lodestone
