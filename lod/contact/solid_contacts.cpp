#include "lod/contact/solid_contacts.h"

#include <algorithm>
#include <limits>

#include "lod/contact/faces_below.h"
#include "lod/contact/hull_contacts.h"
#include "lod/contact/solid_meeting.h"
#include "lod/contact/triangle_sieve.h"

namespace lodestone {
namespace {

constexpr double kTouching = 0.01;  // over R: near enough to carry, as between bodies
// Cosines, of 3 and 15°: so far triangles may turn from the mean slope that stands for them. What hulls rest
// on is off by a few millimetres then, and by some centimetres.
constexpr double kGentle = 0.999, kGentleToTables = 0.966;
constexpr std::size_t kMostProbed = 32;  // vertices of a body, by a ray each

// Whether the contact closes within `time`.
bool closes(const PairContact& contact, const GroundPart& part, const StatisticalBody& body,
            const Vec3& omega, double touching, double time) {
  const auto points = std::span(contact.manifold.points).first(std::size_t(contact.manifold.count));
  return std::ranges::any_of(points, [&](const ManifoldPoint& p) {
    const Vec3 velocity = body.velocity + omega.cross(p.point - body.position) - part.velocity_at(p.point);
    return p.gap + velocity.dot(contact.normal) * time <= touching;
  });
}

/// A body that looks for ground.
struct Seeker {
  const StatisticalBody& body;
  const Shape& shape;
  Vec3 omega;
  double touching = 0.0, way = 0.0;  // m
  std::int32_t slot = 0;
  double reach() const { return shape.radius + touching + way; }  // m
};

Seeker seeker_of(const StatisticalBody& body, const Shape& shape, std::int32_t slot, double time) {
  const Vec3 omega = angular_velocity(body.orientation, body.spin, shape);
  return {body,
          shape,
          omega,
          kTouching * shape.radius,
          (body.velocity.norm() + omega.norm() * shape.radius) * time,
          slot};
}

// Over uneven ground: the vertices of a hull that are less than `margin` over the plane below its centre, m,
// as any of them may be what touches. Of more than there is room for the lower ones.
std::span<const std::int32_t> find_low_vertices(const Seeker& s, const Vec3& normal, double height,
                                                double margin, std::int32_t lowest,
                                                std::span<std::int32_t> found) {
  const Vec3 own = s.body.orientation.conjugate() * normal;
  const double least = height + s.shape.hull.vertices[std::size_t(lowest)].dot(own);
  for (;; margin = least + 0.5 * (margin - least)) {
    const auto count = std::size_t(find_vertices_below(s.shape, own, height, margin, lowest, found));
    if (count < found.size() || margin - least < 1e-3 * s.shape.radius) return found.first(count);
  }
}

// Of a part that is known by rays alone: one from above each of the body's vertices that may carry it. Where
// they all meet one plane, it is that plane.
void find_probed_contacts(const Seeker& s, const GroundPart& part, double time,
                          std::vector<SolidContact>& found, std::vector<HalfSpace>& planes) {
  const Vec3 up = part.pose.orientation * part.shape.up;
  const double reach = s.reach();
  const auto hit_below = [&](const Vec3& point) {
    return part.shape.probe(point + reach * up, -up, 2.0 * reach);
  };
  const std::optional<GroundHit> below = hit_below(s.body.position);
  const Vec3 normal = below ? below->normal : up;
  std::int32_t hint = s.body.support_hint;
  const double height = below ? normal.dot(s.body.position - below->point) : 0.0,
               slack = 0.25 * s.shape.radius;  // as uneven as the ground may be there
  const HullContacts low = find_hull_contacts(s.shape, s.body.orientation, normal, height,
                                              below ? s.touching + s.way + slack : reach, hint);
  std::array<std::optional<GroundHit>, kMaxGroundContacts> hits;
  bool even = below.has_value();
  for (int i = 0; i < low.count; ++i) {
    hits[std::size_t(i)] = hit_below(s.body.position + low.contact[std::size_t(i)].arm);
    const auto& hit = hits[std::size_t(i)];
    even = even && hit && (hit->normal - normal).squaredNorm() < 1e-12 &&
           std::abs(normal.dot(hit->point - below->point)) < 1e-6 * s.shape.radius;
  }
  if (even && !part.moves())
    return planes.push_back({normal, normal.dot(below->point), part.material, part.id});
  const auto add = [&](const Vec3& arm, std::int32_t vertex, const std::optional<GroundHit>& hit) {
    if (!hit) return;
    const Vec3 point = s.body.position + arm;
    PairContact contact;
    contact.normal = hit->normal;
    contact.gap = hit->normal.dot(point - hit->point);
    contact.manifold.count = 1;
    contact.manifold.points[0] = {point, contact.gap};
    if (contact.gap > -s.shape.radius && closes(contact, part, s.body, s.omega, s.touching, time))
      found.push_back({s.slot, std::uint32_t(vertex + 1), part.material, &part, contact});
  };
  for (int i = 0; i < low.count; ++i)
    add(low.contact[std::size_t(i)].arm, low.contact[std::size_t(i)].vertex, hits[std::size_t(i)]);
  if (even || !below || low.count < 3) return;  // of two there are no more
  std::array<std::int32_t, kMostProbed> room;
  for (const std::int32_t vertex :
       find_low_vertices(s, normal, height, s.touching + s.way + slack, low.contact[0].vertex, room)) {
    const auto is_known = [&](const HullContact& c) { return c.vertex == vertex; };
    if (std::any_of(low.contact.begin(), low.contact.begin() + low.count, is_known)) continue;
    const Vec3 arm = s.body.orientation * s.shape.hull.vertices[std::size_t(vertex)];
    add(arm, vertex, hit_below(s.body.position + arm));
  }
}

// Whether two of them look against each other, so that what is between them is wedged in. A body that is
// moved over planes is lifted off one of them: there, into the other.
bool are_wedge(std::span<const HalfSpace> planes) {
  constexpr double kAgainst = 0.0;  // cosine, of a wedge of less than 90°
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (planes[i].normal.dot(planes[k].normal) < kAgainst) return true;
  return false;
}

// m; see meet_solid.
double find_height_over_triangles(std::span<const PlacedSolid> near, const Vec3& center) {
  double least = 1e300;
  for (const PlacedSolid& placed : near) {
    if (!placed.solid->surface) continue;
    const SurfaceTriangle& t = *placed.solid->surface;
    const Vec3 at = in_part(placed, center);
    const double height = t.normal.dot(at - t.corner[0]);
    if (height >= 0.0 && height < least && is_over(t, at)) least = height;
  }
  return least;
}

}  // namespace

void find_ground_near(const Ground& ground, const Vec3& center, double reach, double after,
                      std::vector<GroundNear>& found, const PairBody* hull) {
  thread_local std::vector<const GroundPart*> parts;
  thread_local std::vector<PlacedSolid> near;
  thread_local std::vector<Nearest> planes;
  parts.clear();
  ground.find_parts(center, reach, parts);
  for (const GroundPart* part : parts) {
    if (const auto plane = probe_below(*part, center, reach))
      found.push_back({plane->normal, plane->height_of(center), part, part->first_number});
    near.clear();
    find_solids(*part, center, reach, after, near);
    const auto in_solid = [&](const PlacedSolid& placed) {
      return Vec3(placed.orientation.conjugate() * (center - placed.position));
    };
    const std::size_t before = found.size();
    for (const PlacedSolid& placed : near) {
      const auto nearest = find_nearest(*placed.solid, in_solid(placed));
      if (!nearest || std::abs(nearest->height) >= reach) continue;
      planes.clear();
      if (hull)
        find_planes_to_hull(*hull, placed, *nearest, planes);
      else
        planes.push_back(*nearest);
      for (const Nearest& plane : planes)
        found.push_back(
            {placed.orientation * plane.normal, plane.height, part, placed.number, plane.at_edge});
    }
    if (found.size() > before) continue;
    std::optional<GroundNear> beyond;
    for (const PlacedSolid& placed : near) {
      const auto nearest = find_nearest_beyond(*placed.solid, in_solid(placed));
      if (nearest && nearest->height < (beyond ? beyond->height : reach))
        beyond = {placed.orientation * nearest->normal, nearest->height, part, placed.number, true};
    }
    if (beyond) found.push_back(*beyond);
  }
}

bool is_held_several_ways(std::span<const GroundNear> near, std::span<const HalfSpace> planes,
                          const Vec3& center, double reach) {
  constexpr double kSameWay = 0.99;  // cosine
  const Vec3* one = nullptr;
  const auto holds_another_way = [&](const Vec3& normal, double height) {
    if (height > reach) return false;
    if (!one) return one = &normal, false;
    return one->dot(normal) < kSameWay;
  };
  return std::ranges::any_of(near,
                             [&](const GroundNear& n) { return holds_another_way(n.normal, n.height); }) ||
         std::ranges::any_of(planes, [&](const HalfSpace& plane) {
           return holds_another_way(plane.normal, plane.height_of(center));
         });
}

std::span<const HalfSpace> join_planes(std::span<const HalfSpace> planes, std::span<const HalfSpace> faces) {
  if (faces.empty()) return planes;
  thread_local std::vector<HalfSpace> joined;
  joined.assign(planes.begin(), planes.end());
  joined.insert(joined.end(), faces.begin(), faces.end());
  return joined;
}

void find_sphere_contacts(const StatisticalBody& body, const BodyKind& kind, std::int32_t slot,
                          const Ground& ground, double after, double time, std::vector<SolidContact>& found,
                          std::vector<HalfSpace>& planes) {
  const double radius = double(body.sphere_radius), touching = kTouching * kind.shape->radius,
               reach = radius + touching + body.velocity.norm() * time;
  thread_local std::vector<GroundNear> near;
  near.clear();
  find_ground_near(ground, body.position, reach, after, near);
  const bool moves = std::ranges::any_of(near, [](const GroundNear& n) { return n.part->moves(); });
  if (!moves && !is_held_several_ways(near, ground.planes(), body.position, reach)) {
    for (const GroundNear& n : near) planes.push_back(n.plane(body.position));
    return;
  }
  for (const GroundNear& n : near) {
    PairContact contact;
    contact.normal = n.normal;
    contact.gap = n.height - radius;
    contact.manifold.count = 1;
    contact.manifold.points[0] = {body.position - n.height * n.normal, contact.gap};
    if (closes(contact, *n.part, body, Vec3::Zero(), touching, time))
      found.push_back({slot, n.number, n.part->material, n.part, contact});
  }
}

bool find_planes_below(const StatisticalBody& body, const BodyKind& kind, const Ground& ground, double slack,
                       double time, std::vector<HalfSpace>& planes) {
  const Seeker seeker = seeker_of(body, *kind.shape, 0, time);
  const double reach = seeker.reach() + slack;
  thread_local std::vector<const GroundPart*> parts;
  thread_local std::vector<PlacedSolid> near;
  thread_local std::vector<SolidContact> uneven;
  parts.clear(), near.clear(), uneven.clear();
  ground.find_parts(body.position, reach, parts);
  const std::size_t before = planes.size();
  const auto is_planes = [&](const GroundPart* part) {
    if (part->moves()) return false;
    if (part->shape.probe)
      find_probed_contacts(seeker, *part, time, uneven, planes);
    else
      find_solids(*part, body.position, reach, 0.0, near);
    return uneven.empty();
  };
  if (std::ranges::all_of(parts, is_planes)) {
    const std::optional<HalfSpace> mean = find_mean_plane(near, body.position, reach, kGentleToTables);
    if (mean) planes.push_back(*mean);
    if (mean || (find_faces_below(near, body.position, kind.shape->radius, reach, planes) &&
                 !are_wedge(std::span(planes).subspan(before))))
      return true;
  }
  planes.resize(before);
  return false;
}

void find_solid_contacts(const StatisticalBody& body, const BodyKind& kind, std::int32_t slot,
                         const Ground& ground, double after, double time, std::vector<SolidContact>& found,
                         std::vector<HalfSpace>& planes, SolidSearch wanted) {
  const Shape& shape = *kind.shape;
  const Seeker seeker = seeker_of(body, shape, slot, time);
  const double reach = seeker.reach();
  thread_local std::vector<const GroundPart*> parts;
  thread_local std::vector<PlacedSolid> near;
  parts.clear();
  near.clear();
  ground.find_parts(body.position, reach, parts);
  if (parts.empty()) return;
  bool any_moves = false;
  for (const GroundPart* part : parts) {
    any_moves |= part->moves();
    if (part->shape.probe)
      find_probed_contacts(seeker, *part, time, found, planes);
    else
      find_solids(*part, body.position, reach, after, near);
  }
  const std::size_t planes_before = planes.size();
  if (!any_moves && find_faces_below(near, body.position, shape.radius, reach, planes)) {
    if (!are_wedge(std::span(planes).subspan(planes_before))) return;
    planes.resize(planes_before);
  }
  if (!any_moves && is_smooth(near, body.position, reach))
    if (const auto mean = find_mean_plane(near, body.position, reach, kGentle))
      return planes.push_back(*mean);
  const PairBody self{&shape, body.position, body.orientation};
  thread_local HullContactSearch search;
  const double over = shape.sphere_radius ? find_height_over_triangles(near, body.position) : 1e300;
  std::optional<TriangleSieve> sieve;
  if (!shape.sphere_radius)
    sieve.emplace(self, SieveMotion{.velocity = body.velocity,
                                    .omega = seeker.omega,
                                    .touching = seeker.touching,
                                    .time = time,
                                    .margin = seeker.touching + seeker.way,
                                    .deepest = kDeepestBelow * shape.inner_radius});
  const std::size_t before = found.size();
  for (const PlacedSolid& solid : near) {
    // Those of one part stand together.
    if (wanted == SolidSearch::one_of_a_part && found.size() > before && found.back().part == solid.part)
      continue;
    if (sieve && solid.solid->surface && sieve->is_beyond(solid)) continue;
    meet_solid(self, solid, seeker.touching + seeker.way, search, over);
    for (const PairContact& contact : search.contacts)
      if (closes(contact, *solid.part, body, seeker.omega, seeker.touching, time))
        found.push_back({slot, solid.number, solid.part->material, solid.part, contact});
  }
}

}  // namespace lodestone
