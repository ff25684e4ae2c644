#include "lod/contact/crowd_solver.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "lod/contact/crowd_islands.h"
#include "lod/contact/crowd_lanes.h"
#include "lod/contact/impact_waves.h"
#include "lod/contact/island_contacts.h"
#include "lod/contact/small_islands.h"
#include "lod/contact/uneven_islands.h"

namespace lodestone {

using namespace lane;

struct CrowdSolver::Work {
  explicit Work(Simd simd) : small_islands(simd), uneven_islands(simd), great_islands(simd) {}

  ImpactWaves waves;
  CrowdIslands islands;
  SmallIslands small_islands;
  IslandContacts uneven_island;
  UnevenIslands uneven_islands;
  CrowdLanes<F8> great_islands;
  std::vector<std::uint32_t> uneven, great;  // manifolds

  void sort_manifolds(std::size_t count);
  void solve_uneven_islands(const CrowdContacts& contacts, const JobRunner& jobs);
  void solve_great_islands(const CrowdContacts& contacts, const JobRunner& jobs);
};

void CrowdSolver::Work::sort_manifolds(std::size_t count) {
  uneven.clear(), great.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    const IslandKind kind = islands.kind_of(i);
    if (kind == IslandKind::uneven) uneven.push_back(i);
    if (kind == IslandKind::great) great.push_back(i);
  }
}

// One by one: how often one is swept is no other's matter.
void CrowdSolver::Work::solve_uneven_islands(const CrowdContacts& contacts, const JobRunner& jobs) {
  const auto island_of = [&](std::uint32_t manifold) { return islands.island_of(manifold); };
  std::ranges::sort(uneven, {}, [&](std::uint32_t m) { return std::pair(island_of(m), m); });
  for (auto begin = uneven.begin(), end = begin; begin != uneven.end(); begin = end) {
    end = std::ranges::find_if(begin, uneven.end(),
                               [&](std::uint32_t m) { return island_of(m) != island_of(*begin); });
    uneven_island.take(contacts, {begin, end});
    uneven_islands.solve(uneven_island.contacts(contacts), uneven_island.which(),
                         islands.unevenness_of(*begin), jobs);
    uneven_island.hand_out(contacts);
  }
}

void CrowdSolver::Work::solve_great_islands(const CrowdContacts& contacts, const JobRunner& jobs) {
  if (great.empty()) return;
  const ContactSolverSettings& settings = contacts.settings;
  great_islands.take(contacts, great, jobs);
  great_islands.sweep(GuessesGiven<F8>{}, jobs);
  const double enough = settings.tolerance * settings.fall.norm();
  // A heavy body on a light one asks for as many more as it is heavier: with as few as elsewhere heaps of
  // cubes of 1 : 4 and 1 : 8 keep overlaps of 8 and 26 % of their size, so 3 and 11 %.
  const int sweeps = int(settings.sweeps * islands.most_uneven_of_great());
  for (int i = 0; i < sweeps; ++i)
    if (great_islands.sweep(Relaxation<F8>{}, jobs) <= enough) break;
  great_islands.hand_out(contacts, jobs);
}

CrowdSolver::CrowdSolver(Simd simd) : work_(std::make_unique<Work>(simd)) {}
CrowdSolver::~CrowdSolver() = default;

void CrowdSolver::solve(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                        std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
                        const JobRunner& jobs) {
  Work& work = *work_;
  const CrowdContacts contacts{bodies, manifolds, points, step, settings};
  work.waves.pass_on(bodies, manifolds, points, step, settings);
  work.islands.find(bodies, manifolds);
  work.sort_manifolds(manifolds.size());
  work.small_islands.solve(contacts, work.islands, jobs);
  work.solve_uneven_islands(contacts, jobs);
  work.solve_great_islands(contacts, jobs);
  work.waves.add_impulses(points);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].inverse_mass > 0.0) bodies[i].in_great_heap = work.islands.in_great_heap(std::int32_t(i));
}

std::span<const std::uint32_t> CrowdSolver::struck() const { return work_->waves.struck(); }

}  // namespace lodestone
