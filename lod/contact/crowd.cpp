#include "lod/contact/crowd.h"

#include <algorithm>
#include <tuple>

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

SolverBody solver_body_of(const ContactScene& scene, Participant p, double time) {
  SolverBody solver;
  if (scene.asleep(p)) {
    solver.in_great_heap = p.is_statistical() && scene.body(p).in_great_heap;
    return solver;
  }
  const bool moved = !scene.properties(p).kinematic;  // by what it meets
  const Vec3 acceleration = moved ? scene.acceleration(p) : Vec3(Vec3::Zero());
  if (p.is_statistical()) {
    const StatisticalBody& body = scene.body(p);
    const BodyKind& kind = scene.kind_of(body);
    solver.velocity = body.velocity + acceleration * time;
    solver.angular_velocity = angular_velocity(body.orientation, body.spin, *kind.shape);
    if (!moved) return solver;
    solver.inverse_mass = 1.0 / body.mass;
    solver.inverse_inertia = inverse_inertia_world(body.orientation, *kind.shape) / body.mass;
  } else {
    const FullNeighbor& body = scene.neighbor(p);
    solver.velocity = body.state.velocity;
    solver.angular_velocity = body.state.angular_velocity;
    if (!moved) return solver;
    solver.velocity += acceleration * time;
    solver.inverse_mass = 1.0 / body.mass;
    solver.inverse_inertia = inverse_inertia_world(body.state.orientation, *body.shape) / body.mass;
    solver.angular_velocity += solver.inverse_inertia * (body.torque * time);
  }
  return solver;
}

// Of a body of this level; full ones are turned by ODE.
void turn_by_torque(const ContactScene& scene, Participant p, double time, SolverBody& solver) {
  if (!p.is_statistical() || solver.inverse_mass == 0.0) return;
  const Vec3& turning = scene.world.force_on(std::int32_t(p.index())).turning;
  if (!turning.isZero(0.0))
    solver.angular_velocity += solver.inverse_inertia * (scene.mass(p) * time * turning);
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

bool is_sphere(const ContactScene& scene, Participant p) {
  return p.is_statistical() && scene.body(p).is_sphere();
}

bool is_borne_up(const ContactScene& scene, Participant p) {
  return p.is_statistical() && scene.body(p).borne_up;
}

}  // namespace

int Crowd::solver_index(Participant p) {
  std::int32_t& index = p.is_statistical() ? index_of_body_[p.index()] : index_of_neighbor_[p.index()];
  if (index >= 0) return index;
  index = std::int32_t(participants_.size());
  participants_.push_back(p);
  return index;
}

// Those of the participants from `from` on.
void Crowd::take_bodies(const ContactScene& scene, std::size_t from, double time) {
  solver_bodies_.resize(participants_.size());
  angular_before_.resize(participants_.size());
  run_in_pieces(jobs_, std::int64_t(participants_.size() - from), kBlock,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::size_t i = from + std::size_t(begin); i < from + std::size_t(end); ++i) {
                    if (participants_[i].is_ground()) continue;
                    solver_bodies_[i] = solver_body_of(scene, participants_[i], time);
                    angular_before_[i] = solver_bodies_[i].angular_velocity;
                    turn_by_torque(scene, participants_[i], time, solver_bodies_[i]);
                  }
                });
  for (const auto& [part, index] : moving_parts_) {
    SolverBody& body = solver_bodies_[std::size_t(index)] = {};
    body.velocity = part->pose.velocity;
    body.angular_velocity = part->pose.angular_velocity;
  }
  for (const auto& [velocity, index] : moving_ground_) {
    solver_bodies_[std::size_t(index)] = {};
    solver_bodies_[std::size_t(index)].velocity = velocity;
  }
}

// Ground that moves carries what touches it: a body that nothing stops. −1: it stands still.
std::int32_t Crowd::solver_index(const GroundPart& part) {
  if (!part.moves()) return -1;
  const auto known =
      std::ranges::find(moving_parts_, &part, &std::pair<const GroundPart*, std::int32_t>::first);
  if (known != moving_parts_.end()) return known->second;
  const auto index = std::int32_t(participants_.size());
  moving_parts_.emplace_back(&part, index);
  participants_.push_back(Participant::ground());
  return index;
}

// Of what a full body lies on. −1: it stands still.
std::int32_t Crowd::solver_index_of_ground(const Vec3& velocity) {
  if (velocity.isZero(0.0)) return -1;
  const auto known = std::ranges::find(moving_ground_, velocity, &std::pair<Vec3, std::int32_t>::first);
  if (known != moving_ground_.end()) return known->second;
  const auto index = std::int32_t(participants_.size());
  moving_ground_.emplace_back(velocity, index);
  participants_.push_back(Participant::ground());
  return index;
}

void Crowd::add_manifold(ContactKey key, std::int32_t first, std::int32_t second, const Vec3& normal,
                         const ContactLaw& law) {
  keys_.push_back(key);
  manifolds_.push_back({first, second, normal, law, std::uint32_t(points_.size()), 0});
  grounds_.emplace_back();
}

// Of the last manifold.
void Crowd::add_point(const Vec3& arm_first, const Vec3& arm_second, double gap) {
  CrowdPoint& point = points_.emplace_back();
  point.arm_first = arm_first;
  point.arm_second = arm_second;
  point.gap = gap;
  ++manifolds_.back().count;
}

// The first manifolds of all.
void Crowd::add_pair_contacts(const ContactScene& scene, std::span<const CrowdContact> contacts) {
  keys_.resize(contacts.size());
  manifolds_.resize(contacts.size());
  grounds_.assign(contacts.size(), {});
  std::uint32_t points = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    manifolds_[i].first = solver_index(contacts[i].first),
    manifolds_[i].second = solver_index(contacts[i].second);
    manifolds_[i].begin = points;
    points += std::uint32_t(contacts[i].contact.manifold.count);
  }
  points_.resize(points);
  run_in_pieces(jobs_, std::int64_t(contacts.size()), kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i) {
      const auto& [first, second, contact] = contacts[i];
      CrowdManifold& m = manifolds_[i];
      keys_[i] = contact_key(scene.owner(first), scene.owner(second));
      m.normal = contact.normal, m.law = scene.law(first, second);
      m.known = m.to_forget = false, m.pressed = 0.0f, m.most_impulse = kUnbounded;
      if (is_borne_up(scene, first) || is_borne_up(scene, second)) m.law.restitution = 0.0;
      m.count = std::uint32_t(contact.manifold.count);
      for (std::uint32_t k = 0; k < m.count; ++k) {
        const auto& [point, gap] = contact.manifold.points[k];
        points_[m.begin + k] = {.arm_first = point - scene.position(first),
                                .arm_second = point - scene.position(second),
                                .gap = gap};
      }
    }
  });
}

void Crowd::add_solid_contact(const ContactScene& scene, const SolidContact& on_solid) {
  const Participant p = Participant::statistical(std::size_t(on_solid.slot));
  const std::int32_t index = solver_index(p), ground = solver_index(*on_solid.part);
  add_manifold(ground_key(scene.owner(p), kFirstSolid + on_solid.number), index, ground,
               on_solid.contact.normal, scene.world.materials->law(scene.material(p), on_solid.material));
  grounds_.back() = {on_solid.part->id, on_solid.material};
  const Manifold& manifold = on_solid.contact.manifold;
  for (int i = 0; i < manifold.count; ++i)
    add_point(manifold.points[i].point - scene.position(p),
              manifold.points[i].point - on_solid.part->pose.position, manifold.points[i].gap);
}

void Crowd::add_ground_contacts(const ContactScene& scene, std::int32_t index) {
  for (const GroundMeeting& meeting : meetings_.of(std::size_t(index))) {
    const StatisticalBody& body = scene.body(participants_[std::size_t(index)]);
    const auto reaches = [&](const HullContact& contact) { return contact.gap <= meeting.margin; };
    const auto contacts = std::span(meeting.found.contact).first(std::size_t(meeting.found.count));
    if (std::ranges::none_of(contacts, reaches)) continue;
    const HalfSpace& plane = *meeting.plane;
    add_manifold(ground_key(body.owner, meeting.number), index, -1, plane.normal,
                 scene.world.law(scene.kind_of(body), plane));
    grounds_.back() = {plane.id, plane.material};
    for (const HullContact& contact : contacts)
      if (reaches(contact)) add_point(contact.arm, Vec3::Zero(), contact.gap);
  }
}

// A counting sort of the contacts by neighbour; a contact of two is in both runs.
void Crowd::sort_full_contacts(std::span<const FullContact> full_contacts, std::size_t neighbors) {
  full_start_.assign(neighbors + 1, 0);
  const auto each_end = [&](const auto& visit) {
    for (std::size_t i = 0; i < full_contacts.size(); ++i)
      for (const std::int32_t end : {full_contacts[i].first, full_contacts[i].second})
        if (end >= 0) visit(end, std::int32_t(i));
  };
  each_end([&](std::int32_t end, std::int32_t) { ++full_start_[end + 1]; });
  for (std::size_t i = 0; i < neighbors; ++i) full_start_[i + 1] += full_start_[i];
  full_order_.resize(std::size_t(full_start_[neighbors]));
  full_next_.assign(full_start_.begin(), full_start_.end() - 1);
  each_end([&](std::int32_t end, std::int32_t contact) { full_order_[full_next_[end]++] = contact; });
}

// What holds up a full body, and what holds that up in turn: bodies met here take their place among the
// participants.
void Crowd::add_full_contacts(const ContactScene& scene, int index, const CrowdTouch& touch) {
  const auto self = std::int32_t(participants_[std::size_t(index)].index());
  const Vec3& at_self = scene.neighbors[self].state.position;
  for (std::int32_t i = full_start_[self]; i < full_start_[self + 1]; ++i) {
    const FullContact& contact = touch.full_contacts[full_order_[i]];
    const bool is_first = contact.first == self;
    const std::int32_t other = is_first ? contact.second : contact.first,
                       second = other < 0 ? solver_index_of_ground(contact.velocity)
                                          : solver_index(Participant::full(std::size_t(other)));
    const bool added_by_the_other = other >= 0 && second < index && !scene.neighbors[other].asleep;
    if (added_by_the_other) continue;
    add_manifold(
        contact_key(scene.neighbors[self].owner, other < 0 ? 0xffffffff : scene.neighbors[other].owner),
        index, second, is_first ? contact.normal : Vec3(-contact.normal),
        {.restitution = 0.0, .friction = contact.friction});
    add_point(contact.point - at_self,
              other < 0 ? Vec3(Vec3::Zero()) : Vec3(contact.point - scene.neighbors[other].state.position),
              contact.drive ? -contact.drive->speed * touch.time : contact.gap);
    if (contact.drive) manifolds_.back().most_impulse = contact.drive->force * touch.time;
  }
}

// Pair contacts, then what is under every moving participant.
void Crowd::gather(const ContactScene& scene, const CrowdTouch& touch) {
  participants_.clear();
  moving_parts_.clear(), moving_ground_.clear();
  make_room(scene.bodies.size());
  index_of_neighbor_.assign(scene.neighbors.size(), -1);

  add_pair_contacts(scene, touch.contacts);
  pair_manifolds_ = manifolds_.size();
  for (const SolidContact& on_solid : touch.solid_contacts) add_solid_contact(scene, on_solid);
  take_bodies(scene, 0, touch.time);
  meetings_.find(scene, participants_, solver_bodies_, touch.faces, touch.time, settings_.contact_margin,
                 jobs_);
  sort_full_contacts(touch.full_contacts, scene.neighbors.size());
  const std::size_t taken = participants_.size();
  for (std::size_t i = 0; i < participants_.size(); ++i) {
    const Participant p = participants_[i];
    if (p.is_ground() || scene.asleep(p) || scene.properties(p).kinematic) continue;
    if (p.is_full())
      add_full_contacts(scene, int(i), touch);
    else
      add_ground_contacts(scene, std::int32_t(i));
  }
  take_bodies(scene, taken, touch.time);
  turn_carriers_half(touch.time);
}

// What nothing stops and turns carries its riders along the chord of their arc, not along the tangent at its
// beginning, on which they would walk outward by ω² h² r / 2 in each substep: its arms are those of half-way.
void Crowd::turn_carriers_half(double time) {
  const auto turns = [this](std::int32_t index) {
    return index >= 0 && solver_bodies_[std::size_t(index)].inverse_mass == 0.0 &&
           !solver_bodies_[std::size_t(index)].angular_velocity.isZero(0.0);
  };
  bool any = false;
  for (std::int32_t i = 0; i < std::int32_t(solver_bodies_.size()) && !any; ++i) any = turns(i);
  if (!any) return;
  for (const CrowdManifold& m : manifolds_) {
    const auto turn = [&](std::int32_t index, Vec3 CrowdPoint::*arm) {
      if (!turns(index)) return;
      const Vec3 half = 0.5 * time * solver_bodies_[std::size_t(index)].angular_velocity;
      for (CrowdPoint& point : std::span(points_).subspan(m.begin, m.count))
        point.*arm += half.cross(point.*arm);
    };
    turn(m.first, &CrowdPoint::arm_first);
    turn(m.second, &CrowdPoint::arm_second);
  }
}

// What forces press together does not strike.
void Crowd::note_presses(const ContactScene& scene, double time) {
  const auto is_pushed = [&](const FullNeighbor& body) { return !body.force.isZero(0.0); };
  const bool any =
      (scene.world.forces && !scene.world.forces->empty()) || std::ranges::any_of(scene.neighbors, is_pushed);
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
  borne_weights_.guess(solver_bodies_, manifolds_, points_, settings.fall, time);
  noted_ = scene.world.log ? note_approaches(scene, time) : 0;
  solver_.solve(solver_bodies_, manifolds_, points_, time, settings, jobs_);
  for (const std::uint32_t struck : solver_.struck()) manifolds_[struck].to_forget = true;
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
  const auto is_forced = [&](std::int32_t body) {
    return body >= 0 && !sleeps(body) && scene.is_forced(participants_[std::size_t(body)]);
  };
  for (const CrowdManifold& m : manifolds) {
    pushes_[std::size_t(m.first)].forced |= is_forced(m.second);
    if (m.second >= 0) pushes_[std::size_t(m.second)].forced |= is_forced(m.first);
  }
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
    any |= scene.body(participants_[i]).quiet_time + float(touch.time) >= touch.still_time;
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
    if (!body.is_sphere() && !body.borne_up &&
        (solved.velocity - body.velocity).dot(falls) > kFalling * falls.squaredNorm() * time)
      body.quiet_time = std::max(0.0f, body.quiet_time - 2.0f * float(time));
    body.in_great_heap = solved.in_great_heap;
    body.pinned = false;
    body.velocity = solved.velocity;
    body.spin += added;
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

void Crowd::give_to_full(const ContactScene& scene, const CrowdTouch& touch) {
  if (scene.neighbors.empty()) return;
  for (const CrowdManifold& m : std::span(manifolds_).first(pair_manifolds_))
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      const auto give = [&](Participant to, Participant from, const Vec3& impulse, const Vec3& arm) {
        if (!to.is_full() || scene.neighbor(to).asleep || scene.properties(to).kinematic) return;
        const bool hits = point.bounces && !is_borne_up(scene, from);
        FullNeighbor& full = scene.neighbor(to);
        Impulse& share = !hits                                   ? full.push
                         : is_backed(to.index(), impulse, touch) ? full.backed_hit
                                                                 : full.hit;
        if (hits) full.fastest_hit = std::max(full.fastest_hit, double(point.blow));
        const bool moves =
            from.is_statistical() && !scene.asleep(from) && scene.body(from).quiet_time == 0.0f;
        scene.neighbor(to).carried |= moves;
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
  constexpr double kOfOne = 0.4;  // of the speed at which two come apart
  const auto velocity_of = [&](std::int32_t index, const Vec3& arm) {
    return index < 0
               ? Vec3(Vec3::Zero())
               : Vec3(solver_bodies_[index].velocity + solver_bodies_[index].angular_velocity.cross(arm));
  };
  const auto can_move = [&](std::int32_t index) {
    return index >= 0 && solver_bodies_[index].inverse_mass > 0.0;
  };
  const auto move = [&](std::int32_t index, const Vec3& by) {
    if (!can_move(index)) return;
    const Participant p = participants_[index];
    scene.position(p) += by;
    shifts_[std::size_t(index)] += by;
    if (p.is_full()) scene.neighbor(p).shift += by;
  };
  shifts_.assign(solver_bodies_.size(), Vec3::Zero());
  partings_.clear();
  insiders_.clear();
  parting_of_.assign(solver_bodies_.size(), -1);
  const auto part_slowly = [&](std::int32_t index, const Vec3& by, double farthest) {
    if (!can_move(index)) return;
    std::int32_t& place = parting_of_[std::size_t(index)];
    if (place < 0) {
      place = std::int32_t(partings_.size());
      partings_.push_back({index, Vec3::Zero(), farthest});
    }
    Parting& parting = partings_[std::size_t(place)];
    parting.by += by, parting.farthest = std::min(parting.farthest, farthest);
  };
  for (const CrowdManifold& m : manifolds_) {
    const Participant one = participants_[std::size_t(m.first)],
                      other = m.second < 0 ? Participant::ground() : participants_[std::size_t(m.second)];
    if (!one.is_statistical() && !other.is_statistical()) continue;
    const double radius = radius_of_pair(scene, one, other);
    const bool eased = is_eased(scene, one) || is_eased(scene, other);
    const double first = solver_bodies_[m.first].inverse_mass,
                 second = m.second < 0 ? 0.0 : solver_bodies_[m.second].inverse_mass;
    if (first + second == 0.0) continue;
    const double deep = deep_overlap_of(scene, one, other);
    // A face of the ground has a contact of each triangle: together they push it out once.
    const double by_others = m.second < 0 ? std::max(0.0, shift_of(m.first).dot(m.normal)) : 0.0;
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      if (push_out_overlap(point.gap, radius) == 0.0) continue;
      const bool inside =
          point.gap < -kWakingOverlap * radius && !is_sphere(scene, one) && !is_sphere(scene, other);
      for (const std::int32_t index : {m.first, m.second}) {
        const Participant p = index < 0 ? Participant::ground() : participants_[std::size_t(index)];
        if (is_eased(scene, p) && point.gap < -kBroughtOverlap * radius)
          scene.body(p).eased = kEasedTime;  // for as long as there is some
        if (inside && p.is_statistical())
          insiders_.push_back({index, scene.position(p) - shift_of(index),
                               touch.parting * push_out_overlap(point.gap, radius),
                               std::max(first, second) >= kUnevenMasses * std::min(first, second)});
      }
      const double parting =
          (velocity_of(m.first, point.arm_first) - velocity_of(m.second, point.arm_second)).dot(m.normal);
      double overlap =
          point.gap + std::max(0.0, parting) * touch.time;  // the rest is undone by the motion itself
      // Up through a column of thin bodies one after the other: all at once, those in its midst, pushed from
      // both sides, would hardly move. Of shallower ones it would raise heaps, by 5 % for plates.
      if (point.gap < -deep)
        overlap += (shift_of(m.first) - shift_of(m.second)).dot(m.normal);
      else
        overlap += by_others;
      const double distance = touch.parting * push_out_overlap(overlap, radius) / double(m.count);
      const Vec3 of_first = distance * first / (first + second) * m.normal,
                 of_second = -distance * second / (first + second) * m.normal;
      if (eased) {
        const double farthest = kOfOne * parting_speed(radius, scene.world.gravity_strength()) * touch.time;
        part_slowly(m.first, of_first, farthest), part_slowly(m.second, of_second, farthest);
      } else {
        move(m.first, of_first), move(m.second, of_second);
      }
    }
  }
  // What the overlaps of a body that came with some ask for together, not each of them, is slow: the greatest
  // prevails over those that others keep up.
  for (const auto& [body, by, farthest] : partings_) {
    const double length = by.norm();
    move(body, length > farthest ? Vec3(farthest / length * by) : by);
  }
  keep_full_apart(scene);
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
    if (const BodyProperties& own = scene.properties(p); own.kinematic || !meets_ground(own)) return;
    for (const HalfSpace& plane : scene.world.planes) lift(p, plane);
    for (const HalfSpace& face : touch.faces.of(std::int32_t(p.index()))) lift(p, face);
  });
}

// Who is being moved out of another is not at rest, though it has no velocity. But a pebble between a boulder
// and the ground is not moved, being moved back, nor is the boulder by a share of its lightness: they stay as
// they are.
void Crowd::keep_insiders_awake(const ContactScene& scene) {
  constexpr double kStuck = 0.05;
  const auto body_of = [&](const Insider& i) -> StatisticalBody& {
    return scene.body(participants_[std::size_t(i.body)]);
  };
  const auto is_moved_out = [&](const Insider& i) {
    return !i.uneven || (body_of(i).position - i.from).norm() > kStuck * i.asked;
  };
  for (const Insider& i : insiders_) body_of(i).pinned = true;
  for (const Insider& i : insiders_)
    if (is_moved_out(i)) body_of(i).pinned = false, body_of(i).quiet_time = 0.0f;
}

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

ContactTally Crowd::move(const ContactScene& scene, const CrowdTouch& touch) {
  memory_.remember(keys_, manifolds_, points_, touch.time);
  if (scene.world.log) note_impulses(*scene.world.log, noted_);
  find_footing(scene, touch);
  find_impacts();
  move_bodies(scene, touch.time);
  give_to_full(scene, touch);
  move_apart(scene, touch);
  lift_off_ground(scene, touch);
  keep_insiders_awake(scene);
  ContactTally tally;
  tally.contacts = std::int64_t(points_.size());
  return tally;
}

}  // namespace lodestone
