// F8: meshes dropped in a pile: cubes, and concave shapes, which hook into each other and rest in each other's corners.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reference/ode/ode_world.h"
#include "reference/random.h"
#include "tools/bench/case_parts.h"
#include "tools/bench/contact_cases.h"

namespace lodestone {
namespace {

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
  double height = 0.0;      // m, of the highest start
  double top_speed = 0.0, mean_speed_at_end = 0.0;  // m/s
  double gain = 0.0;        // of energy in any step, over what the pile starts with
  double lowest = 0.0;      // m, of any vertex at the end
};

double energy_of(const Shape& shape, const RigidState& state) {  // J
  const Vec3 spin = state.orientation.conjugate() * state.angular_velocity;
  return kDensity * shape.volume * (0.5 * (state.velocity.squaredNorm() + spin.dot(shape.inertia_per_mass * spin)) + kGravity * state.position.z());
}

/// In layers of a square, a little more than a body's diameter apart.
RigidState start_of(const Pile& pile, int body) {
  RandomStream random(9, body, 0);
  const int side = int(std::cbrt(pile.bodies + 0.5));
  const double cell = 2.1 * pile.shape->radius;
  RigidState state;
  state.position = Vec3(body % side, body / side % side, body / (side * side)) * cell;
  state.position += Vec3(0.05 * cell * random.uniform(), 0.05 * cell * random.uniform(), 1.5 * pile.shape->radius);
  state.orientation = random.orientation();
  return state;
}

double lowest_point(const Shape& shape, const RigidState& state) {
  const Vec3 down = state.orientation.conjugate() * -Vec3::UnitZ();
  return (state.position + state.orientation * shape.hull.vertices[find_support(shape.hull, down)]).z();
}

class PileRun {
 public:
  explicit PileRun(const Pile& pile) : pile_(pile), materials_(make_materials()), world_(settings(pile.contacts), materials_) {
    world_.add_plane(Vec3::UnitZ(), 0.0, 0);
    for (int i = 0; i < pile.bodies; ++i) {
      const RigidState state = start_of(pile, i);
      figures_.height = std::max(figures_.height, state.position.z());
      bodies_.push_back(world_.add_body({.shape = pile.shape, .mass = kDensity * pile.shape->volume, .state = state}));
    }
  }

  Figures run() {
    const double at_first = energy();
    double least = at_first;
    for (double t = 0.0; t < kSeconds; t += kStep) {
      world_.step(kStep, kSubsteps);
      const double now = energy();
      figures_.gain = std::max(figures_.gain, (now - least) / at_first);
      least = std::min(least, now);
      figures_.top_speed = std::max(figures_.top_speed, top_speed());
    }
    for (const OdeBodyId body : bodies_) {
      figures_.mean_speed_at_end += world_.state(body).velocity.norm() / pile_.bodies;
      figures_.lowest = std::min(figures_.lowest, lowest_point(*pile_.shape, world_.state(body)));
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
    return {.quick_step_iterations = kIterations, .direct_contacts_max = kDirectContactsMax, .max_correcting_velocity = kCorrectingVelocity, .mesh_contacts = contacts};
  }
  double energy() const {
    double sum = 0.0;
    for (const OdeBodyId body : bodies_) sum += energy_of(*pile_.shape, world_.state(body));
    return sum;
  }
  double top_speed() const {
    double top = 0.0;
    for (const OdeBodyId body : bodies_) top = std::max(top, world_.state(body).velocity.norm());
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
  rows.push_back({what + ": top speed", figures.top_speed, 1.05 * std::sqrt(2.0 * kGravity * figures.height), "m/s"});
  rows.push_back({what + ": mean speed after 6 s", figures.mean_speed_at_end, 0.02, "m/s"});
  rows.push_back({what + ": deepest vertex under the floor over the size", -figures.lowest / pile.shape->size, 0.02});
  rows.push_back({what + ": energy gained in a step over that at first", figures.gain, 1e-3});
}

}  // namespace

std::vector<HardCaseRow> measure_piles(const HardCaseSettings& settings) {
  const auto l = share(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)));
  const int ls = settings.quick ? 12 : 27;
  // L-shapes meet as two convex pieces each; other concave shapes through the filter, which must hold for these, too.
  std::vector<Pile> piles = {{"L-shapes", l, ls}, {"L-shapes by the contact filter", l, ls, MeshContacts::filtered}};
  if (!settings.quick) {
    piles.push_back({"cubes", share(make_shape("cube", make_box(Vec3::Constant(0.3)))), 64});
    piles.push_back({"bunnies", share(make_bunny_shape(0.2)), 12});
  }
  std::vector<HardCaseRow> rows;
  for (const Pile& pile : piles) add_rows(rows, pile);
  return rows;
}

}  // namespace lodestone
