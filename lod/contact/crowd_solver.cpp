#include "lod/contact/crowd_solver.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "lod/contact/crowd_islands.h"
#include "lod/contact/small_islands.h"
#include "lod/simd/double_lanes.h"

namespace lodestone {

using namespace lane;

namespace {

constexpr int kColours = 64;              // the last one: manifolds for which no other was left, one by one
constexpr std::uint8_t kNoColour = 255;   // of what is solved by itself
constexpr std::uint32_t kMostPoints = 4;  // of a manifold; more make no difference to its place
constexpr std::size_t kGroups =
    2 * kMostPoints;                 // of a colour: by whether it carried something, and its points
constexpr std::int64_t kGrain = 64;  // batches of a job
constexpr double kMostUnevenSweeps =
    80.0;  // times as many as elsewhere; for a ratio r about √(r / 2) times, as such an iteration asks for
// Points, four lanes wide, of one body on another: an impact on a light one, of whose impulses nothing is
// known, is solved to the end, in which so many points are relaxed. Larger ones are no better for it: slabs
// of a thousand times a column's mass then crush it more often.
constexpr std::size_t kFewPoints = 12, kRelaxations = 16'000;
constexpr double kUnevenTolerance = 1e-4;  // of what gravity adds to a velocity in the step

LODESTONE_INLINE D4 inverse_mass_along(const D4& inverse_mass, const Tensor4& inverse_inertia, const V4& arm,
                                       const V4& axis) {
  const V4 turning = cross(arm, axis);
  return inverse_mass + dot(turning, inverse_inertia * turning);
}

LODESTONE_INLINE V4 choose(const Mask4& which, const V4& a, const V4& b) {
  return {which ? a.x : b.x, which ? a.y : b.y, which ? a.z : b.z};
}

// Along the slip, or where there is none across the normal anyhow.
LODESTONE_INLINE V4 find_tangent(const V4& normal, const V4& velocity) {
  const V4 slip = velocity - dot(velocity, normal) * normal;
  const D4 speed = square_root(dot(slip, slip));
  const Mask4 slides = speed > 1e-9 * square_root(dot(velocity, velocity));
  const V4 along = 1.0 / most(speed, all(1e-300)) * slip,
           cleaned = along - dot(along, normal) * normal;  // little is left of a nearly head-on velocity
  const D4 none = {};
  const V4 from_z = {-normal.y, normal.x, none}, from_x = {none, -normal.z, normal.y};
  const V4 tangent = choose(slides, cleaned, choose(absolute(normal.z) < 0.7, from_z, from_x));
  return 1.0 / most(square_root(dot(tangent, tangent)), all(1e-300)) * tangent;
}

void set_lane(Tensor4& tensor, int lane, const Mat3& m) {
  tensor.xx[lane] = m(0, 0), tensor.yy[lane] = m(1, 1), tensor.zz[lane] = m(2, 2);
  tensor.xy[lane] = m(0, 1), tensor.xz[lane] = m(0, 2), tensor.yz[lane] = m(1, 2);
}

void set_lane(V4& vector, int lane, const Vec3& v) {
  vector.x[lane] = v.x(), vector.y[lane] = v.y(), vector.z[lane] = v.z();
}
Vec3 lane_of(const V4& v, int lane) { return {v.x[lane], v.y[lane], v.z[lane]}; }

/// A body's velocities as contacts read and change them.
struct alignas(64) Motion4 {
  D4 velocity{}, angular{};
};

struct alignas(64) PointLanes {
  V4 arm_first, arm_second, tangent;
  // Along normal, tangent and across: kg, 0 in lanes without a point; m/s along the normal that are asked
  // for; N s so far, at first the guess (what the last step had) within its bounds.
  D4 effective_mass[3], target, impulse[3];
};

/// More of a point, N s, where the batch is bounded: of friction; where the impulses are led, and what they
/// were.
struct alignas(64) UnevenLanes {
  D4 bound, step[3], before[3];
};

/// Up to four manifolds, with their bodies' masses beside them, since a sweep reads these in one go.
struct alignas(64) Batch {
  std::int32_t first[kLanes], second[kLanes];
  std::uint32_t manifold[kLanes];
  std::int32_t lanes = 0, count = 0;  // manifolds; points of the longest
  std::uint32_t begin = 0;            // its points
  bool bounded = false;               // friction by what the normal impulses are without any
  V4 normal;
  D4 friction, most_impulse, inverse_mass_first, inverse_mass_second;
  Tensor4 inertia_first, inertia_second;  // inverse
};

/// What a sweep reads and changes.
struct CrowdArrays {
  std::vector<Batch> batches;
  std::vector<PointLanes> points;
  std::vector<UnevenLanes> uneven_points;  // beside the points, where any batch is bounded
  std::vector<Motion4> motions;            // one more than bodies: the ground
};

enum class Round {
  guesses,  // gives what the impulses are
  relaxed,
  led,  // adds a part of `step` to the impulses
};

struct Change {
  double greatest_change = 0.0, greatest_impulse = 0.0;
};

}  // namespace

struct CrowdSolver::Work : CrowdArrays {
  Simd simd;
  CrowdIslands islands;
  SmallIslands small_islands;
  std::vector<std::uint64_t> used;       // of each body, as bits: colours that its manifolds have
  std::vector<std::uint8_t> colour_of;   // each manifold's
  std::vector<std::uint32_t> order;      // manifolds by colour, then those that are not uneven, then by group
  std::vector<std::uint16_t> group_of_;  // of each manifold, over all colours
  std::vector<std::uint32_t> first_of;   // of each of these groups, in `order`
  std::vector<std::uint32_t> first_batch;  // of each colour, and of its uneven ones
  std::vector<Change> changes;
  std::vector<Motion4> motions_before;
  std::vector<std::array<D4, 3>> guesses;

  void colour(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds);
  void make_batches(std::span<const CrowdManifold> manifolds, std::span<const CrowdPoint> contacts);
  void fill(Batch& batch, std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds,
            std::span<const CrowdPoint> contacts);
  void hand_out(const Batch& batch, std::span<const CrowdManifold> manifolds,
                std::span<CrowdPoint> contacts) const;
  enum class Which { all, uneven };
  Change sweep(Round round, Which which, const JobRunner& jobs, double part = 1.0);
  void sweep_uneven(const ContactSolverSettings& settings, const JobRunner& jobs);
  template <class Visit>
  void each_uneven_point(const Visit& visit) {
    for (const Batch& batch : batches)
      if (batch.bounded)
        for (std::uint32_t k = 0; k < std::uint32_t(batch.count); ++k)
          visit(batch, points[batch.begin + k], uneven_points[batch.begin + k], batch.begin + k);
  }
  void bound_friction(const ContactSolverSettings& settings, const JobRunner& jobs);
};

// Each manifold gets the first colour that none of its bodies has yet. What does not move may be shared.
void CrowdSolver::Work::colour(std::span<const SolverBody> bodies, std::span<const CrowdManifold> manifolds) {
  used.assign(bodies.size() + 1, 0);
  colour_of.resize(manifolds.size());
  const auto moves = [&](std::int32_t body) {
    return body >= 0 && bodies[std::size_t(body)].inverse_mass > 0.0;
  };
  for (std::size_t i = 0; i < manifolds.size(); ++i) {
    colour_of[i] = kNoColour;
    if (islands.kind_of(i) == IslandKind::small) continue;
    std::uint64_t none = 0;
    std::uint64_t& first = moves(manifolds[i].first) ? used[std::size_t(manifolds[i].first)] : none;
    std::uint64_t& second = moves(manifolds[i].second) ? used[std::size_t(manifolds[i].second)] : used.back();
    const int colour = std::min(std::countr_one(first | second), kColours - 1);
    if (colour < kColours - 1) first |= std::uint64_t(1) << colour, second |= std::uint64_t(1) << colour;
    used.back() = 0;
    colour_of[i] = std::uint8_t(colour);
  }
}

// Which manifolds each holds, and where its points will be. Those that carried something lie side by side,
// since a sweep is quick where none of four does.
void CrowdSolver::Work::make_batches(std::span<const CrowdManifold> manifolds,
                                     std::span<const CrowdPoint> contacts) {
  const auto carries = [&](const CrowdManifold& m) {
    return std::ranges::any_of(contacts.subspan(m.begin, m.count),
                               [](const CrowdPoint& point) { return !point.guess.isZero(0.0); });
  };
  const auto group_of = [&](std::size_t i) {
    const std::size_t part = 2 * std::size_t(colour_of[i]) + (islands.kind_of(i) == IslandKind::uneven);
    return part * kGroups + carries(manifolds[i]) * kMostPoints + std::min(manifolds[i].count, kMostPoints) -
           1;
  };
  group_of_.resize(manifolds.size());
  first_of.assign(2 * kColours * kGroups + 1, 0);
  for (std::size_t i = 0; i < manifolds.size(); ++i) {
    if (colour_of[i] == kNoColour) continue;
    group_of_[i] = std::uint16_t(group_of(i));
    ++first_of[group_of_[i] + 1U];
  }
  for (std::size_t g = 1; g < first_of.size(); ++g) first_of[g] += first_of[g - 1];
  order.resize(manifolds.size());
  for (std::size_t i = 0; i < manifolds.size(); ++i)
    if (colour_of[i] != kNoColour) order[first_of[group_of_[i]]++] = std::uint32_t(i);

  batches.clear();
  first_batch.assign(1, 0);
  std::uint32_t at = 0, begin = 0;
  for (int part = 0; part < 2 * kColours; ++part) {
    const std::uint32_t end = first_of[std::size_t(part + 1) * kGroups - 1];
    const std::uint32_t width = part / 2 == kColours - 1 ? 1 : kLanes;
    for (; at < end; at = std::min(at + width, end)) {
      Batch& batch = batches.emplace_back();
      batch.lanes = std::int32_t(std::min(width, end - at));
      batch.bounded = part % 2 == 1;
      batch.begin = begin;
      for (int lane = 0; lane < batch.lanes; ++lane) {
        batch.manifold[lane] = order[at + std::uint32_t(lane)];
        batch.count = std::max(batch.count, std::int32_t(manifolds[batch.manifold[lane]].count));
      }
      begin += std::uint32_t(batch.count);
    }
    first_batch.push_back(std::uint32_t(batches.size()));
  }
  points.resize(begin);
}

// What PrepareLoop needs of a point lies meanwhile where its own results will: the guess in `tangent`, the
// gap in `target`, and a 1 in the first `effective_mass` of each lane that has one.
void CrowdSolver::Work::fill(Batch& batch, std::span<const SolverBody> bodies,
                             std::span<const CrowdManifold> manifolds, std::span<const CrowdPoint> contacts) {
  const auto ground = std::int32_t(bodies.size());
  for (int lane = 0; lane < kLanes; ++lane) batch.first[lane] = batch.second[lane] = ground;
  std::fill_n(points.begin() + batch.begin, batch.count, PointLanes{});
  for (int lane = 0; lane < batch.lanes; ++lane) {
    const CrowdManifold& m = manifolds[batch.manifold[lane]];
    const SolverBody& first = bodies[std::size_t(m.first)];
    batch.first[lane] = m.first;
    set_lane(batch.normal, lane, m.normal);
    batch.friction[lane] = m.law.friction;
    batch.most_impulse[lane] = m.most_impulse;
    batch.inverse_mass_first[lane] = first.inverse_mass;
    set_lane(batch.inertia_first, lane, first.inverse_inertia);
    if (m.second >= 0) {
      batch.second[lane] = m.second;
      batch.inverse_mass_second[lane] = bodies[std::size_t(m.second)].inverse_mass;
      set_lane(batch.inertia_second, lane, bodies[std::size_t(m.second)].inverse_inertia);
    }
    for (std::uint32_t k = 0; k < m.count; ++k) {
      const CrowdPoint& point = contacts[m.begin + k];
      PointLanes& to = points[batch.begin + k];
      set_lane(to.arm_first, lane, point.arm_first);
      set_lane(to.arm_second, lane, point.arm_second);
      set_lane(to.tangent, lane, point.guess);  // until prepared
      to.target[lane] = point.gap;
      to.effective_mass[0][lane] = 1.0;  // in use
    }
  }
}

void CrowdSolver::Work::hand_out(const Batch& batch, std::span<const CrowdManifold> manifolds,
                                 std::span<CrowdPoint> contacts) const {
  for (int lane = 0; lane < batch.lanes; ++lane) {
    const CrowdManifold& m = manifolds[batch.manifold[lane]];
    for (std::uint32_t k = 0; k < m.count; ++k) {
      const PointLanes& p = points[batch.begin + k];
      const Vec3 along = lane_of(p.tangent, lane);
      contacts[m.begin + k].impulse = p.impulse[0][lane] * m.normal + p.impulse[1][lane] * along +
                                      p.impulse[2][lane] * m.normal.cross(along);
    }
  }
}

// Frames, effective masses, and the velocities to reach.
struct PrepareLoop {
  CrowdArrays& solver;
  std::span<const CrowdManifold> manifolds;
  std::span<CrowdPoint> points;
  double step;
  const ContactSolverSettings& settings;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const D4 none = {};
    for (std::int64_t b = begin; b < end; ++b) {
      const Batch& batch = solver.batches[std::size_t(b)];
      const Motion4* motions = solver.motions.data();
      const Motion4 &a0 = motions[batch.first[0]], &a1 = motions[batch.first[1]],
                    &a2 = motions[batch.first[2]], &a3 = motions[batch.first[3]];
      const Motion4 &b0 = motions[batch.second[0]], &b1 = motions[batch.second[1]],
                    &b2 = motions[batch.second[2]], &b3 = motions[batch.second[3]];
      const V4 v = columns_of(a0.velocity, a1.velocity, a2.velocity, a3.velocity) -
                   columns_of(b0.velocity, b1.velocity, b2.velocity, b3.velocity);
      const V4 omega_first = columns_of(a0.angular, a1.angular, a2.angular, a3.angular),
               omega_second = columns_of(b0.angular, b1.angular, b2.angular, b3.angular);
      const V4 n = batch.normal;
      for (std::int32_t k = 0; k < batch.count; ++k) {
        PointLanes& p = solver.points[batch.begin + std::uint32_t(k)];
        const V4 guess = p.tangent,
                 velocity = v + cross(omega_first, p.arm_first) - cross(omega_second, p.arm_second);
        p.tangent = find_tangent(n, velocity);
        const V4 axes[3] = {n, p.tangent, cross(n, p.tangent)};
        const Mask4 used = p.effective_mass[0] > none;
        for (int i = 0; i < 3; ++i) {
          const D4 inverse =
              inverse_mass_along(batch.inverse_mass_first, batch.inertia_first, p.arm_first, axes[i]) +
              inverse_mass_along(batch.inverse_mass_second, batch.inertia_second, p.arm_second, axes[i]);
          p.effective_mass[i] = (used & (inverse > none)) ? 1.0 / most(inverse, all(1e-300)) : none;
        }
        const Mask4 drives = batch.most_impulse < kUnbounded;
        const D4 gap = p.target, approach = dot(velocity, n), asked = -gap / step,
                 closing = drives ? asked : least(none, asked);
        const Mask4 bounces =
            used & ~drives & (approach < -settings.bounce_velocity) & (gap + approach * step < none);
        p.target = closing;
        p.impulse[0] = bounces ? none : least(batch.most_impulse, most(none, dot(guess, n)));
        const D4 bound = batch.friction * p.impulse[0];
        for (int i = 1; i < 3; ++i) p.impulse[i] = most(-bound, least(dot(guess, axes[i]), bound));
        for (int lane = 0; lane < batch.lanes; ++lane) {
          if (!bounces[lane]) continue;
          const CrowdManifold& m = manifolds[batch.manifold[lane]];
          CrowdPoint& point = points[m.begin + std::uint32_t(k)];
          point.bounces = true;
          point.impact_time = float(std::max(0.0, gap[lane]) / -approach[lane]);
          const bool on_still = batch.inverse_mass_second[lane] == 0.0;
          const double fall = on_still ? std::min(0.0, settings.fall.dot(m.normal)) : 0.0;
          p.target[lane] = std::max(bounce_in_fall(m.law.restitution, gap[lane], approach[lane], fall, step),
                                    closing[lane]);
        }
      }
    }
  }
};

// One round over batches of one colour.
struct SweepLoop {
  CrowdArrays& solver;
  Round round;
  double part;
  Change& change;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const D4 none = {};
    D4 greatest_change = none, greatest_impulse = none;
    Motion4* motions = solver.motions.data();
    for (std::int64_t at = begin; at < end; ++at) {
      const Batch& batch = solver.batches[std::size_t(at)];
      const Motion4 &a0 = motions[batch.first[0]], &a1 = motions[batch.first[1]],
                    &a2 = motions[batch.first[2]], &a3 = motions[batch.first[3]];
      const Motion4 &b0 = motions[batch.second[0]], &b1 = motions[batch.second[1]],
                    &b2 = motions[batch.second[2]], &b3 = motions[batch.second[3]];
      V4 va = columns_of(a0.velocity, a1.velocity, a2.velocity, a3.velocity),
         wa = columns_of(a0.angular, a1.angular, a2.angular, a3.angular);
      V4 vb = columns_of(b0.velocity, b1.velocity, b2.velocity, b3.velocity),
         wb = columns_of(b0.angular, b1.angular, b2.angular, b3.angular);
      const V4 n = batch.normal;
      for (std::int32_t k = 0; k < batch.count; ++k) {
        PointLanes& p = solver.points[batch.begin + std::uint32_t(k)];
        const V4 other = cross(n, p.tangent);
        V4 impulse;
        if (round == Round::guesses) {
          impulse = p.impulse[0] * n + p.impulse[1] * p.tangent + p.impulse[2] * other;
        } else if (round == Round::led) {
          const D4* way = solver.uneven_points[batch.begin + std::uint32_t(k)].step;
          for (int i = 0; i < 3; ++i) p.impulse[i] = p.impulse[i] + part * way[i];
          impulse = (part * way[0]) * n + (part * way[1]) * p.tangent + (part * way[2]) * other;
        } else {
          const V4 velocity = va - vb + cross(wa, p.arm_first) - cross(wb, p.arm_second);
          const D4 held = p.impulse[0], held_along = p.impulse[1], held_across = p.impulse[2];
          const D4 asked = p.effective_mass[0] * (p.target - dot(velocity, n));
          if (!batch.bounded && !any((held > none) | (asked > none))) continue;  // no point carries anything
          p.impulse[0] = least(batch.most_impulse, most(none, held + asked));
          const D4 bound = batch.bounded ? solver.uneven_points[batch.begin + std::uint32_t(k)].bound
                                         : batch.friction * p.impulse[0];
          p.impulse[1] =
              most(-bound, least(held_along - p.effective_mass[1] * dot(velocity, p.tangent), bound));
          p.impulse[2] = most(-bound, least(held_across - p.effective_mass[2] * dot(velocity, other), bound));
          impulse = (p.impulse[0] - held) * n + (p.impulse[1] - held_along) * p.tangent +
                    (p.impulse[2] - held_across) * other;
          greatest_change =
              most(greatest_change, absolute(impulse.x) + absolute(impulse.y) + absolute(impulse.z));
          greatest_impulse = most(greatest_impulse, p.impulse[0]);
        }
        va = va + batch.inverse_mass_first * impulse,
        wa = wa + batch.inertia_first * cross(p.arm_first, impulse);
        vb = vb - batch.inverse_mass_second * impulse,
        wb = wb - batch.inertia_second * cross(p.arm_second, impulse);
      }
      D4 v[4], w[4];
      rows_of(va, v), rows_of(wa, w);
      for (int lane = 0; lane < kLanes; ++lane)  // what does not move may be in another batch, too
        if (batch.inverse_mass_first[lane] > 0.0) motions[batch.first[lane]] = {v[lane], w[lane]};
      rows_of(vb, v), rows_of(wb, w);
      for (int lane = 0; lane < kLanes; ++lane)
        if (batch.inverse_mass_second[lane] > 0.0) motions[batch.second[lane]] = {v[lane], w[lane]};
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      change.greatest_change = std::max(change.greatest_change, greatest_change[lane]);
      change.greatest_impulse = std::max(change.greatest_impulse, greatest_impulse[lane]);
    }
  }
};

// Returns the greatest of what the blocks of batches say.
Change CrowdSolver::Work::sweep(Round round, Which which, const JobRunner& jobs, double part) {
  Change all;
  for (std::size_t colour = 0; colour < kColours; ++colour) {
    const std::int64_t begin = first_batch[2 * colour + (which == Which::uneven)],
                       end = first_batch[2 * colour + 2], blocks = (end - begin + kGrain - 1) / kGrain;
    if (blocks <= 1 || colour == kColours - 1) {
      if (begin < end) run_wide(simd, SweepLoop{*this, round, part, all}, begin, end);
      continue;
    }
    changes.assign(std::size_t(blocks), {});
    jobs(blocks, TaskRef([&](std::int64_t block) {
           run_wide(simd, SweepLoop{*this, round, part, changes[std::size_t(block)]}, begin + block * kGrain,
                    std::min(end, begin + (block + 1) * kGrain));
         }));
    for (const Change& change : changes) {
      all.greatest_change = std::max(all.greatest_change, change.greatest_change);
      all.greatest_impulse = std::max(all.greatest_impulse, change.greatest_impulse);
    }
  }
  return all;
}

// Sweeps by themselves carry a weight through a light body as many of them as the one is heavier: each is led
// on along the way of the ones before, as conjugate gradients are (Silcowitz, Niebe and Erleben, A nonsmooth
// nonlinear conjugate gradient method for interactive contact force problems, 2010). They end with the
// velocities that are left to be mended: of a great weight's impulses a small part is much for a light body.
void CrowdSolver::Work::sweep_uneven(const ContactSolverSettings& settings, const JobRunner& jobs) {
  std::size_t count = 0;  // of points, four lanes wide
  each_uneven_point([&](const Batch&, const PointLanes&, const UnevenLanes&, std::uint32_t) { ++count; });
  const int sweeps =
      std::max(int(settings.sweeps * std::min(kMostUnevenSweeps, 1.0 + std::sqrt(islands.most_uneven() / 2))),
               count <= kFewPoints ? int(kRelaxations / std::max<std::size_t>(count, 1)) : 0);
  const double enough = kUnevenTolerance * settings.fall.norm();
  double last = 0.0;
  for (int i = 0; i < sweeps; ++i) {
    each_uneven_point([](const Batch&, PointLanes& p, UnevenLanes& u, std::uint32_t) {
      std::ranges::copy(p.impulse, u.before);
    });
    sweep(Round::relaxed, Which::uneven, jobs);
    if (i + 1 == sweeps) return;       // within its bounds
    double size = 0.0, fastest = 0.0;  // of the change: J; m/s
    each_uneven_point([&](const Batch& batch, const PointLanes& p, const UnevenLanes& u, std::uint32_t) {
      for (int axis = 0; axis < 3; ++axis)
        for (int lane = 0; lane < batch.lanes; ++lane) {
          const double mass = p.effective_mass[axis][lane],
                       change = p.impulse[axis][lane] - u.before[axis][lane];
          if (mass <= 0.0) continue;
          size += change * change / mass;
          fastest = std::max(fastest, std::abs(change) / mass);
        }
    });
    if (fastest <= enough) return;
    const double part = i > 0 && size <= last ? (last > 0.0 ? size / last : 0.0) : 0.0;
    each_uneven_point([](const Batch&, PointLanes& p, UnevenLanes& u, std::uint32_t) {
      for (int axis = 0; axis < 3; ++axis) u.before[axis] = p.impulse[axis] - u.before[axis];
    });
    if (part > 0.0) sweep(Round::led, Which::uneven, jobs, part);
    each_uneven_point([&](const Batch&, const PointLanes&, UnevenLanes& u, std::uint32_t) {
      for (int axis = 0; axis < 3; ++axis)
        u.step[axis] = i == 0 || part == 0.0 ? u.before[axis] : part * u.step[axis] + u.before[axis];
    });
    last = size;
  }
}

// A weight that rolls or slides onto light bodies presses them to the ground, where friction then holds them
// all the more, and so on: bounds that follow the normal impulses brake a ball of two tons on boxes of ten
// kilograms within a metre. dWorldStep with Approx1, the truth's law, has bounds from the normal impulses
// without friction.
void CrowdSolver::Work::bound_friction(const ContactSolverSettings& settings, const JobRunner& jobs) {
  motions_before = motions;
  uneven_points.resize(points.size());
  guesses.resize(points.size());
  each_uneven_point([&](const Batch&, PointLanes& p, UnevenLanes& u, std::uint32_t at) {
    guesses[at] = {p.impulse[0], p.impulse[1], p.impulse[2]};
    u.bound = p.impulse[1] = p.impulse[2] = D4{};
  });
  sweep(Round::guesses, Which::uneven, jobs);
  sweep_uneven(settings, jobs);
  motions = motions_before;
  each_uneven_point([&](const Batch& batch, PointLanes& p, UnevenLanes& u, std::uint32_t at) {
    const std::array<D4, 3>& guess = guesses[at];
    u.bound = batch.friction * p.impulse[0];
    p.impulse[0] = guess[0];
    for (std::size_t i = 1; i < 3; ++i) p.impulse[i] = most(-u.bound, least(guess[i], u.bound));
  });
}

CrowdSolver::CrowdSolver(Simd simd) : work_(std::make_unique<Work>()) { work_->simd = simd; }
CrowdSolver::~CrowdSolver() = default;

void CrowdSolver::solve(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                        std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings,
                        const JobRunner& jobs) {
  Work& work = *work_;
  work.islands.find(bodies, manifolds);
  work.small_islands.find(bodies, manifolds, work.islands);
  work.small_islands.solve(bodies, manifolds, points, step, settings, work.simd, jobs);
  work.motions.resize(bodies.size() + 1);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3 &v = bodies[i].velocity, &w = bodies[i].angular_velocity;
    work.motions[i] = {D4{v.x(), v.y(), v.z(), 0.0}, D4{w.x(), w.y(), w.z(), 0.0}};
  }
  work.motions.back() = {};
  work.colour(bodies, manifolds);
  work.make_batches(manifolds, points);
  const auto batches = std::int64_t(work.batches.size());
  run_in_pieces(jobs, batches, kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      work.fill(work.batches[std::size_t(i)], bodies, manifolds, points);
    run_wide(work.simd, PrepareLoop{work, manifolds, points, step, settings}, begin, end);
  });
  using Which = Work::Which;
  if (work.islands.any_uneven()) work.bound_friction(settings, jobs);
  work.sweep(Round::guesses, Which::all, jobs);
  for (int i = 0; i < settings.sweeps; ++i)
    if (const Change change = work.sweep(Round::relaxed, Which::all, jobs);
        change.greatest_change <= settings.tolerance * change.greatest_impulse)
      break;
  if (work.islands.any_uneven()) work.sweep_uneven(settings, jobs);

  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].inverse_mass > 0.0) bodies[i].in_great_heap = work.islands.in_great_heap(std::int32_t(i));
    bodies[i].velocity = {work.motions[i].velocity[0], work.motions[i].velocity[1],
                          work.motions[i].velocity[2]};
    bodies[i].angular_velocity = {work.motions[i].angular[0], work.motions[i].angular[1],
                                  work.motions[i].angular[2]};
  }
  run_in_pieces(jobs, batches, kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) work.hand_out(work.batches[std::size_t(i)], manifolds, points);
  });
}

}  // namespace lodestone
