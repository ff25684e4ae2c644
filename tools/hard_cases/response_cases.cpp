// S4 to S6: what the statistical level draws from its tables, within and beyond them.
#include <fmt/format.h>

#include <array>
#include <limits>
#include <numbers>

#include "lod/ground/ground.h"
#include "lod/rungs/statistical_level.h"
#include "lod/support/support_model.h"
#include "lod/tables/tables_model.h"
#include "reference/free_rotation.h"
#include "reference/random.h"
#include "signature/response_lookup.h"
#include "tools/hard_cases/hard_case.h"
#include "tools/hard_cases/statistical_case_parts.h"

namespace lodestone {
namespace {

// S4: what lies beyond the tables, and what is no number.
namespace beyond_tables {

constexpr double kPi = std::numbers::pi, kNan = std::numeric_limits<double>::quiet_NaN();

/// As measured on a grid of speeds up to 5 m/s, which bodies can leave.
std::shared_ptr<const Signature> make_bounded(const Signature& measured) {
  Signature bounded = measured;
  SpeedTable& table = bounded.by_speed;
  table.n_theta = table.n_phi = 2;
  table.speeds = {1.0f, 5.0f};
  table.spins = {0.0f, 5.0f};
  table.cells.mean.assign(std::size_t(table.size()), Response::Zero());
  table.cells.deviation.assign(std::size_t(table.size()), Response::Constant(0.05f));
  return std::make_shared<const Signature>(std::move(bounded));
}

/// Look-ups outside of the tables that were not flagged, or gave what is no number.
int count_unflagged(const Signature& signature, std::span<const CollisionConfiguration> outside) {
  int unflagged = 0;
  for (const CollisionConfiguration& c : outside)
    for (const bool interpolate : {true, false}) {
      const FoundResponse found = find_response(signature, c, 0.05, interpolate);
      unflagged += !found.extrapolated || !found.mean.allFinite() || !found.deviation.allFinite();
    }
  return unflagged;
}

std::vector<CollisionConfiguration> configurations_outside(bool speeds_too) {
  std::vector<CollisionConfiguration> list;
  for (const double theta : {-0.1, kPi / 2 + 0.01, 1e300, kNan})
    list.push_back({.theta = theta, .phi = 1.0, .speed = 2.0, .spin = 2.0});
  for (const double phi : {-0.1, kPi + 0.01, -1e300, kNan})
    list.push_back({.theta = 0.5, .phi = phi, .speed = 2.0, .spin = 2.0});
  list.push_back({.theta = 0.5, .phi = 1.0, .speed = kNan, .spin = 2.0});
  list.push_back({.theta = 0.5, .phi = 1.0, .speed = 2.0, .spin = kNan});
  if (!speeds_too) return list;
  for (const double speed : {0.0, 0.5, 6.0, 1e300})
    list.push_back({.theta = 0.5, .phi = 1.0, .speed = speed, .spin = 2.0});
  for (const double spin : {5.1, 1e8, 1e300})
    list.push_back({.theta = 0.5, .phi = 1.0, .speed = 2.0, .spin = spin});
  return list;
}

struct Fate {
  int lost = 0, uncounted = 0;
};

/// Bodies that spin at 1e8 rad/s fall on the plane.
Fate drop_spinners(const std::shared_ptr<const Shape>& shape, StatisticalModel model,
                   const std::shared_ptr<const Signature>& signature, bool published = false) {
  Fate fate;
  for (int trial = 0; trial < 100; ++trial) {
    RandomStream random(105, std::uint64_t(trial), 0);
    Manager manager = make_case_manager(
        {.model = model, .seed = std::uint64_t(trial) + 1, .signature = signature, .published = published});
    const BodyId body = add_case_body(manager, shape,
                                      {.position = {0, 0, 0.4},
                                       .orientation = random.orientation(),
                                       .velocity = {1, 0, -2},
                                       .angular_velocity = 1e8 * random.direction()});
    for (int i = 0; i < 60; ++i) manager.step(kCaseStep);
    fate.lost += !is_finite(manager.state(body));
    fate.uncounted += manager.report().counters.table_extrapolations == 0;
  }
  return fate;
}

/// One body of a settled heap gets a state that is no number. What the others are after a second, and whether
/// it was counted.
Fate spoil_heap(const std::shared_ptr<const Shape>& shape, StatisticalModel model,
                const std::shared_ptr<const Signature>& signature) {
  Fate fate;
  const MaterialTable materials;
  Ground ground;
  ground.add_plane({});
  for (int spoilt = 0; spoilt < 6; ++spoilt) {
    StatisticalLevel level({.tables = {}}, ground, materials);
    std::vector<StatisticalPlace> places;
    for (int i = 0; i < 12; ++i) {
      RandomStream random(106, std::uint64_t(i), 0);
      places.push_back(level.add(model, std::uint32_t(i), shape, 24.0, 0,
                                 {.position = {0.25 * (i % 2), 0.25 * (i / 2 % 2), 0.3 + 0.4 * (i / 4)},
                                  .orientation = random.orientation()},
                                 false, signature));
    }
    StepReport report;
    for (int i = 0; i < 45; ++i) level.step(kCaseStep, {}, report);
    RigidState state = level.state(places[3]);
    const Vec3 nan = Vec3::Constant(kNan);
    if (spoilt == 0) state.velocity = nan;
    if (spoilt == 1) state.angular_velocity = nan;
    if (spoilt == 2) state.position = nan;
    if (spoilt == 3) state.orientation.coeffs().setConstant(kNan);
    if (spoilt < 4)
      level.set_state(places[3], state);
    else
      level.add_force(places[3], spoilt == 4 ? nan : Vec3(1e308, 0, 0),
                      spoilt == 4 ? Vec3(Vec3::Zero()) : nan);
    for (int i = 0; i < 60; ++i) level.step(kCaseStep, {}, report);
    for (const StatisticalPlace place : places) fate.lost += !is_finite(level.state(place));
    fate.uncounted += report.counters.states_recovered == 0;
  }
  return fate;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings&) {
  const auto box = box_of({0.2, 0.3, 0.4});
  const auto measured = find_case_signature(*box), bounded = make_bounded(*measured);
  std::vector<HardCaseRow> rows;
  const int unflagged = count_unflagged(*measured, configurations_outside(false)) +
                        count_unflagged(*bounded, configurations_outside(true));
  rows.push_back({.what = "look-ups beyond the tables or of no number: not flagged or no finite answer",
                  .value = double(unflagged),
                  .bound = 0.0});
  const bool flagged =
      find_response(*measured, {.theta = 0.5, .phi = 1.0, .speed = 2.0, .spin = 2.0}, 0.05).extrapolated;
  rows.push_back({.what = "look-ups within the tables: flagged", .value = double(flagged), .bound = 0.0});
  for (const auto& [model, name] : kBothModels) {
    const Fate spinners = drop_spinners(box, model, bounded), heap = spoil_heap(box, model, measured);
    rows.push_back({.what = fmt::format("100 x box at 1e8 rad/s meets the plane, {}: no finite state", name),
                    .value = double(spinners.lost),
                    .bound = 0.0,
                    .unit = "bodies"});
    if (model == StatisticalModel::tables)
      rows.push_back({.what = "100 x box at 1e8 rad/s meets the plane, published, up to 5 m/s: not counted",
                      .value = double(drop_spinners(box, model, bounded, true).uncounted),
                      .bound = 0.0,
                      .unit = "bodies"});
    rows.push_back(
        {.what = fmt::format("6 x heap of 12, one state no number, {}: no finite state a second later", name),
         .value = double(heap.lost),
         .bound = 0.0,
         .unit = "bodies"});
    rows.push_back({.what = fmt::format("6 x heap of 12, one state no number, {}: not counted", name),
                    .value = double(heap.uncounted),
                    .bound = 0.0,
                    .unit = "heaps"});
  }
  return rows;
}

}  // namespace beyond_tables

// S5: hits over the whole table: energy, direction and, after truncation, the measured moments.
namespace random_hits {

/// What hits are made of: a box, its signature and a plane, without gravity.
struct HitWorld {
  explicit HitWorld(const ContactLaw& law)
      : law_(law), materials_(materials_of(law.restitution, law.friction)) {
    ground_.add_plane({});
    const auto box = box_of({0.2, 0.3, 0.4});
    kind_ = make_body_kind(box, find_case_signature(*box));
  }

  StepWorld world() const {
    return {.gravity = Vec3::Zero(), .planes = ground_.planes(), .materials = &materials_, .seed = 1};
  }

  /// A body that touches the plane, in any orientation, falling at up to 10 m/s and spinning at up to 60
  /// rad/s.
  StatisticalBody make_body(std::uint32_t hit) const {
    RandomStream random(107, hit, 0);
    StatisticalBody body;
    body.owner = hit;
    body.orientation = random.orientation();
    body.position.z() = resting_height(*kind_.shape, body.orientation);
    const Vec3 direction = random.direction();
    body.velocity = random.uniform(0.0, 10.0) * direction;
    body.velocity.z() = -std::abs(body.velocity.z());
    const Vec3 axis = random.direction();
    body.spin = spin_of(body.orientation, random.uniform(0.0, 60.0) * axis, *kind_.shape);
    return body;
  }

  ContactLaw law_;
  MaterialTable materials_;
  Ground ground_;
  BodyKind kind_;
};

struct Violations {
  int energy = 0, direction = 0;
};

Violations hit_by_tables(const HitWorld& hits, int count) {
  Violations found;
  for (int i = 0; i < count; ++i) {
    StatisticalBody body = hits.make_body(std::uint32_t(i));
    const double before = kinetic_energy(body, *hits.kind_.shape);
    ContactTally tally;
    respond_from_tables(body, hits.kind_, Vec3::UnitZ(), hits.world(), hits.law_, {}, tally);
    found.energy += !(kinetic_energy(body, *hits.kind_.shape) <= before * (1.0 + 1e-9));
    found.direction += !(body.velocity.z() >= -1e-12);
  }
  return found;
}

int count_energy_gains_by_support(const HitWorld& hits, int count) {
  int gains = 0;
  for (int i = 0; i < count; ++i) {
    StatisticalBody body = hits.make_body(std::uint32_t(i));
    const double before = kinetic_energy(body, *hits.kind_.shape);
    step_support_body(body, hits.kind_, hits.world(), 1e-4, {});
    gains += !(kinetic_energy(body, *hits.kind_.shape) <= before * (1.0 + 1e-9));
  }
  return gains;
}

/// Greatest error of the mean, over the spread of the cell's trials, of the velocity along the normal that
/// draws from a cell leave, over some of the cells.
double worst_truncated_mean(const Signature& signature, int cells, int draws) {
  double worst = 0.0;
  for (int i = 0; i < cells; ++i) {
    const std::int64_t cell = signature.bouncing.size() * i / cells;
    CollisionConfiguration c = signature.bouncing.center(cell);
    c.speed *= 100.0, c.spin *= 100.0;  // everything bounces
    const FoundResponse found = find_response(signature, c, 0.05, false);
    if (found.deviation[0] <= 0.0f) continue;
    const double particle = signature.settings.law.restitution * c.speed / c.speed_unit() * std::cos(c.theta);
    double sum = 0.0;
    for (int k = 0; k < draws; ++k) {
      RandomStream random(108, std::uint64_t(cell), std::uint32_t(k));
      sum += draw_response(found, c, signature.settings.law.restitution, signature.settings.draw, random)
                 .linear.x();
    }
    worst =
        worse(worst, std::abs(sum / draws - (particle + double(found.mean[0]))) / double(found.deviation[0]));
  }
  return worst;
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const int hits = settings.quick ? 100'000 : 1'000'000, cells = 200, draws = 20'000;
  std::vector<HardCaseRow> rows;
  const HitWorld usual({0.4, 0.5}), bouncy({0.9, 0.5});
  const Violations tables = hit_by_tables(usual, hits);
  rows.push_back({.what = fmt::format("{:.0e} hits, tables: energy gained", double(hits)),
                  .value = double(tables.energy),
                  .bound = 0.0,
                  .unit = "hits"});
  rows.push_back({.what = fmt::format("{:.0e} hits, tables: v.n < 0 after", double(hits)),
                  .value = double(tables.direction),
                  .bound = 0.0,
                  .unit = "hits"});
  rows.push_back({.what = fmt::format("{:.0e} hits, support, e .4: energy gained", double(hits)),
                  .value = double(count_energy_gains_by_support(usual, hits)),
                  .bound = 0.0,
                  .unit = "hits"});
  rows.push_back({.what = fmt::format("{:.0e} hits, support, e .9: energy gained", double(hits)),
                  .value = double(count_energy_gains_by_support(bouncy, hits)),
                  .bound = 0.0,
                  .unit = "hits"});
  rows.push_back({.what = fmt::format(
                      "{} draws in {} cells, truncated: greatest error of the mean of v.n over its deviation",
                      draws, cells),
                  .value = worst_truncated_mean(*usual.kind_.signature, cells, draws),
                  .bound = 4.5 / std::sqrt(double(draws))});
  return rows;
}

}  // namespace random_hits

// S6: draws from cells against the cells' moments.
namespace draws {

constexpr double kFarFromTheEdge = 6.0;  // deviations: farther from v·n = 0 than truncation reaches

struct Errors {
  double mean = 0.0;      ///< over the cell's deviation
  double variance = 0.0;  ///< relative
  int numbers = 0;        ///< that were compared
};

/// The numbers of a cell that truncation does not touch against draws from it.
void add_cell(const Signature& signature, std::int64_t cell, int draws, Errors& errors) {
  CollisionConfiguration c = signature.bouncing.center(cell);
  c.speed *= 100.0, c.spin *= 100.0;  // everything bounces
  const FoundResponse found = find_response(signature, c, 0.05);
  const double e = signature.settings.law.restitution, speed = c.speed / c.speed_unit();
  const Vec3 particle(e * speed * std::cos(c.theta), speed * std::sin(c.theta), 0.0);
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero(), squares = sum;
  for (int k = 0; k < draws; ++k) {
    RandomStream random(109, std::uint64_t(cell), std::uint32_t(k));
    const DrawnVelocities drawn = draw_response(found, c, e, signature.settings.draw, random);
    Eigen::Matrix<double, 6, 1> error;
    error << drawn.linear - particle, drawn.angular;
    error -= signature.bouncing.cells.mean[std::size_t(cell)].cast<double>();
    sum += error, squares += error.cwiseProduct(error);
  }
  for (int i = 0; i < 6; ++i) {
    const double mean = double(signature.bouncing.cells.mean[std::size_t(cell)][i]),
                 deviation = double(signature.bouncing.cells.deviation[std::size_t(cell)][i]);
    if (deviation <= 0.0 || (i == 0 && particle.x() + mean < kFarFromTheEdge * deviation)) continue;
    errors.mean = worse(errors.mean, std::abs(sum[i] / draws) / deviation);
    errors.variance = worse(
        errors.variance,
        std::abs((squares[i] / draws - sum[i] * sum[i] / draws / draws) / (deviation * deviation) - 1.0));
    ++errors.numbers;
  }
}

std::vector<HardCaseRow> measure_case(const HardCaseSettings& settings) {
  const int cells = settings.quick ? 20 : 200, draws = 100'000;
  const auto signature = find_case_signature(*box_of({0.2, 0.3, 0.4}));
  Errors errors;
  for (int i = 0; i < cells; ++i) add_cell(*signature, signature->bouncing.size() * i / cells, draws, errors);
  const std::string what = fmt::format("{:.0e} draws in {} cells: ", double(draws), cells);
  return {{.what = what + "greatest error of a mean over its deviation",
           .value = errors.mean,
           .bound = 4.5 / std::sqrt(double(draws))},
          {.what = what + "greatest relative error of a variance", .value = errors.variance, .bound = 0.03},
          {.what = what + "numbers compared",
           .value = double(errors.numbers),
           .bound = 4.0 * cells,
           .side = BoundSide::at_least}};
}

}  // namespace draws

}  // namespace

std::span<const HardCase> response_cases() {
  static constexpr std::array kCases = {
      HardCase{"S4", beyond_tables::measure_case},
      HardCase{"S5", random_hits::measure_case},
      HardCase{"S6", draws::measure_case},
  };
  return kCases;
}

}  // namespace lodestone
