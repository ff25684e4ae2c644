#include "lod/contact/solid_search.h"

#include <algorithm>
#include <array>

#include "lod/contact/faces_below.h"
#include "lod/contact/hull_contacts.h"
#include "lod/contact/solid_meeting.h"

namespace lodestone {
namespace {

// Cosine, of 3°: so far triangles may turn from the mean slope that stands for them. What hulls rest on is
// off by a few millimetres then.
constexpr double kGentle = 0.999;
constexpr std::size_t kMostProbed = 32;  // vertices of a body, by a ray each

// Over uneven ground: the vertices of a hull that are less than `margin` over the plane below its centre, m,
// as any of them may be what touches. Of more than there is room for the lower ones.
std::span<const std::int32_t> find_low_vertices(const GroundSeeker& s, const Vec3& normal, double height,
                                                double margin, std::int32_t lowest,
                                                std::span<std::int32_t> found) {
  const Vec3 own = s.body.orientation.conjugate() * normal;
  const double least = height + s.shape.hull.vertices[std::size_t(lowest)].dot(own);
  for (;; margin = least + 0.5 * (margin - least)) {
    const auto count = std::size_t(find_vertices_below(s.shape, own, height, margin, lowest, found));
    if (count < found.size() || margin - least < 1e-3 * s.shape.radius) return found.first(count);
  }
}

}  // namespace

GroundSeeker seeker_of(const StatisticalBody& body, const Shape& shape, std::int32_t slot, double time) {
  constexpr double kTouching = 0.01;  // over R: near enough to carry, as between bodies
  const Vec3 omega = angular_velocity(body.orientation, body.spin, shape);
  return {body,
          shape,
          omega,
          kTouching * shape.radius,
          (body.velocity.norm() + omega.norm() * shape.radius) * time,
          slot};
}

bool closes(const PairContact& contact, const GroundPart& part, const GroundSeeker& seeker, double time) {
  const auto points = std::span(contact.manifold.points).first(std::size_t(contact.manifold.count));
  return std::ranges::any_of(points, [&](const ManifoldPoint& p) {
    const Vec3 velocity = seeker.velocity_at(p.point) - part.velocity_at(p.point);
    return p.gap + velocity.dot(contact.normal) * time <= seeker.touching;
  });
}

void find_probed_contacts(const GroundSeeker& s, const GroundPart& part, double time,
                          std::vector<SolidContact>& found, std::vector<HalfSpace>& planes) {
  const Vec3 up = part.pose.orientation * part.shape.up;
  const double reach = s.reach();
  const auto hit_below = [&](const Vec3& point) {
    return part.shape.probe(point + reach * up, -up, 2.0 * reach);
  };
  const Vec3 ahead = s.shape.sphere_radius ? s.half_way(time) : Vec3(Vec3::Zero());
  const std::optional<GroundHit> below = hit_below(s.body.position + ahead);
  const Vec3 normal = below ? below->normal : up;
  std::int32_t hint = s.body.support_hint;
  const double height = below ? normal.dot(s.body.position - below->point) : 0.0,
               slack = 0.25 * s.shape.radius;  // as uneven as the ground may be there
  const HullContacts low = find_hull_contacts(s.shape, s.body.orientation, normal, height,
                                              below ? s.touching + s.way + slack : reach, hint);
  std::array<std::optional<GroundHit>, kMaxGroundContacts> hits;
  bool even = below.has_value();
  for (int i = 0; i < low.count; ++i) {
    hits[std::size_t(i)] = hit_below(s.body.position + low.contact[std::size_t(i)].arm + ahead);
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
    if (contact.gap > -s.shape.radius && closes(contact, part, s, time))
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

bool are_wedge(std::span<const HalfSpace> planes) {
  constexpr double kAgainst = 0.0;  // cosine, of a wedge of less than 90°
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (planes[i].normal.dot(planes[k].normal) < kAgainst) return true;
  return false;
}

bool find_uneven_ground(const GroundSeeker& seeker, const MetGround& ground, double after, double time,
                        std::vector<PlacedSolid>& near, std::vector<SolidContact>& found,
                        std::vector<HalfSpace>& planes) {
  const Vec3& center = seeker.body.position;
  const double reach = seeker.reach();
  thread_local std::vector<const GroundPart*> parts;
  parts.clear();
  ground.find_parts(center, reach, parts);
  if (parts.empty()) return false;
  bool any_moves = false;
  for (const GroundPart* part : parts) {
    any_moves |= part->moves();
    if (part->shape.probe)
      find_probed_contacts(seeker, *part, time, found, planes);
    else
      find_solids(*part, center, reach, after, near);
  }
  if (any_moves) return true;
  const std::size_t before = planes.size();
  if (find_faces_below(near, center, seeker.shape.radius, reach, planes)) {
    if (!are_wedge(std::span(planes).subspan(before))) return false;
    planes.resize(before);
  }
  if (!is_smooth(near, center, reach)) return true;
  const auto mean = find_plane_half_way(seeker, near, reach, kGentle, time);
  if (mean) planes.push_back(*mean);
  return !mean;
}

std::optional<HalfSpace> find_plane_half_way(const GroundSeeker& seeker, std::span<const PlacedSolid> near,
                                             double reach, double least_cosine, double time) {
  const auto mean = find_mean_plane(near, seeker.body.position, reach, least_cosine);
  if (!mean) return {};
  constexpr double kNear = 1e-3;  // over the reach: the same plane
  const Vec3 ahead = seeker.half_way(time), along = ahead - ahead.dot(mean->normal) * mean->normal;
  if (along.norm() < kNear * reach) return mean;
  return find_mean_plane(near, seeker.body.position + along, reach, least_cosine);
}

std::optional<TriangleSieve> sieve_of(const GroundSeeker& seeker, double time) {
  if (seeker.shape.sphere_radius) return {};
  return TriangleSieve({&seeker.shape, seeker.body.position, seeker.body.orientation},
                       {.velocity = seeker.body.velocity,
                        .omega = seeker.omega,
                        .touching = seeker.touching,
                        .time = time,
                        .margin = seeker.touching + seeker.way,
                        .deepest = kDeepestBelow * seeker.shape.inner_radius});
}

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

}  // namespace lodestone
