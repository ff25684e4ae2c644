#include "lod/rungs/blows.h"

#include <algorithm>
#include <limits>

namespace lodestone {
namespace {

constexpr double kOnGround = 1.01;  // over R: with its centre no higher, a body may touch the plane

double mass_of(const ContactScene& scene, Participant p) {
  if (scene.properties(p).kinematic) return std::numeric_limits<double>::infinity();
  return p.is_statistical() ? scene.body(p).mass : scene.neighbor(p).mass;
}

// The normal of the plane that is nearest, among those that it may touch.
Vec3 ground_under(const ContactScene& scene, Participant p) {
  Vec3 normal = Vec3::Zero();
  double least = kOnGround * scene.shape(p).radius;
  for (const HalfSpace& plane : scene.world.planes)
    if (const double height = plane.height_of(scene.position(p)); height < least)
      least = height, normal = plane.normal;
  return normal;
}

}  // namespace

std::int32_t Blows::number_of(const ContactScene& scene, const RestLaw& law, Participant p) {
  std::int32_t& number = (p.is_statistical() ? number_of_body_ : number_of_neighbor_)[p.index()];
  if (number >= 0) return number;
  participants_.push_back(p);
  return number = reach_.add_body({.mass = mass_of(scene, p),
                                   .wake_speed = law.wake_speed(scene.shape(p).radius),
                                   .asleep = scene.asleep(p),
                                   .ground = ground_under(scene, p)});
}

void Blows::find(const ContactScene& scene, const NearPairs& pairs, const RestLaw& law,
                 std::vector<Participant>& struck) {
  struck.clear();
  const std::span<const CrowdContact> contacts = pairs.contacts();
  if (std::ranges::none_of(
          contacts, [&](const CrowdContact& c) { return scene.asleep(c.first) || scene.asleep(c.second); }))
    return;
  number_of_body_.resize(std::max(number_of_body_.size(), scene.bodies.size()), -1);
  number_of_neighbor_.resize(std::max(number_of_neighbor_.size(), scene.neighbors.size()), -1);
  for (const CrowdContact& c : contacts) {
    const Vec3& normal = c.contact.normal;
    double closing = 0.0;
    for (const ManifoldPoint& p :
         std::span(c.contact.manifold.points).first(std::size_t(c.contact.manifold.count)))
      closing = std::max(closing, (pairs.point_velocity(scene, c.second, p.point) -
                                   pairs.point_velocity(scene, c.first, p.point))
                                      .dot(normal));
    reach_.add_contact(number_of(scene, law, c.first), number_of(scene, law, c.second), normal, closing,
                       scene.law(c.first, c.second).restitution);
  }
  for (const std::int32_t number : reach_.find()) struck.push_back(participants_[std::size_t(number)]);
  for (const Participant p : participants_)
    (p.is_statistical() ? number_of_body_ : number_of_neighbor_)[p.index()] = -1;
  participants_.clear();
  reach_.clear();
}

}  // namespace lodestone
