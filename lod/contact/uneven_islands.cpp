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

constexpr double kMostUnevenSweeps =
    80.0;  // times as many as elsewhere; for a ratio r about √(r / 2) times, as such an iteration asks for
// Points, four lanes wide, of one body on another: an impact on a light one, of whose impulses nothing is
// known, is solved to the end, in which so many points are relaxed. Larger ones are no better for it: slabs
// of a thousand times a column's mass then crush it more often.
constexpr std::size_t kFewPoints = 12, kRelaxations = 16'000;
constexpr double kUnevenTolerance = 1e-4;  // of what gravity adds to a velocity in the step
// Of many points no more than so: gravel under boulders, 1 : 8,000, costs a third and lies no otherwise. Of
// those between, a boulder on a few pebbles would creep.
constexpr std::size_t kManyPoints = 40, kRelaxationsOfMany = 16'000;
constexpr double kToleranceOfMany = 0.01;

/// More of a point: its friction's bound; the way on which the impulses are led, and what a sweep changed.
struct alignas(64) LedPoint {
  D4 bound, way[3], change[3];
};

struct BoundedRelaxation {
  const LedPoint* led;

  LODESTONE_INLINE bool operator()(const PointAtHand<D4>& at, V4& impulse) const {
    const V4 velocity = at.velocity();
    const D4 asked = at.point.effective_mass[0] * (at.point.target - dot(velocity, at.batch.normal));
    impulse = relax(at, velocity, asked, all<D4>(1.0), FrictionWithin<D4>{led[at.index].bound});
    return true;
  }
};

}  // namespace

struct UnevenIslands::Work {
  explicit Work(Simd simd) : crowd(simd), lanes(crowd.lanes()) {}

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
// much for a light body.
void UnevenIslands::Work::sweep_led(int sweeps, double enough, const JobRunner& jobs) {
  double last = 0.0;
  for (int i = 0; i < sweeps; ++i) {
    each_point([&](const BatchLanes<D4>&, const PointLanes<D4>& p, std::uint32_t at) {
      std::ranges::copy(p.impulse, led[at].change);
      if (i == 0) std::ranges::fill(led[at].way, D4{});
    });
    crowd.sweep(BoundedRelaxation{led.data()}, jobs);
    if (i + 1 == sweeps) return;       // within its bounds
    double size = 0.0, fastest = 0.0;  // of the change: J over the unit of mass; m/s
    each_point([&](const BatchLanes<D4>& batch, const PointLanes<D4>& p, std::uint32_t at) {
      for (int axis = 0; axis < 3; ++axis) {
        D4& of_axis = led[at].change[axis];
        of_axis = p.impulse[axis] - of_axis;
        for (int lane = 0; lane < batch.lanes; ++lane) {
          const double mass = p.effective_mass[axis][lane], change = of_axis[lane];
          if (mass <= 0.0) continue;
          size += change * change / mass;
          fastest = std::max(fastest, std::abs(change) / mass);
        }
      }
    });
    if (fastest <= enough) return;
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
