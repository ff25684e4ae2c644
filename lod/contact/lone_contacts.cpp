#include "lod/contact/lone_contacts.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr int kSweeps = 40;  // at most, or as many as the crowd takes: a body on two edges asks for many
constexpr double kTolerance = 1e-4;

}  // namespace

void LoneContacts::find(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds) {
  among_others_.assign(bodies.size(), 0);
  for (const CrowdManifold& m : manifolds)
    if (moves(bodies, m.first) && moves(bodies, m.second))
      among_others_[std::size_t(m.first)] = among_others_[std::size_t(m.second)] = 1;
  is_lone_.assign(manifolds.size(), 0);
  own_.clear();
  for (std::uint32_t i = 0; i < manifolds.size(); ++i) {
    const CrowdManifold& m = manifolds[i];
    const std::int32_t body = moves(bodies, m.first) ? m.first : m.second;
    if (!moves(bodies, body) || among_others_[std::size_t(body)]) continue;
    is_lone_[i] = 1;
    own_.push_back({body, i});
  }
  std::ranges::sort(own_, {}, [](const Own& own) { return std::pair(own.body, own.manifold); });
  first_.clear();
  for (std::uint32_t i = 0; i < own_.size(); ++i)
    if (i == 0 || own_[i].body != own_[i - 1].body) first_.push_back(i);
  first_.push_back(std::uint32_t(own_.size()));
}

void LoneContacts::solve(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                         std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
                         const JobRunner& jobs) {
  constexpr std::int64_t kBlock = 32;  // bodies of a job
  ContactSolverSettings own = settings;
  own.sweeps = std::max(settings.sweeps, kSweeps);
  own.tolerance = std::min(settings.tolerance, kTolerance);
  own.frictionless_bound = true;
  run_in_pieces(jobs, std::int64_t(first_.size()) - 1, kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i)
      solve_one(bodies, manifolds, points, step, own,
                std::span(own_).subspan(first_[i], first_[i + 1] - first_[i]));
  });
}

void LoneContacts::solve_one(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                             std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
                             std::span<const Own> own) {
  thread_local std::vector<SolverBody> local;  // the body, then what it touches, a copy for each manifold
  thread_local std::vector<SolverContact> contacts;
  local.assign(1, bodies[std::size_t(own.front().body)]);
  contacts.clear();
  for (const auto& [body, manifold] : own) {
    const CrowdManifold& m = manifolds[manifold];
    const std::int32_t other = m.first == body ? m.second : m.first;
    std::int32_t still = -1;
    if (other >= 0) {
      still = std::int32_t(local.size());
      local.push_back(bodies[std::size_t(other)]);
    }
    for (const CrowdPoint& point : points.subspan(m.begin, m.count))
      contacts.push_back({.first = m.first == body ? 0 : still,
                          .second = m.first == body ? still : 0,
                          .normal = m.normal,
                          .arm_first = point.arm_first,
                          .arm_second = point.arm_second,
                          .gap = point.gap,
                          .law = m.law,
                          .guess = point.guess});
  }
  solve_contacts(local, contacts, step, settings);
  bodies[std::size_t(own.front().body)] = local.front();
  std::size_t at = 0;
  for (const Own& one : own)
    for (CrowdPoint& point : points.subspan(manifolds[one.manifold].begin, manifolds[one.manifold].count)) {
      const SolverContact& solved = contacts[at++];
      point.impulse = impulse_of(solved);
      point.bounces = solved.bounces;
      point.impact_time = float(solved.impact_time);
    }
}

}  // namespace lodestone
