// Contacts side by side: sequential impulses as in contact_solver.h, one manifold in each lane. Which may lie
// side by side is a matter of who uses it: they share no body that moves.
//
// Included by the solvers alone, which are compiled for lanes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "lod/contact/contact_solver.h"
#include "lod/contact/crowd_manifold.h"
#include "lod/room.h"
#include "lod/simd/lanes.h"

namespace lodestone {

/// What there is to solve.
struct CrowdContacts {
  std::span<SolverBody> bodies;
  std::span<const CrowdManifold> manifolds;
  std::span<CrowdPoint> points;  ///< those of a manifold follow each other
  double step = 0.0;             ///< s
  const ContactSolverSettings& settings;
};

/// kg: of the heavier of the two that move, or 1. Impulses over it lie in the midst of what floats hold.
inline double unit_mass_of(const CrowdContacts& contacts, const CrowdManifold& m) {
  const auto mass_of = [&](std::int32_t body) {
    const double inverse = body < 0 ? 0.0 : contacts.bodies[std::size_t(body)].inverse_mass;
    return inverse > 0.0 ? 1.0 / inverse : 0.0;
  };
  const double heavier = std::max(mass_of(m.first), mass_of(m.second));
  if (heavier > 0.0) return heavier;
  double greatest = 1.0;  // of two that nothing moves, so that floats hold what they begin with
  for (const CrowdPoint& point : contacts.points.subspan(m.begin, m.count))
    greatest = std::max(greatest, point.guess.norm());
  return greatest;
}

namespace lane {

/// A body's velocities as contacts read and change them, m/s and rad/s.
template <Lanes L>
struct Motion;
template <>
struct alignas(64) Motion<D4> {
  D4 velocity{}, angular{};
  void set(const Vec3& v, const Vec3& w) {
    velocity = D4{v.x(), v.y(), v.z(), 0.0}, angular = D4{w.x(), w.y(), w.z(), 0.0};
  }
};
template <>
struct alignas(32) Motion<F8> {
  F8 both{};
  void set(const Vec3& v, const Vec3& w) {
    both = F8{float(v.x()), float(v.y()), float(v.z()), 0.0F, float(w.x()), float(w.y()), float(w.z()), 0.0F};
  }
};

/// Of as many bodies as there are lanes.
template <Lanes L>
struct Motions {
  Vec3Lanes<L> velocity, angular;
};

LODESTONE_INLINE Motions<D4> gather(const Motion<D4>* motions, const std::int32_t (&of)[kLanes<D4>]) {
  const Motion<D4>&a = motions[of[0]], &b = motions[of[1]], &c = motions[of[2]], &d = motions[of[3]];
  return {columns_of(a.velocity, b.velocity, c.velocity, d.velocity),
          columns_of(a.angular, b.angular, c.angular, d.angular)};
}
LODESTONE_INLINE Motions<F8> gather(const Motion<F8>* motions, const std::int32_t (&of)[kLanes<F8>]) {
  const F8 rows[8] = {motions[of[0]].both, motions[of[1]].both, motions[of[2]].both, motions[of[3]].both,
                      motions[of[4]].both, motions[of[5]].both, motions[of[6]].both, motions[of[7]].both};
  Motions<F8> gathered;
  columns_of(rows, gathered.velocity, gathered.angular);
  return gathered;
}

// What does not move may be in another batch, too: it is not written.
LODESTONE_INLINE void scatter(const Motions<D4>& of, const D4& inverse_mass, const std::int32_t (&to)[4],
                              Motion<D4>* motions) {
  D4 v[4], w[4];
  rows_of(of.velocity, v), rows_of(of.angular, w);
  for (int i = 0; i < 4; ++i)
    if (inverse_mass[i] > 0.0) motions[to[i]] = {v[i], w[i]};
}
LODESTONE_INLINE void scatter(const Motions<F8>& of, const F8& inverse_mass, const std::int32_t (&to)[8],
                              Motion<F8>* motions) {
  F8 rows[8];
  rows_of(of.velocity, of.angular, rows);
  for (int i = 0; i < 8; ++i)
    if (inverse_mass[i] > 0.0F) motions[to[i]].both = rows[i];
}

template <Lanes L>
void set_lane(TensorLanes<L>& tensor, int lane, const Mat3& m, double scale) {
  const auto set = [&](L& to, int row, int column) { to[lane] = Real<L>(scale * m(row, column)); };
  set(tensor.xx, 0, 0), set(tensor.yy, 1, 1), set(tensor.zz, 2, 2);
  set(tensor.xy, 0, 1), set(tensor.xz, 0, 2), set(tensor.yz, 1, 2);
}
template <Lanes L>
void set_lane(Vec3Lanes<L>& vector, int lane, const Vec3& v) {
  vector.x[lane] = Real<L>(v.x()), vector.y[lane] = Real<L>(v.y()), vector.z[lane] = Real<L>(v.z());
}
template <Lanes L>
Vec3 lane_of(const Vec3Lanes<L>& v, int lane) {
  return {double(v.x[lane]), double(v.y[lane]), double(v.z[lane])};
}

template <Lanes L>
LODESTONE_INLINE L inverse_mass_along(const L& inverse_mass, const TensorLanes<L>& inverse_inertia,
                                      const Vec3Lanes<L>& arm, const Vec3Lanes<L>& axis) {
  const Vec3Lanes<L> turning = cross(arm, axis);
  return inverse_mass + dot(turning, inverse_inertia * turning);
}

// Along the slip, or where there is none across the normal anyhow.
template <Lanes L>
LODESTONE_INLINE Vec3Lanes<L> find_tangent(const Vec3Lanes<L>& normal, const Vec3Lanes<L>& velocity) {
  using R = Real<L>;
  constexpr R kLeast = std::same_as<L, D4> ? R(1e-300) : R(1e-30);  // divides by no zero
  constexpr R kSlip = std::same_as<L, D4> ? R(1e-9) : R(1e-5);      // of the velocity; less is rounding
  const Vec3Lanes<L> slip = velocity - dot(velocity, normal) * normal;
  const L speed = square_root(dot(slip, slip));
  const Mask<L> slides = speed > kSlip * square_root(dot(velocity, velocity));
  const Vec3Lanes<L> along = R(1) / most(speed, all<L>(kLeast)) * slip,
                     cleaned =
                         along - dot(along, normal) * normal;  // little is left of a nearly head-on velocity
  const L none = {};
  const Vec3Lanes<L> from_z = {-normal.y, normal.x, none}, from_x = {none, -normal.z, normal.y};
  const Vec3Lanes<L> tangent =
      choose<L>(slides, cleaned, choose<L>(absolute(normal.z) < R(0.7), from_z, from_x));
  return R(1) / most(square_root(dot(tangent, tangent)), all<L>(kLeast)) * tangent;
}

/// A point of each lane's manifold. Masses and impulses are over its batch's units of mass.
template <Lanes L>
struct alignas(64) PointLanes {
  Vec3Lanes<L> arm_first, arm_second, tangent;
  // Along normal, tangent and across: 0 in lanes without a point; m/s along the normal that are asked for;
  // impulses so far, at first the guess (what the last step had) within its bounds.
  L effective_mass[3], target, impulse[3];
};

/// Of more friction nothing slides the less, and floats have room for its bounds.
inline constexpr double kMostFriction = 1e12;

/// As many manifolds as there are lanes, or fewer, with their bodies' masses beside them, since a sweep reads
/// these in one go.
template <Lanes L>
struct alignas(64) BatchLanes {
  std::int32_t first[kLanes<L>], second[kLanes<L>];
  std::uint32_t manifold[kLanes<L>];
  std::int32_t lanes = 0, count = 0;  // manifolds; points of the longest
  std::uint32_t begin = 0;            // its points
  double unit_mass[kLanes<L>];        // kg, of each lane: keeps floats in the midst of their range
  Vec3Lanes<L> normal;
  L friction, most_impulse, inverse_mass_first, inverse_mass_second;
  TensorLanes<L> inertia_first, inertia_second;  // inverse
};

/// A batch as a round of sweeps has it at hand.
template <Lanes L>
struct PointAtHand {
  const BatchLanes<L>& batch;
  PointLanes<L>& point;
  std::uint32_t index;  // of the point
  const Motions<L>&first, &second;
  Vec3Lanes<L> across;  // normal × tangent

  LODESTONE_INLINE Vec3Lanes<L> velocity() const {
    return first.velocity - second.velocity + cross(first.angular, point.arm_first) -
           cross(second.angular, point.arm_second);
  }
  LODESTONE_INLINE Vec3Lanes<L> along_axes(const L (&size)[3]) const {
    return size[0] * batch.normal + size[1] * point.tangent + size[2] * across;
  }
};

/// What a round of sweeps changed in each lane: velocities, m/s, and impulses over the lane's units of mass,
/// N s; and the greatest impulse along a normal that there is.
template <Lanes L>
struct LaneChange {
  L of_velocity{}, of_impulse{}, greatest_impulse{};
};

/// Batches of contacts, each known by its place in batches().
template <Lanes L>
class ContactLanes {
 public:
  static constexpr int kWidth = kLanes<L>;

  explicit ContactLanes(Simd simd) : simd_(simd) {}

  /// The velocities of all bodies.
  void take_motions(std::span<const SolverBody> bodies);
  void clear() { batches_.clear(), point_count_ = 0; }
  /// A batch of manifolds of which any two share no body that moves, with the unit of mass of each, kg. The
  /// points of all are made by end().
  void add_batch(const CrowdContacts& contacts, std::span<const std::uint32_t> which,
                 std::span<const double> unit_mass);
  void end() { resize_in_room(points_, point_count_); }
  bool empty() const { return batches_.empty(); }

  /// Frames, effective masses, the velocities to reach and guesses of the batches [begin, end); the contacts'
  /// points say then what bounces.
  void prepare(const CrowdContacts& contacts, std::int64_t begin, std::int64_t end);
  /// One round over the batches [begin, end). `answer(at, impulse)` changes the impulse of a point and says
  /// by how much, or returns false where there is none.
  template <class Answer>
  LaneChange<L> sweep(const Answer& answer, std::int64_t begin, std::int64_t end) {
    LaneChange<L> change;
    run_wide(simd_, SweepLoop<Answer>{*this, answer, change}, begin, end);
    return change;
  }
  /// The impulses, and the velocities that these give the bodies: summed up in doubles, so that momentum is
  /// exact to rounding of these.
  void hand_out(const CrowdContacts& contacts, std::int64_t begin, std::int64_t end) const {
    for (std::int64_t i = begin; i < end; ++i) hand_out(batches_[std::size_t(i)], contacts);
  }

  std::span<const BatchLanes<L>> batches() const { return batches_; }
  std::span<PointLanes<L>> points() { return points_; }
  /// One more than bodies: the ground.
  std::vector<Motion<L>>& motions() { return motions_; }

 private:
  struct PrepareLoop;
  template <class Answer>
  struct SweepLoop;

  void fill(BatchLanes<L>& batch, const CrowdContacts& contacts);
  void hand_out(const BatchLanes<L>& batch, const CrowdContacts& contacts) const;

  Simd simd_;
  std::vector<BatchLanes<L>> batches_;
  std::vector<PointLanes<L>> points_;
  std::uint32_t point_count_ = 0;
  std::vector<Motion<L>> motions_;
};

/// A bound of friction: times the normal impulse, or as it is.
template <Lanes L>
struct FrictionTimes {
  const L& friction;
  LODESTONE_INLINE L operator()(const L& normal) const { return friction * normal; }
};
template <Lanes L>
struct FrictionWithin {
  const L& bound;
  LODESTONE_INLINE L operator()(const L&) const { return bound; }
};

/// Adds what is `asked` along the normal, and as much along the tangents as stops the slip of `velocity`
/// within `bound_of` the normal impulse, by the effective masses times `live`. Returns by how much that
/// changes the impulse.
template <Lanes L, class BoundOf>
LODESTONE_INLINE Vec3Lanes<L> relax(const PointAtHand<L>& at, const Vec3Lanes<L>& velocity, const L& asked,
                                    const L& live, const BoundOf& bound_of) {
  PointLanes<L>& p = at.point;
  const L held[3] = {p.impulse[0], p.impulse[1], p.impulse[2]},
          slip[2] = {dot(velocity, p.tangent), dot(velocity, at.across)};
  p.impulse[0] = least(at.batch.most_impulse, most(L{}, held[0] + asked));
  const L bound = bound_of(p.impulse[0]);
  for (int t = 1; t < 3; ++t)
    p.impulse[t] = most(-bound, least(held[t] - live * p.effective_mass[t] * slip[t - 1], bound));
  const L change[3] = {p.impulse[0] - held[0], p.impulse[1] - held[1], p.impulse[2] - held[2]};
  return at.along_axes(change);
}

/// Relaxes a point, its friction bounded by its normal impulse as it is.
template <Lanes L>
struct Relaxation {
  LODESTONE_INLINE bool operator()(const PointAtHand<L>& at, Vec3Lanes<L>& impulse) const {
    const PointLanes<L>& p = at.point;
    const L none = {};
    const Vec3Lanes<L> velocity = at.velocity();
    const L asked = p.effective_mass[0] * (p.target - dot(velocity, at.batch.normal));
    if (!any((p.impulse[0] > none) | (asked > none))) return false;  // no point carries anything
    impulse = relax(at, velocity, asked, all<L>(1), FrictionTimes<L>{at.batch.friction});
    return true;
  }
};

/// Gives what the impulses are.
template <Lanes L>
struct GuessesGiven {
  LODESTONE_INLINE bool operator()(const PointAtHand<L>& at, Vec3Lanes<L>& impulse) const {
    impulse = at.along_axes(at.point.impulse);
    return true;
  }
};

template <Lanes L>
template <class Answer>
struct ContactLanes<L>::SweepLoop {
  ContactLanes& lanes;
  const Answer& answer;
  LaneChange<L>& change;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    LaneChange<L> greatest;
    Motion<L>* motions = lanes.motions_.data();
    for (std::int64_t at = begin; at < end; ++at) {
      const BatchLanes<L>& batch = lanes.batches_[std::size_t(at)];
      Motions<L> first = gather(motions, batch.first), second = gather(motions, batch.second);
      const L inverse_mass = batch.inverse_mass_first + batch.inverse_mass_second;
      for (std::int32_t k = 0; k < batch.count; ++k) {
        const std::uint32_t index = batch.begin + std::uint32_t(k);
        PointLanes<L>& p = lanes.points_[index];
        Vec3Lanes<L> impulse;
        if (!answer({batch, p, index, first, second, cross(batch.normal, p.tangent)}, impulse)) continue;
        const L size = absolute(impulse.x) + absolute(impulse.y) + absolute(impulse.z);
        greatest.of_velocity = most(greatest.of_velocity, size * inverse_mass);
        greatest.of_impulse = most(greatest.of_impulse, size);
        greatest.greatest_impulse = most(greatest.greatest_impulse, p.impulse[0]);
        first.velocity = first.velocity + batch.inverse_mass_first * impulse;
        first.angular = first.angular + batch.inertia_first * cross(p.arm_first, impulse);
        second.velocity = second.velocity - batch.inverse_mass_second * impulse;
        second.angular = second.angular - batch.inertia_second * cross(p.arm_second, impulse);
      }
      scatter(first, batch.inverse_mass_first, batch.first, motions);
      scatter(second, batch.inverse_mass_second, batch.second, motions);
    }
    change = greatest;
  }
};

// Frames, effective masses, and the velocities to reach.
template <Lanes L>
struct ContactLanes<L>::PrepareLoop {
  ContactLanes& lanes;
  const CrowdContacts& contacts;

  // m/s along an axis of an impulse of 1 along another, across the first: by how the bodies turn.
  LODESTONE_INLINE static L turned_along(const BatchLanes<L>& batch, const PointLanes<L>& p,
                                         const Vec3Lanes<L>& axis, const Vec3Lanes<L>& other) {
    return dot(cross(p.arm_first, axis), batch.inertia_first * cross(p.arm_first, other)) +
           dot(cross(p.arm_second, axis), batch.inertia_second * cross(p.arm_second, other));
  }
  LODESTONE_INLINE static void soften(const BatchLanes<L>& batch, PointLanes<L>& p,
                                      const Vec3Lanes<L> (&axes)[3]) {
    const L coupled[3] = {turned_along(batch, p, axes[0], axes[1]), turned_along(batch, p, axes[1], axes[2]),
                          turned_along(batch, p, axes[2], axes[0])};
    L swing;
    find_swing(p.effective_mass, coupled, swing);
    const L part = swing < all<L>(1) ? all<L>(1) : all<L>(0.5);
    for (L& mass : p.effective_mass) mass = mass * part;
  }

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    using R = Real<L>;
    using V = Vec3Lanes<L>;
    constexpr R kLeast = std::numeric_limits<R>::min();  // divides by no zero
    const L none = {};
    const ContactSolverSettings& settings = contacts.settings;
    const R step = R(contacts.step), bounce_velocity = R(settings.bounce_velocity);
    for (std::int64_t b = begin; b < end; ++b) {
      const BatchLanes<L>& batch = lanes.batches_[std::size_t(b)];
      const Motions<L> first = gather(lanes.motions_.data(), batch.first),
                       second = gather(lanes.motions_.data(), batch.second);
      const V n = batch.normal;
      for (std::int32_t k = 0; k < batch.count; ++k) {
        PointLanes<L>& p = lanes.points_[batch.begin + std::uint32_t(k)];
        const V guess = p.tangent;
        const V velocity = first.velocity - second.velocity + cross(first.angular, p.arm_first) -
                           cross(second.angular, p.arm_second);
        p.tangent = find_tangent(n, velocity);
        const V axes[3] = {n, p.tangent, cross(n, p.tangent)};
        const Mask<L> used = p.effective_mass[0] > none;
        for (int i = 0; i < 3; ++i) {
          const L inverse =
              inverse_mass_along(batch.inverse_mass_first, batch.inertia_first, p.arm_first, axes[i]) +
              inverse_mass_along(batch.inverse_mass_second, batch.inertia_second, p.arm_second, axes[i]);
          p.effective_mass[i] = (used & (inverse > none)) ? R(1) / most(inverse, all<L>(kLeast)) : none;
        }
        soften(batch, p, axes);
        const Mask<L> drives = batch.most_impulse < std::numeric_limits<R>::max();
        const L gap = p.target, approach = dot(velocity, n), asked = -gap / step,
                closing = drives ? asked : least(none, asked);
        Mask<L> bounces = used & ~drives & (approach < -bounce_velocity) & (gap + approach * step < none);
        if (any(bounces)) {
          for (int lane = 0; lane < batch.lanes; ++lane)
            if (approach[lane] >= -bounce_velocity - R(contacts.manifolds[batch.manifold[lane]].pressed))
              bounces[lane] = 0;
        }
        p.target = closing;
        p.impulse[0] = bounces ? none : least(batch.most_impulse, most(none, dot(guess, n)));
        const L bound = batch.friction * p.impulse[0];
        for (int i = 1; i < 3; ++i) p.impulse[i] = most(-bound, least(dot(guess, axes[i]), bound));
        if (!any(bounces)) continue;
        for (int lane = 0; lane < batch.lanes; ++lane) {
          if (!bounces[lane]) continue;
          const CrowdManifold& m = contacts.manifolds[batch.manifold[lane]];
          CrowdPoint& point = contacts.points[m.begin + std::uint32_t(k)];
          point.bounces = true;
          point.blow = -float(approach[lane]);
          point.impact_time = float(std::max(0.0, point.gap) / -double(approach[lane]));
          const bool on_still = batch.inverse_mass_second[lane] == R(0);
          const double fall = on_still ? std::min(0.0, settings.fall.dot(m.normal) + double(m.spared)) : 0.0;
          const double bounced =
              bounce_in_fall(m.law.restitution, point.gap, double(approach[lane]), fall, contacts.step);
          p.target[lane] = std::max(R(bounced), closing[lane]);
        }
      }
    }
  }
};

template <Lanes L>
void ContactLanes<L>::take_motions(std::span<const SolverBody> bodies) {
  motions_.resize(bodies.size() + 1);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    motions_[i].set(bodies[i].velocity, bodies[i].angular_velocity);
  motions_.back() = {};
}

template <Lanes L>
void ContactLanes<L>::add_batch(const CrowdContacts& contacts, std::span<const std::uint32_t> which,
                                std::span<const double> unit_mass) {
  BatchLanes<L>& batch = append_in_room(batches_);
  batch.lanes = std::int32_t(which.size());
  batch.begin = point_count_;
  for (std::size_t lane = 0; lane < which.size(); ++lane) {
    batch.manifold[lane] = which[lane];
    batch.unit_mass[lane] = unit_mass[lane];
    batch.count = std::max(batch.count, std::int32_t(contacts.manifolds[which[lane]].count));
  }
  point_count_ += std::uint32_t(batch.count);
}

// What PrepareLoop needs of a point lies meanwhile where its own results will: the guess in `tangent`, the
// gap in `target`, and a 1 in the first `effective_mass` of each lane that has one.
template <Lanes L>
void ContactLanes<L>::fill(BatchLanes<L>& batch, const CrowdContacts& contacts) {
  using R = Real<L>;
  const auto ground = std::int32_t(contacts.bodies.size());
  for (int lane = 0; lane < kWidth; ++lane) batch.first[lane] = batch.second[lane] = ground;
  std::fill_n(points_.begin() + batch.begin, batch.count, PointLanes<L>{});
  for (int lane = 0; lane < batch.lanes; ++lane) {
    const CrowdManifold& m = contacts.manifolds[batch.manifold[lane]];
    const SolverBody& first = contacts.bodies[std::size_t(m.first)];
    const double unit = batch.unit_mass[lane], inverse_unit = 1.0 / unit;
    batch.first[lane] = m.first;
    set_lane(batch.normal, lane, m.normal);
    batch.friction[lane] = R(std::min(m.law.friction, kMostFriction));
    constexpr auto greatest = double(std::numeric_limits<R>::max());
    batch.most_impulse[lane] =
        R(m.most_impulse < kUnbounded ? std::min(m.most_impulse * inverse_unit, greatest) : greatest);
    batch.inverse_mass_first[lane] = R(unit * first.inverse_mass);
    set_lane(batch.inertia_first, lane, first.inverse_inertia, unit);
    if (m.second >= 0) {
      const SolverBody& second = contacts.bodies[std::size_t(m.second)];
      batch.second[lane] = m.second;
      batch.inverse_mass_second[lane] = R(unit * second.inverse_mass);
      set_lane(batch.inertia_second, lane, second.inverse_inertia, unit);
    }
    for (std::uint32_t k = 0; k < m.count; ++k) {
      const CrowdPoint& point = contacts.points[m.begin + k];
      PointLanes<L>& to = points_[batch.begin + k];
      set_lane(to.arm_first, lane, point.arm_first);
      set_lane(to.arm_second, lane, point.arm_second);
      set_lane(to.tangent, lane, inverse_unit * point.guess);  // until prepared
      to.target[lane] = R(point.gap);
      to.effective_mass[0][lane] = R(1);  // in use
    }
  }
}

template <Lanes L>
void ContactLanes<L>::prepare(const CrowdContacts& contacts, std::int64_t begin, std::int64_t end) {
  for (std::int64_t i = begin; i < end; ++i) fill(batches_[std::size_t(i)], contacts);
  run_wide(simd_, PrepareLoop{*this, contacts}, begin, end);
}

template <Lanes L>
void ContactLanes<L>::hand_out(const BatchLanes<L>& batch, const CrowdContacts& contacts) const {
  for (int lane = 0; lane < batch.lanes; ++lane) {
    const CrowdManifold& m = contacts.manifolds[batch.manifold[lane]];
    Vec3 sum = Vec3::Zero(), turn_first = Vec3::Zero(), turn_second = Vec3::Zero();
    bool carries = false;  // most contacts of a heap do not: they touch no body
    for (std::uint32_t k = 0; k < m.count; ++k) {
      const PointLanes<L>& p = points_[batch.begin + k];
      CrowdPoint& point = contacts.points[m.begin + k];
      if (std::ranges::all_of(p.impulse, [&](const L& part) { return part[lane] == Real<L>(0); })) {
        point.impulse = Vec3::Zero();
        continue;
      }
      carries = true;
      const Vec3 along = lane_of(p.tangent, lane);
      point.impulse = batch.unit_mass[lane] *
                      (double(p.impulse[0][lane]) * m.normal + double(p.impulse[1][lane]) * along +
                       double(p.impulse[2][lane]) * m.normal.cross(along));
      sum += point.impulse;
      turn_first += point.arm_first.cross(point.impulse),
          turn_second += point.arm_second.cross(point.impulse);
    }
    if (!carries) continue;
    const auto give = [](SolverBody& body, const Vec3& impulse, const Vec3& turn) {
      if (body.inverse_mass == 0.0) return;
      body.velocity += body.inverse_mass * impulse;
      body.angular_velocity += body.inverse_inertia * turn;
    };
    give(contacts.bodies[std::size_t(m.first)], sum, turn_first);
    if (m.second >= 0) give(contacts.bodies[std::size_t(m.second)], -sum, -turn_second);
  }
}

}  // namespace lane
}  // namespace lodestone
