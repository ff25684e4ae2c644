// Of Crowd: what follows from the impulses. Bodies move, full ones are given what is theirs, and who overlaps
// is moved apart.
#include <algorithm>

#include "lod/contact/crowd.h"
#include "lod/statistical/flight.h"
#include "lod/statistical/parting.h"

namespace lodestone {
namespace {

constexpr double kFalling = 0.5;  // of what gravity gives a body in a step

void lift_sphere_out(StatisticalBody& body, const HalfSpace& plane) {
  const double gap = plane.height_of(body.position) - body.sphere_radius;
  if (gap >= 0.0) return;
  body.position -= gap * plane.normal;
  body.velocity -= std::min(0.0, body.velocity.dot(plane.normal)) * plane.normal;
}

// m: by which overlaps of two bodies, or of one and the ground, are judged: that of the smaller.
double radius_of_pair(const ContactScene& scene, Participant one, Participant other) {
  const double radius = scene.shape(one).radius;
  return other.is_ground() ? radius : std::min(radius, scene.shape(other).radius);
}

// m: deeper overlaps are a good part of the thinner one's thickness.
double deep_overlap_of(const ContactScene& scene, Participant one, Participant other) {
  constexpr double kDeep = 0.25;  // over its inner radius
  const double inner = scene.shape(one).inner_radius;
  return kDeep * (other.is_ground() ? inner : std::min(inner, scene.shape(other).inner_radius));
}

bool is_eased(const ContactScene& scene, Participant p) {
  return p.is_statistical() && scene.body(p).eased > 0.0f;
}

float placed_time(const ContactScene& scene, Participant p) {
  return p.is_statistical() ? scene.body(p).placed : 0.0f;
}

bool is_sphere(const ContactScene& scene, Participant p) {
  return p.is_statistical() && scene.body(p).is_sphere();
}

}  // namespace

// Full neighbours only get their velocities.
void Crowd::move_bodies(const ContactScene& scene, double time) {
  const auto move_one = [&](std::size_t i) {
    const Participant p = participants_[i];
    const SolverBody& solved = solver_bodies_[i];
    if (p.is_ground()) return;
    if (p.is_full()) {
      RigidState& state = scene.neighbor(p).state;
      state.velocity = solved.velocity;
      state.angular_velocity = solved.angular_velocity;
      return;
    }
    index_of_body_[p.index()] = -1;
    StatisticalBody& body = scene.body(p);
    if (body.motion == Motion::asleep) return;
    const BodyKind& kind = scene.kind_of(body);
    if (scene.properties(p).kinematic) return advance_kinematic(body, kind, time);
    const Vec3 added = spin_of(body.orientation, solved.angular_velocity - angular_before_[i], *kind.shape);
    const double until = double(impact_time_[i]), left = until < time ? time - until : time;
    if (until < time) {
      body.position += (body.velocity + 0.5 * until * scene.acceleration(p)) * until;
      body.orientation = advance_orientation(body.orientation, body.spin, kind, until);
    }
    // What falls with all that it touches is at no rest, however slow. (Spheres that are guests here are
    // carried by others that this solver knows nothing of.)
    const Vec3 falls = scene.acceleration(p);
    if (!body.is_sphere() &&
        (solved.velocity - body.velocity).dot(falls) > kFalling * falls.squaredNorm() * time)
      body.quiet_time = std::max(0.0f, body.quiet_time - 2.0f * float(time));
    body.in_great_heap = solved.in_great_heap;
    body.pinned = false;
    body.velocity = solved.velocity;
    body.spin += added;
    resist_rolling(body, time);
    body.position += body.velocity * left;
    body.orientation = advance_orientation(body.orientation, body.spin, kind, left).normalized();
    ++body.events;
  };
  each_participant(move_one);
}

// Whether something else of ODE's stands behind it: what is struck against that does not start at a speed
// with which ODE would have it bounce there, though all contacts together left it none.
bool Crowd::is_backed(std::size_t neighbor, const Vec3& impulse, const CrowdTouch& touch) const {
  constexpr double kAgainst = 0.5;  // cosine
  const auto runs = std::span(full_order_)
                        .subspan(std::size_t(full_start_[neighbor]),
                                 std::size_t(full_start_[neighbor + 1] - full_start_[neighbor]));
  return std::ranges::any_of(runs, [&](std::int32_t i) {
    const FullContact& contact = touch.full_contacts[std::size_t(i)];
    const double into = contact.normal.dot(impulse) * (contact.first == std::int32_t(neighbor) ? 1.0 : -1.0);
    return into < -kAgainst * impulse.norm();
  });
}

namespace {

// Not so who was only just woken, or jostled.
bool moves_on(const ContactScene& scene, Participant p, double still_speed) {
  if (!p.is_statistical() || scene.asleep(p) || scene.body(p).quiet_time > 0.0f) return false;
  return scene.properties(p).kinematic || scene.body(p).carried || scene.is_forced(p) ||
         scene.velocity(p).norm() > still_speed;
}

}  // namespace

void Crowd::give_to_full(const ContactScene& scene, const CrowdTouch& touch) {
  if (scene.neighbors.empty()) return;
  for (const CrowdManifold& m : std::span(manifolds_).first(pair_manifolds_))
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      const auto give = [&](Participant to, Participant from, const Vec3& impulse, const Vec3& arm) {
        if (!to.is_full() || scene.neighbor(to).asleep || scene.properties(to).kinematic) return;
        const bool hits = point.bounces;
        FullNeighbor& full = scene.neighbor(to);
        Impulse& share = !hits                                   ? full.push
                         : is_backed(to.index(), impulse, touch) ? full.backed_hit
                                                                 : full.hit;
        if (hits) full.fastest_hit = std::max(full.fastest_hit, double(point.blow));
        full.moved |= !impulse.isZero(0.0) && moves_on(scene, from, touch.still_speed);
        share.linear += impulse;
        share.angular += arm.cross(impulse);
      };
      const Participant first = participants_[std::size_t(m.first)],
                        second = participants_[std::size_t(m.second)];
      give(first, second, point.impulse, point.arm_first);
      give(second, first, -point.impulse, point.arm_second);
    }
  for (const CrowdManifold& m : std::span(manifolds_).subspan(pair_manifolds_)) {
    const Participant first = participants_[std::size_t(m.first)];
    if (!first.is_full()) continue;
    const Participant second = m.second < 0 ? Participant::ground() : participants_[std::size_t(m.second)];
    Impulse on_first, on_second;
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      on_first = on_first + Impulse{point.impulse, point.arm_first.cross(point.impulse)};
      on_second = on_second + Impulse{-point.impulse, -point.arm_second.cross(point.impulse)};
    }
    if (second.is_full())
      exchanges_.push_back({std::int32_t(first.index()), std::int32_t(second.index()), on_first, on_second});
    else if (second.is_ground())
      scene.neighbor(first).backing = scene.neighbor(first).backing + on_first;
  }
}

// Overlaps are undone by moving apart, the lighter body farther; those among full bodies are the full level's
// matter.
void Crowd::move_apart(const ContactScene& scene, const CrowdTouch& touch) {
  shifts_.assign(solver_bodies_.size(), Vec3::Zero());
  partings_.clear();
  insiders_.clear();
  parting_of_.assign(solver_bodies_.size(), -1);
  for (const CrowdManifold& m : manifolds_) {
    const Participant one = participants_[std::size_t(m.first)],
                      other = m.second < 0 ? Participant::ground() : participants_[std::size_t(m.second)];
    if (!one.is_statistical() && !other.is_statistical()) continue;
    const double first = solver_bodies_[m.first].inverse_mass,
                 second = m.second < 0 ? 0.0 : solver_bodies_[m.second].inverse_mass;
    if (first + second == 0.0) continue;
    const Overlap overlap{
        .one = one,
        .other = other,
        .radius = radius_of_pair(scene, one, other),
        .deep = deep_overlap_of(scene, one, other),
        // A face of the ground has a contact of each triangle: together they push it out once.
        .by_others = other.is_ground() ? std::max(0.0, shift_of(m.first).dot(m.normal)) : 0.0,
        .eased = is_eased(scene, one) || is_eased(scene, other)};
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      if (push_out_overlap(point.gap, overlap.radius) == 0.0) continue;
      note_overlap(scene, touch, m, point, overlap);
      undo_overlap(scene, touch, m, point, overlap);
    }
  }
  // What the overlaps of a body that came with some ask for together, not each of them, is slow: the greatest
  // prevails over those that others keep up.
  for (const auto& [body, by, farthest] : partings_) {
    const double length = by.norm();
    shift(scene, body, length > farthest ? Vec3(farthest / length * by) : by);
  }
  keep_full_apart(scene);
}

// Who came with it, and who is inside another.
void Crowd::note_overlap(const ContactScene& scene, const CrowdTouch& touch, const CrowdManifold& m,
                         const CrowdPoint& point, const Overlap& overlap) {
  const Participant one = overlap.one, other = overlap.other;
  const float placed = std::max(placed_time(scene, one), placed_time(scene, other));
  const bool inside = point.gap < -(placed > 0.0f ? kBroughtOverlap : kWakingOverlap) * overlap.radius &&
                      !is_sphere(scene, one) && !is_sphere(scene, other);
  for (const std::int32_t index : {m.first, m.second}) {
    const Participant p = index < 0 ? Participant::ground() : participants_[std::size_t(index)];
    if (is_eased(scene, p) && point.gap < -kBroughtOverlap * overlap.radius)
      scene.body(p).eased = kEasedTime;  // for as long as there is some
    if (inside && p.is_statistical())
      insiders_.push_back({index, scene.position(p) - shift_of(index),
                           touch.parting * push_out_overlap(point.gap, overlap.radius), placed});
  }
}

void Crowd::undo_overlap(const ContactScene& scene, const CrowdTouch& touch, const CrowdManifold& m,
                         const CrowdPoint& point, const Overlap& overlap) {
  constexpr double kOfOne = 0.4;  // of the speed at which two come apart
  const auto velocity_of = [&](std::int32_t index, const Vec3& arm) {
    return index < 0
               ? Vec3(Vec3::Zero())
               : Vec3(solver_bodies_[index].velocity + solver_bodies_[index].angular_velocity.cross(arm));
  };
  const double parting =
      (velocity_of(m.first, point.arm_first) - velocity_of(m.second, point.arm_second)).dot(m.normal);
  double left = point.gap + std::max(0.0, parting) * touch.time;  // the rest is undone by the motion itself
  // Up through a column of thin bodies one after the other: all at once, those in its midst, pushed from
  // both sides, would hardly move. Of shallower ones it would raise heaps, by 5 % for plates.
  if (point.gap < -overlap.deep)
    left += (shift_of(m.first) - shift_of(m.second)).dot(m.normal);
  else
    left += overlap.by_others;
  const double first = solver_bodies_[m.first].inverse_mass,
               second = m.second < 0 ? 0.0 : solver_bodies_[m.second].inverse_mass;
  const double distance = touch.parting * push_out_overlap(left, overlap.radius) / double(m.count);
  const Vec3 of_first = distance * first / (first + second) * m.normal,
             of_second = -distance * second / (first + second) * m.normal;
  if (overlap.eased) {
    const double farthest =
        kOfOne * parting_speed(overlap.radius, scene.world.gravity_strength()) * touch.time;
    part_slowly(m.first, of_first, farthest), part_slowly(m.second, of_second, farthest);
  } else {
    shift(scene, m.first, of_first), shift(scene, m.second, of_second);
  }
}

bool Crowd::can_move(std::int32_t index) const {
  return index >= 0 && solver_bodies_[std::size_t(index)].inverse_mass > 0.0;
}

void Crowd::shift(const ContactScene& scene, std::int32_t index, const Vec3& by) {
  if (!can_move(index)) return;
  const Participant p = participants_[std::size_t(index)];
  scene.position(p) += by;
  shifts_[std::size_t(index)] += by;
  if (p.is_full()) scene.neighbor(p).shift += by;
}

void Crowd::part_slowly(std::int32_t index, const Vec3& by, double farthest) {
  if (!can_move(index)) return;
  std::int32_t& place = parting_of_[std::size_t(index)];
  if (place < 0) {
    place = std::int32_t(partings_.size());
    partings_.push_back({index, Vec3::Zero(), farthest});
  }
  Parting& parting = partings_[std::size_t(place)];
  parting.by += by, parting.farthest = std::min(parting.farthest, farthest);
}

// What was moved must not be moved into what holds it up: ODE would throw it back, the faster the shorter its
// substeps are. Another full body gives way, the lighter one farther, and so on; the ground does not.
void Crowd::keep_full_apart(const ContactScene& scene) {
  constexpr int kRounds = 4;
  constexpr double kMost = 0.99;
  if (scene.neighbors.empty()) return;
  const auto move = [&](std::int32_t index, const Vec3& by) {
    if (index < 0 || solver_bodies_[std::size_t(index)].inverse_mass == 0.0) return;
    FullNeighbor& body = scene.neighbor(participants_[std::size_t(index)]);
    body.state.position += by, body.shift += by;
    shifts_[std::size_t(index)] += by;
  };
  const auto is_of_full = [&](const CrowdManifold& m) {
    return participants_[std::size_t(m.first)].is_full() &&
           (m.second < 0 || !participants_[std::size_t(m.second)].is_statistical());
  };
  const auto gives_way = [&](const CrowdManifold& m) {  // a motor that does what it can
    return m.most_impulse < kUnbounded && points_[m.begin].impulse.dot(m.normal) >= kMost * m.most_impulse;
  };
  for (int i = 0; i < kRounds; ++i)
    for (const CrowdManifold& m : std::span(manifolds_).subspan(pair_manifolds_)) {
      if (!is_of_full(m) || gives_way(m)) continue;
      const double nearing = (shift_of(m.second) - shift_of(m.first)).dot(m.normal);
      const double first = solver_bodies_[std::size_t(m.first)].inverse_mass,
                   second = m.second < 0 ? 0.0 : solver_bodies_[std::size_t(m.second)].inverse_mass;
      if (nearing <= 0.0 || first + second == 0.0) continue;
      move(m.first, nearing * first / (first + second) * m.normal);
      move(m.second, -nearing * second / (first + second) * m.normal);
    }
}

// The ground has the last word.
void Crowd::lift_off_ground(const ContactScene& scene, const CrowdTouch& touch) const {
  const auto lift = [&](Participant p, const HalfSpace& plane) {
    StatisticalBody& body = scene.body(p);
    const Shape& shape = *scene.kind_of(body).shape;
    if (body.is_sphere())
      lift_sphere_out(body, plane);
    else
      lift_out(body, shape, plane, scene.gravity(p),
               lift_of(body, shape, scene.world.gravity_strength(), touch.time));
  };
  each_participant([&](std::size_t i) {
    const Participant p = participants_[i];
    if (!p.is_statistical() || scene.asleep(p)) return;
    const BodyProperties& own = scene.properties(p);
    if (own.kinematic) return;
    for (const HalfSpace& plane : scene.world.planes)
      if (meets_ground(own, plane.bits)) lift(p, plane);
    for (const HalfSpace& face : touch.faces.of(std::int32_t(p.index()))) lift(p, face);
  });
}

// Who is being moved out of another is not at rest, though it has no velocity. But a pebble between a boulder
// and the ground is moved back, the boulder by a share of its lightness alone, and a leg in a plate both
// ways: they stay as they are.
void Crowd::keep_insiders_awake(const ContactScene& scene, double time) {
  constexpr double kStuck = 0.05;
  const auto body_of = [&](const Insider& i) -> StatisticalBody& {
    return scene.body(participants_[std::size_t(i.body)]);
  };
  const auto is_moved_out = [&](const Insider& i) {
    return (body_of(i).position - i.from).norm() > kStuck * i.asked;
  };
  each_participant([&](std::size_t i) {
    if (participants_[i].is_statistical()) scene.body(participants_[i]).placed = 0.0f;
  });
  for (const Insider& i : insiders_) {
    StatisticalBody& body = body_of(i);
    body.pinned = true;
    body.placed = std::max(body.placed, i.placed - float(time));
  }
  for (const Insider& i : insiders_)
    if (is_moved_out(i)) body_of(i).pinned = false, body_of(i).quiet_time = 0.0f;
}

}  // namespace lodestone
