// S10, S14, S16, S17: many statistical bodies, in a heap, in other orders, in the air, in towers.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "reference/hull/hull_overlap.h"
#include "reference/random.h"
#include "tools/hard_cases/hard_case.h"
#include "tools/hard_cases/statistical_case_parts.h"

namespace lodestone {
namespace {

// S10: ten thousand boxes fall into a heap and lie for a minute.
namespace great_pile {

constexpr double kStill = 0.05;  // m/s

struct PileSize {
  int side, layers, seconds;
};

struct Figures {
  int hovering = 0;
  double overlap = 0.0;          ///< over a radius
  double energy_gain = 0.0;      ///< within a second, over that at first
  double kinetic_rise = -1e300;  ///< from one third of the time to the next, over the greatest
  double kinetic_left = 0.0;     ///< at the end, over the greatest
};

class Pile {
 public:
  Pile(const NamedModel& model, const PileSize& size)
      : size_(size),
        manager_(make_case_manager({.model = model.model, .signature = find_case_signature(*box_)})) {
    const double gap = 1.3 * box_->size;
    for (int i = 0; i < size.side * size.side * size.layers; ++i) {
      RandomStream random(115, std::uint64_t(i), 0);
      const int layer = i / (size.side * size.side);
      const Vec3 place(gap * (i % size.side + 0.5 * (layer % 2)),
                       gap * (i / size.side % size.side + 0.5 * (layer % 2)),
                       box_->size * (1.0 + 1.8 * layer));
      bodies_.push_back(add_case_body(
          manager_, box_,
          {.position = place + 0.02 * random.direction(), .orientation = random.orientation()}));
    }
    hovers_.assign(bodies_.size(), false);
  }

  Figures run() {
    const double first = energies().total;
    double total = first, greatest = 0.0, before = 1e300, sum = 0.0;
    const int tenth = std::max(1, size_.seconds / 10);
    for (int second = 1; second <= size_.seconds; ++second) {
      for (int i = 0; i < 60; ++i) manager_.step(kCaseStep);
      read_states();
      const Energies now = energies();
      figures_.energy_gain = worse(figures_.energy_gain, (now.total - total) / first);
      total = now.total;
      greatest = worse(greatest, now.kinetic);
      figures_.kinetic_left = now.kinetic / greatest;
      sum += now.kinetic;
      if (second % tenth == 0) {
        measure_overlap();
      }
      if (second % (size_.seconds / 3) == 0) {
        if (second > size_.seconds / 3)
          figures_.kinetic_rise = worse(figures_.kinetic_rise, (sum - before) / greatest);
        before = sum, sum = 0.0;
      }
      look_for_hovering();
    }
    return figures_;
  }

 private:
  struct Energies {
    double kinetic = 0.0, total = 0.0;
  };
  using Cell = std::array<int, 3>;

  void read_states() {
    states_.clear();
    cells_.clear();
    for (const BodyId body : bodies_) states_.push_back(manager_.state(body));
    for (std::size_t i = 0; i < states_.size(); ++i) cells_[cell_of(states_[i].position)].push_back(int(i));
  }

  Energies energies() const {
    Energies sum;
    for (const BodyId body : bodies_) {
      const RigidState state = manager_.state(body);
      const double kinetic = kinetic_energy(*box_, 1.0, state);
      sum.kinetic += kinetic, sum.total += kinetic + kCaseGravity * state.position.z();
    }
    return sum;
  }

  Cell cell_of(const Vec3& p) const {
    const double side = 2.0 * box_->radius;
    return {int(std::floor(p.x() / side)), int(std::floor(p.y() / side)), int(std::floor(p.z() / side))};
  }

  /// `look` at each other body whose bounding sphere meets that of body `i`.
  template <typename Look>
  void for_each_near(int i, Look look) const {
    const Cell at = cell_of(states_[i].position);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
      if (found == cells_.end()) continue;
      for (const int other : found->second)
        if (other != i && (states_[other].position - states_[i].position).norm() < 2.0 * box_->radius)
          look(other);
    }
  }

  void measure_overlap() {
    for (int i = 0; i < int(states_.size()); ++i)
      for_each_near(i, [&](int other) {
        if (other > i)
          figures_.overlap =
              worse(figures_.overlap,
                    measure_hull_overlap(*box_, states_[i], *box_, states_[other]) / box_->radius);
      });
  }

  // Still now and a second ago, more than a radius above the plane and clear of every other's bounding
  // sphere.
  void look_for_hovering() {
    for (int i = 0; i < int(states_.size()); ++i) {
      bool alone = states_[i].velocity.norm() < kStill &&
                   -measure_plane_overlap(*box_, states_[i], Vec3::UnitZ(), 0.0) > box_->radius;
      if (alone) for_each_near(i, [&](int) { alone = false; });
      figures_.hovering += alone && hovers_[i];
      hovers_[i] = alone;
    }
  }

  PileSize size_;
  std::shared_ptr<const Shape> box_ = box_of({0.2, 0.3, 0.25});
  Manager manager_;
  std::vector<BodyId> bodies_;
  std::vector<RigidState> states_;
  std::map<Cell, std::vector<int>> cells_;
  std::vector<bool> hovers_;
  Figures figures_;
};

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const PileSize size = settings.quick ? PileSize{8, 4, 21} : PileSize{50, 4, 60};
  std::vector<HardCaseRow> rows;
  for (const NamedModel& model : kBothModels) {
    const Figures figures = Pile(model, size).run();
    const std::string what = fmt::format("pile of {} boxes, {} s, {}: ", size.side * size.side * size.layers,
                                         size.seconds, model.name);
    rows.push_back({.what = what + "hover a radius off everything for a second",
                    .value = double(figures.hovering),
                    .bound = 0.0,
                    .unit = "bodies"});
    if (model.model == StatisticalModel::support)  // the spheres of `tables` leave hulls in each other
      rows.push_back(
          {.what = what + "greatest overlap over a radius", .value = figures.overlap, .bound = 0.1});
    rows.push_back({.what = what + "energy gained in a second over that at first",
                    .value = figures.energy_gain,
                    .bound = 1e-3});
    rows.push_back({.what = what + "rise of kinetic energy, third by third, over its greatest",
                    .value = figures.kinetic_rise,
                    .bound = 0.0});
    rows.push_back({.what = what + "kinetic energy left over its greatest",
                    .value = figures.kinetic_left,
                    .bound = 1e-3});
  }
  return rows;
}

}  // namespace great_pile

// S14: The same bodies in another order, and on other numbers of threads.
namespace orders {

constexpr int kBodies = 150;
constexpr double kSeconds = 2.0;

struct Subject {
  StatisticalModel model;
  std::shared_ptr<const Shape> shape;
  std::shared_ptr<const Signature> signature;
};

/// How bodies lie at first: `across` by `across`, `gap` m apart, in as many layers as that takes.
struct Layout {
  int across;
  double gap;
};
constexpr Layout kHeap{5, 0.35}, kApart{13, 5.0};

RigidState start_of(int i, const Layout& layout) {
  RandomStream random(117, std::uint64_t(i), 0);
  const int across = layout.across;
  return {.position = {layout.gap * (i % across), layout.gap * (i / across % across),
                       0.4 + 0.4 * (i / (across * across))},
          .orientation = random.orientation(),
          .angular_velocity = 3.0 * random.direction()};
}

/// The bodies' states at the end, by their number, added in the order `order`.
std::vector<RigidState> run(const Subject& subject, const std::vector<int>& order, const Layout& layout,
                            int threads) {
  Manager manager =
      make_case_manager({.model = subject.model, .threads = threads, .signature = subject.signature});
  std::vector<BodyId> bodies(order.size());
  for (const int i : order)
    bodies[std::size_t(i)] = add_case_body(manager, subject.shape, start_of(i, layout));
  for (int i = 0; i < int(kSeconds / kCaseStep); ++i) manager.step(kCaseStep);
  std::vector<RigidState> states;
  for (const BodyId body : bodies) states.push_back(manager.state(body));
  return states;
}

int count_different(const std::vector<RigidState>& a, const std::vector<RigidState>& b) {
  int different = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    different += a[i].position != b[i].position || a[i].orientation.coeffs() != b[i].orientation.coeffs() ||
                 a[i].velocity != b[i].velocity || a[i].angular_velocity != b[i].angular_velocity;
  return different;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  std::vector<int> in_order(kBodies);
  std::iota(in_order.begin(), in_order.end(), 0);
  std::vector<int> reversed(in_order.rbegin(), in_order.rend());
  const auto box = box_of({0.2, 0.3, 0.25});
  const auto signature = find_case_signature(*box);
  std::vector<HardCaseRow> rows;
  for (const auto& [model, name] : kBothModels) {
    const Subject subject{model, box, signature};
    const std::vector<RigidState> heap = run(subject, in_order, kHeap, 1);
    for (const int threads : {2, 5})
      rows.push_back(
          {.what = fmt::format("heap of {} boxes, {} threads, {}: states that differ from one thread's",
                               kBodies, threads, name),
           .value = double(count_different(heap, run(subject, in_order, kHeap, threads))),
           .bound = 0.0,
           .unit = "bodies"});
    if (model == StatisticalModel::tables) continue;  // whose draws are keyed by the body's number
    rows.push_back(
        {.what = fmt::format("{} boxes apart, added in reverse, {}: states that differ", kBodies, name),
         .value =
             double(count_different(run(subject, in_order, kApart, 1), run(subject, reversed, kApart, 1))),
         .bound = 0.0,
         .unit = "bodies"});
    rows.push_back(
        {.what = fmt::format("heap of {} boxes, added in reverse, {}: states that differ", kBodies, name),
         .value = double(count_different(heap, run(subject, reversed, kHeap, 1))),
         .bound = 0.0,
         .unit = "bodies"});
  }
  return rows;
}

}  // namespace orders

// S16: L-shapes that collide in the air: how many stand still there (the paper's 5.2), beside ODE's.
namespace frozen_in_air {

constexpr int kBodies = 300, kFrames = 24;  // up to a little after the top
constexpr double kThrow = 3.0,
                 kInward = 1.5;  // m/s up, 1/s: near the top the cloud is dense, and many are slow
constexpr double kStill = 0.05;  // m/s

RigidState start_of(std::uint32_t seed, int i) {
  RandomStream random(118 + seed, std::uint64_t(i), 0);
  const Vec3 place = 0.36 * (Vec3(i % 7, i / 7 % 7, i / 49) - Vec3(3, 3, 3));
  const Quat orientation = random.orientation();
  const Vec3 axis = random.direction();
  return {.position = place,
          .orientation = orientation,
          .velocity = kThrow * Vec3::UnitZ() - kInward * place,
          .angular_velocity = random.uniform(0.0, 5.0) * axis};
}

/// Of a run without ground: frames of bodies in which one is pushed while it stands still, among all.
struct Count {
  std::int64_t frozen = 0, hit = 0, all = 0;
  void add(const Vec3& before, const Vec3& after, double dt) {
    const bool pushed = ((after - before) / dt + kCaseGravity * Vec3::UnitZ()).norm() > 0.5 * kCaseGravity;
    hit += pushed, frozen += pushed && after.norm() < kStill, ++all;
  }
  double fraction() const { return double(frozen) / double(all); }
};

template <typename Step, typename Velocity>
void count_frames(Count& count, Step step, Velocity velocity) {
  std::vector<Vec3> before;
  for (int i = 0; i < kBodies; ++i) before.push_back(velocity(i));
  for (int frame = 0; frame < kFrames; ++frame) {
    step();
    for (int i = 0; i < kBodies; ++i) {
      const Vec3 after = velocity(i);
      count.add(before[i], after, kCaseStep);
      before[i] = after;
    }
  }
}

Count count_under_ode(const std::shared_ptr<const Shape>& shape, std::uint32_t clouds) {
  const MaterialTable materials;
  Count count;
  for (std::uint32_t seed = 0; seed < clouds; ++seed) {
    OdeWorld world({.gravity = {0, 0, -kCaseGravity}}, materials);
    std::vector<OdeBodyId> bodies;
    for (int i = 0; i < kBodies; ++i)
      bodies.push_back(world.add_body({.shape = shape, .state = start_of(seed, i)}));
    count_frames(
        count, [&] { world.step(kCaseStep, 8); },
        [&](int i) { return world.state(bodies[std::size_t(i)]).velocity; });
  }
  return count;
}

Count count_under(StatisticalModel model, const std::shared_ptr<const Shape>& shape, std::uint32_t clouds) {
  Count count;
  for (std::uint32_t seed = 0; seed < clouds; ++seed) {
    Manager manager = make_case_manager(
        {.model = model, .plane_normals = {}, .seed = seed + 1, .signature = find_case_signature(*shape)});
    std::vector<BodyId> bodies;
    for (int i = 0; i < kBodies; ++i) bodies.push_back(add_case_body(manager, shape, start_of(seed, i)));
    count_frames(
        count, [&] { manager.step(kCaseStep); },
        [&](int i) { return manager.state(bodies[std::size_t(i)]).velocity; });
  }
  return count;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  // ODE's clouds take most of the time: so of the others there are more, the first of them the same.
  const std::uint32_t clouds = settings.quick ? 3 : 192, of_ode = settings.quick ? 3 : 48;
  const auto l = share(make_shape("l", make_l(0.3, 0.2, 0.08, 0.1)));
  const Count ode = count_under_ode(l, of_ode);
  // A short run counts a handful of frames: their difference from twice ODE's is a sum of rare events,
  // uncertain by the root of its variance; of so few the variance is one more than was counted.
  const double uncertain =
      settings.quick ? 2.0 * std::sqrt(6.0 * double(ode.frozen + 1)) / double(ode.all) : 0.0;
  const auto what = [](std::uint32_t count) {
    return fmt::format("{} x cloud of {} L-shapes in the air, ", count, kBodies);
  };
  std::vector<HardCaseRow> rows = {{.what = what(of_ode) + "ODE: frames of bodies that are hit",
                                    .value = double(ode.hit),
                                    .bound = 300.0 * of_ode,
                                    .side = BoundSide::at_least}};
  for (const auto& [model, name] : kBothModels) {
    const Count count = count_under(model, l, clouds);
    rows.push_back(
        {.what = what(clouds) +
                 fmt::format("{}: fraction of frames in which one is pushed and stands still", name),
         .value = count.fraction(),
         .bound = 2.0 * ode.fraction() + uncertain});
  }
  return rows;
}

}  // namespace frozen_in_air

// S17: towers of cubes that are built, not poured: each exactly on the one below. A solver that begins
// without knowing what they bear crushes the lower ones before it has found out.
namespace built_towers {

constexpr double kSide = 0.2, kSeconds = 10.0;
constexpr int kFullSubsteps = 16;  // at the default of four the tower of twenty falls

constexpr double kMostSag = 0.1;  // of the height, at `tables`, which has one contact a face

// Farthest that one of them is from where it was put, m, after ten seconds.
double greatest_move(LevelChoice level, int cubes) {
  ManagerSettings settings;
  settings.full_substeps = kFullSubsteps;
  const auto cube = share(make_shape("cube", make_box(Vec3::Constant(kSide))));
  const auto signature = level == LevelChoice::tables ? find_case_signature(*cube) : nullptr;
  settings.signatures = [&](const Shape&, const ContactLaw&) { return signature; };
  Manager manager(settings);
  manager.add_plane(Vec3::UnitZ(), 0.0);
  const auto start_of = [](int i) { return Vec3(0.0, 0.0, kSide * (0.5 + i)); };
  std::vector<BodyId> bodies;
  for (int i = 0; i < cubes; ++i)
    bodies.push_back(manager.add_body({.shape = cube, .state = {.position = start_of(i)}, .level = level}));
  for (int step = 0; step < int(kSeconds / kCaseStep); ++step) manager.step(kCaseStep);
  double farthest = 0.0;
  for (int i = 0; i < cubes; ++i)
    farthest = worse(farthest, (manager.state(bodies[std::size_t(i)]).position - start_of(i)).norm());
  return farthest;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  std::vector<HardCaseRow> rows;
  for (const auto& [level, name] :
       {std::pair{LevelChoice::support, "support"}, {LevelChoice::full, "full, 16 substeps"}})
    for (const int cubes : {10, 20, 50})
      if (!settings.quick || cubes == 20 || level == LevelChoice::support)
        rows.push_back({.what = fmt::format(
                            "tower of {} cubes of .2 m built exactly, {}, 10 s: greatest move", cubes, name),
                        .value = 1e3 * greatest_move(level, cubes),
                        .bound = 50.0,
                        .unit = "mm"});
  for (const int cubes : {3, 5, 10, 20})
    if (!settings.quick || cubes == 5)
      rows.push_back(
          {.what = fmt::format(
               "tower of {} cubes of .2 m built exactly, tables, 10 s: greatest move over its height", cubes),
           .value = greatest_move(LevelChoice::tables, cubes) / (cubes * kSide),
           .bound = kMostSag});
  return rows;
}

}  // namespace built_towers

}  // namespace

std::span<const HardCase> crowd_cases() {
  static constexpr std::array kCases = {
      HardCase{"S10", great_pile::measure_case},
      HardCase{"S14", orders::measure_case},
      HardCase{"S16", frozen_in_air::measure_case},
      HardCase{"S17", built_towers::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
