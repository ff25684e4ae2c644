#include "lod/contact/solid_contacts.h"

#include <algorithm>
#include <limits>

#include "lod/contact/faces_below.h"
#include "lod/contact/hull_contacts.h"

namespace lodestone {
namespace {

constexpr double kTouching = 0.01;  // over R: near enough to carry, as between bodies
// Cosines, of 3 and 15°: so far triangles may turn from the mean slope that stands for them. What hulls rest
// on is off by a few millimetres then, and by some centimetres.
constexpr double kGentle = 0.999, kGentleToTables = 0.966;
constexpr double kAhead = 0.25;           // over the inner radius
constexpr double kSteepestFeature = 0.7;  // cosine: from a triangle's normal to that of what stands out of it

PairBody pair_body(const PlacedSolid& placed) {
  return {placed.solid->shape.get(), placed.position, placed.orientation};
}

Vec3 middle_of(const Manifold& manifold) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < manifold.count; ++i) sum += manifold.points[i].point;
  return sum / manifold.count;
}

// The edge of the triangle that `point` is nearest to, or farthest beyond.
std::size_t nearest_edge(const SurfaceTriangle& t, const Vec3& point) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 inward = t.normal.cross(t.corner[(i + 1) % 3] - t.corner[i]).normalized();
    const double distance = inward.dot(point - t.corner[i]);
    if (distance < least) least = distance, nearest = i;
  }
  return nearest;
}

// A point that looks for the solid's nearest one.
const Shape& point_shape() {
  static const Shape point = [] {
    Shape shape;
    shape.sphere_radius = 0.0;
    return shape;
  }();
  return point;
}

/// Of a solid, what a point is nearest to: which way, how far (negative: inside).
struct Nearest {
  Vec3 normal;  ///< in the part's axes
  double height = 0.0;
};

// A point in the frame of the solid's shape. None behind the edge of a surface, where a neighbour is nearer.
std::optional<Nearest> find_nearest(const GroundSolid& solid, const Vec3& point) {
  if (solid.shape->sphere_radius)
    return Nearest{point.squaredNorm() > 0.0 ? Vec3(point.normalized()) : Vec3(Vec3::UnitZ()),
                   point.norm() - *solid.shape->sphere_radius};
  if (const auto& t = solid.surface) {
    const Vec3 at = point + solid.center;
    const double height = t->normal.dot(at - t->corner[0]);
    const std::size_t edge = nearest_edge(*t, at);
    const Vec3 &from = t->corner[edge], along = (t->corner[(edge + 1) % 3] - from).normalized();
    if (t->normal.cross(along).dot(at - from) >= 0.0) return Nearest{t->normal, height};
    if (!t->ridge[edge] || height < 0.0) return {};
  }
  const SolidFace* highest = nullptr;
  double most = -1e300;
  for (const SolidFace& face : solid.faces)
    if (const double height = face.normal.dot(point) - face.offset; height > most)
      most = height, highest = &face;
  const Vec3 foot = point - most * highest->normal;
  const double rounding = 1e-9 * solid.shape->radius;
  const bool over_face = std::ranges::all_of(
      solid.faces, [&](const SolidFace& face) { return face.normal.dot(foot) - face.offset <= rounding; });
  if (most <= 0.0 || over_face) return Nearest{highest->normal, most};
  const HullGap gap =
      find_hull_gap({point_shape(), point, Quat::Identity()}, {*solid.shape, Vec3::Zero(), Quat::Identity()},
                    {.normal = Vec3::Zero()}, 1e300);
  return Nearest{gap.normal, gap.gap};
}

/// How the lowest point of a body lies to a triangle, along its normal.
struct LowestPoint {
  double gap = 0.0;  ///< m
  bool is_over = false;
};

LowestPoint find_lowest_over(const PairBody& body, const PlacedSolid& placed, const Vec3& normal) {
  const SurfaceTriangle& t = *placed.solid->surface;
  const Vec3 own = body.orientation.conjugate() * -normal;
  std::int32_t hint = body.shape->sphere_radius ? -1 : std::int32_t(body.shape->support_map.find_start(own));
  const HullContact lowest = find_lowest_point(*body.shape, body.orientation, normal, 0.0, hint);
  const Vec3 point = in_part(placed, body.position + lowest.arm);
  bool is_over = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 inward = t.normal.cross(t.corner[(i + 1) % 3] - t.corner[i]);
    is_over = is_over && inward.dot(point - t.corner[i]) >= 0.0;
  }
  return {t.normal.dot(point - t.corner[0]), is_over};
}

// m, how far a body reaches from its centre of mass along `direction` (unit, world).
double find_extent(const PairBody& body, const Vec3& direction) {
  std::int32_t hint = 0;
  if (!body.shape->sphere_radius)
    hint = std::int32_t(body.shape->support_map.find_start(body.orientation.conjugate() * direction));
  return find_lowest_point(*body.shape, body.orientation, -direction, 0.0, hint).arm.dot(direction);
}

// From the nearest edge of a triangle to a point, in its part's axes; zero: the point lies in it.
Vec3 find_way_from_edges(const SurfaceTriangle& t, const Vec3& point) {
  Vec3 way = Vec3::Zero();
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 from = point - t.corner[i], along = t.corner[(i + 1) % 3] - t.corner[i];
    const Vec3 to = from - std::clamp(from.dot(along) / along.squaredNorm(), 0.0, 1.0) * along;
    if (to.squaredNorm() < least) least = to.squaredNorm(), way = to;
  }
  return way;
}

// An axis along which the two are nearly as far apart as along any, world, unit: where a search for that one
// begins. Of a few: from the nearest point of the solid to the body's centre, and across each face that this
// lies over, as an overhanging body is nearer to an edge than to the face that it lies on. Zero: there is
// none.
Vec3 find_start_axis(const PairBody& body, const PlacedSolid& placed) {
  if (placed.solid->surface) {
    const Vec3 way = find_way_from_edges(*placed.solid->surface, in_part(placed, body.position));
    return way.isZero(0.0) ? Vec3(Vec3::Zero()) : Vec3(placed.orientation * way.normalized());
  }
  const Vec3 center = placed.orientation.conjugate() * (body.position - placed.position);
  Vec3 axis = Vec3::Zero();
  double greatest = -std::numeric_limits<double>::max();  // m, gap
  const auto look_along = [&](const Vec3& normal, double height) {
    const Vec3 along = placed.orientation * normal;
    const double gap = height - find_extent(body, -along);
    if (gap > greatest) greatest = gap, axis = along;
  };
  if (const auto nearest = find_nearest(*placed.solid, center)) look_along(nearest->normal, nearest->height);
  constexpr std::size_t kFewFaces = 12;
  if (placed.solid->faces.size() <= kFewFaces)
    for (const SolidFace& face : placed.solid->faces)
      if (const double height = face.normal.dot(center) - face.offset; height > 0.0)
        look_along(face.normal, height);
  return axis;
}

std::optional<PairContact> meet(const PairBody& body, const PlacedSolid& placed, double margin) {
  const PairBody ground = pair_body(placed);
  // Not those of a thin body's other side.
  const double ahead = std::min(margin, kAhead * body.shape->inner_radius);
  const auto find_anyhow = [&] {
    return find_hull_contact(body, ground, margin, ahead, find_start_axis(body, placed));
  };
  if (!placed.solid->surface) return find_anyhow();
  const SurfaceTriangle& t = *placed.solid->surface;
  const Vec3 normal = placed.orientation * t.normal;
  const LowestPoint lowest = find_lowest_over(body, placed, normal);
  if (lowest.gap > margin) return {};
  // What is over the triangle is nearest to it along its normal.
  if (lowest.is_over && lowest.gap > -kAhead * body.shape->inner_radius)
    return find_contact_along(body, ground, normal, margin, ahead);
  const std::optional<PairContact> contact = find_anyhow();
  if (!contact) return {};
  const double along = contact->normal.dot(normal);
  const bool over_ridge =
      along > 0.0 && along < 0.999 && t.ridge[nearest_edge(t, in_part(placed, middle_of(contact->manifold)))];
  if (over_ridge) return contact;
  std::optional<PairContact> flat = find_contact_along(body, ground, normal, margin, ahead);
  // What straddles a hill top is lowest, along each triangle's normal, over another: its own features hold
  // it.
  if (!flat && along > kSteepestFeature) return contact;
  return flat;
}

// A concave body of few faces meets what is convex in its pieces.
void find_contacts(const PairBody& body, const PlacedSolid& placed, double margin,
                   HullContactSearch& search) {
  search.contacts.clear();
  if (body.shape->pieces.empty() || placed.solid->surface) {
    if (const auto contact = meet(body, placed, margin)) search.contacts.push_back(*contact);
    return;
  }
  HullGap whole = {.normal = find_start_axis(body, placed)};
  thread_local std::vector<KnownGap> of_pieces;
  of_pieces.clear();
  for (const Shape& piece : body.shape->pieces) {
    const Vec3 center = body.position + body.orientation * piece.center_of_mass_in_mesh;
    of_pieces.emplace_back().axis.normal = find_start_axis({&piece, center, body.orientation}, placed);
  }
  find_pair_contacts(body, pair_body(placed), whole, of_pieces, margin, search);
}

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
  for (int i = 0; i < low.count; ++i) {
    const auto& hit = hits[std::size_t(i)];
    if (!hit) continue;
    const Vec3 point = s.body.position + low.contact[std::size_t(i)].arm;
    PairContact contact;
    contact.normal = hit->normal;
    contact.gap = hit->normal.dot(point - hit->point);
    contact.manifold.count = 1;
    contact.manifold.points[0] = {point, contact.gap};
    if (contact.gap > -s.shape.radius && closes(contact, part, s.body, s.omega, s.touching, time))
      found.push_back(
          {s.slot, std::uint32_t(low.contact[std::size_t(i)].vertex + 1), part.material, &part, contact});
  }
}

}  // namespace

void find_ground_near(const Ground& ground, const Vec3& center, double reach, double after,
                      std::vector<GroundNear>& found) {
  thread_local std::vector<const GroundPart*> parts;
  thread_local std::vector<PlacedSolid> near;
  parts.clear();
  ground.find_parts(center, reach, parts);
  for (const GroundPart* part : parts) {
    if (const auto plane = probe_below(*part, center, reach))
      found.push_back({plane->normal, plane->height_of(center), part, part->first_number});
    near.clear();
    find_solids(*part, center, reach, after, near);
    for (const PlacedSolid& placed : near)
      if (const auto nearest =
              find_nearest(*placed.solid, placed.orientation.conjugate() * (center - placed.position));
          nearest && std::abs(nearest->height) < reach)
        found.push_back({placed.orientation * nearest->normal, nearest->height, part, placed.number});
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
    if (mean || find_faces_below(near, body.position, kind.shape->radius, reach, planes)) return true;
  }
  planes.resize(before);
  return false;
}

void find_solid_contacts(const StatisticalBody& body, const BodyKind& kind, std::int32_t slot,
                         const Ground& ground, double after, double time, std::vector<SolidContact>& found,
                         std::vector<HalfSpace>& planes) {
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
  if (!any_moves && find_faces_below(near, body.position, shape.radius, reach, planes)) return;
  if (!any_moves && is_smooth(near, body.position, reach))
    if (const auto mean = find_mean_plane(near, body.position, reach, kGentle))
      return planes.push_back(*mean);
  const PairBody self{&shape, body.position, body.orientation};
  thread_local HullContactSearch search;
  for (const PlacedSolid& solid : near) {
    find_contacts(self, solid, seeker.touching + seeker.way, search);
    for (const PairContact& contact : search.contacts)
      if (closes(contact, *solid.part, body, seeker.omega, seeker.touching, time))
        found.push_back({slot, solid.number, solid.part->material, solid.part, contact});
  }
}

}  // namespace lodestone
