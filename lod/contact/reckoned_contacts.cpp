#include "lod/contact/reckoned_contacts.h"

#include <algorithm>

#include "lod/contact/hull_contacts.h"
#include "lod/contact/pair_contacts.h"

namespace lodestone {
namespace {

constexpr double kHeldUp = 0.002;  // over R: so near it is held up

void add_points(const PairContact& contact, const FullContact& between, const GroundPart* part,
                std::vector<FullContact>& contacts) {
  for (int i = 0; i < contact.manifold.count; ++i) {
    const ManifoldPoint& at = contact.manifold.points[std::size_t(i)];
    FullContact& added = contacts.emplace_back(between);
    added.point = at.point, added.normal = contact.normal, added.gap = at.gap;
    if (part) added.velocity = part->velocity_at(at.point), added.ground_material = part->material;
  }
}

PairBody pair_body_of(const FullNeighbor& body) {
  return {body.shape, body.state.position, body.state.orientation};
}

}  // namespace

void reckon_ground_contacts(const MetGround& ground, const FullNeighbor& body, std::int32_t index,
                            std::vector<FullContact>& contacts) {
  const Shape& shape = *body.shape;
  const double margin = kHeldUp * shape.radius;
  for (const HalfSpace& plane : ground.planes()) {
    const double height = plane.height_of(body.state.position);
    if (height > shape.radius + margin) continue;
    std::int32_t hint = 0;
    const HullContacts low =
        find_hull_contacts(shape, body.state.orientation, plane.normal, height, margin, hint);
    for (int i = 0; i < low.count; ++i)
      if (const HullContact& at = low.contact[std::size_t(i)]; at.gap < margin)
        contacts.push_back({.first = index,
                            .second = -1,
                            .point = body.state.position + at.arm,
                            .normal = plane.normal,
                            .gap = at.gap,
                            .ground_material = plane.material});
  }
  std::vector<const GroundPart*> parts;
  std::vector<PlacedSolid> near;
  ground.find_parts(body.state.position, shape.radius + margin, parts);
  for (const GroundPart* part : parts)
    find_solids(*part, body.state.position, shape.radius + margin, 0.0, near);
  for (const PlacedSolid& solid : near)
    if (const auto contact = find_hull_contact(
            pair_body_of(body), {solid.solid->shape.get(), solid.position, solid.orientation}, margin))
      add_points(*contact, {index, -1}, solid.part, contacts);
}

void reckon_pair_contacts(std::span<const FullNeighbor> bodies, std::int32_t first, std::int32_t second,
                          std::vector<FullContact>& contacts) {
  const FullNeighbor &a = bodies[std::size_t(first)], &b = bodies[std::size_t(second)];
  const double margin = kHeldUp * std::min(a.shape->radius, b.shape->radius);
  if (const auto contact = find_hull_contact(pair_body_of(a), pair_body_of(b), margin))
    add_points(*contact, {first, second}, nullptr, contacts);
}

}  // namespace lodestone
