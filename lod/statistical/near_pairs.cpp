// Stages 1 and 2: which bodies are near each other, and which of them touch.
#include "lod/statistical/statistical_level_internal.h"

#include <algorithm>
#include <cmath>

namespace lodestone {

void StatisticalLevel::Impl::find_near_pairs(double dt, std::span<const FullNeighbor> neighbors) {
  const double fall = 0.5 * settings.gravity.norm() * dt * dt;
  const auto bound = [&](const Vec3& position, const Vec3& velocity, double radius) {
    return Bound{position, 1.02 * radius + 0.5 * velocity.norm() * dt + fall};
  };
  if (sleepers_changed) {
    bounds.clear();
    for (const std::int32_t slot : asleep) bounds.push_back({bodies[slot].position, 1.02 * kind_of(bodies[slot]).shape->radius});
    broad_phase.set_still(bounds);
    sleepers_changed = false;
  }
  bounds.clear();
  for (const std::int32_t slot : awake) bounds.push_back(bound(bodies[slot].position, bodies[slot].velocity, kind_of(bodies[slot]).shape->radius));
  for (const FullNeighbor& n : neighbors) bounds.push_back(bound(n.state.position, n.state.velocity, n.shape->radius));
  pairs.clear();
  broad_phase.find_pairs(bounds, pairs);
}


PairBody StatisticalLevel::Impl::pair_body(Participant p, std::span<const FullNeighbor> neighbors) const {
  if (p < 0) {
    const FullNeighbor& n = neighbors[-1 - p];
    return {n.shape, n.signature, n.state.position, n.state.orientation, 0.8 * n.shape->radius};
  }
  const StatisticalBody& body = bodies[p];
  const BodyKind& kind = kind_of(body);
  return {kind.shape.get(), kind.signature.get(), body.position, body.orientation, body.sphere_radius};
}

Vec3 StatisticalLevel::Impl::point_velocity(Participant p, const Vec3& point, std::span<const FullNeighbor> neighbors) const {
  if (p < 0) {
    const RigidState& s = neighbors[-1 - p].state;
    return s.velocity + s.angular_velocity.cross(point - s.position);
  }
  const StatisticalBody& body = bodies[p];
  if (body.motion == Motion::asleep) return Vec3::Zero();
  return body.velocity + angular_velocity(body.orientation, body.spin, *kind_of(body).shape).cross(point - body.position);
}

void StatisticalLevel::Impl::find_contact(Participant first, Participant second, double dt, std::span<const FullNeighbor> neighbors, FoundPair& pair) const {
  const PairBody a = pair_body(first, neighbors), b = pair_body(second, neighbors);
  const double touching = 0.01 * std::min(a.shape->radius, b.shape->radius);
  const bool statistical = first >= 0 && second >= 0;
  const double gone = statistical ? travels[first].gone + travels[second].gone : 0.0;
  const PairRecord* known = pair_memory.find(pair.key);
  if (statistical && known && known->gap - (gone - known->travel) > touching + travels[first].ahead + travels[second].ahead) {
    pair.record = *known;
    return;
  }
  const Vec3 closing = point_velocity(first, a.position, neighbors) - point_velocity(second, b.position, neighbors);
  const double margin = touching + closing.norm() * dt;
  // A contact counts if it closes within the step.
  const auto closes = [&](const PairContact& contact) {
    return std::ranges::any_of(std::span(contact.manifold.points).first(std::size_t(contact.manifold.count)), [&](const ManifoldPoint& p) {
      const Vec3 velocity = point_velocity(first, p.point, neighbors) - point_velocity(second, p.point, neighbors);
      return p.gap + velocity.dot(contact.normal) * dt <= touching;
    });
  };
  const auto keep = [&](const PairContact& contact) {
    if (!closes(contact)) return;
    if (!pair.contact) pair.contact = CrowdContact{first, second, contact};
    else pair.more.push_back({first, second, contact});
  };
  if (tables()) {
    if (const auto contact = find_sphere_contact(a, b, margin)) keep(*contact);
    return;
  }
  const HullContactSearch search = find_pair_contacts(a, b, known ? Vec3(known->normal.cast<double>()) : Vec3::Zero(), margin);
  pair.record = {search.normal.cast<float>(), float(search.gap), gone};
  for (const PairContact& contact : search.contacts) keep(contact);
}

void StatisticalLevel::Impl::find_contacts(double dt, std::span<const FullNeighbor> neighbors) {
  const auto mover = [&](std::int32_t i) { return i < std::int32_t(awake.size()) ? awake[i] : -1 - (i - std::int32_t(awake.size())); };
  // The lower owner first, so that a contact is the same whichever of its bodies is full.
  const auto owner = [&](Participant p) { return p < 0 ? neighbors[-1 - p].owner : bodies[p].owner; };
  for (const std::int32_t slot : awake) bodies[slot].crowded = false;
  found.resize(pairs.size());
  parallel(std::int64_t(pairs.size()), 64, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      Participant first = mover(pairs[i].first), second = pairs[i].second >= 0 ? mover(pairs[i].second) : asleep[-1 - pairs[i].second];
      if (owner(second) < owner(first)) std::swap(first, second);
      found[i] = {contact_key(owner(first), owner(second)), {}, {}, {}};
      if (first < 0 && second < 0) continue;  // two full bodies are the full level's matter
      if (is_asleep(first, neighbors) && is_asleep(second, neighbors)) continue;
      find_contact(first, second, dt, neighbors, found[i]);
    }
  });
  contacts.clear();
  if (!tables()) pair_memory.begin(pairs.size());
  for (const FoundPair& pair : found) {
    if (!tables()) pair_memory.put(pair.key, pair.record);
    if (!pair.contact) continue;
    contacts.push_back(*pair.contact);
    contacts.insert(contacts.end(), pair.more.begin(), pair.more.end());
    for (const Participant p : {pair.contact->first, pair.contact->second})
      if (p >= 0) bodies[p].crowded = true;
  }
  if (!tables()) pair_memory.end();
}

// Static boxes and meshes: what nears one is solved with all that it touches.
void StatisticalLevel::Impl::find_ground_solids(double dt, bool of_near_only) {
  solid_contacts.clear();
  faces_below.clear();
  faces_of.clear();
  if (ground.solids.empty() || tables()) return;
  for (const std::int32_t slot : awake) {
    const std::size_t before = solid_contacts.size(), faces = faces_below.size();
    if (!of_near_only || near_another[std::size_t(slot)])
      find_solid_contacts(bodies[slot], kind_of(bodies[slot]), slot, ground.solids, dt, solid_contacts, faces_below);
    faces_of.emplace_back(faces, faces_below.size());
    if (solid_contacts.size() > before) bodies[slot].crowded = true;
  }
}

// No point of a body goes farther than its centre does plus R times the angle turned.
void StatisticalLevel::Impl::plan_travel(double dt) {
  const double fall = 0.5 * settings.gravity.norm() * dt * dt;
  for (const std::int32_t slot : awake) {
    const StatisticalBody& body = bodies[slot];
    const Shape& shape = *kind_of(body).shape;
    travels[slot].ahead = body.velocity.norm() * dt + fall + angular_velocity(body.orientation, body.spin, shape).norm() * shape.radius * dt;
    travels[slot].position = body.position;
    travels[slot].orientation = body.orientation;
  }
}

void StatisticalLevel::Impl::add_travel() {
  for (const std::int32_t slot : awake) {
    const StatisticalBody& body = bodies[slot];
    Travel& t = travels[slot];
    const double same = (body.orientation.coeffs() - t.orientation.coeffs()).squaredNorm();
    const double opposite = (body.orientation.coeffs() + t.orientation.coeffs()).squaredNorm();
    t.gone += (body.position - t.position).norm() + 2.2 * std::sqrt(std::min(same, opposite)) * kind_of(body).shape->radius;
    t.ahead = 0.0;
  }
}

// Both bodies of a pair respond by themselves and then move as if alone; pairs with full bodies keep the impulse that both share.
ContactTally StatisticalLevel::Impl::respond_pairs_as_paper() {
  ContactTally tally;
  std::erase_if(contacts, [&](const CrowdContact& c) {
    if (c.first < 0 || c.second < 0) return false;
    StatisticalBody &first = bodies[c.first], &second = bodies[c.second];
    const BodyKind &first_kind = kind_of(first), &second_kind = kind_of(second);
    respond_pair_as_paper(first, first_kind, second, second_kind, c.contact, world(), materials.law(first_kind.material, second_kind.material),
                          settings.tables, tally);
    first.crowded = second.crowded = false;
    return true;
  });
  return tally;
}

}  // namespace lodestone
