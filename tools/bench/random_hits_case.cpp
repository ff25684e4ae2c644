// S5.
#include <fmt/format.h>

#include <numbers>

#include "lod/ground/ground.h"
#include "lod/support/support_model.h"
#include "lod/tables/tables_model.h"
#include "reference/free_rotation.h"
#include "reference/random.h"
#include "signature/response_lookup.h"
#include "tools/bench/response_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

/// What hits are made of: a box, its signature and a plane, without gravity.
struct HitWorld {
  explicit HitWorld(const ContactLaw& law) : law_(law), materials_(materials_of(law.restitution, law.friction)) {
    ground_.add_plane({});
    const auto box = box_of({0.2, 0.3, 0.4});
    kind_ = make_body_kind(box, find_case_signature(*box));
  }

  StepWorld world() const { return {.gravity = Vec3::Zero(), .planes = ground_.planes(), .materials = &materials_, .seed = 1}; }

  /// A body that touches the plane, in any orientation, falling at up to 10 m/s and spinning at up to 60 rad/s.
  StatisticalBody make_body(std::uint32_t hit) const {
    RandomStream random(107, hit, 0);
    StatisticalBody body;
    body.owner = hit;
    body.orientation = random.orientation();
    body.position.z() = resting_height(*kind_.shape, body.orientation);
    body.velocity = random.uniform(0.0, 10.0) * random.direction();
    body.velocity.z() = -std::abs(body.velocity.z());
    body.spin = spin_of(body.orientation, random.uniform(0.0, 60.0) * random.direction(), *kind_.shape);
    return body;
  }

  ContactLaw law_;
  MaterialTable materials_;
  Ground ground_;
  BodyKind kind_;
};

struct Violations { int energy = 0, direction = 0; };

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

/// Greatest error of the mean, over the spread of the cell's trials, of the velocity along the normal that draws from a cell leave, over some of the cells.
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
      sum += draw_response(found, c, signature.settings.law.restitution, signature.settings.draw, random).linear.x();
    }
    worst = worse(worst, std::abs(sum / draws - (particle + double(found.mean[0]))) / double(found.deviation[0]));
  }
  return worst;
}

}  // namespace

std::vector<HardCaseRow> measure_random_hits(const HardCaseSettings& settings) {
  const int hits = settings.quick ? 100'000 : 1'000'000, cells = 200, draws = 20'000;
  std::vector<HardCaseRow> rows;
  const HitWorld usual({0.4, 0.5}), bouncy({0.9, 0.5});
  const Violations tables = hit_by_tables(usual, hits);
  rows.push_back({.what = fmt::format("{:.0e} hits, tables: energy gained", double(hits)), .value = double(tables.energy), .bound = 0.0, .unit = "hits"});
  rows.push_back({.what = fmt::format("{:.0e} hits, tables: v.n < 0 after", double(hits)), .value = double(tables.direction), .bound = 0.0, .unit = "hits"});
  rows.push_back({.what = fmt::format("{:.0e} hits, support, e .4: energy gained", double(hits)), .value = double(count_energy_gains_by_support(usual, hits)), .bound = 0.0, .unit = "hits"});
  rows.push_back({.what = fmt::format("{:.0e} hits, support, e .9: energy gained", double(hits)), .value = double(count_energy_gains_by_support(bouncy, hits)), .bound = 0.0, .unit = "hits"});
  rows.push_back({.what = fmt::format("{} draws in {} cells, truncated: greatest error of the mean of v.n over its deviation", draws, cells),
                  .value = worst_truncated_mean(*usual.kind_.signature, cells, draws), .bound = 4.5 / std::sqrt(double(draws))});
  return rows;
}

}  // namespace lodestone
