#include "lod/contact/small_islands.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr int kMostIslandSweeps = 40;  // of few points: a body on two edges asks for many
constexpr int kIslandRelaxations =
    400;  // of points, in as many sweeps as that is, but never fewer than a crowd's
constexpr std::int64_t kSideBySide = 8;  // islands

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
  own.frictionless_bound = true;
  run_in_pieces(jobs, std::int64_t(first_.size()) - 1, kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; i += kSideBySide) {
      const std::int64_t count = std::min(kSideBySide, end - i);
      solve_some(bodies, manifolds, points, step, own, simd,
                 std::span(first_).subspan(std::size_t(i), std::size_t(count) + 1));
    }
  });
}

void SmallIslands::solve_some(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                              std::span<CrowdPoint> points, double step,
                              const ContactSolverSettings& settings, Simd simd,
                              std::span<const std::uint32_t> first) {
  thread_local std::vector<SolverBody> local;      // those that move once, of what does not a copy a manifold
  thread_local std::vector<std::int32_t> body_of;  // of each of these, or −1 of what does not move
  thread_local std::vector<SolverContact> contacts;
  thread_local std::vector<IslandRun> runs;  // of each island
  local.clear(), body_of.clear(), contacts.clear(), runs.clear();
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
  for (std::size_t island = 0; island + 1 < first.size(); ++island) {
    const auto begin = std::uint32_t(contacts.size());
    for (std::uint32_t i = first[island]; i < first[island + 1]; ++i) {
      const CrowdManifold& m = manifolds[own_[i].manifold];
      const std::int32_t one = place_of(m.first), other = place_of(m.second);
      for (const CrowdPoint& point : points.subspan(m.begin, m.count))
        contacts.push_back({.first = one,
                            .second = other,
                            .normal = m.normal,
                            .arm_first = point.arm_first,
                            .arm_second = point.arm_second,
                            .gap = point.gap,
                            .law = m.law,
                            .guess = point.guess,
                            .frictionless = point.frictionless,
                            .most_impulse = m.most_impulse});
    }
    const std::uint32_t count = std::uint32_t(contacts.size()) - begin;
    const int enough = std::min(kIslandRelaxations / int(std::max(count, 1U)), kMostIslandSweeps);
    runs.push_back({begin, count, std::max(settings.sweeps, enough)});
  }
  solve_contacts(local, contacts, runs, step, settings, simd);
  for (std::size_t i = 0; i < local.size(); ++i)
    if (body_of[i] >= 0) bodies[std::size_t(body_of[i])] = local[i];
  std::size_t at = 0;
  for (const Own& own : std::span(own_).subspan(first.front(), first.back() - first.front())) {
    const CrowdManifold& m = manifolds[own.manifold];
    for (CrowdPoint& point : points.subspan(m.begin, m.count)) {
      const SolverContact& solved = contacts[at++];
      point.impulse = impulse_of(solved);
      point.frictionless = float(solved.frictionless);
      point.bounces = solved.bounces;
      point.impact_time = float(solved.impact_time);
    }
  }
}

}  // namespace lodestone
