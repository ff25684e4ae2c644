// F9 and F19: trimeshes in random poses, and hooked into each other.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "reference/hull/hull_overlap.h"
#include "reference/ode/ode_world.h"
#include "reference/random.h"
#include "tools/hard_cases/case_parts.h"
#include "tools/hard_cases/hard_case.h"

namespace lodestone {
namespace {

// F9, the contact oracle: two bodies in random poses, overlapping by a little or a lot. For convex bodies the
// oracle is the least depth over every direction that can be the least (each face's normal, each pair of
// edges' cross product), and a sweep of directions besides. Concave bodies are clear of each other once their
// hulls are, so no contact of theirs may be deeper than the hulls'.
namespace contact_depths {

constexpr double kTolerance = 2.5e-3;                   // of the smaller body's size
constexpr double kDepths[] = {1e-4, 1e-3, 1e-2, 5e-2};  // of the first body's size, at which pairs are posed

struct Pair {
  std::shared_ptr<const Shape> first, second;
  RigidState first_state, second_state;
  double size() const { return std::min(first->size, second->size); }
};

/// How far the first body must go along `direction` (unit) to be clear of the second's hull.
double depth_along(const Pair& pair, const Vec3& direction) {
  const auto farthest = [](const Shape& shape, const RigidState& state, const Vec3& d) {
    const Vec3 in_body = state.orientation.conjugate() * d;
    return d.dot(state.position) +
           in_body.dot(
               shape.hull.vertices[find_support(shape.hull, in_body, shape.support_map.find_start(in_body))]);
  };
  return farthest(*pair.second, pair.second_state, direction) +
         farthest(*pair.first, pair.first_state, -direction);
}

std::vector<Vec3> face_normals(const Shape& shape, const Quat& orientation) {
  std::vector<Vec3> normals;
  for (int i = 0; i < int(shape.hull.faces.size()); ++i)
    normals.push_back(orientation * shape.hull.face_normals[std::size_t(i)]);
  return normals;
}

std::vector<Vec3> edge_directions(const Shape& shape, const Quat& orientation) {
  std::vector<Vec3> edges;
  for (int i = 0; i < int(shape.hull.vertices.size()); ++i)
    for (const int j : shape.hull.neighbors(i))
      if (j > i)
        edges.push_back(orientation * (shape.hull.vertices[j] - shape.hull.vertices[i]).normalized());
  return edges;
}

/// Over a sweep of directions, and over all that a face or two edges ask for.
double measure_true_depth(const Pair& pair) {
  double least = std::numeric_limits<double>::infinity();
  const auto try_both = [&](const Vec3& direction) {
    least = std::min({least, depth_along(pair, direction), depth_along(pair, -direction)});
  };
  for (const Vec3& normal : face_normals(*pair.first, pair.first_state.orientation)) try_both(normal);
  for (const Vec3& normal : face_normals(*pair.second, pair.second_state.orientation)) try_both(normal);
  const auto edges = edge_directions(*pair.second, pair.second_state.orientation);
  for (const Vec3& a : edge_directions(*pair.first, pair.first_state.orientation))
    for (const Vec3& b : edges)
      if (const Vec3 across = a.cross(b); across.norm() > 1e-6) try_both(across.normalized());
  return least;
}

std::shared_ptr<const Shape> make_random_hull(RandomStream& random) {
  std::vector<Vec3> points(8 + int(random.uniform() * 8));
  for (Vec3& point : points) {
    const Vec3 direction = random.direction();
    point = random.uniform(0.35, 0.5) * direction;
  }
  const Hull hull = make_hull(points);
  return std::make_shared<const Shape>(make_shape("random hull", Mesh{hull.vertices, hull.faces}));
}

/// The second body at the origin, the first beside it at a random distance that makes them overlap by about
/// `depth` of the size.
void pose(Pair& pair, double depth, RandomStream& random) {
  pair.second_state = {.orientation = random.orientation()};
  pair.first_state = {.orientation = random.orientation()};
  const Vec3 away = random.direction();
  double near = 0.0, far = pair.first->radius + pair.second->radius;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (near + far);
    pair.first_state.position = middle * away;
    (measure_hull_overlap(*pair.first, pair.first_state, *pair.second, pair.second_state) >
             depth * pair.size()
         ? near
         : far) = middle;
  }
  pair.first_state.position = near * away;
}

struct Excess {
  double worst = 0.0;  // beyond the oracle, over the size
  int too_deep = 0, missed = 0, poses = 0;
};

/// Of the contacts that one step makes of the two, in a world without gravity.
void add_excess(Excess& excess, const Pair& pair, double oracle, MeshContacts way) {
  const MaterialTable materials;
  OdeWorld world({.gravity = Vec3::Zero(), .mesh_contacts = way}, materials);
  world.add_body({.shape = pair.first, .state = pair.first_state});
  world.add_body({.shape = pair.second, .state = pair.second_state});
  world.step(1e-6);
  double deepest = -1.0;
  for (const OdeContact& contact : world.contacts()) deepest = worse(deepest, contact.depth);
  const double over = (deepest - oracle) / pair.size();
  excess.worst = worse(excess.worst, over);
  excess.too_deep += over > kTolerance;
  excess.missed += deepest < 0.0;
  ++excess.poses;
}

/// `make` gives the pair of pose i; `oracle` its greatest sound depth (m).
template <class Make, class Oracle>
Excess measure_excess(int poses, MeshContacts way, Make make, Oracle oracle) {
  Excess excess;
  for (int i = 0; i < poses; ++i) {
    RandomStream random(9, i, 0);
    Pair pair = make(random);
    pose(pair, kDepths[i % std::size(kDepths)], random);
    add_excess(excess, pair, oracle(pair), way);
  }
  return excess;
}

HardCaseRow depth_row(const std::string& what, const Excess& excess, const std::string& odes_own = "") {
  return {fmt::format("{}, {} poses ({} too deep): worst depth beyond the truth over the size", what,
                      excess.poses, excess.too_deep),
          excess.worst,
          kTolerance,
          "",
          BoundSide::at_most,
          odes_own};
}

HardCaseRow missed_row(const std::string& what, const Excess& excess) {
  return {fmt::format("{}: overlaps without a contact", what), double(excess.missed), 0.0};
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const int poses = settings.quick ? 400 : 10'000, concave_poses = settings.quick ? 100 : 1'000;
  const auto box = std::make_shared<const Shape>(make_shape("box", make_box({0.6, 0.8, 1.0})));
  const auto l = std::make_shared<const Shape>(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)));
  const auto random_hulls = [](RandomStream& random) {
    return Pair{make_random_hull(random), make_random_hull(random), {}, {}};
  };
  const auto boxes = [&](RandomStream&) { return Pair{box, box, {}, {}}; };
  const auto ls = [&](RandomStream&) { return Pair{l, l, {}, {}}; };
  const auto of_hulls = [](const Pair& pair) {
    return measure_hull_overlap(*pair.first, pair.first_state, *pair.second, pair.second_state);
  };

  const Excess of_random = measure_excess(poses / 2, MeshContacts::exact, random_hulls, measure_true_depth);
  const Excess of_boxes = measure_excess(poses / 2, MeshContacts::exact, boxes, measure_true_depth);
  const Excess of_ls = measure_excess(concave_poses, MeshContacts::exact, ls, of_hulls);
  const Excess plain = measure_excess(concave_poses, MeshContacts::plain, boxes, measure_true_depth);
  return {depth_row("random hulls", of_random),
          missed_row("random hulls", of_random),
          depth_row("boxes", of_boxes),
          missed_row("boxes", of_boxes),
          depth_row("L-shapes, against their hulls", of_ls),
          depth_row("boxes, ODE's trimesh contacts as they are", plain,
                    "OPCODE measures crossing triangles against each other's planes; by default hulls meet "
                    "exactly, concave meshes through the contact filter")};
}

}  // namespace contact_depths

// F19: concave meshes that hold each other where their convex hulls could not: an L hooked into an L and
// pulled, an L pushed into another's corner, a bunny dropped on a bunny.
namespace concave {

constexpr double kDensity = 1000.0, kGravity = 9.81, kStep = 1.0 / 240;
constexpr double kCorrectingVelocity = 1.0;  // m/s
constexpr double kSlack = 2e-3;              // m, between surfaces at first

struct Figures {
  double moved = 0.0, depth = 0.0, speed = 0.0, gain = 0.0;  // m, m, m/s, J
};

/// Legs of 1 m, .2 m wide and thick; in the mesh's frame the inner corner is at (−.3, −.3).
std::shared_ptr<const Shape> make_hook() {
  return std::make_shared<const Shape>(make_shape("l", make_l(1.0, 1.0, 0.2, 0.2)));
}

/// The state in which the frame of the shape's mesh, turned by `orientation`, has its origin at `origin`.
RigidState place_mesh(const Shape& shape, const Vec3& origin, const Quat& orientation) {
  return {.position = origin + orientation * shape.center_of_mass_in_mesh, .orientation = orientation};
}

double deepest(const OdeWorld& world) {
  double depth = 0.0;
  for (const OdeContact& contact : world.contacts()) depth = worse(depth, contact.depth);
  return depth;
}

/// Two L-shapes, the first all but immovable; the second feels `force` for 2 s. What it does in the last
/// quarter second counts as its end.
Figures push(const Vec3& origin, const Quat& orientation, const Vec3& force) {
  const MaterialTable materials = materials_of(0.0, 0.3);
  OdeWorld world({.gravity = Vec3::Zero(), .max_correcting_velocity = kCorrectingVelocity}, materials);
  const auto hook = make_hook();
  const double mass = kDensity * hook->volume;
  world.add_body(
      {.shape = hook, .mass = 1e6 * mass, .state = place_mesh(*hook, Vec3::Zero(), Quat::Identity())});
  const RigidState start = place_mesh(*hook, origin, orientation);
  const OdeBodyId pulled = world.add_body({.shape = hook, .mass = mass, .state = start});
  Figures figures;
  for (int i = 0; i < 480; ++i) {
    world.add_force(pulled, mass * kGravity * force, Vec3::Zero());
    world.step(kStep);
    if (i < 420) continue;
    figures.depth = worse(figures.depth, deepest(world));
    figures.speed = worse(figures.speed, world.state(pulled).velocity.norm());
  }
  figures.moved = (world.state(pulled).position - start.position).norm();
  return figures;
}

/// The second, half a turn round, has a leg in the first's corner and the other over the end of the first's
/// leg.
Figures pull_hooked() {
  return push({-0.6 + kSlack, 0.2 + kSlack, 0.0}, Quat(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitZ())),
              {-10, 0, 0});
}

/// The second as it is, moved along the diagonal by the width of a leg: its outer corner in the first's inner
/// corner.
Figures push_into_corner() {
  return push({0.2 + kSlack, 0.2 + kSlack, 0.0}, Quat::Identity(), {-10, -10, 0});
}

Figures drop_bunny_on_bunny(std::uint32_t trial) {
  RandomStream random(19, trial, 0);
  const MaterialTable materials = materials_of(0.0, 0.5);
  OdeWorld world({.max_correcting_velocity = kCorrectingVelocity}, materials);
  world.add_plane(Vec3::UnitZ(), 0.0, 0);
  const auto bunny = std::make_shared<const Shape>(make_bunny_shape(0.2));
  const double mass = kDensity * bunny->volume;
  std::vector<OdeBodyId> bodies;
  for (int i = 0; i < 2; ++i) {
    const double y = 0.02 * random.uniform() * i, x = 0.02 * random.uniform() * i;
    const Vec3 position(x, y, bunny->radius * (1.1 + 2.1 * i));
    bodies.push_back(world.add_body({.shape = bunny,
                                     .mass = mass,
                                     .state = {.position = position, .orientation = random.orientation()}}));
  }
  Figures figures;
  const auto energy = [&] {
    double sum = 0.0;
    for (const OdeBodyId body : bodies)
      sum +=
          kinetic_energy(*bunny, mass, world.state(body)) + mass * kGravity * world.state(body).position.z();
    return sum;
  };
  double least = energy();
  for (int i = 0; i < 960; ++i) {
    world.step(kStep);
    figures.gain = worse(figures.gain, energy() - least);
    least = lesser(least, energy());
    if (i < 900) continue;
    for (const OdeContact& contact : world.contacts())
      if (contact.second) figures.depth = worse(figures.depth, contact.depth);
  }
  return figures;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const Figures hooked = pull_hooked(), corner = push_into_corner();
  Figures bunnies;
  const int trials = settings.quick ? 2 : 12;
  const Shape bunny = make_bunny_shape(0.2);
  const double corrected = 0.5 * kDensity * bunny.volume * kCorrectingVelocity * kCorrectingVelocity;
  for (int i = 0; i < trials; ++i) {
    const Figures trial = drop_bunny_on_bunny(i);
    bunnies.depth = worse(bunnies.depth, trial.depth);
    bunnies.gain = worse(bunnies.gain, trial.gain);
  }
  return {{"L hooked into an L, pulled by 10 times its weight for 2 s: moved", 1e3 * hooked.moved,
           2e3 * kSlack, "mm"},
          {"L hooked into an L: deepest contact at the end", 1e3 * hooked.depth, 1.0, "mm"},
          {"L hooked into an L: speed at the end", hooked.speed, 2e-3, "m/s"},
          {"L pushed into the corner of an L: moved", 1e3 * corner.moved, 2e3 * kSlack, "mm"},
          {"L pushed into the corner of an L: deepest contact at the end", 1e3 * corner.depth, 1.0, "mm"},
          {"L pushed into the corner of an L: speed at the end", corner.speed, 2e-3, "m/s"},
          {fmt::format("bunny dropped on bunny, {} times: deepest mutual contact after 3.75 s over the size",
                       trials),
           bunnies.depth / bunny.size, 2.5e-3},
          {fmt::format("bunny dropped on bunny, {} times: energy gained in a step over what pushing a bunny "
                       "out of an overlap may give it",
                       trials),
           bunnies.gain / corrected, 1.0}};
}

}  // namespace concave

}  // namespace

std::span<const HardCase> contact_cases() {
  static constexpr std::array kCases = {
      HardCase{"F9", contact_depths::measure_case},
      HardCase{"F19", concave::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
