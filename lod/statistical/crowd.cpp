#include "lod/statistical/crowd.h"

#include <algorithm>

#include "lod/statistical/flight.h"

namespace lodestone {
namespace {

MaterialId material_of(Participant p, std::span<const StatisticalBody> bodies, std::span<const BodyKind> kinds, std::span<const FullNeighbor> neighbors) {
  return p >= 0 ? kinds[bodies[p].kind].material : neighbors[-1 - p].material;
}

const Vec3& position_of(Participant p, std::span<const StatisticalBody> bodies, std::span<const FullNeighbor> neighbors) {
  return p >= 0 ? bodies[p].position : neighbors[-1 - p].state.position;
}

std::uint32_t owner_of(Participant p, std::span<const StatisticalBody> bodies, std::span<const FullNeighbor> neighbors) {
  return p >= 0 ? bodies[p].owner : neighbors[-1 - p].owner;
}

void lift_sphere_out(StatisticalBody& body, const HalfSpace& plane) {
  const double gap = plane.height_of(body.position) - body.sphere_radius;
  if (gap >= 0.0) return;
  body.position -= gap * plane.normal;
  body.velocity -= std::min(0.0, body.velocity.dot(plane.normal)) * plane.normal;
}

}  // namespace

int Crowd::solver_index(Participant p, std::span<const StatisticalBody> bodies, std::span<const BodyKind> kinds,
                        std::span<const FullNeighbor> neighbors, const StepWorld& world, double time) {
  std::int32_t& index = p >= 0 ? index_of_slot_[p] : index_of_neighbor_[-1 - p];
  if (index >= 0) return index;
  index = std::int32_t(solver_bodies_.size());
  participants_.push_back(p);
  SolverBody solver;
  if (p >= 0) {
    const StatisticalBody& body = bodies[p];
    const BodyKind& kind = kinds[body.kind];
    if (body.motion != Motion::asleep) {
      solver.velocity = body.velocity + world.gravity * time;
      solver.angular_velocity = angular_velocity(body.orientation, body.spin, *kind.shape);
      solver.inverse_mass = 1.0 / kind.mass;
      solver.inverse_inertia = inverse_inertia_world(body.orientation, *kind.shape) / kind.mass;
    }
  } else {
    const FullNeighbor& body = neighbors[-1 - p];
    if (!body.asleep) {
      solver.velocity = body.state.velocity + (world.gravity + body.force / body.mass) * time;
      solver.angular_velocity = body.state.angular_velocity;
      solver.inverse_mass = 1.0 / body.mass;
      solver.inverse_inertia = inverse_inertia_world(body.state.orientation, *body.shape) / body.mass;
    }
  }
  angular_before_.push_back(solver.angular_velocity);
  solver_bodies_.push_back(solver);
  return index;
}

CrowdManifold& Crowd::add_manifold(ContactKey key, std::int32_t first, std::int32_t second, const Vec3& normal, const ContactLaw& law) {
  keys_.push_back(key);
  return manifolds_.emplace_back(CrowdManifold{first, second, normal, law, std::uint32_t(points_.size()), 0});
}

// Of the last manifold.
void Crowd::add_point(const Vec3& arm_first, const Vec3& arm_second, double gap) {
  CrowdPoint& point = points_.emplace_back();
  point.arm_first = arm_first;
  point.arm_second = arm_second;
  point.gap = gap;
  ++manifolds_.back().count;
}

// `number`: of the plane, for what is remembered of its contacts.
void Crowd::add_ground_contacts(int index, StatisticalBody& body, const BodyKind& kind, const HalfSpace& plane, std::size_t number, const StepWorld& world,
                                StatisticalModel model, double time) {
  const double reach = model == StatisticalModel::support ? kind.shape->radius : double(body.sphere_radius);
  const double spin_speed = model == StatisticalModel::support ? solver_bodies_[index].angular_velocity.norm() * reach : 0.0;
  const double height = plane.height_of(body.position);
  const double falling = std::max(0.0, -solver_bodies_[index].velocity.dot(plane.normal));
  const double margin = settings_.contact_margin * kind.shape->radius + (falling + 0.5 * spin_speed) * time;
  if (height > reach + margin) return;
  HullContacts found;
  if (model == StatisticalModel::support) {
    found = find_hull_contacts(*kind.shape, body.orientation, plane.normal, height, margin, body.support_hint);
  } else {
    found.contact[0] = {-reach * plane.normal, height - reach};
    found.count = 1;
  }
  const auto reaches = [&](const HullContact& contact) { return contact.gap <= margin; };
  const auto contacts = std::span(found.contact).first(std::size_t(found.count));
  if (std::ranges::none_of(contacts, reaches)) return;
  add_manifold(ground_key(body.owner, number), index, -1, plane.normal, world.law(kind, plane));
  for (const HullContact& contact : contacts)
    if (reaches(contact)) add_point(contact.arm, Vec3::Zero(), contact.gap);
}

void Crowd::add_solid_contact(const SolidContact& on_solid, std::span<const StatisticalBody> bodies, std::span<const BodyKind> kinds,
                              std::span<const FullNeighbor> neighbors, const StepWorld& world, double time) {
  const StatisticalBody& body = bodies[on_solid.slot];
  add_manifold(ground_key(body.owner, world.ground->planes.size() + std::size_t(on_solid.solid)),
               solver_index(on_solid.slot, bodies, kinds, neighbors, world, time), -1, on_solid.contact.normal,
               world.materials->law(kinds[body.kind].material, world.ground->solids[on_solid.solid].material));
  const Manifold& manifold = on_solid.contact.manifold;
  for (int i = 0; i < manifold.count; ++i) add_point(manifold.points[i].point - body.position, Vec3::Zero(), manifold.points[i].gap);
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
void Crowd::add_full_contacts(int index, std::span<const StatisticalBody> bodies, std::span<const BodyKind> kinds,
                              std::span<const FullNeighbor> neighbors, std::span<const FullContact> full_contacts, const StepWorld& world,
                              double time) {
  const std::int32_t self = -1 - participants_[index];
  for (std::int32_t i = full_start_[self]; i < full_start_[self + 1]; ++i) {
    const FullContact& contact = full_contacts[full_order_[i]];
    const bool is_first = contact.first == self;
    const std::int32_t other = is_first ? contact.second : contact.first;
    const std::int32_t second = other >= 0 ? solver_index(-1 - other, bodies, kinds, neighbors, world, time) : -1;
    const bool added_by_the_other = other >= 0 && second < index && !neighbors[other].asleep;
    if (added_by_the_other) continue;
    add_manifold(contact_key(neighbors[self].owner, other < 0 ? 0xffffffff : neighbors[other].owner), index, second,
                 is_first ? contact.normal : Vec3(-contact.normal), {.restitution = 0.0, .friction = contact.friction});
    add_point(contact.point - neighbors[self].state.position, other < 0 ? Vec3(Vec3::Zero()) : Vec3(contact.point - neighbors[other].state.position), contact.gap);
  }
}

void Crowd::give_to_full(std::span<FullNeighbor> neighbors, std::size_t pair_manifolds) const {
  if (neighbors.empty()) return;
  for (const CrowdManifold& m : std::span(manifolds_).first(pair_manifolds))
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
void Crowd::move_apart(std::span<StatisticalBody> bodies, std::span<const BodyKind> kinds, std::span<FullNeighbor> neighbors, double time) const {
  const auto velocity_of = [&](std::int32_t index, const Vec3& arm) {
    return index < 0 ? Vec3(Vec3::Zero()) : Vec3(solver_bodies_[index].velocity + solver_bodies_[index].angular_velocity.cross(arm));
  };
  const auto move = [&](std::int32_t index, const Vec3& by) {
    if (index < 0 || solver_bodies_[index].inverse_mass == 0.0) return;
    const Participant p = participants_[index];
    (p >= 0 ? bodies[p].position : neighbors[-1 - p].state.position) += by;
    if (p < 0) neighbors[-1 - p].shift += by;
  };
  for (const CrowdManifold& m : manifolds_) {
    const Participant p = std::max(participants_[m.first], m.second < 0 ? -1 : participants_[m.second]);
    if (p < 0) continue;
    const double radius = kinds[bodies[p].kind].shape->radius;
    const double first = solver_bodies_[m.first].inverse_mass, second = m.second < 0 ? 0.0 : solver_bodies_[m.second].inverse_mass;
    if (first + second == 0.0) continue;
    for (const CrowdPoint& point : std::span(points_).subspan(m.begin, m.count)) {
      if (push_out_overlap(point.gap, radius) == 0.0) continue;
      const double parting = (velocity_of(m.first, point.arm_first) - velocity_of(m.second, point.arm_second)).dot(m.normal);
      const double overlap = point.gap + std::max(0.0, parting) * time;  // the rest is undone by the motion itself
      const double distance = push_out_overlap(overlap, radius) / double(m.count);
      move(m.first, distance * first / (first + second) * m.normal);
      move(m.second, -distance * second / (first + second) * m.normal);
    }
  }
}

ContactTally Crowd::step(std::span<StatisticalBody> bodies, std::span<const BodyKind> kinds, std::span<FullNeighbor> neighbors,
                         std::span<const FullContact> full_contacts, std::span<const CrowdContact> contacts,
                         std::span<const SolidContact> solid_contacts, const FacesBelow& faces, const StepWorld& world, StatisticalModel model, double time) {
  participants_.clear();
  solver_bodies_.clear();
  angular_before_.clear();
  manifolds_.clear();
  keys_.clear();
  points_.clear();
  index_of_slot_.resize(bodies.size(), -1);
  index_of_neighbor_.assign(neighbors.size(), -1);

  // Pair contacts, then what is under every moving participant.
  for (const CrowdContact& pair : contacts) {
    const std::int32_t first = solver_index(pair.first, bodies, kinds, neighbors, world, time), second = solver_index(pair.second, bodies, kinds, neighbors, world, time);
    add_manifold(contact_key(owner_of(pair.first, bodies, neighbors), owner_of(pair.second, bodies, neighbors)), first, second, pair.contact.normal,
                 world.materials->law(material_of(pair.first, bodies, kinds, neighbors), material_of(pair.second, bodies, kinds, neighbors)));
    const Manifold& manifold = pair.contact.manifold;
    const Vec3 &at_first = position_of(pair.first, bodies, neighbors), &at_second = position_of(pair.second, bodies, neighbors);
    for (int i = 0; i < manifold.count; ++i) add_point(manifold.points[i].point - at_first, manifold.points[i].point - at_second, manifold.points[i].gap);
  }
  const std::size_t pair_manifolds = manifolds_.size();
  for (const SolidContact& on_solid : solid_contacts) add_solid_contact(on_solid, bodies, kinds, neighbors, world, time);
  sort_full_contacts(full_contacts, neighbors.size());
  for (std::size_t i = 0; i < participants_.size(); ++i) {
    const Participant p = participants_[i];
    if (p < 0 && !neighbors[-1 - p].asleep) add_full_contacts(int(i), bodies, kinds, neighbors, full_contacts, world, time);
    if (p < 0 || bodies[p].motion == Motion::asleep) continue;
    const auto& planes = world.ground->planes;
    for (std::size_t number = 0; number < planes.size(); ++number)
      add_ground_contacts(int(i), bodies[p], kinds[bodies[p].kind], planes[number], number, world, model, time);
    std::size_t number = planes.size() + world.ground->solids.size();
    for (const HalfSpace& face : faces.of(p)) add_ground_contacts(int(i), bodies[p], kinds[bodies[p].kind], face, number++, world, model, time);
  }
  ContactSolverSettings settings = settings_.solver;
  settings.bounce_velocity = world.bounce_velocity + world.gravity_strength() * time;  // what gravity adds in a step is no impact
  settings.fall = world.gravity * time;
  memory_.recall(keys_, manifolds_, points_, time);
  solver_.solve(solver_bodies_, manifolds_, points_, time, settings, jobs_);
  memory_.remember(keys_, manifolds_, points_, time);

  // Velocities back, and motion; full neighbours take theirs as impulses.
  for (std::size_t i = 0; i < participants_.size(); ++i) {
    const Participant p = participants_[i];
    const SolverBody& solved = solver_bodies_[i];
    if (p < 0) {
      RigidState& state = neighbors[-1 - p].state;
      state.velocity = solved.velocity;
      state.angular_velocity = solved.angular_velocity;
      continue;
    }
    index_of_slot_[p] = -1;
    StatisticalBody& body = bodies[p];
    if (body.motion == Motion::asleep) continue;
    const BodyKind& kind = kinds[body.kind];
    body.velocity = solved.velocity;
    body.spin += spin_of(body.orientation, solved.angular_velocity - angular_before_[i], *kind.shape);
    body.position += body.velocity * time;
    body.orientation = advance_orientation(body.orientation, body.spin, kind, time).normalized();
    ++body.events;
  }
  give_to_full(neighbors, pair_manifolds);
  move_apart(bodies, kinds, neighbors, time);
  // The ground has the last word.
  const auto lift = [&](StatisticalBody& body, const HalfSpace& plane) {
    if (model == StatisticalModel::support) lift_out(body, *kinds[body.kind].shape, plane);
    else lift_sphere_out(body, plane);
  };
  for (const Participant p : participants_) {
    if (p < 0 || bodies[p].motion == Motion::asleep) continue;
    for (const HalfSpace& plane : world.ground->planes) lift(bodies[p], plane);
    for (const HalfSpace& face : faces.of(p)) lift(bodies[p], face);
  }
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
