#include "lod/contact/small_islands.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <vector>

#include "lod/contact/led_sweeps.h"

namespace lodestone {

using namespace lane;

namespace {

using L = F8;
constexpr std::size_t kWidth = kLanes<L>;
constexpr int kMostIslandSweeps = 40;  // of few points: a body on two edges asks for many
// Of points, in as many sweeps as that is, but never fewer than a crowd's.
constexpr int kIslandRelaxations = 400;

// A blow at which sweeps are led, over √(g d), d being how far from its body's centre it strikes: slower ones
// throw nothing aside that anybody would see.
constexpr double kStrongBlow = 0.3;
constexpr int kMostLedSweeps = 60;
constexpr float kLedTolerance = 3e-4F;  // of it

constexpr auto kMostRemembered = double(std::numeric_limits<float>::max());  // N s

/// A manifold, by its island.
struct Own {
  std::int32_t island;
  std::uint32_t manifold;
};

struct Island {
  std::uint32_t begin = 0, count = 0;  // its manifolds among those that are owned
  std::uint32_t points = 0;
};

/// Islands in lanes, each in the same one of all its batches: the first manifold of each, the second of each,
/// and so on.
struct Group {
  std::int64_t begin = 0;  // batches
  std::array<std::uint32_t, kWidth> manifolds{};
  std::array<int, kWidth> sweeps{};  // at most
};

/// More of a point: its friction's bound, and what its impulses begin with.
struct alignas(64) StartLanes {
  L bound, guess[3];
};

/// More of a point that is led: what a sweep changed, on which way it is, and what a change of its impulse
/// changes of its velocity, over the unit of mass.
struct alignas(64) LedLanes {
  L change[3], way[3], inverse_mass[3];
};

struct FrictionlessRelaxation {
  const L& live;  // 1 or 0, of each lane

  LODESTONE_INLINE bool operator()(const PointAtHand<L>& at, Vec3Lanes<L>& impulse) const {
    PointLanes<L>& p = at.point;
    const L held = p.impulse[0],
            asked = live * p.effective_mass[0] * (p.target - dot(at.velocity(), at.batch.normal));
    p.impulse[0] = least(at.batch.most_impulse, most(L{}, held + asked));
    impulse = (p.impulse[0] - held) * at.batch.normal;
    return true;
  }
};

struct BoundedRelaxation {
  const StartLanes* starts;
  const L& live;

  LODESTONE_INLINE bool operator()(const PointAtHand<L>& at, Vec3Lanes<L>& impulse) const {
    const PointLanes<L>& p = at.point;
    const Vec3Lanes<L> velocity = at.velocity();
    const L asked = live * p.effective_mass[0] * (p.target - dot(velocity, at.batch.normal));
    impulse = relax(at, velocity, asked, live, FrictionWithin<L>{starts[at.index].bound});
    return true;
  }
};

/// How much a sweep changed in each lane: Σ J² over the masses, and the velocity of a point, m/s.
struct SweepSize {
  L sum{}, fastest{};
};

/// Notes what an answer changes.
template <class Answer>
struct Noted {
  const Answer& answer;
  LedLanes* led;
  SweepSize& size;

  LODESTONE_INLINE bool operator()(const PointAtHand<L>& at, Vec3Lanes<L>& impulse) const {
    const L* now = at.point.impulse;
    const L before[3] = {now[0], now[1], now[2]};
    const bool answered = answer(at, impulse);
    LedLanes& own = led[at.index];
    for (int axis = 0; axis < 3; ++axis) {
      own.change[axis] = now[axis] - before[axis];
      const L change = absolute(own.change[axis]), speed = change * own.inverse_mass[axis];
      size.sum = size.sum + change * speed, size.fastest = most(size.fastest, speed);
    }
    return answered;
  }
};

}  // namespace

struct SmallIslands::Work {
  explicit Work(Simd simd) : lanes(simd) {}

  ContactLanes<L> lanes;
  std::vector<Own> own;
  std::vector<Island> islands;
  std::vector<Group> groups;
  std::vector<StartLanes> starts;  // beside the points
  std::vector<LedLanes> led;       // likewise

  void find(const CrowdContacts& contacts, const CrowdIslands& kinds);
  void make_groups(const CrowdContacts& contacts);
  void solve_group(const Group& group, const CrowdContacts& contacts);
  template <class Visit>
  void each_point(const Group& group, const Visit& visit) {
    for (std::uint32_t round = 0; round < group.manifolds.front(); ++round) {
      const BatchLanes<L>& batch = lanes.batches()[std::size_t(group.begin) + round];
      for (std::uint32_t k = 0; k < std::uint32_t(batch.count); ++k)
        visit(batch, lanes.points()[batch.begin + k], batch.begin + k, k);
    }
  }
  void take_motions_back(const Group& group, const CrowdContacts& contacts);
  template <class Answer>
  void sweep(const Group& group, const Answer& answer, L& live, const L& struck, double tolerance);
  template <class Answer>
  void sweep_led(const Group& group, const Answer& answer, L& live, const L& struck);
};

// The islands with most manifolds first, so that those side by side are alike.
void SmallIslands::Work::find(const CrowdContacts& contacts, const CrowdIslands& kinds) {
  own.clear();
  for (std::uint32_t i = 0; i < contacts.manifolds.size(); ++i)
    if (kinds.kind_of(i) == IslandKind::small) own.push_back({kinds.island_of(i), i});
  std::ranges::sort(own, {}, [](const Own& o) { return std::pair(o.island, o.manifold); });
  islands.clear();
  for (std::uint32_t i = 0; i < own.size(); ++i) {
    if (i == 0 || own[i].island != own[i - 1].island) islands.push_back({.begin = i});
    ++islands.back().count;
    islands.back().points += contacts.manifolds[own[i].manifold].count;
  }
  std::ranges::sort(islands, [](const Island& a, const Island& b) {
    return std::tuple(b.count, b.points, a.begin) < std::tuple(a.count, a.points, b.begin);
  });
}

void SmallIslands::Work::make_groups(const CrowdContacts& contacts) {
  groups.clear();
  lanes.clear();
  for (std::size_t first = 0; first < islands.size(); first += kWidth) {
    const auto side_by_side = std::span(islands).subspan(first, std::min(kWidth, islands.size() - first));
    Group& group = groups.emplace_back();
    group.begin = std::int64_t(lanes.batches().size());
    std::array<double, kWidth> unit_mass;
    for (std::size_t i = 0; i < side_by_side.size(); ++i) {
      const Island& island = side_by_side[i];
      group.manifolds[i] = island.count;
      group.sweeps[i] =
          std::max(contacts.settings.sweeps,
                   std::min(kIslandRelaxations / int(std::max(island.points, 1U)), kMostIslandSweeps));
      unit_mass[i] = unit_mass_of(contacts, contacts.manifolds[own[island.begin].manifold]);
    }
    std::array<std::uint32_t, kWidth> manifolds;
    for (std::uint32_t round = 0; round < side_by_side.front().count; ++round) {
      std::size_t count = 0;
      for (; count < side_by_side.size() && side_by_side[count].count > round; ++count)
        manifolds[count] = own[side_by_side[count].begin + round].manifold;
      lanes.add_batch(contacts, std::span(manifolds).first(count), std::span(unit_mass).first(count));
    }
  }
  lanes.end();
  starts.resize(lanes.points().size()), led.resize(lanes.points().size());
}

void SmallIslands::Work::take_motions_back(const Group& group, const CrowdContacts& contacts) {
  for (std::uint32_t round = 0; round < group.manifolds.front(); ++round) {
    const BatchLanes<L>& batch = lanes.batches()[std::size_t(group.begin) + round];
    const auto take_back = [&](std::int32_t body, bool moves) {
      if (!moves) return;
      const SolverBody& from = contacts.bodies[std::size_t(body)];
      lanes.motions()[std::size_t(body)].set(from.velocity, from.angular_velocity);
    };
    for (int lane = 0; lane < batch.lanes; ++lane) {
      take_back(batch.first[lane], batch.inverse_mass_first[lane] > 0.0F);
      take_back(batch.second[lane], batch.inverse_mass_second[lane] > 0.0F);
    }
  }
}

// Each lane that was not struck, until nothing changes in it any more.
template <class Answer>
void SmallIslands::Work::sweep(const Group& group, const Answer& answer, L& live, const L& struck,
                               double tolerance) {
  for (std::size_t i = 0; i < kWidth; ++i)
    live[i] = group.manifolds[i] > 0 && struck[i] == 0.0F ? 1.0F : 0.0F;
  for (int done = 1;; ++done) {
    std::uint32_t rounds = 0;
    for (std::size_t i = 0; i < kWidth; ++i)
      if (live[i] > 0.0F) rounds = std::max(rounds, group.manifolds[i]);
    if (rounds == 0) return;
    const LaneChange<L> change = lanes.sweep(answer, group.begin, group.begin + rounds);
    for (std::size_t i = 0; i < kWidth; ++i)
      if (done >= group.sweeps[i] || change.of_impulse[i] <= float(tolerance) * change.greatest_impulse[i])
        live[i] = 0.0F;
  }
}

// Those lanes that were struck: what sweeps by themselves had left of a blow would throw the bodies aside.
template <class Answer>
void SmallIslands::Work::sweep_led(const Group& group, const Answer& answer, L& live, const L& struck) {
  live = struck > L{} ? all<L>(1) : L{};
  if (!any(live > L{})) return;
  each_point(group, [&](const BatchLanes<L>&, const PointLanes<L>& p, std::uint32_t at, std::uint32_t) {
    for (int axis = 0; axis < 3; ++axis) {
      led[at].way[axis] = L{};
      const L mass = p.effective_mass[axis];
      led[at].inverse_mass[axis] =
          mass > L{} ? 1.0F / most(mass, all<L>(1e-30F)) : L{};  // divides by no zero
    }
  });
  // Leading may go astray: then a lane goes on by itself.
  constexpr float kWorse = 10.0F;  // over its first change
  L first{}, last{}, leads = live;
  for (int i = 1;; ++i) {
    std::uint32_t rounds = 0;
    for (std::size_t lane = 0; lane < kWidth; ++lane)
      if (live[lane] > 0.0F) rounds = std::max(rounds, group.manifolds[lane]);
    SweepSize size;
    lanes.sweep(Noted<Answer>{answer, led.data(), size}, group.begin, group.begin + rounds);
    live = size.fastest > kLedTolerance * struck ? live : L{};
    if (i == kMostLedSweeps || !any(live > L{})) return;  // within its bounds
    if (i == 1) first = size.sum;
    leads = size.sum <= kWorse * first ? leads : L{};
    const Mask<L> nears = (leads > L{}) & (live > L{}) & (last > L{}) & (size.sum <= last);
    const L part = nears ? size.sum / (nears ? last : all<L>(1)) : L{};
    lanes.sweep(Leading<L, LedLanes>{led.data(), part}, group.begin, group.begin + rounds);
    last = size.sum;
  }
}

// Twice: what the normal impulses are without friction bounds it.
void SmallIslands::Work::solve_group(const Group& group, const CrowdContacts& contacts) {
  const std::int64_t end = group.begin + group.manifolds.front();
  lanes.prepare(contacts, group.begin, end);
  const double gravity = contacts.settings.fall.norm() / contacts.step;  // m/s²
  const auto is_strong = [&](const CrowdPoint& point) {
    return double(point.blow) * double(point.blow) >
           kStrongBlow * kStrongBlow * gravity * point.arm_first.norm();
  };
  // m/s, of each lane: its fastest blow; 0: none that is strong, or of one manifold alone, or with a motor,
  // whose pushes it goes on with.
  L struck{}, driven{};
  each_point(group, [&](const BatchLanes<L>& batch, PointLanes<L>& p, std::uint32_t at, std::uint32_t k) {
    std::ranges::copy(p.impulse, starts[at].guess);
    for (int lane = 0; lane < batch.lanes; ++lane) {
      const CrowdManifold& m = contacts.manifolds[batch.manifold[lane]];
      if (k >= m.count) continue;
      const CrowdPoint& point = contacts.points[m.begin + k];
      if (point.bounces && group.manifolds[std::size_t(lane)] > 1 && is_strong(point))
        struck[lane] = std::max(struck[lane], point.blow);
      if (m.most_impulse < kUnbounded) driven[lane] = 1.0F;
      if (point.frictionless >= 0.0F && !point.bounces)
        p.impulse[0][lane] =
            std::min(float(double(point.frictionless) / batch.unit_mass[lane]), batch.most_impulse[lane]);
    }
    p.impulse[1] = p.impulse[2] = L{};
  });
  struck = driven > L{} ? L{} : struck;
  L live;
  const auto solve = [&](const auto& answer) {
    lanes.sweep(GuessesGiven<L>{}, group.begin, end);
    sweep(group, answer, live, struck, contacts.settings.tolerance);
    sweep_led(group, answer, live, struck);
  };
  solve(FrictionlessRelaxation{live});
  take_motions_back(group, contacts);
  each_point(group, [&](const BatchLanes<L>& batch, PointLanes<L>& p, std::uint32_t at, std::uint32_t k) {
    for (int lane = 0; lane < batch.lanes; ++lane)
      if (const CrowdManifold& m = contacts.manifolds[batch.manifold[lane]]; k < m.count) {
        CrowdPoint& point = contacts.points[m.begin + k];
        point.frictionless =
            float(std::min(double(p.impulse[0][lane]) * batch.unit_mass[lane], kMostRemembered));
        point.in_blow = struck[lane] > 0.0F;
      }
    StartLanes& start = starts[at];
    start.bound = batch.friction * p.impulse[0];
    p.impulse[0] = struck > L{} ? p.impulse[0] : start.guess[0];
    for (int t = 1; t < 3; ++t) p.impulse[t] = most(-start.bound, least(start.guess[t], start.bound));
  });
  solve(BoundedRelaxation{starts.data(), live});
  lanes.hand_out(contacts, group.begin, end);
}

SmallIslands::SmallIslands(Simd simd) : work_(std::make_unique<Work>(simd)) {}
SmallIslands::~SmallIslands() = default;

void SmallIslands::solve(const CrowdContacts& contacts, const CrowdIslands& islands, const JobRunner& jobs) {
  constexpr std::int64_t kGrain = 4;  // groups of a job
  Work& work = *work_;
  work.find(contacts, islands);
  if (work.own.empty()) return;
  work.make_groups(contacts);
  work.lanes.take_motions(contacts.bodies);
  run_in_pieces(jobs, std::int64_t(work.groups.size()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) work.solve_group(work.groups[std::size_t(i)], contacts);
  });
}

}  // namespace lodestone
