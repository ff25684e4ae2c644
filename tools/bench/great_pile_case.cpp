// S10.
#include <fmt/format.h>

#include <map>

#include "reference/hull/hull_overlap.h"
#include "reference/random.h"
#include "tools/bench/ensemble_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr double kStill = 0.05;  // m/s

struct PileSize { int side, layers, seconds; };

struct Figures {
  int hovering = 0;
  double overlap = 0.0;      ///< over a radius
  double energy_gain = 0.0;  ///< within a second, over that at first
  double kinetic_rise = -1e300;  ///< from one third of the time to the next, over the greatest
  double kinetic_left = 0.0; ///< at the end, over the greatest
};

class Pile {
 public:
  Pile(const NamedModel& model, const PileSize& size) : size_(size), manager_(make_case_manager({.model = model.model, .signature = find_case_signature(*box_)})) {
    const double gap = 1.3 * box_->size;
    for (int i = 0; i < size.side * size.side * size.layers; ++i) {
      RandomStream random(115, std::uint64_t(i), 0);
      const int layer = i / (size.side * size.side);
      const Vec3 place(gap * (i % size.side + 0.5 * (layer % 2)), gap * (i / size.side % size.side + 0.5 * (layer % 2)), box_->size * (1.0 + 1.8 * layer));
      bodies_.push_back(add_case_body(manager_, box_, {.position = place + 0.02 * random.direction(), .orientation = random.orientation()}));
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
      greatest = std::max(greatest, now.kinetic);
      figures_.kinetic_left = now.kinetic / greatest;
      sum += now.kinetic;
      if (second % tenth == 0) {
        measure_overlap();
      }
      if (second % (size_.seconds / 3) == 0) {
        if (second > size_.seconds / 3) figures_.kinetic_rise = worse(figures_.kinetic_rise, (sum - before) / greatest);
        before = sum, sum = 0.0;
      }
      look_for_hovering();
    }
    return figures_;
  }

 private:
  struct Energies { double kinetic = 0.0, total = 0.0; };
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
        if (other != i && (states_[other].position - states_[i].position).norm() < 2.0 * box_->radius) look(other);
    }
  }

  void measure_overlap() {
    for (int i = 0; i < int(states_.size()); ++i)
      for_each_near(i, [&](int other) {
        if (other > i) figures_.overlap = worse(figures_.overlap, measure_hull_overlap(*box_, states_[i], *box_, states_[other]) / box_->radius);
      });
  }

  // Still now and a second ago, more than a radius above the plane and clear of every other's bounding sphere.
  void look_for_hovering() {
    for (int i = 0; i < int(states_.size()); ++i) {
      bool alone = states_[i].velocity.norm() < kStill && -measure_plane_overlap(*box_, states_[i], Vec3::UnitZ(), 0.0) > box_->radius;
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

}  // namespace

std::vector<HardCaseRow> measure_great_pile(const HardCaseSettings& settings) {
  const PileSize size = settings.quick ? PileSize{8, 4, 21} : PileSize{50, 4, 60};
  std::vector<HardCaseRow> rows;
  for (const NamedModel& model : kBothModels) {
    const Figures figures = Pile(model, size).run();
    const std::string what = fmt::format("pile of {} boxes, {} s, {}: ", size.side * size.side * size.layers, size.seconds, model.name);
    rows.push_back({.what = what + "hover a radius off everything for a second", .value = double(figures.hovering), .bound = 0.0, .unit = "bodies"});
    if (model.model == StatisticalModel::support)  // the spheres of `tables` leave hulls in each other
      rows.push_back({.what = what + "greatest overlap over a radius", .value = figures.overlap, .bound = 0.1});
    rows.push_back({.what = what + "energy gained in a second over that at first", .value = figures.energy_gain, .bound = 1e-3});
    rows.push_back({.what = what + "rise of kinetic energy, third by third, over its greatest", .value = figures.kinetic_rise, .bound = 0.0});
    rows.push_back({.what = what + "kinetic energy left over its greatest", .value = figures.kinetic_left, .bound = 1e-3});
  }
  return rows;
}

}  // namespace lodestone
