// Of Crowd: who takes part in a step, and what touches.
#include <algorithm>

#include "lod/contact/crowd.h"
#include "lod/room.h"

namespace lodestone {
namespace {

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
  resize_in_room(solver_bodies_, participants_.size());
  resize_in_room(angular_before_, participants_.size());
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
  append_in_room(keys_) = key;
  append_in_room(manifolds_) = {first, second, normal, law, std::uint32_t(points_.size()), 0};
  append_in_room(grounds_);
}

// Of the last manifold.
void Crowd::add_point(const Vec3& arm_first, const Vec3& arm_second, double gap) {
  CrowdPoint& point = append_in_room(points_);
  point.arm_first = arm_first;
  point.arm_second = arm_second;
  point.gap = gap;
  ++manifolds_.back().count;
}

// The first manifolds of all.
void Crowd::add_pair_contacts(const ContactScene& scene, std::span<const CrowdContact> contacts) {
  resize_in_room(keys_, contacts.size());
  resize_in_room(manifolds_, contacts.size());
  grounds_.assign(contacts.size(), {});
  std::uint32_t points = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    manifolds_[i].first = solver_index(contacts[i].first),
    manifolds_[i].second = solver_index(contacts[i].second);
    manifolds_[i].begin = points;
    points += std::uint32_t(contacts[i].contact.manifold.count);
  }
  resize_in_room(points_, points);
  run_in_pieces(jobs_, std::int64_t(contacts.size()), kBlock, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i) {
      const auto& [first, second, contact] = contacts[i];
      CrowdManifold& m = manifolds_[i];
      keys_[i] = contact_key(scene.owner(first), scene.owner(second));
      m.normal = contact.normal, m.law = scene.law(first, second);
      m.known = m.to_forget = false, m.pressed = m.spared = 0.0f, m.most_impulse = kUnbounded;
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
    const auto adds_its_own = [&](Participant full) {
      return !scene.asleep(full) && !scene.properties(full).kinematic;
    };
    if (other >= 0 && second < index && adds_its_own(Participant::full(std::size_t(other)))) continue;
    const ContactKey key =
        contact_key(scene.neighbors[self].owner, other < 0 ? 0xffffffff : scene.neighbors[other].owner);
    if (contact.row % 2 == 1) opposed_.push_back(std::uint32_t(manifolds_.size()));
    add_manifold(numbered_key(key, contact.row), index, second,
                 is_first ? contact.normal : Vec3(-contact.normal),
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
  opposed_.clear();
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
// beginning, on which they would walk outward by ω² h² r / 2 in each substep: the arms of both are those of
// half-way, the rider's turned as if it went with its carrier.
void Crowd::turn_carriers_half(double time) {
  const auto turns = [this](std::int32_t index) {
    return index >= 0 && solver_bodies_[std::size_t(index)].inverse_mass == 0.0 &&
           !solver_bodies_[std::size_t(index)].angular_velocity.isZero(0.0);
  };
  bool any = false;
  for (std::int32_t i = 0; i < std::int32_t(solver_bodies_.size()) && !any; ++i) any = turns(i);
  if (!any) return;
  for (const CrowdManifold& m : manifolds_)
    for (const std::int32_t carrier : {m.first, m.second}) {
      if (!turns(carrier)) continue;
      const Mat3 half =
          rotation_from_vector(0.5 * time * solver_bodies_[std::size_t(carrier)].angular_velocity)
              .toRotationMatrix();
      for (CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
        point.arm_first = half * point.arm_first;
        point.arm_second = half * point.arm_second;
      }
    }
}

}  // namespace lodestone
