#include "lod/contact/uneven_islands.h"

#include <algorithm>
#include <array>
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

/// More of a point: its friction's bound; the way on which the impulses are led, what the last sweep changed,
/// and the inverse of its effective masses, 0 in lanes without a point.
struct alignas(64) LedPoint {
  D4 bound, way[3], change[3], inverse_mass[3];
};

struct BoundedRelaxation {
  LedPoint* led;

  LODESTONE_INLINE bool operator()(const PointAtHand<D4>& at, V4& impulse) const {
    const V4 velocity = at.velocity();
    const D4 asked = at.point.effective_mass[0] * (at.point.target - dot(velocity, at.batch.normal));
    LedPoint& own = led[at.index];
    const D4* now = at.point.impulse;
    const D4 before[3] = {now[0], now[1], now[2]};
    impulse = relax(at, velocity, asked, all<D4>(1.0), FrictionWithin<D4>{own.bound});
    for (int axis = 0; axis < 3; ++axis) own.change[axis] = now[axis] - before[axis];
    return true;
  }
};

/// What a sweep changed in all: J over the unit of mass; m/s, the fastest point.
struct SweepSize {
  D4 sum{}, fastest{};
};

struct SizeLoop {
  std::span<const BatchLanes<D4>> batches;
  const LedPoint* led;
  SweepSize& size;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    SweepSize all;
    for (std::int64_t b = begin; b < end; ++b) {
      const BatchLanes<D4>& batch = batches[std::size_t(b)];
      for (const LedPoint* own = led + batch.begin; own != led + batch.begin + batch.count; ++own)
        for (int axis = 0; axis < 3; ++axis) {
          const D4 change = absolute(own->change[axis]), speed = change * own->inverse_mass[axis];
          all.sum = all.sum + change * speed, all.fastest = most(all.fastest, speed);
        }
    }
    size = all;
  }
};

}  // namespace

struct UnevenIslands::Work {
  explicit Work(Simd own_simd) : simd(own_simd), crowd(simd), lanes(crowd.lanes()) {}

  Simd simd;
  CrowdLanes<D4> crowd;
  ContactLanes<D4>& lanes;
  std::vector<LedPoint> led;  // beside the points
  std::vector<Motion<D4>> motions_before;
  std::vector<std::array<D4, 3>> guesses;

  template <class Visit>
  void each_point(const Visit& visit) {
    for (const BatchLanes<D4>& batch : lanes.batches())
      for (std::uint32_t i = batch.begin; i < batch.begin + std::uint32_t(batch.count); ++i)
        visit(batch, lanes.points()[i], i);
  }
  void bound_friction(int sweeps, double enough, const JobRunner& jobs);
  void sweep_led(int sweeps, double enough, const JobRunner& jobs);
};

// Sweeps by themselves carry a weight through a light body as many of them as the one is heavier. Those that
// are led end with the velocities that are left to be mended: of a great weight's impulses a small part is
// much for a light body. Nothing says that these become less: where they are many times what they were, those
// that are left go by themselves, and never gain.
void UnevenIslands::Work::sweep_led(int sweeps, double enough, const JobRunner& jobs) {
  constexpr double kWorse = 100.0;
  double first = 0.0, last = 0.0;
  bool leads = true;
  for (LedPoint& point : led) std::ranges::fill(point.way, D4{});
  for (int i = 0; i < sweeps; ++i) {
    crowd.sweep(BoundedRelaxation{led.data()}, jobs);
    if (i + 1 == sweeps) return;  // within its bounds
    SweepSize changed;
    run_wide(simd, SizeLoop{lanes.batches(), led.data(), changed}, 0, std::int64_t(lanes.batches().size()));
    const D4 &sums = changed.sum, &fastest = changed.fastest;
    const double size = (sums[0] + sums[1]) + (sums[2] + sums[3]);
    if (std::max({fastest[0], fastest[1], fastest[2], fastest[3]}) <= enough) return;
    if (i == 0) first = size;
    leads = leads && size <= kWorse * first;
    if (!leads) continue;
    const D4 part = all<D4>(size <= last && last > 0.0 ? size / last : 0.0);
    crowd.sweep(Leading<D4, LedPoint>{led.data(), part}, jobs);
    last = size;
  }
}

// A weight that rolls or slides onto light bodies presses them to the ground, where friction then holds them
// all the more, and so on: bounds that follow the normal impulses brake a ball of two tons on boxes of ten
// kilograms within a metre. dWorldStep with Approx1, the truth's law, has bounds from the normal impulses
// without friction.
void UnevenIslands::Work::bound_friction(int sweeps, double enough, const JobRunner& jobs) {
  motions_before = lanes.motions();
  led.resize(lanes.points().size());
  guesses.resize(lanes.points().size());
  each_point([&](const BatchLanes<D4>&, PointLanes<D4>& p, std::uint32_t at) {
    guesses[at] = {p.impulse[0], p.impulse[1], p.impulse[2]};
    led[at].bound = p.impulse[1] = p.impulse[2] = D4{};
    for (int axis = 0; axis < 3; ++axis) {
      const D4& mass = p.effective_mass[axis];
      led[at].inverse_mass[axis] =
          mass > D4{} ? 1.0 / most(mass, all<D4>(1e-30)) : D4{};  // divides by no zero
    }
  });
  crowd.sweep(GuessesGiven<D4>{}, jobs);
  sweep_led(sweeps, enough, jobs);
  lanes.motions() = motions_before;
  each_point([&](const BatchLanes<D4>& batch, PointLanes<D4>& p, std::uint32_t at) {
    const D4 bound = led[at].bound = batch.friction * p.impulse[0];
    p.impulse[0] = guesses[at][0];
    for (std::size_t i = 1; i < 3; ++i) p.impulse[i] = most(-bound, least(guesses[at][i], bound));
  });
}

UnevenIslands::UnevenIslands(Simd simd) : work_(std::make_unique<Work>(simd)) {}
UnevenIslands::~UnevenIslands() = default;

void UnevenIslands::solve(const CrowdContacts& contacts, std::span<const std::uint32_t> which, double ratio,
                          const JobRunner& jobs) {
  if (which.empty()) return;
  Work& work = *work_;
  const ContactSolverSettings& settings = contacts.settings;
  work.crowd.take(contacts, which, jobs);
  const std::size_t count = work.lanes.points().size();  // of points, four lanes wide
  const int wanted = int(settings.sweeps * std::min(kMostUnevenSweeps, 1.0 + std::sqrt(ratio / 2)));
  const bool many = count > kManyPoints;
  const int sweeps = many ? std::min(wanted, std::max(2 * settings.sweeps, int(kRelaxationsOfMany / count)))
                     : count <= kFewPoints ? std::max(wanted, int(kRelaxations / count))
                                           : wanted;
  const double enough = (many ? kToleranceOfMany : kUnevenTolerance) * settings.fall.norm();
  work.bound_friction(sweeps, enough, jobs);
  work.crowd.sweep(GuessesGiven<D4>{}, jobs);
  for (int i = 0; i < settings.sweeps; ++i)
    if (work.crowd.sweep(BoundedRelaxation{work.led.data()}, jobs) <= enough) break;
  work.sweep_led(sweeps, enough, jobs);
  work.crowd.hand_out(contacts, jobs);
}

}  // namespace lodestone
