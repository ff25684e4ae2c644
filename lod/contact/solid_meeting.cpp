#include "lod/contact/solid_meeting.h"

#include <algorithm>
#include <limits>

#include "lod/contact/faces_below.h"
#include "lod/contact/hull_contacts.h"

namespace lodestone {
namespace {

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

bool has_point_within(const Manifold& manifold, double gap) {
  return std::any_of(manifold.points.begin(), manifold.points.begin() + manifold.count,
                     [&](const ManifoldPoint& p) { return p.gap <= gap; });
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

// Whether what is met across an edge along `normal` (in the part's axes) is the triangle's: what is steeper
// than the triangle beyond the edge is met by that one.
bool stands_out(const SurfaceTriangle& t, std::size_t edge, const Vec3& normal) {
  constexpr double kRounding = 0.01;  // of a cosine
  return t.ridge[edge] && t.normal.dot(normal) >= t.cosine[edge] - kRounding;
}

// Whether a normal leads away from the edge itself: from a corner, where many triangles meet, it slants along
// it.
bool is_across(const SurfaceTriangle& t, std::size_t edge, const Vec3& normal) {
  constexpr double kSlant = 0.02;  // sine
  const Vec3 along = (t.corner[(edge + 1) % 3] - t.corner[edge]).normalized();
  return std::abs(along.dot(normal)) <= kSlant;
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

// From the centre of mass to the point farthest along `direction` (unit, world).
Vec3 find_farthest_arm(const PairBody& body, const Vec3& direction) {
  std::int32_t hint = -1;
  if (!body.shape->sphere_radius)
    hint = std::int32_t(body.shape->support_map.find_start(body.orientation.conjugate() * direction));
  return find_lowest_point(*body.shape, body.orientation, -direction, 0.0, hint).arm;
}

/// How the lowest point of a body lies to a triangle, along its normal.
struct LowestPoint {
  Vec3 place = Vec3::Zero();  ///< m, world
  double gap = 0.0;           ///< m
  bool is_over = false;
};

LowestPoint find_lowest_over(const PairBody& body, const PlacedSolid& placed, const Vec3& normal) {
  const SurfaceTriangle& t = *placed.solid->surface;
  const Vec3 place = body.position + find_farthest_arm(body, -normal), point = in_part(placed, place);
  return {place, t.normal.dot(point - t.corner[0]), is_over(t, point)};
}

// From the nearest edge of a triangle to a point, in its part's axes; zero: the point lies in it.
Vec3 find_way_from_edges(const SurfaceTriangle& t, const Vec3& point) {
  Vec3 way = Vec3::Zero();
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 to = find_way_from_edge(t, i, point);
    if (to.squaredNorm() < least) least = to.squaredNorm(), way = to;
  }
  return way;
}

// What keeps a body farthest from a solid, of `nearest`, which is of its centre, and the solid's faces that
// the centre lies over: what overhangs an edge lies on the face, though the edge is nearer.
Nearest find_farthest_apart(const PairBody& body, const PlacedSolid& placed, const Nearest& nearest) {
  constexpr std::size_t kFewFaces = 12;
  const Vec3 center = placed.orientation.conjugate() * (body.position - placed.position);
  const auto gap_along = [&](const Vec3& normal, double height) {
    const Vec3 along = placed.orientation * normal;
    return height - find_farthest_arm(body, -along).dot(-along);
  };
  Nearest best = nearest;
  if (placed.solid->faces.size() > kFewFaces) return best;
  double greatest = gap_along(nearest.normal, nearest.height);  // m
  for (const SolidFace& face : placed.solid->faces) {
    const double height = face.normal.dot(center) - face.offset;
    if (height <= 0.0) continue;
    const double gap = gap_along(face.normal, height);
    if (gap > greatest) greatest = gap, best.normal = face.normal, best.height = height;
  }
  return best;
}

// Whether a point lies straight above or below the face with this normal (in the part's axes).
bool is_over_face(const PlacedSolid& placed, const Vec3& normal, const Vec3& point) {
  constexpr double kSame = 0.999;  // cosine
  const GroundSolid& solid = *placed.solid;
  if (solid.surface)
    return solid.surface->normal.dot(normal) > kSame && is_over(*solid.surface, in_part(placed, point));
  if (solid.shape->sphere_radius) return true;
  const Vec3 at = placed.orientation.conjugate() * (point - placed.position);
  const auto face =
      std::ranges::max_element(solid.faces, {}, [&](const SolidFace& f) { return f.normal.dot(normal); });
  if (face == solid.faces.end() || face->normal.dot(normal) < kSame) return false;
  const Vec3 foot = at - (face->normal.dot(at) - face->offset) * face->normal;
  const double rounding = 1e-3 * solid.shape->radius;
  return std::ranges::all_of(solid.faces,
                             [&](const SolidFace& f) { return f.normal.dot(foot) - f.offset <= rounding; });
}

// An axis along which the two are nearly as far apart as along any, world, unit: where a search for that one
// begins. Zero: there is none.
Vec3 find_start_axis(const PairBody& body, const PlacedSolid& placed) {
  if (placed.solid->surface) {
    const Vec3 way = find_way_from_edges(*placed.solid->surface, in_part(placed, body.position));
    return way.isZero(0.0) ? Vec3(Vec3::Zero()) : Vec3(placed.orientation * way.normalized());
  }
  const auto nearest =
      find_nearest(*placed.solid, placed.orientation.conjugate() * (body.position - placed.position));
  if (!nearest) return Vec3::Zero();
  return placed.orientation * find_farthest_apart(body, placed, *nearest).normal;
}

PairContact contact_with_plane(const Vec3& normal, const LowestPoint& lowest) {
  PairContact contact{.normal = normal, .gap = lowest.gap, .manifold = {}};
  contact.manifold.count = 1;
  contact.manifold.points[0] = {lowest.place - 0.5 * lowest.gap * normal, lowest.gap};
  return contact;
}

std::optional<PairContact> meet(const PairBody& body, const PlacedSolid& placed, double margin,
                                double ball_is_over, MeetAhead how_far) {
  const PairBody ground = pair_body(placed);
  // Not those of a thin body's other side.
  const double ahead = how_far == MeetAhead::near ? std::min(margin, kAhead * body.shape->inner_radius) : 0.0;
  const auto meet_as_hulls = [&] {
    return find_hull_contact(body, ground, margin, ahead, find_start_axis(body, placed));
  };
  if (!placed.solid->surface) return meet_as_hulls();
  const SurfaceTriangle& t = *placed.solid->surface;
  const Vec3 normal = placed.orientation * t.normal;
  const LowestPoint lowest = find_lowest_over(body, placed, normal);
  if (lowest.gap > margin) return {};
  // What is over the triangle is nearest to it along its normal. What is far below it came another way: it
  // is beside it, or behind.
  const bool is_deep = lowest.gap <= -kDeepestBelow * body.shape->inner_radius;
  if (lowest.is_over && !is_deep) return find_contact_along(body, ground, normal, margin, ahead);
  std::optional<PairContact> flat;
  const auto find_flat = [&] {
    if (!is_deep) flat = find_contact_along(body, ground, normal, margin, ahead);
  };
  const bool any_ridge = std::ranges::find(t.ridge, true) != t.ridge.end();
  if (!any_ridge) {
    // Most of a fine surface: nearer than `margin` along the normal they are nearer anyhow, so that what they
    // meet along as hulls, which takes longest to find, does not matter.
    find_flat();
    if (flat && has_point_within(flat->manifold, margin)) return flat;
  }
  const std::optional<PairContact> contact = meet_as_hulls();
  if (!contact) return {};
  const double along = contact->normal.dot(normal);
  const std::size_t edge = nearest_edge(t, in_part(placed, middle_of(contact->manifold)));
  if (along > 0.0 && along < 0.999 && t.ridge[edge]) {
    if (stands_out(t, edge, placed.orientation.conjugate() * contact->normal)) return contact;
    // What flies on past its neighbour comes down on the triangle itself.
    if (contact->gap > 0.0 && lowest.gap > 0.0) return contact_with_plane(normal, lowest);
  }
  if (any_ridge) find_flat();
  // What straddles a hill top is lowest, along each triangle's normal, over another: its own features hold
  // it. Not so a ball in a hollow, which lies over a triangle that is nearer.
  const bool in_hollow =
      body.shape->sphere_radius && ball_is_over <= contact->gap + *body.shape->sphere_radius;
  if (!flat && along > kSteepestFeature && !in_hollow) return contact;
  return flat;
}

Nearest find_nearest_of_faces(const GroundSolid& solid, const Vec3& point) {
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
  return Nearest{gap.normal, gap.gap, true};
}

}  // namespace

std::optional<Nearest> find_nearest(const GroundSolid& solid, const Vec3& point) {
  if (solid.shape->sphere_radius)
    return Nearest{point.squaredNorm() > 0.0 ? Vec3(point.normalized()) : Vec3(Vec3::UnitZ()),
                   point.norm() - *solid.shape->sphere_radius};
  if (const auto& t = solid.surface) {
    const Vec3 at = point + solid.center;
    const double height = t->normal.dot(at - t->corner[0]);
    const std::size_t edge = nearest_edge(*t, at);
    const Vec3 &from = t->corner[edge], along = (t->corner[(edge + 1) % 3] - from).normalized();
    if (t->normal.cross(along).dot(at - from) >= 0.0)
      return is_behind(*t, at) ? std::nullopt : std::optional(Nearest{t->normal, height});
    if (!t->ridge[edge] || height < 0.0) return {};
    Nearest nearest = find_nearest_of_faces(solid, point);
    nearest.beyond = is_across(*t, edge, nearest.normal) && !stands_out(*t, edge, nearest.normal);
    return nearest;
  }
  return find_nearest_of_faces(solid, point);
}

std::optional<Nearest> find_nearest_beyond(const GroundSolid& solid, const Vec3& point) {
  const auto& t = solid.surface;
  if (!t || t->normal.dot(point + solid.center - t->corner[0]) < 0.0) return {};
  return find_nearest_of_faces(solid, point);
}

std::optional<PassedFace> find_passed_face(const PairBody& body, const PlacedSolid& placed, const Vec3& way,
                                           double touching) {
  constexpr std::size_t kMostFaces = 32;
  if (placed.solid->surface || placed.solid->faces.size() > kMostFaces) return {};
  const Vec3 center = placed.orientation.conjugate() * (body.position - placed.position);
  std::optional<PassedFace> passed;
  double most = -touching;  // m
  for (const SolidFace& face : placed.solid->faces) {
    const double height = face.normal.dot(center) - face.offset;
    if (height <= 0.0) continue;
    const Vec3 normal = placed.orientation * face.normal;
    const Vec3 arm = find_farthest_arm(body, -normal);
    const double gap = height + arm.dot(normal);
    if (const double least = std::min(gap, gap + way.dot(normal)); least >= most)
      most = least, passed = PassedFace{normal, gap, body.position + arm};
  }
  return passed;
}

void find_planes_to_hull(const PairBody& body, const PlacedSolid& placed, const Nearest& nearest,
                         std::vector<Nearest>& found) {
  constexpr double kOverlap = 0.01, kFlush = 0.05;  // over R: less of it may be the planes' own error
  const double most = kOverlap * body.shape->radius;
  const double flush = kFlush * body.shape->radius;
  const auto level = nearest.at_edge ? find_passed_face(body, placed, Vec3::Zero(), flush) : std::nullopt;
  if (level && level->gap <= flush) {
    const Vec3 arm = find_farthest_arm(body, -level->normal),
               normal = placed.orientation.conjugate() * level->normal;
    if (is_over_face(placed, normal, body.position + arm))
      found.push_back({normal, level->gap - arm.dot(level->normal), true});
    return;
  }
  const Nearest best = nearest.at_edge ? find_farthest_apart(body, placed, nearest) : nearest;
  const Vec3 along = placed.orientation * best.normal, arm = find_farthest_arm(body, -along);
  const Vec3 lowest = body.position + arm;
  if (best.height + arm.dot(along) >= -most || is_over_face(placed, best.normal, lowest))
    return found.push_back(best);
  // In a hollow it lies in a neighbour, which is no lower than this one's plane.
  if (const auto& t = placed.solid->surface; t && !best.at_edge) {
    const Vec3 at = in_part(placed, lowest);
    if (!t->ridge[nearest_edge(*t, at)]) return found.push_back(best);
  }
  thread_local HullContactSearch search;
  meet_solid(body, placed, most, search);
  for (const PairContact& contact : search.contacts)
    found.push_back({placed.orientation.conjugate() * contact.normal,
                     contact.gap - find_farthest_arm(body, -contact.normal).dot(contact.normal), true});
}

void meet_solid(const PairBody& body, const PlacedSolid& placed, double margin, HullContactSearch& search,
                double ball_is_over, MeetAhead ahead) {
  search.contacts.clear();
  if (body.shape->pieces.empty() || placed.solid->surface) {
    if (const auto contact = meet(body, placed, margin, ball_is_over, ahead))
      search.contacts.push_back(*contact);
    return;
  }
  HullGap whole = {.normal = find_start_axis(body, placed)};
  thread_local std::vector<KnownGap> of_pieces;
  of_pieces.clear();
  for (int piece = 0; piece < int(body.shape->pieces.size()); ++piece)
    of_pieces.emplace_back().axis.normal = find_start_axis(piece_of(body, piece), placed);
  find_pair_contacts(body, pair_body(placed), whole, of_pieces, margin, search);
}

void meet_along(const PairBody& body, const PlacedSolid& placed, const Vec3& normal, double margin,
                std::vector<PairContact>& found) {
  const PairBody ground = pair_body(placed);
  const auto meet_one = [&](const PairBody& convex) {
    if (const auto contact = find_contact_along(convex, ground, normal, margin)) found.push_back(*contact);
  };
  if (body.shape->pieces.empty()) return meet_one(body);
  for (int piece = 0; piece < int(body.shape->pieces.size()); ++piece) meet_one(piece_of(body, piece));
}

}  // namespace lodestone
