// Of Crowd: its step. Who takes part is crowd_gather.cpp's, what follows from the impulses crowd_move.cpp's.
#include "lod/contact/crowd.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "reference/rocking.h"

namespace lodestone {

void Crowd::solve(const ContactScene& scene, const CrowdTouch& touch) {
  gather(scene, touch);
  solve_gathered(scene, touch);
  find_pressed(scene, touch.time);
}

void Crowd::drop(const ContactScene& scene) {
  for (const Participant p : participants_)
    if (p.is_statistical()) index_of_body_[p.index()] = -1;
  if (scene.world.log) scene.world.log->records().resize(noted_);
}

// What falls by a step's way or two onto what bears it does not strike it.
void Crowd::note_struck(const ContactScene& scene) {
  constexpr double kBlow = 0.4;  // over √(g R)
  const double strength = scene.world.gravity_strength();
  for (const CrowdManifold& m : manifolds_) {
    double fastest = 0.0;  // m/s
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count))
      if (point.bounces) fastest = std::max(fastest, speed_of_blow(m, point));
    if (fastest == 0.0) continue;
    for (const std::int32_t i : {m.first, m.second}) {
      if (i < 0) continue;
      const Participant p = participants_[std::size_t(i)];
      if (p.is_statistical() && scene.body(p).is_sphere() &&
          fastest > kBlow * std::sqrt(strength * scene.shape(p).radius))
        scene.body(p).struck = true;
    }
  }
}

// m/s. Of one that others passed on only what it gave is known.
double Crowd::speed_of_blow(const CrowdManifold& m, const CrowdPoint& point) const {
  if (point.blow > 0.0f) return double(point.blow);
  const auto inverse_mass = [&](std::int32_t body) {
    return body < 0 ? 0.0 : solver_bodies_[std::size_t(body)].inverse_mass;
  };
  return std::abs(point.impulse.dot(m.normal)) * (inverse_mass(m.first) + inverse_mass(m.second));
}

ContactTally Crowd::move(const ContactScene& scene, const CrowdTouch& touch) {
  memory_.remember(keys_, manifolds_, points_, touch.time);
  note_struck(scene);
  if (scene.world.log) note_impulses(*scene.world.log, noted_);
  find_footing(scene, touch);
  find_impacts();
  move_bodies(scene, touch.time);
  give_to_full(scene, touch);
  move_apart(scene, touch);
  lift_off_ground(scene, touch);
  keep_insiders_awake(scene, touch.time);
  ContactTally tally;
  tally.contacts = std::int64_t(points_.size());
  return tally;
}

// What forces press together does not strike, and what falls by more or less than gravity has it fall, by
// forces or as it has none, bounces off what stands as it came.
void Crowd::note_presses(const ContactScene& scene, double time) {
  for (CrowdManifold& m : manifolds_) {
    const Participant p = participants_[std::size_t(m.first)];
    const bool on_still = m.second < 0 || solver_bodies_[std::size_t(m.second)].inverse_mass == 0.0;
    if (!on_still || !p.is_statistical()) continue;
    m.spared = float((scene.gravity(p) + scene.pushed(p) - scene.world.gravity).dot(m.normal) * time);
  }
  const auto is_pushed = [&](Participant p) { return !p.is_ground() && !scene.pushed(p).isZero(0.0); };
  const bool any = std::ranges::any_of(participants_, is_pushed);
  if (!any) return;
  const auto pushed = [&](std::int32_t index) {
    return index < 0 || solver_bodies_[std::size_t(index)].inverse_mass == 0.0
               ? Vec3(Vec3::Zero())
               : scene.pushed(participants_[std::size_t(index)]);
  };
  for (CrowdManifold& m : manifolds_)
    m.pressed = float(std::max(0.0, (pushed(m.second) - pushed(m.first)).dot(m.normal) * time));
}

void Crowd::solve_gathered(const ContactScene& scene, const CrowdTouch& touch) {
  const double time = touch.time;
  note_presses(scene, time);
  ContactSolverSettings settings{.sweeps = touch.sweeps, .tolerance = settings_.tolerance};
  settings.bounce_velocity =
      scene.world.bounce_velocity +
      scene.world.gravity_strength() * time;  // what gravity adds in a step is no impact
  settings.fall = scene.world.gravity * time;
  memory_.recall(keys_, manifolds_, points_, time, jobs_);
  relieve_opposed();
  borne_weights_.guess(solver_bodies_, manifolds_, points_, settings.fall, time);
  noted_ = scene.world.log ? note_approaches(scene, time) : 0;
  solver_.solve(solver_bodies_, manifolds_, points_, time, settings, jobs_);
  for (const std::uint32_t struck : solver_.struck()) manifolds_[struck].to_forget = true;
}

// By how much both of two that push against each other do: nothing is held by that, and from step to step it
// would grow.
void Crowd::relieve_opposed() {
  for (const std::uint32_t i : opposed_) {
    const CrowdManifold& one_way = manifolds_[i];
    CrowdPoint &one = points_[one_way.begin], &other = points_[manifolds_[i + 1].begin];
    const double both =
        std::max(0.0, std::min(one.guess.dot(one_way.normal), -other.guess.dot(one_way.normal)));
    one.guess -= both * one_way.normal;
    other.guess += both * one_way.normal;
    const float both_without = std::min(one.frictionless, other.frictionless);
    if (both_without > 0.0F) one.frictionless -= both_without, other.frictionless -= both_without;
  }
}

// What touches, but for two full bodies. The impulses follow, in the same order.
std::size_t Crowd::note_approaches(const ContactScene& scene, double time) const {
  std::vector<ContactRecord>& records = scene.world.log->records();
  const std::size_t known = records.size();
  const auto velocity_of = [&](std::int32_t index, const Vec3& arm) {
    if (index < 0) return Vec3(Vec3::Zero());
    const SolverBody& body = solver_bodies_[std::size_t(index)];
    const Vec3 fall = body.inverse_mass > 0.0
                          ? Vec3(scene.acceleration(participants_[std::size_t(index)]) * time)
                          : Vec3(Vec3::Zero());
    return Vec3(body.velocity - fall + body.angular_velocity.cross(arm));
  };
  for (std::size_t i = 0; i < manifolds_.size(); ++i) {
    const CrowdManifold& m = manifolds_[i];
    const Participant first = participants_[std::size_t(m.first)],
                      second = m.second < 0 ? Participant::ground() : participants_[std::size_t(m.second)];
    ContactRecord& record =
        records.emplace_back(ContactRecord{.first = scene.owner(first), .normal = m.normal});
    if (second.is_ground())
      std::tie(record.ground, record.ground_material) = grounds_[i];
    else
      record.second = scene.owner(second);
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      record.approach = std::max(
          record.approach,
          (velocity_of(m.second, point.arm_second) - velocity_of(m.first, point.arm_first)).dot(m.normal));
      record.point += (scene.position(first) + point.arm_first) / double(m.count);
    }
  }
  return known;
}

// Those that gave nothing were no touch. Two full bodies, or one and its ground, are the full level's matter.
void Crowd::note_impulses(ContactLog& log, std::size_t known) const {
  std::vector<ContactRecord>& records = log.records();
  std::size_t kept = known;
  for (std::size_t i = 0; i < manifolds_.size(); ++i) {
    const CrowdManifold& m = manifolds_[i];
    const bool statistical = participants_[std::size_t(m.first)].is_statistical() ||
                             (m.second >= 0 && participants_[std::size_t(m.second)].is_statistical());
    double impulse = 0.0;
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count))
      impulse += point.impulse.dot(m.normal);
    if (!statistical || impulse <= 0.0) continue;
    records[kept] = records[known + i];
    records[kept++].impulse = impulse;
  }
  records.resize(kept);
}

// Through those awake that touch each other.
template <class Sleeps>
void Crowd::pass_forces_on(const ContactScene& scene, const Sleeps& sleeps) {
  const auto manifolds = std::span(manifolds_).first(pair_manifolds_);
  const auto passes = [&](std::int32_t body) {
    return body >= 0 && !sleeps(body) &&
           (pushes_[std::size_t(body)].forced || scene.is_forced(participants_[std::size_t(body)]));
  };
  bool any = true;
  const auto pass_on = [&](const CrowdManifold& m) {
    for (const auto& [from, to] : {std::pair{m.first, m.second}, std::pair{m.second, m.first}})
      if (to >= 0 && !pushes_[std::size_t(to)].forced && passes(from))
        pushes_[std::size_t(to)].forced = any = true;
  };
  while (std::exchange(any, false)) {  // to and fro: rows stand in the manifolds' order, or against it
    std::for_each(manifolds.begin(), manifolds.end(), pass_on);
    std::for_each(manifolds.rbegin(), manifolds.rend(), pass_on);
  }
}

// A sleeper stands like ground, and what is between it and the ground is held as in a vice: by impulses that
// need no weight, and are the next step's guesses. Who is pushed up by more than before and than it weighs,
// or along by more than friction under what is left of its weight holds, is to wake, and of what held it
// nothing is remembered. (What lies on it is not known: by how much it was pushed before was no blow.) One
// that bore more than that took a good part of a blow to those that it lies on. Next to a body that a force
// acts on the first of these hold in each substep, however little of it passes in one.
void Crowd::find_pressed(const ContactScene& scene, double time) {
  constexpr double kStirs = 0.02;   // over √(g R): slower it would hardly move
  constexpr double kForced = 0.05;  // over g: what is forced along by less hardly moves
  pressed_.clear();
  const double strength = scene.world.gravity_strength();
  if (strength == 0.0) return;
  const Vec3 up = -scene.world.gravity / strength;
  const auto sleeps = [&](std::int32_t body) {
    if (body < 0) return false;
    const Participant p = participants_[std::size_t(body)];
    return !p.is_ground() && scene.asleep(p) && !scene.properties(p).kinematic;
  };
  const auto manifolds = std::span(manifolds_).first(pair_manifolds_);
  if (std::ranges::none_of(manifolds,
                           [&](const CrowdManifold& m) { return sleeps(m.first) || sleeps(m.second); }))
    return;
  pushes_.assign(solver_bodies_.size(), {});
  for (const CrowdManifold& m : manifolds)
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      Push &first = pushes_[std::size_t(m.first)], &second = pushes_[std::size_t(m.second)];
      first.now += point.impulse, first.before += point.guess;
      second.now -= point.impulse, second.before -= point.guess;
    }
  pass_forces_on(scene, sleeps);
  const auto friction_under = [&](Participant p) {  // of planes that it may lie on
    double least = kUnbounded;
    if (!p.is_statistical()) return least;
    const BodyKind& kind = scene.kind_of(scene.body(p));
    for (const HalfSpace& plane : scene.world.planes)
      if (plane.normal.dot(up) > 0.0 && plane.height_of(scene.position(p)) < kind.shape->radius)
        least = std::min(least, scene.world.law(kind, plane).friction);
    return least;
  };
  const auto is_pressed = [&](std::int32_t body, double friction) {
    if (!sleeps(body)) return false;
    const Participant p = participants_[std::size_t(body)];
    friction = std::min(friction, friction_under(p));
    const double mass = p.is_statistical() ? scene.body(p).mass : scene.neighbor(p).mass,
                 weight = mass * strength * time,  // N s
        stirs = mass * kStirs * std::sqrt(strength * scene.shape(p).radius);
    const auto [now, before, forced] = pushes_[std::size_t(body)];
    const Vec3 more = now - before;
    const double rise = now.dot(up), along = (now - rise * up).norm(), more_rise = more.dot(up),
                 more_along = (more - more_rise * up).norm();
    const double holds = friction * std::max(0.0, weight - rise);
    if (forced && std::max(rise - weight, along - holds) > kForced * weight) return true;
    return std::min(rise, more_rise) > std::max(weight, stirs) ||
           std::min(along, more_along) > std::max(holds, stirs);
  };
  for (CrowdManifold& m : manifolds)
    for (const std::int32_t body : {m.first, m.second})
      if (is_pressed(body, m.law.friction)) {
        pressed_.push_back(participants_[std::size_t(body)]);
        m.to_forget = true;
      }
}

// Where somebody is about to fall asleep. In great heaps others hold who stands on an edge.
void Crowd::find_footing(const ContactScene& scene, const CrowdTouch& touch) {
  const double strength = scene.world.gravity_strength();
  const auto is_asked = [&](std::size_t i) {
    const Participant p = participants_[i];
    return p.is_statistical() && !scene.asleep(p) && !scene.body(p).is_sphere() &&
           !solver_bodies_[i].in_great_heap;
  };
  bool any = false;
  radii_.assign(participants_.size(), 0.0);
  for (std::size_t i = 0; i < participants_.size(); ++i) {
    if (!is_asked(i)) continue;
    radii_[i] = scene.shape(participants_[i]).radius;
    const float still_time = touch.still_time * float(rocking_slowness(radii_[i], strength));
    any |= scene.body(participants_[i]).quiet_time + float(touch.time) >= still_time;
  }
  if (!any || strength == 0.0) return;
  footing_.find(solver_bodies_, radii_, manifolds_, points_, -scene.world.gravity / strength);
  for (std::size_t i = 0; i < participants_.size(); ++i)
    if (is_asked(i)) scene.body(participants_[i]).on_edge = !footing_.is_firm(i);
}

// What strikes the ground is answered before it has arrived: a body goes on as it came until its first
// impact. Not so one that touches another: shifted against that, they would not keep Σ m x × v, nor their
// gap.
void Crowd::find_impacts() {
  constexpr float kNone = 1e9f;
  impact_time_.assign(solver_bodies_.size(), kNone);
  for (const CrowdManifold& m : std::span(manifolds_).subspan(pair_manifolds_))
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      if (!point.bounces) continue;
      float& first = impact_time_[std::size_t(m.first)];
      first = std::min(first, point.impact_time);
    }
  for (const CrowdManifold& m : std::span(manifolds_).first(pair_manifolds_))
    impact_time_[std::size_t(m.first)] = impact_time_[std::size_t(m.second)] = kNone;
}

}  // namespace lodestone
