#include "lod/statistical/crowd.h"

#include <algorithm>

#include "lod/statistical/flight.h"

namespace lodestone {
namespace {

void lift_sphere_out(StatisticalBody& body, const HalfSpace& plane) {
  const double gap = plane.height_of(body.position) - body.sphere_radius;
  if (gap >= 0.0) return;
  body.position -= gap * plane.normal;
  body.velocity -= std::min(0.0, body.velocity.dot(plane.normal)) * plane.normal;
}

}  // namespace

SolverBody CrowdScene::solver_body(Participant p) const {
  SolverBody solver;
  if (asleep(p)) return solver;
  if (p >= 0) {
    const StatisticalBody& body = bodies[std::size_t(p)];
    const BodyKind& kind = kind_of(p);
    solver.velocity = body.velocity + world.gravity * time;
    solver.angular_velocity = angular_velocity(body.orientation, body.spin, *kind.shape);
    solver.inverse_mass = 1.0 / kind.mass;
    solver.inverse_inertia = inverse_inertia_world(body.orientation, *kind.shape) / kind.mass;
  } else {
    const FullNeighbor& body = neighbors[std::size_t(-1 - p)];
    solver.velocity = body.state.velocity + (world.gravity + body.force / body.mass) * time;
    solver.angular_velocity = body.state.angular_velocity;
    solver.inverse_mass = 1.0 / body.mass;
    solver.inverse_inertia = inverse_inertia_world(body.state.orientation, *body.shape) / body.mass;
  }
  return solver;
}

int Crowd::solver_index(const CrowdScene& scene, Participant p) {
  std::int32_t& index = p >= 0 ? index_of_slot_[p] : index_of_neighbor_[-1 - p];
  if (index >= 0) return index;
  index = std::int32_t(solver_bodies_.size());
  participants_.push_back(p);
  solver_bodies_.push_back(scene.solver_body(p));
  angular_before_.push_back(solver_bodies_.back().angular_velocity);
  return index;
}

void Crowd::add_manifold(ContactKey key, std::int32_t first, std::int32_t second, const Vec3& normal, const ContactLaw& law) {
  keys_.push_back(key);
  manifolds_.push_back({first, second, normal, law, std::uint32_t(points_.size()), 0});
}

// Of the last manifold.
void Crowd::add_point(const Vec3& arm_first, const Vec3& arm_second, double gap) {
  CrowdPoint& point = points_.emplace_back();
  point.arm_first = arm_first;
  point.arm_second = arm_second;
  point.gap = gap;
  ++manifolds_.back().count;
}

void Crowd::add_pair_contact(const CrowdScene& scene, const CrowdContact& pair) {
  const std::int32_t first = solver_index(scene, pair.first), second = solver_index(scene, pair.second);
  add_manifold(contact_key(scene.owner_of(pair.first), scene.owner_of(pair.second)), first, second, pair.contact.normal,
               scene.world.materials->law(scene.material_of(pair.first), scene.material_of(pair.second)));
  const Manifold& manifold = pair.contact.manifold;
  const Vec3 &at_first = scene.position_of(pair.first), &at_second = scene.position_of(pair.second);
  for (int i = 0; i < manifold.count; ++i) add_point(manifold.points[i].point - at_first, manifold.points[i].point - at_second, manifold.points[i].gap);
}

void Crowd::add_solid_contact(const CrowdScene& scene, const SolidContact& on_solid) {
  const StaticGround& ground = *scene.world.ground;
  const auto solid = std::size_t(on_solid.solid);
  add_manifold(ground_key(scene.owner_of(on_solid.slot), ground.planes.size() + solid), solver_index(scene, on_solid.slot), -1, on_solid.contact.normal,
               scene.world.materials->law(scene.material_of(on_solid.slot), ground.solids[on_solid.solid].material));
  const Manifold& manifold = on_solid.contact.manifold;
  for (int i = 0; i < manifold.count; ++i) add_point(manifold.points[i].point - scene.position_of(on_solid.slot), Vec3::Zero(), manifold.points[i].gap);
}

// `number`: of the plane, for what is remembered of its contacts.
void Crowd::add_ground_contacts(const CrowdScene& scene, int index, const HalfSpace& plane, std::size_t number) {
  StatisticalBody& body = scene.bodies[std::size_t(participants_[index])];
  const BodyKind& kind = scene.kind_of(participants_[index]);
  const bool hull = scene.model == StatisticalModel::support;
  const double reach = hull ? kind.shape->radius : double(body.sphere_radius);
  const double spin_speed = hull ? solver_bodies_[index].angular_velocity.norm() * reach : 0.0;
  const double height = plane.height_of(body.position);
  const double falling = std::max(0.0, -solver_bodies_[index].velocity.dot(plane.normal));
  const double margin = settings_.contact_margin * kind.shape->radius + (falling + 0.5 * spin_speed) * scene.time;
  if (height > reach + margin) return;
  HullContacts found;
  if (hull) {
    found = find_hull_contacts(*kind.shape, body.orientation, plane.normal, height, margin, body.support_hint);
  } else {
    found.contact[0] = {-reach * plane.normal, height - reach};
    found.count = 1;
  }
  const auto reaches = [&](const HullContact& contact) { return contact.gap <= margin; };
  const auto contacts = std::span(found.contact).first(std::size_t(found.count));
  if (std::ranges::none_of(contacts, reaches)) return;
  add_manifold(ground_key(body.owner, number), index, -1, plane.normal, scene.world.law(kind, plane));
  for (const HullContact& contact : contacts)
    if (reaches(contact)) add_point(contact.arm, Vec3::Zero(), contact.gap);
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

// What holds up a full body, and what holds that up in turn: bodies met here take their place among the participants.
void Crowd::add_full_contacts(const CrowdScene& scene, int index) {
  const std::int32_t self = -1 - participants_[index];
  const Vec3& at_self = scene.neighbors[self].state.position;
  for (std::int32_t i = full_start_[self]; i < full_start_[self + 1]; ++i) {
    const FullContact& contact = scene.full_contacts[full_order_[i]];
    const bool is_first = contact.first == self;
    const std::int32_t other = is_first ? contact.second : contact.first, second = other < 0 ? -1 : solver_index(scene, -1 - other);
    const bool added_by_the_other = other >= 0 && second < index && !scene.neighbors[other].asleep;
    if (added_by_the_other) continue;
    add_manifold(contact_key(scene.neighbors[self].owner, other < 0 ? 0xffffffff : scene.neighbors[other].owner), index, second,
                 is_first ? contact.normal : Vec3(-contact.normal), {.restitution = 0.0, .friction = contact.friction});
    add_point(contact.point - at_self, other < 0 ? Vec3(Vec3::Zero()) : Vec3(contact.point - scene.neighbors[other].state.position), contact.gap);
  }
}

// Pair contacts, then what is under every moving participant.
void Crowd::gather(const CrowdScene& scene, std::span<const CrowdContact> contacts, std::span<const SolidContact> solid_contacts) {
  participants_.clear();
  solver_bodies_.clear();
  angular_before_.clear();
  manifolds_.clear();
  keys_.clear();
  points_.clear();
  index_of_slot_.resize(scene.bodies.size(), -1);
  index_of_neighbor_.assign(scene.neighbors.size(), -1);

  for (const CrowdContact& pair : contacts) add_pair_contact(scene, pair);
  pair_manifolds_ = manifolds_.size();
  for (const SolidContact& on_solid : solid_contacts) add_solid_contact(scene, on_solid);
  sort_full_contacts(scene.full_contacts, scene.neighbors.size());
  const auto& planes = scene.world.ground->planes;
  for (std::size_t i = 0; i < participants_.size(); ++i) {
    const Participant p = participants_[i];
    if (scene.asleep(p)) continue;
    if (p < 0) {
      add_full_contacts(scene, int(i));
      continue;
    }
    for (std::size_t number = 0; number < planes.size(); ++number) add_ground_contacts(scene, int(i), planes[number], number);
    std::size_t number = planes.size() + scene.world.ground->solids.size();
    for (const HalfSpace& face : scene.faces.of(p)) add_ground_contacts(scene, int(i), face, number++);
  }
}

void Crowd::solve(const CrowdScene& scene) {
  ContactSolverSettings settings = settings_.solver;
  settings.bounce_velocity = scene.world.bounce_velocity + scene.world.gravity_strength() * scene.time;  // what gravity adds in a step is no impact
  settings.fall = scene.world.gravity * scene.time;
  memory_.recall(keys_, manifolds_, points_, scene.time);
  solver_.solve(solver_bodies_, manifolds_, points_, scene.time, settings, jobs_);
  memory_.remember(keys_, manifolds_, points_, scene.time);
}

// Full neighbours only get their velocities.
void Crowd::move(const CrowdScene& scene) {
  for (std::size_t i = 0; i < participants_.size(); ++i) {
    const Participant p = participants_[i];
    const SolverBody& solved = solver_bodies_[i];
    if (p < 0) {
      RigidState& state = scene.neighbors[-1 - p].state;
      state.velocity = solved.velocity;
      state.angular_velocity = solved.angular_velocity;
      continue;
    }
    index_of_slot_[p] = -1;
    StatisticalBody& body = scene.bodies[p];
    if (body.motion == Motion::asleep) continue;
    const BodyKind& kind = scene.kind_of(p);
    body.velocity = solved.velocity;
    body.spin += spin_of(body.orientation, solved.angular_velocity - angular_before_[i], *kind.shape);
    body.position += body.velocity * scene.time;
    body.orientation = advance_orientation(body.orientation, body.spin, kind, scene.time).normalized();
    ++body.events;
  }
}

void Crowd::give_to_full(std::span<FullNeighbor> neighbors) const {
  if (neighbors.empty()) return;
  for (const CrowdManifold& m : std::span(manifolds_).first(pair_manifolds_))
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      const auto give = [&](Participant to, const Vec3& impulse, const Vec3& arm) {
        if (to >= 0 || neighbors[-1 - to].asleep) return;
        Impulse& share = point.bounces ? neighbors[-1 - to].hit : neighbors[-1 - to].push;
        share.linear += impulse;
        share.angular += arm.cross(impulse);
      };
      give(participants_[m.first], point.impulse, point.arm_first);
      give(participants_[m.second], -point.impulse, point.arm_second);
    }
}

// Overlaps are undone by moving apart, the lighter body farther; those among full bodies are the full level's matter.
void Crowd::move_apart(const CrowdScene& scene) const {
  const auto velocity_of = [&](std::int32_t index, const Vec3& arm) {
    return index < 0 ? Vec3(Vec3::Zero()) : Vec3(solver_bodies_[index].velocity + solver_bodies_[index].angular_velocity.cross(arm));
  };
  const auto move = [&](std::int32_t index, const Vec3& by) {
    if (index < 0 || solver_bodies_[index].inverse_mass == 0.0) return;
    const Participant p = participants_[index];
    scene.position_of(p) += by;
    if (p < 0) scene.neighbors[-1 - p].shift += by;
  };
  for (const CrowdManifold& m : manifolds_) {
    const Participant p = std::max(participants_[m.first], m.second < 0 ? -1 : participants_[m.second]);
    if (p < 0) continue;
    const double radius = scene.kind_of(p).shape->radius;
    const double first = solver_bodies_[m.first].inverse_mass, second = m.second < 0 ? 0.0 : solver_bodies_[m.second].inverse_mass;
    if (first + second == 0.0) continue;
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      if (push_out_overlap(point.gap, radius) == 0.0) continue;
      const double parting = (velocity_of(m.first, point.arm_first) - velocity_of(m.second, point.arm_second)).dot(m.normal);
      const double overlap = point.gap + std::max(0.0, parting) * scene.time;  // the rest is undone by the motion itself
      const double distance = push_out_overlap(overlap, radius) / double(m.count);
      move(m.first, distance * first / (first + second) * m.normal);
      move(m.second, -distance * second / (first + second) * m.normal);
    }
  }
}

// The ground has the last word.
void Crowd::lift_off_ground(const CrowdScene& scene) const {
  const auto lift = [&](Participant p, const HalfSpace& plane) {
    if (scene.model == StatisticalModel::support) lift_out(scene.bodies[p], *scene.kind_of(p).shape, plane);
    else lift_sphere_out(scene.bodies[p], plane);
  };
  for (const Participant p : participants_) {
    if (p < 0 || scene.asleep(p)) continue;
    for (const HalfSpace& plane : scene.world.ground->planes) lift(p, plane);
    for (const HalfSpace& face : scene.faces.of(p)) lift(p, face);
  }
}

ContactTally Crowd::step(const CrowdScene& scene, std::span<const CrowdContact> contacts, std::span<const SolidContact> solid_contacts) {
  gather(scene, contacts, solid_contacts);
  solve(scene);
  move(scene);
  give_to_full(scene.neighbors);
  move_apart(scene);
  lift_off_ground(scene);
  ContactTally tally;
  tally.contacts = std::int64_t(points_.size());
  return tally;
}

void respond_pair_as_paper(StatisticalBody& first, const BodyKind& first_kind, StatisticalBody& second, const BodyKind& second_kind,
                           const PairContact& contact, const StepWorld& world, const ContactLaw& law, const TablesOptions& options,
                           ContactTally& tally) {
  const Vec3 first_velocity = first.velocity, second_velocity = second.velocity;
  first.velocity -= second_velocity;
  respond_from_tables(first, first_kind, contact.normal, world, law, options, tally);
  first.velocity += second_velocity;
  second.velocity -= first_velocity;
  respond_from_tables(second, second_kind, -contact.normal, world, law, options, tally);
  second.velocity += first_velocity;
}

}  // namespace lodestone
