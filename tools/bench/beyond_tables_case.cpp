// S4.
#include <fmt/format.h>

#include <limits>
#include <numbers>

#include "lod/rungs/statistical_level.h"
#include "reference/random.h"
#include "signature/response_lookup.h"
#include "tools/bench/response_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

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
  for (const double theta : {-0.1, kPi / 2 + 0.01, 1e300, kNan}) list.push_back({.theta = theta, .phi = 1.0, .speed = 2.0, .spin = 2.0});
  for (const double phi : {-0.1, kPi + 0.01, -1e300, kNan}) list.push_back({.theta = 0.5, .phi = phi, .speed = 2.0, .spin = 2.0});
  list.push_back({.theta = 0.5, .phi = 1.0, .speed = kNan, .spin = 2.0});
  list.push_back({.theta = 0.5, .phi = 1.0, .speed = 2.0, .spin = kNan});
  if (!speeds_too) return list;
  for (const double speed : {0.0, 0.5, 6.0, 1e300}) list.push_back({.theta = 0.5, .phi = 1.0, .speed = speed, .spin = 2.0});
  for (const double spin : {5.1, 1e8, 1e300}) list.push_back({.theta = 0.5, .phi = 1.0, .speed = 2.0, .spin = spin});
  return list;
}

struct Fate { int lost = 0, uncounted = 0; };

/// Bodies that spin at 1e8 rad/s fall on the plane.
Fate drop_spinners(const std::shared_ptr<const Shape>& shape, StatisticalModel model, const std::shared_ptr<const Signature>& signature) {
  Fate fate;
  for (int trial = 0; trial < 100; ++trial) {
    RandomStream random(105, std::uint64_t(trial), 0);
    Manager manager = make_case_manager({.model = model, .seed = std::uint64_t(trial) + 1, .signature = signature});
    const BodyId body = add_case_body(manager, shape, {.position = {0, 0, 0.4}, .orientation = random.orientation(), .velocity = {1, 0, -2}, .angular_velocity = 1e8 * random.direction()});
    for (int i = 0; i < 60; ++i) manager.step(kCaseStep);
    fate.lost += !is_finite(manager.state(body));
    fate.uncounted += manager.report().counters.table_extrapolations == 0;
  }
  return fate;
}

/// One body of a settled heap gets a state that is no number. What the others are after a second, and whether it was counted.
Fate spoil_heap(const std::shared_ptr<const Shape>& shape, StatisticalModel model, const std::shared_ptr<const Signature>& signature) {
  Fate fate;
  const MaterialTable materials;
  Ground ground;
  ground.add_plane({});
  for (int spoilt = 0; spoilt < 6; ++spoilt) {
    StatisticalLevel level({.tables = {}}, ground, materials);
    std::vector<StatisticalPlace> places;
    for (int i = 0; i < 12; ++i) {
      RandomStream random(106, std::uint64_t(i), 0);
      places.push_back(level.add(model, std::uint32_t(i), shape, 24.0, 0, {.position = {0.25 * (i % 2), 0.25 * (i / 2 % 2), 0.3 + 0.4 * (i / 4)}, .orientation = random.orientation()}, false, signature));
    }
    StepReport report;
    for (int i = 0; i < 45; ++i) level.step(kCaseStep, {}, report);
    RigidState state = level.state(places[3]);
    const Vec3 nan = Vec3::Constant(kNan);
    if (spoilt == 0) state.velocity = nan;
    if (spoilt == 1) state.angular_velocity = nan;
    if (spoilt == 2) state.position = nan;
    if (spoilt == 3) state.orientation.coeffs().setConstant(kNan);
    if (spoilt < 4) level.set_state(places[3], state);
    else level.add_force(places[3], spoilt == 4 ? nan : Vec3(1e308, 0, 0), spoilt == 4 ? Vec3(Vec3::Zero()) : nan);
    for (int i = 0; i < 60; ++i) level.step(kCaseStep, {}, report);
    for (const StatisticalPlace place : places) fate.lost += !is_finite(level.state(place));
    fate.uncounted += report.counters.states_recovered == 0;
  }
  return fate;
}

}  // namespace

std::vector<HardCaseRow> measure_beyond_tables(const HardCaseSettings&) {
  const auto box = box_of({0.2, 0.3, 0.4});
  const auto measured = find_case_signature(*box), bounded = make_bounded(*measured);
  std::vector<HardCaseRow> rows;
  const int unflagged = count_unflagged(*measured, configurations_outside(false)) + count_unflagged(*bounded, configurations_outside(true));
  rows.push_back({.what = "look-ups beyond the tables or of no number: not flagged or no finite answer", .value = double(unflagged), .bound = 0.0});
  const bool flagged = find_response(*measured, {.theta = 0.5, .phi = 1.0, .speed = 2.0, .spin = 2.0}, 0.05).extrapolated;
  rows.push_back({.what = "look-ups within the tables: flagged", .value = double(flagged), .bound = 0.0});
  for (const auto& [model, name] : kBothModels) {
    const Fate spinners = drop_spinners(box, model, bounded), heap = spoil_heap(box, model, measured);
    rows.push_back({.what = fmt::format("100 x box at 1e8 rad/s meets the plane, {}: no finite state", name), .value = double(spinners.lost), .bound = 0.0, .unit = "bodies"});
    if (model == StatisticalModel::tables)
      rows.push_back({.what = "100 x box at 1e8 rad/s meets the plane, tables up to 5 m/s: not counted", .value = double(spinners.uncounted), .bound = 0.0, .unit = "bodies"});
    rows.push_back({.what = fmt::format("6 x heap of 12, one state no number, {}: no finite state a second later", name), .value = double(heap.lost), .bound = 0.0, .unit = "bodies"});
    rows.push_back({.what = fmt::format("6 x heap of 12, one state no number, {}: not counted", name), .value = double(heap.uncounted), .bound = 0.0, .unit = "heaps"});
  }
  return rows;
}

}  // namespace lodestone
