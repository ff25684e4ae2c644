#include "lod/contact/impact_waves.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lod/room.h"

namespace lodestone {
namespace {

constexpr std::size_t kMostAnswers = 32;  // of each contact, on average: a row's blow takes one
constexpr int kMostRoundSweeps = 10;      // over the contacts of a round
constexpr double kAnswered = 1e-3;        // of the greatest impulse: a smaller change is none
constexpr double kAsFast = 0.99;          // of the fastest on its bodies: is answered with it
constexpr double kAtOnce = 0.01;          // of the step: blows as close in time are ordered by their speed
constexpr std::uint8_t kOpen = 1, kBlow = 2, kStruck = 4;  // of a manifold

}  // namespace

struct ImpactWaves::Scene {
  std::span<SolverBody> bodies;
  std::span<const CrowdManifold> manifolds;
  std::span<CrowdPoint> points;
  double step;
  double bounce_velocity;

  bool moves(std::int32_t body) const { return body >= 0 && bodies[std::size_t(body)].inverse_mass > 0.0; }
  Vec3 velocity(const CrowdManifold& m, const CrowdPoint& point) const {
    const SolverBody& first = bodies[std::size_t(m.first)];
    Vec3 v = first.velocity + first.angular_velocity.cross(point.arm_first);
    if (m.second < 0) return v;
    const SolverBody& second = bodies[std::size_t(m.second)];
    return v - second.velocity - second.angular_velocity.cross(point.arm_second);
  }
  // m/s along the normal, negative where they close in.
  bool strikes(const CrowdManifold& m, const CrowdPoint& point, double approach) const {
    return approach < -bounce_velocity - double(m.pressed) && point.gap + approach * step < 0.0;
  }
  Blow blow_of(const CrowdManifold& m) const {
    Blow blow;
    for (const CrowdPoint& point : points.subspan(m.begin, m.count)) {
      const double approach = velocity(m, point).dot(m.normal);
      if (!strikes(m, point, approach)) continue;
      blow.speed = std::max(blow.speed, -approach);
      blow.time = std::min(blow.time, std::max(0.0, point.gap) / -approach);
    }
    return blow;
  }
  bool strikes(const CrowdManifold& m) const { return blow_of(m).speed > 0.0; }
  double inverse_mass_along(const CrowdManifold& m, const CrowdPoint& point, const Vec3& axis) const {
    const auto of = [&](std::int32_t body, const Vec3& arm) {
      if (!moves(body)) return 0.0;
      const SolverBody& b = bodies[std::size_t(body)];
      const Vec3 lever = arm.cross(axis);
      return b.inverse_mass + lever.dot(b.inverse_inertia * lever);
    };
    return of(m.first, point.arm_first) + of(m.second, point.arm_second);
  }
  void give(const CrowdManifold& m, const CrowdPoint& point, const Vec3& impulse) const {
    const auto to = [&](std::int32_t body, const Vec3& arm, const Vec3& by) {
      if (!moves(body)) return;
      SolverBody& b = bodies[std::size_t(body)];
      b.velocity += b.inverse_mass * by;
      b.angular_velocity += b.inverse_inertia * arm.cross(by);
    };
    to(m.first, point.arm_first, impulse), to(m.second, point.arm_second, -impulse);
  }
};

// Manifolds that bounce if anything, whether they are open to pass something on, and who bears or lies on
// another body: heaps take blows as a whole.
void ImpactWaves::find_blows(const Scene& scene) {
  blows_.clear();
  make_room(state_, scene.manifolds.size()), make_room(in_heap_, scene.bodies.size());
  state_.assign(scene.manifolds.size(), 0);
  in_heap_.assign(scene.bodies.size(), 0);
  for (std::uint32_t i = 0; i < scene.manifolds.size(); ++i) {
    const CrowdManifold& m = scene.manifolds[i];
    if (!scene.moves(m.first) && !scene.moves(m.second)) continue;
    double carried = 0.0;  // N s
    for (const CrowdPoint& point : scene.points.subspan(m.begin, m.count))
      carried += std::abs(point.guess.dot(m.normal));
    const double inverse_mass = scene.bodies[std::size_t(m.first)].inverse_mass +
                                (m.second < 0 ? 0.0 : scene.bodies[std::size_t(m.second)].inverse_mass);
    if (carried * inverse_mass > kUnloaded * scene.bounce_velocity) {
      if (m.second >= 0) in_heap_[std::size_t(m.first)] = in_heap_[std::size_t(m.second)] = 1;
      continue;
    }
    if (m.law.restitution <= 0.0 || m.most_impulse < kUnbounded) continue;
    state_[i] = kOpen;
    if (!scene.strikes(m)) continue;
    state_[i] |= kBlow;
    blows_.push_back(i);
  }
  const auto is_in_heap = [&](std::int32_t body) { return body >= 0 && in_heap_[std::size_t(body)] != 0; };
  const auto is_of_heap = [&](std::uint32_t i) {
    return is_in_heap(scene.manifolds[i].first) || is_in_heap(scene.manifolds[i].second);
  };
  std::erase_if(blows_, is_of_heap);
  if (blows_.empty()) return;
  for (std::uint32_t i = 0; i < scene.manifolds.size(); ++i)
    if (is_of_heap(i)) state_[i] = 0;
}

void ImpactWaves::link(const Scene& scene) {
  make_room(first_of_, scene.bodies.size());
  first_of_.assign(scene.bodies.size(), -1);
  resize_in_room(next_, 2 * scene.manifolds.size());
  const auto add = [&](std::int32_t body, std::uint32_t at) {
    if (!scene.moves(body)) return;
    next_[at] = std::exchange(first_of_[std::size_t(body)], std::int32_t(at));
  };
  for (auto i = std::uint32_t(scene.manifolds.size()); i-- > 0;)
    if (state_[i] & kOpen) add(scene.manifolds[i].first, 2 * i), add(scene.manifolds[i].second, 2 * i + 1);
}

// Whether another contact would close in, of one of the two, that did not before. Leaves the bodies as they
// were.
bool ImpactWaves::is_passed_on(const Scene& scene, std::uint32_t manifold) {
  const CrowdManifold& m = scene.manifolds[manifold];
  const auto reaches_further = [&](std::int32_t body) {
    if (!scene.moves(body)) return false;
    for (std::int32_t at = first_of_[std::size_t(body)]; at >= 0; at = next_[std::size_t(at)])
      if (const auto other = std::uint32_t(at) / 2;
          !(state_[other] & kBlow) && scene.strikes(scene.manifolds[other]))
        return true;
    return false;
  };
  const auto any_other = [&](std::int32_t body) {
    if (!scene.moves(body)) return false;
    for (std::int32_t at = first_of_[std::size_t(body)]; at >= 0; at = next_[std::size_t(at)])
      if (!(state_[std::size_t(at) / 2] & kBlow)) return true;
    return false;
  };
  if (!any_other(m.first) && !any_other(m.second)) return false;
  SolverBody none;
  SolverBody &first = scene.bodies[std::size_t(m.first)],
             &second = m.second < 0 ? none : scene.bodies[std::size_t(m.second)];
  const SolverBody before[2] = {first, second};
  answer(scene, {&manifold, 1});
  const bool passed = reaches_further(m.first) || reaches_further(m.second);
  first = before[0], second = before[1];
  return passed;
}

// Newton's law for all of these at once, each against the approach that it has now.
void ImpactWaves::answer(const Scene& scene, std::span<const std::uint32_t> manifolds) {
  answers_.clear();
  for (const std::uint32_t i : manifolds) {
    const CrowdManifold& m = scene.manifolds[i];
    for (std::uint32_t k = m.begin; k < m.begin + m.count; ++k) {
      const CrowdPoint& point = scene.points[k];
      const double approach = scene.velocity(m, point).dot(m.normal),
                   closing = std::min(0.0, -point.gap / scene.step);
      const double target =
          scene.strikes(m, point, approach) ? std::max(-m.law.restitution * approach, closing) : closing;
      answers_.push_back(
          {i, k, target, 1.0 / scene.inverse_mass_along(m, point, m.normal), 0.0, Vec3::Zero()});
    }
  }
  for (int sweep = 0; sweep < kMostRoundSweeps; ++sweep) {
    double greatest = 0.0, changed = 0.0;
    for (Answer& a : answers_) {
      const CrowdManifold& m = scene.manifolds[a.manifold];
      const CrowdPoint& point = scene.points[a.point];
      const Vec3 v = scene.velocity(m, point);
      const double along = v.dot(m.normal);
      const double before =
          std::exchange(a.impulse, std::max(0.0, a.impulse + a.effective_mass * (a.target - along)));
      Vec3 change = (a.impulse - before) * m.normal;
      const Vec3 slip = v - along * m.normal, held = a.friction;
      if (const double speed = slip.norm(); speed > 1e-12) {
        const Vec3 way = slip / speed;
        a.friction -= speed / scene.inverse_mass_along(m, point, way) * way;
      }
      const double bound = m.law.friction * a.impulse, size = a.friction.norm();
      if (size > bound) a.friction *= bound / size;
      change += a.friction - held;
      scene.give(m, point, change);
      changed = std::max(changed, change.lpNorm<1>()), greatest = std::max(greatest, a.impulse);
    }
    if (changed <= kAnswered * greatest) return;
  }
}

// Adds to `active_` the open contacts of the bodies that have just been answered, and keeps those that
// strike.
void ImpactWaves::find_next(const Scene& scene) {
  for (const Answer& a : answers_)
    for (const std::int32_t body : {scene.manifolds[a.manifold].first, scene.manifolds[a.manifold].second}) {
      if (!scene.moves(body)) continue;
      for (std::int32_t at = first_of_[std::size_t(body)]; at >= 0; at = next_[std::size_t(at)])
        active_.push_back(std::uint32_t(at) / 2);
    }
  std::ranges::sort(active_);
  active_.erase(std::unique(active_.begin(), active_.end()), active_.end());
  std::erase_if(active_, [&](std::uint32_t i) { return !scene.strikes(scene.manifolds[i]); });
}

// Of a body's contacts that strike the first come first, and of those the fastest, as of bodies a hair apart,
// with those that are as fast.
void ImpactWaves::find_foremost(const Scene& scene) {
  resize_in_room(blow_on_, scene.bodies.size());
  const auto each_body = [&](std::uint32_t i, const auto& visit) {
    for (const std::int32_t body : {scene.manifolds[i].first, scene.manifolds[i].second})
      if (scene.moves(body)) visit(blow_on_[std::size_t(body)]);
  };
  blow_sizes_.clear();
  for (const std::uint32_t i : active_) {
    each_body(i, [](Blow& on) { on = {}; });
    blow_sizes_.push_back(scene.blow_of(scene.manifolds[i]));
  }
  for (std::size_t k = 0; k < active_.size(); ++k)
    each_body(active_[k], [&](Blow& on) { on.time = std::min(on.time, blow_sizes_[k].time); });
  for (std::size_t k = 0; k < active_.size(); ++k) {
    Blow& own = blow_sizes_[k];
    each_body(active_[k], [&](const Blow& on) {
      if (own.time > on.time + kAtOnce * scene.step) own.speed = 0.0;
    });
  }
  for (std::size_t k = 0; k < active_.size(); ++k)
    each_body(active_[k], [&](Blow& on) { on.speed = std::max(on.speed, blow_sizes_[k].speed); });
  foremost_.clear();
  for (std::size_t k = 0; k < active_.size(); ++k) {
    bool is_foremost = blow_sizes_[k].speed > 0.0;
    each_body(active_[k], [&](const Blow& on) { is_foremost &= blow_sizes_[k].speed >= kAsFast * on.speed; });
    if (is_foremost) foremost_.push_back(active_[k]);
  }
}

void ImpactWaves::pass_on(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
                          std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings) {
  const Scene scene{bodies, manifolds, points, step, settings.bounce_velocity};
  struck_.clear(), given_.clear();
  find_blows(scene);
  if (blows_.empty()) return;
  link(scene);
  active_.clear();
  for (const std::uint32_t i : blows_)
    if (is_passed_on(scene, i)) active_.push_back(i);
  for (std::size_t answered = 0; !active_.empty() && answered < kMostAnswers * manifolds.size();
       answered += foremost_.size()) {
    find_foremost(scene);
    if (foremost_.empty()) return;
    for (const std::uint32_t i : foremost_)
      for (CrowdPoint& point : points.subspan(manifolds[i].begin, manifolds[i].count)) {
        const Vec3& n = manifolds[i].normal;
        const double approach = scene.velocity(manifolds[i], point).dot(n);
        if (!scene.strikes(manifolds[i], point, approach) || point.bounces) continue;
        point.bounces = true, point.impact_time = float(std::max(0.0, point.gap) / -approach);
      }
    answer(scene, foremost_);
    for (const Answer& a : answers_) {
      if (!(state_[a.manifold] & kStruck)) state_[a.manifold] |= kStruck, struck_.push_back(a.manifold);
      if (a.impulse > 0.0) given_.push_back({a.point, a.impulse * manifolds[a.manifold].normal + a.friction});
    }
    find_next(scene);
  }
}

void ImpactWaves::add_impulses(std::span<CrowdPoint> points) const {
  for (const auto& [point, impulse] : given_) points[point].impulse += impulse;
}

}  // namespace lodestone
