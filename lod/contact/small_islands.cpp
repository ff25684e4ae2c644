#include "lod/contact/small_islands.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr int kMostIslandSweeps = 40;  // of few points: a body on two edges asks for many
constexpr int kIslandRelaxations =
    400;  // of points, in as many sweeps as that is, but never fewer than a crowd's
constexpr double kIslandTolerance = 1e-4;

}  // namespace

void SmallIslands::find(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                        const CrowdIslands& islands) {
  own_.clear();
  for (std::uint32_t i = 0; i < manifolds.size(); ++i)
    if (islands.kind_of(i) == IslandKind::small) own_.push_back({islands.island_of(i), i});
  std::ranges::sort(own_, {}, [](const Own& own) { return std::pair(own.island, own.manifold); });
  first_.clear();
  for (std::uint32_t i = 0; i < own_.size(); ++i)
    if (i == 0 || own_[i].island != own_[i - 1].island) first_.push_back(i);
  first_.push_back(std::uint32_t(own_.size()));
  place_of_.assign(bodies.size(), -1);
}

void SmallIslands::solve(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                         std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
                         Simd simd, const JobRunner& jobs) {
  constexpr std::int64_t kBlock = 32;  // islands of a job
  ContactSolverSettings own = settings;
  own.tolerance = std::min(settings.tolerance, kIslandTolerance);
  own.frictionless_bound = true;
  run_in_pieces(jobs, std::int64_t(first_.size()) - 1, kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i)
      solve_one(bodies, manifolds, points, step, own, simd,
                std::span(own_).subspan(first_[i], first_[i + 1] - first_[i]));
  });
}

void SmallIslands::solve_one(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                             std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
                             Simd simd, std::span<const Own> own) {
  thread_local std::vector<SolverBody> local;      // those that move once, of what does not a copy a manifold
  thread_local std::vector<std::int32_t> body_of;  // of each of these, or −1 of what does not move
  thread_local std::vector<SolverContact> contacts;
  local.clear(), body_of.clear(), contacts.clear();
  const auto place_of = [&](std::int32_t body) {
    if (body < 0) return -1;
    const auto next = std::int32_t(local.size());
    const bool moves = bodies[std::size_t(body)].inverse_mass > 0.0;
    std::int32_t none = -1;
    std::int32_t& place = moves ? place_of_[std::size_t(body)] : none;
    if (place >= 0) return place;
    local.push_back(bodies[std::size_t(body)]);
    body_of.push_back(moves ? body : -1);
    return place = next;
  };
  for (const Own& one : own) {
    const CrowdManifold& m = manifolds[one.manifold];
    const std::int32_t first = place_of(m.first), second = place_of(m.second);
    for (const CrowdPoint& point : points.subspan(m.begin, m.count))
      contacts.push_back({.first = first,
                          .second = second,
                          .normal = m.normal,
                          .arm_first = point.arm_first,
                          .arm_second = point.arm_second,
                          .gap = point.gap,
                          .law = m.law,
                          .guess = point.guess,
                          .frictionless = point.frictionless});
  }
  ContactSolverSettings enough = settings;
  enough.sweeps =
      std::max(settings.sweeps, std::min(kIslandRelaxations / int(contacts.size()), kMostIslandSweeps));
  solve_contacts(local, contacts, step, enough, simd);
  for (std::size_t i = 0; i < local.size(); ++i)
    if (body_of[i] >= 0) bodies[std::size_t(body_of[i])] = local[i];
  std::size_t at = 0;
  for (const Own& one : own)
    for (CrowdPoint& point : points.subspan(manifolds[one.manifold].begin, manifolds[one.manifold].count)) {
      const SolverContact& solved = contacts[at++];
      point.impulse = impulse_of(solved);
      point.frictionless = float(solved.frictionless);
      point.bounces = solved.bounces;
      point.impact_time = float(solved.impact_time);
    }
}

}  // namespace lodestone
