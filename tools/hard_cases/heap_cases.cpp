// F7 and F8: trimeshes in stacks and in piles.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reference/free_rotation.h"
#include "reference/ode/ode_world.h"
#include "reference/random.h"
#include "tools/hard_cases/case_parts.h"
#include "tools/hard_cases/hard_case.h"

namespace lodestone {
namespace {

// F7: stacks of trimesh cubes, each turned and moved aside a little, beside the same stacks of ODE's box
// primitives.
namespace stacks {

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
    for (int i = 0; i < 3; ++i)
      fine.vertices.push_back(0.5 * (mesh.vertices[face[i]] + mesh.vertices[face[(i + 1) % 3]]));
    for (const auto& [a, b, c] : {std::array{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}})
      fine.faces.push_back({first + a, first + b, first + c});
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
    bodies.push_back(world.add_body(
        {.shape = cube, .mass = kDensity * cube->volume, .state = start_of(i), .geometry = geometry}));
  Figures figures;
  for (int i = 0; i < int(std::lround(kSeconds / stack.dt)); ++i) {
    world.step(stack.dt);
    for (const OdeBodyId body : bodies)
      figures.top_speed = worse(figures.top_speed, world.state(body).velocity.norm());
  }
  for (int i = 0; i < stack.cubes; ++i) {
    const Vec3 moved = world.state(bodies[i]).position - start_of(i).position;
    figures.sag = worse(figures.sag, kSide * (0.5 + i) - world.state(bodies[i]).position.z());
    figures.drift = worse(figures.drift, moved.head<2>().norm());
  }
  return figures;
}

/// Where the primitive's own figure is next to nothing, `negligible` of ours is, too.
HardCaseRow row_of(const std::string& what, const char* figure, double ours, double primitive,
                   double negligible, const char* unit) {
  return {fmt::format("{}: {} (primitives {:.3g})", what, figure, primitive), ours,
          std::max(2.0 * primitive, negligible), unit};
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const std::array<std::shared_ptr<const Shape>, 2> cubes = {make_cube(0), make_cube(3)};
  std::vector<HardCaseRow> rows;
  for (const int count : {2, 5, 10})
    for (const double dt : {1.0 / 60, 1.0 / 100, 1.0 / 500}) {
      if (settings.quick && (count == 10 || dt < 1.0 / 100)) continue;
      const Figures primitive = measure({count, dt}, cubes[0], OdeGeometry::box);
      for (const auto& cube : cubes) {
        const Figures ours = measure({count, dt}, cube, OdeGeometry::trimesh);
        const std::string what =
            fmt::format("{} cubes of {} triangles, 1/{:.0f} s", count, cube->mesh.faces.size(), 1.0 / dt);
        rows.push_back(row_of(what, "sag", 1e3 * ours.sag, 1e3 * primitive.sag, 0.1, "mm"));
        rows.push_back(row_of(what, "drift", 1e3 * ours.drift, 1e3 * primitive.drift, 1.0, "mm"));
        rows.push_back(row_of(what, "top speed", ours.top_speed, primitive.top_speed, 0.01, "m/s"));
      }
    }
  return rows;
}

}  // namespace stacks

// F8: meshes dropped in a pile: cubes, and concave shapes, which hook into each other and rest in each
// other's corners.
namespace piles {

constexpr double kDensity = 1000.0, kSeconds = 6.0, kStep = 1.0 / 60, kGravity = 9.81;
constexpr int kSubsteps = 4, kDirectContactsMax = 150, kIterations = 60;  // as the full level has them
constexpr double kCorrectingVelocity = 1.0;

struct Pile {
  std::string what;
  std::shared_ptr<const Shape> shape;
  int bodies = 0;
  MeshContacts contacts = MeshContacts::exact;
};

struct Figures {
  double height = 0.0;                              // m, of the highest start
  double top_speed = 0.0, mean_speed_at_end = 0.0;  // m/s
  double gain = 0.0;                                // of energy in any step, over what the pile starts with
  double lowest = 0.0;                              // m, of any vertex at the end
};

double energy_of(const Shape& shape, const RigidState& state) {  // J
  return kDensity * shape.volume * (kinetic_energy(shape, state) + kGravity * state.position.z());
}

/// In layers of a square, a little more than a body's diameter apart.
RigidState start_of(const Pile& pile, int body) {
  RandomStream random(9, body, 0);
  const int side = int(std::cbrt(pile.bodies + 0.5));
  const double cell = 2.1 * pile.shape->radius;
  RigidState state;
  state.position = Vec3(body % side, body / side % side, body / (side * side)) * cell;
  const double y = 0.05 * cell * random.uniform(), x = 0.05 * cell * random.uniform();
  state.position += Vec3(x, y, 1.5 * pile.shape->radius);
  state.orientation = random.orientation();
  return state;
}

double lowest_point(const Shape& shape, const RigidState& state) {
  const Vec3 down = state.orientation.conjugate() * -Vec3::UnitZ();
  return (state.position + state.orientation * shape.hull.vertices[find_support(shape.hull, down)]).z();
}

class PileRun {
 public:
  explicit PileRun(const Pile& pile)
      : pile_(pile), materials_(make_materials()), world_(settings(pile.contacts), materials_) {
    world_.add_plane(Vec3::UnitZ(), 0.0, 0);
    for (int i = 0; i < pile.bodies; ++i) {
      const RigidState state = start_of(pile, i);
      figures_.height = worse(figures_.height, state.position.z());
      bodies_.push_back(
          world_.add_body({.shape = pile.shape, .mass = kDensity * pile.shape->volume, .state = state}));
    }
  }

  Figures run() {
    const double at_first = energy();
    double least = at_first;
    for (double t = 0.0; t < kSeconds; t += kStep) {
      world_.step(kStep, kSubsteps);
      const double now = energy();
      figures_.gain = worse(figures_.gain, (now - least) / at_first);
      least = lesser(least, now);
      figures_.top_speed = worse(figures_.top_speed, top_speed());
    }
    for (const OdeBodyId body : bodies_) {
      figures_.mean_speed_at_end += world_.state(body).velocity.norm() / pile_.bodies;
      figures_.lowest = lesser(figures_.lowest, lowest_point(*pile_.shape, world_.state(body)));
    }
    return figures_;
  }

 private:
  static MaterialTable make_materials() {
    MaterialTable materials;
    materials.replace(0, {.restitution = 0.0, .friction = 0.5});
    return materials;
  }
  static OdeSettings settings(MeshContacts contacts) {
    return {.quick_step_iterations = kIterations,
            .direct_contacts_max = kDirectContactsMax,
            .max_correcting_velocity = kCorrectingVelocity,
            .mesh_contacts = contacts};
  }
  double energy() const {
    double sum = 0.0;
    for (const OdeBodyId body : bodies_) sum += energy_of(*pile_.shape, world_.state(body));
    return sum;
  }
  double top_speed() const {
    double top = 0.0;
    for (const OdeBodyId body : bodies_) top = worse(top, world_.state(body).velocity.norm());
    return top;
  }

  const Pile& pile_;
  MaterialTable materials_;
  OdeWorld world_;
  std::vector<OdeBodyId> bodies_;
  Figures figures_;
};

void add_rows(std::vector<HardCaseRow>& rows, const Pile& pile) {
  const Figures figures = PileRun(pile).run();
  const std::string what = fmt::format("{} {} in a pile", pile.bodies, pile.what);
  rows.push_back(
      {what + ": top speed", figures.top_speed, 1.05 * std::sqrt(2.0 * kGravity * figures.height), "m/s"});
  rows.push_back({what + ": mean speed after 6 s", figures.mean_speed_at_end, 0.02, "m/s"});
  rows.push_back(
      {what + ": deepest vertex under the floor over the size", -figures.lowest / pile.shape->size, 0.02});
  rows.push_back({what + ": energy gained in a step over that at first", figures.gain, 1e-3});
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const auto l = share(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)));
  const int ls = settings.quick ? 12 : 27;
  // L-shapes meet as two convex pieces each; other concave shapes through the filter, which must hold for
  // these, too.
  std::vector<Pile> piles = {{"L-shapes", l, ls},
                             {"L-shapes by the contact filter", l, ls, MeshContacts::filtered}};
  if (!settings.quick) {
    piles.push_back({"cubes", share(make_shape("cube", make_box(Vec3::Constant(0.3)))), 64});
    piles.push_back({"bunnies", share(make_bunny_shape(0.2)), 12});
  }
  std::vector<HardCaseRow> rows;
  for (const Pile& pile : piles) add_rows(rows, pile);
  return rows;
}

}  // namespace piles

}  // namespace

std::span<const HardCase> heap_cases() {
  static constexpr std::array kCases = {
      HardCase{"F7", stacks::measure_case},
      HardCase{"F8", piles::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
