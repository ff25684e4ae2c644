#include "lod/contact/uneven_islands.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lod/contact/crowd_lanes.h"
#include "lod/contact/led_sweeps.h"

namespace lodestone {

using namespace lane;

namespace {

// Times as many as elsewhere; for a ratio r about √(r / 2) times, as such an iteration asks for.
constexpr double kMostUnevenSweeps = 80.0;
// Points, four lanes wide, of one body on another: an impact on a light one, of whose impulses nothing is
// known, is solved to the end, in which so many points are relaxed. Larger ones are no better for it: slabs
// of a thousand times a column's mass then crush it more often.
constexpr std::size_t kFewPoints = 12, kRelaxations = 16'000;
constexpr double kUnevenTolerance = 1e-4;  // of what gravity adds to a velocity in the step
// Of many points no more than so: gravel under boulders, 1 : 8,000, costs a third and lies no otherwise. Of
// those between, a boulder on a few pebbles would creep.
constexpr std::size_t kManyPoints = 40, kRelaxationsOfMany = 16'000;
constexpr double kToleranceOfMany = 0.01;
// Beyond it floats do not hold what this tolerance asks of the light ones: they round a blow of 1 m/s of the
// heavy ones to 6e-5 m/s of theirs.
constexpr double kMostUnevenOfFloats = 1000.0;

/// More of a point: its friction's bound; the way on which the impulses are led, what the last sweep changed,
/// and the inverse of its effective masses, 0 in lanes without a point; and what its impulses begin with.
template <Lanes L>
struct alignas(64) LedPoint {
  L bound, way[3], change[3], inverse_mass[3], guess[3];
};

template <Lanes L>
struct BoundedRelaxation {
  LedPoint<L>* led;

  LODESTONE_INLINE bool operator()(const PointAtHand<L>& at, Vec3Lanes<L>& impulse) const {
    const Vec3Lanes<L> velocity = at.velocity();
    const L asked = at.point.effective_mass[0] * (at.point.target - dot(velocity, at.batch.normal));
    LedPoint<L>& own = led[at.index];
    const L* now = at.point.impulse;
    const L before[3] = {now[0], now[1], now[2]};
    impulse = relax(at, velocity, asked, all<L>(1), FrictionWithin<L>{own.bound});
    for (int axis = 0; axis < 3; ++axis) own.change[axis] = now[axis] - before[axis];
    return true;
  }
};

/// What a sweep changed in all: J over the unit of mass; m/s, the fastest point.
struct SweepSize {
  double sum = 0.0, fastest = 0.0;
};

template <Lanes L>
struct SizeLoop {
  std::span<const BatchLanes<L>> batches;
  const LedPoint<L>* led;
  SweepSize& size;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    L sum{}, fastest{};
    for (std::int64_t b = begin; b < end; ++b) {
      const BatchLanes<L>& batch = batches[std::size_t(b)];
      for (const LedPoint<L>* own = led + batch.begin; own != led + batch.begin + batch.count; ++own)
        for (int axis = 0; axis < 3; ++axis) {
          const L change = absolute(own->change[axis]), speed = change * own->inverse_mass[axis];
          sum = sum + change * speed, fastest = most(fastest, speed);
        }
    }
    for (int lane = 0; lane < kLanes<L>; ++lane) {
      size.sum += double(sum[lane]);
      size.fastest = std::max(size.fastest, double(fastest[lane]));
    }
  }
};

/// Of one island at a time.
template <Lanes L>
struct LedIsland {
  explicit LedIsland(Simd own_simd) : simd(own_simd), crowd(simd), lanes(crowd.lanes()) {}

  Simd simd;
  CrowdLanes<L> crowd;
  ContactLanes<L>& lanes;
  std::vector<LedPoint<L>> led;  // beside the points
  std::vector<Motion<L>> motions_before;

  /// As many sweeps as there may be, and m/s that none need change any more.
  void solve(const CrowdContacts& contacts, int sweeps, double enough, const JobRunner& jobs);

 private:
  template <class Visit>
  void each_point(const Visit& visit) {
    for (const BatchLanes<L>& batch : lanes.batches())
      for (std::uint32_t i = batch.begin; i < batch.begin + std::uint32_t(batch.count); ++i)
        visit(batch, lanes.points()[i], led[i]);
  }
  void bound_friction(int sweeps, double enough, const JobRunner& jobs);
  void sweep_led(int sweeps, double enough, const JobRunner& jobs);
};

// Sweeps by themselves carry a weight through a light body as many of them as the one is heavier. Those that
// are led end with the velocities that are left to be mended: of a great weight's impulses a small part is
// much for a light body. Nothing says that these become less: where they are many times what they were, those
// that are left go by themselves, and never gain.
//
// Nor need there be an end: two points whose line is askew to their normals ask, where they are of unlike
// depth, for what no motion gives, and press against each other by the same amount more in each sweep.
template <Lanes L>
void LedIsland<L>::sweep_led(int sweeps, double enough, const JobRunner& jobs) {
  constexpr double kWorse = 100.0;
  // Sweeps in a row that change as much, to a part of it: they go on so. What nears an end slowly, as masses
  // of 1 : 10,000 do, changes by a thousand times that part.
  constexpr int kAlike = 4;
  constexpr double kAsMuch = 1e-7;
  double first = 0.0, last = 0.0;
  int alike = 0;
  bool leads = true;
  for (LedPoint<L>& point : led) std::ranges::fill(point.way, L{});
  for (int i = 0; i < sweeps; ++i) {
    crowd.sweep(BoundedRelaxation<L>{led.data()}, jobs);
    if (i + 1 == sweeps) return;  // within its bounds
    SweepSize size;
    run_wide(simd, SizeLoop<L>{lanes.batches(), led.data(), size}, 0, std::int64_t(lanes.batches().size()));
    alike = std::abs(size.sum - last) <= kAsMuch * last ? alike + 1 : 0;
    if (size.fastest <= enough || alike == kAlike) return;
    if (i == 0) first = size.sum;
    leads = leads && size.sum <= kWorse * first;
    const double part = size.sum <= last && last > 0.0 ? size.sum / last : 0.0;
    if (leads) crowd.sweep(Leading<L, LedPoint<L>>{led.data(), all<L>(Real<L>(part))}, jobs);
    last = size.sum;
  }
}

// A weight that rolls or slides onto light bodies presses them to the ground, where friction then holds them
// all the more, and so on: bounds that follow the normal impulses brake a ball of two tons on boxes of ten
// kilograms within a metre. dWorldStep with Approx1, the truth's law, has bounds from the normal impulses
// without friction.
template <Lanes L>
void LedIsland<L>::bound_friction(int sweeps, double enough, const JobRunner& jobs) {
  motions_before = lanes.motions();
  led.resize(lanes.points().size());
  each_point([&](const BatchLanes<L>&, PointLanes<L>& p, LedPoint<L>& own) {
    std::ranges::copy(p.impulse, own.guess);
    own.bound = p.impulse[1] = p.impulse[2] = L{};
    for (int axis = 0; axis < 3; ++axis) {
      const L& mass = p.effective_mass[axis];
      own.inverse_mass[axis] =
          mass > L{} ? Real<L>(1) / most(mass, all<L>(Real<L>(1e-30))) : L{};  // divides by no zero
    }
  });
  crowd.sweep(GuessesGiven<L>{}, jobs);
  sweep_led(sweeps, enough, jobs);
  lanes.motions() = motions_before;
  each_point([&](const BatchLanes<L>& batch, PointLanes<L>& p, LedPoint<L>& own) {
    own.bound = batch.friction * p.impulse[0];
    p.impulse[0] = own.guess[0];
    for (int t = 1; t < 3; ++t) p.impulse[t] = most(-own.bound, least(own.guess[t], own.bound));
  });
}

template <Lanes L>
void LedIsland<L>::solve(const CrowdContacts& contacts, int sweeps, double enough, const JobRunner& jobs) {
  bound_friction(sweeps, enough, jobs);
  crowd.sweep(GuessesGiven<L>{}, jobs);
  for (int i = 0; i < contacts.settings.sweeps; ++i)
    if (crowd.sweep(BoundedRelaxation<L>{led.data()}, jobs) <= enough) break;
  sweep_led(sweeps, enough, jobs);
  crowd.hand_out(contacts, jobs);
}

}  // namespace

struct UnevenIslands::Work {
  explicit Work(Simd simd) : exact(simd), quick(simd) {}

  LedIsland<D4> exact;
  LedIsland<F8> quick;
};

UnevenIslands::UnevenIslands(Simd simd) : work_(std::make_unique<Work>(simd)) {}
UnevenIslands::~UnevenIslands() = default;

void UnevenIslands::solve(const CrowdContacts& contacts, std::span<const std::uint32_t> which, double ratio,
                          const JobRunner& jobs) {
  if (which.empty()) return;
  auto& [exact, quick] = *work_;
  const ContactSolverSettings& settings = contacts.settings;
  exact.crowd.take(contacts, which, jobs);
  const std::size_t count = exact.lanes.points().size();  // of points, four lanes wide
  const int wanted = int(settings.sweeps * std::min(kMostUnevenSweeps, 1.0 + std::sqrt(ratio / 2)));
  const bool many = count > kManyPoints;
  const int sweeps = many ? std::min(wanted, std::max(2 * settings.sweeps, int(kRelaxationsOfMany / count)))
                     : count <= kFewPoints ? std::max(wanted, int(kRelaxations / count))
                                           : wanted;
  const double enough = (many ? kToleranceOfMany : kUnevenTolerance) * settings.fall.norm();
  if (!many || ratio > kMostUnevenOfFloats) return exact.solve(contacts, sweeps, enough, jobs);
  quick.crowd.take(contacts, which, jobs);
  quick.solve(contacts, sweeps, enough, jobs);
}

}  // namespace lodestone
