#include "lod/contact/solid_contacts.h"

#include <algorithm>
#include <limits>

#include "lod/contact/faces_below.h"
#include "lod/contact/hull_contacts.h"
#include "lod/contact/near_faces.h"
#include "lod/contact/solid_meeting.h"
#include "lod/contact/solid_search.h"

namespace lodestone {
namespace {

// Cosine, of 10°: so far triangles may turn from the mean slope that stands for them at `tables`. What hulls
// rest on is off by some centimetres then.
constexpr double kGentleToTables = 0.985;

// Whichever way it turns and whatever of it comes near then.
bool may_close(const PairContact& contact, const GroundPart& part, const GroundSeeker& seeker, double time) {
  const Vec3& center = seeker.body.position;
  const double approach = (part.velocity_at(center) - seeker.body.velocity).dot(contact.normal),
               turn = (seeker.omega - part.pose.angular_velocity).norm() * seeker.shape.radius;
  return contact.gap <= seeker.touching + std::max(0.0, approach + turn) * time;
}

// Whether `point` lies in the `face` of a solid that `center` is over.
bool lies_in_face(const PlacedSolid& placed, const Nearest& face, const Vec3& point, const Vec3& center,
                  double rounding) {
  const Vec3 at = placed.orientation.conjugate() * (point - placed.position),
             over = placed.orientation.conjugate() * (center - point);
  if (std::abs(face.height - over.dot(face.normal)) > rounding) return false;
  if (const auto& t = placed.solid->surface) return is_over(*t, at + placed.solid->center, rounding);
  return std::ranges::all_of(placed.solid->faces,
                             [&](const SolidFace& f) { return f.normal.dot(at) - f.offset <= rounding; });
}

// Whether an edge of a solid lies in a face of another that `center` is over: a seam, which whoever is over
// that face meets first, and would trip over.
bool is_seam(const Vec3& edge, std::span<const PlacedSolid> near,
             std::span<const std::optional<Nearest>> nearest, std::span<const HalfSpace> planes,
             const Vec3& center, double reach) {
  constexpr double kFlush = 0.01;  // over the reach
  const double rounding = kFlush * reach;
  for (std::size_t i = 0; i < near.size(); ++i) {
    const auto& face = nearest[i];
    if (!face || face->at_edge || face->height < 0.0 || face->height >= reach) continue;
    if (lies_in_face(near[i], *face, edge, center, rounding)) return true;
  }
  return std::ranges::any_of(
      planes, [&](const HalfSpace& plane) { return std::abs(plane.height_of(edge)) <= rounding; });
}

// In place of contacts with edges and faces that another solid covers those with the faces beside them.
void meet_uncovered(const PairBody& body, const PlacedSolid& solid, double margin, NearFaces& faces,
                    std::vector<PairContact>& contacts) {
  if (faces.solids().size() < 2) return;
  thread_local std::vector<Vec3> ways;
  ways.clear();
  std::erase_if(contacts, [&](const PairContact& contact) {
    std::optional<Vec3> way;
    for (const ManifoldPoint& p :
         std::span(contact.manifold.points).first(std::size_t(contact.manifold.count))) {
      const auto uncovered =
          faces.find_uncovered(solid, p.point - 0.5 * p.gap * contact.normal, contact.normal);
      if (uncovered == contact.normal) return false;
      if (uncovered) way = uncovered;
    }
    if (way && std::ranges::find(ways, *way) == ways.end()) ways.push_back(*way);
    return true;
  });
  for (const Vec3& way : ways) meet_along(body, solid, way, margin, contacts);
}

// With the face of a solid that the body lies over wholly, without a search among hulls. None near its edges.
std::optional<PairContact> meet_face_below(const GroundSeeker& seeker, const PlacedSolid& solid) {
  const StatisticalBody& body = seeker.body;
  const auto face = find_face_below(solid, body.position, seeker.reach());
  if (!face) return {};
  std::int32_t hint = body.support_hint;
  const HullContact lowest =
      find_lowest_point(seeker.shape, body.orientation, face->normal, face->height_of(body.position), hint);
  PairContact contact;
  contact.normal = face->normal, contact.gap = lowest.gap;
  contact.manifold.count = 1;
  contact.manifold.points[0] = {body.position + lowest.arm - 0.5 * lowest.gap * face->normal, lowest.gap};
  return contact;
}

// Across such triangles a hull lies on their edges: no one of them holds it.
bool is_small_beside(const SurfaceTriangle& triangle, double radius) {
  constexpr double kLongest = 3.0;  // over the radius, of an edge
  const auto& [a, b, c] = triangle.corner;
  return std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}) <= kLongest * radius;
}

}  // namespace

void find_ground_near(const MetGround& ground, const Vec3& center, double reach, double after,
                      std::vector<GroundNear>& found, const PairBody* hull, Seams seams) {
  thread_local std::vector<const GroundPart*> parts;
  thread_local std::vector<PlacedSolid> near;
  thread_local std::vector<std::optional<Nearest>> nearest;  // of each
  thread_local std::vector<Nearest> planes;
  parts.clear(), near.clear(), nearest.clear();
  ground.find_parts(center, reach, parts);
  for (const GroundPart* part : parts) find_solids(*part, center, reach, after, near);
  const auto in_solid = [&](const PlacedSolid& placed) {
    return Vec3(placed.orientation.conjugate() * (center - placed.position));
  };
  for (const PlacedSolid& placed : near) nearest.push_back(find_nearest(*placed.solid, in_solid(placed)));
  const auto add = [&](std::size_t i) {
    const PlacedSolid& placed = near[i];
    planes.clear();
    if (hull)
      find_planes_to_hull(*hull, placed, *nearest[i], planes);
    else
      planes.push_back(*nearest[i]);
    for (const Nearest& plane : planes)
      found.push_back(
          {placed.orientation * plane.normal, plane.height, placed.part, placed.number, plane.at_edge});
  };
  std::size_t i = 0;
  for (const GroundPart* part : parts) {
    if (const auto plane = probe_below(*part, center, reach))
      found.push_back({plane->normal, plane->height_of(center), part, part->first_number});
    bool any = false;
    const std::size_t first = i;
    double least = reach;                 // m, height over what is taken
    std::optional<std::size_t> left_out;  // the nearest whose neighbour is nearer
    for (; i < near.size() && near[i].part == part; ++i) {
      const PlacedSolid& placed = near[i];
      if (!nearest[i] || std::abs(nearest[i]->height) >= reach) continue;
      any = true;
      const auto may_lie_on = [&] {
        return hull && placed.solid->surface && nearest[i]->height <= hull->shape->radius &&
               is_small_beside(*placed.solid->surface, hull->shape->radius);
      };
      if (seams == Seams::left_out && nearest[i]->at_edge && !may_lie_on()) {
        if (nearest[i]->beyond) {
          if (!left_out || nearest[i]->height < nearest[*left_out]->height) left_out = i;
          continue;
        }
        const Vec3 edge = center - nearest[i]->height * (placed.orientation * nearest[i]->normal);
        if (is_seam(edge, near, nearest, ground.planes(), center, reach)) continue;
      }
      least = std::min(least, nearest[i]->height);
      add(i);
    }
    // Over a corner each may have a neighbour that is nearer, round in a circle.
    if (left_out && nearest[*left_out]->height < least) add(*left_out);
    if (any) continue;
    std::optional<GroundNear> beyond;
    for (std::size_t k = first; k < i; ++k) {
      const auto met = find_nearest_beyond(*near[k].solid, in_solid(near[k]));
      if (met && met->height < (beyond ? beyond->height : reach))
        beyond = {near[k].orientation * met->normal, met->height, part, near[k].number, true};
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
                          const MetGround& ground, double after, double time,
                          std::vector<SolidContact>& found, std::vector<HalfSpace>& planes) {
  GroundSeeker seeker = seeker_of(body, *kind.shape, slot, time);
  seeker.omega.setZero();
  const double radius = double(body.sphere_radius),
               reach = radius + seeker.touching + body.velocity.norm() * time;
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
    if (closes(contact, *n.part, seeker, time))
      found.push_back({slot, n.number, n.part->material, n.part, contact});
  }
}

std::span<const SolidContact> first_run_of(std::span<const SolidContact> contacts) {
  const auto end =
      std::ranges::find_if(contacts, [&](const SolidContact& c) { return c.slot != contacts.front().slot; });
  return contacts.first(std::size_t(end - contacts.begin()));
}

namespace {

// Through the whole step of `dt` s.
bool goes_on_with(const GroundPart& part, const Vec3& velocity, double dt) {
  if (!part.moves()) return velocity.isZero(0.0);
  return !part.shape.probe && part.pose.angular_velocity.isZero(0.0) && part.pose.goes_on_s >= dt &&
         part.pose.velocity == velocity;
}

}  // namespace

std::optional<Vec3> find_velocity_of_ground(std::span<const SolidContact> of_body, double dt) {
  const Vec3& velocity = of_body.front().part->pose.velocity;
  const bool together = std::ranges::all_of(
      of_body, [&](const SolidContact& c) { return goes_on_with(*c.part, velocity, dt); });
  return together ? std::optional(velocity) : std::nullopt;
}

bool find_faces_going_along(const StatisticalBody& body, const BodyKind& kind, const MetGround& ground,
                            const Vec3& velocity, double time, std::vector<HalfSpace>& faces) {
  const GroundSeeker seeker = seeker_of(body, *kind.shape, 0, time);
  const double reach = seeker.reach();
  thread_local std::vector<const GroundPart*> parts;
  thread_local std::vector<PlacedSolid> near;
  parts.clear(), near.clear();
  ground.find_parts(body.position, reach, parts);
  const auto stands_still = [&](const HalfSpace& plane) { return plane.height_of(body.position) < reach; };
  if (!std::ranges::all_of(parts, [&](const GroundPart* p) { return goes_on_with(*p, velocity, time); }) ||
      std::ranges::any_of(ground.planes(), stands_still))
    return false;
  for (const GroundPart* part : parts) find_solids(*part, body.position, reach, 0.0, near);
  const std::size_t before = faces.size();
  if (!find_faces_below(near, body.position, kind.shape->radius, reach, faces)) return false;
  if (!are_wedge(std::span(faces).subspan(before))) return true;
  faces.resize(before);
  return false;
}

bool find_planes_below(const StatisticalBody& body, const BodyKind& kind, const MetGround& ground,
                       double slack, double time, std::vector<HalfSpace>& planes) {
  const GroundSeeker seeker = seeker_of(body, *kind.shape, 0, time);
  const double reach = seeker.reach() + slack, from_half_way = reach + seeker.half_way(time).norm();
  thread_local std::vector<const GroundPart*> parts;
  thread_local std::vector<PlacedSolid> near;
  thread_local std::vector<SolidContact> uneven;
  parts.clear(), near.clear(), uneven.clear();
  ground.find_parts(body.position, from_half_way, parts);
  const std::size_t before = planes.size();
  const auto is_planes = [&](const GroundPart* part) {
    if (part->moves()) return false;
    if (part->shape.probe)
      find_probed_contacts(seeker, *part, time, uneven, planes);
    else
      find_solids(*part, body.position, from_half_way, 0.0, near);
    return uneven.empty();
  };
  if (std::ranges::all_of(parts, is_planes)) {
    const std::optional<HalfSpace> mean = find_plane_half_way(seeker, near, reach, kGentleToTables, time);
    if (mean) planes.push_back(*mean);
    if (mean || (find_faces_below(near, body.position, kind.shape->radius, reach, planes) &&
                 !are_wedge(std::span(planes).subspan(before))))
      return true;
  }
  planes.resize(before);
  return false;
}

void find_solid_contacts(const StatisticalBody& body, const BodyKind& kind, std::int32_t slot,
                         const MetGround& ground, double after, double time, std::vector<SolidContact>& found,
                         std::vector<HalfSpace>& planes, SolidSearch wanted) {
  const Shape& shape = *kind.shape;
  const GroundSeeker seeker = seeker_of(body, shape, slot, time);
  thread_local std::vector<PlacedSolid> near;
  near.clear();
  if (!find_uneven_ground(seeker, ground, after, time, near, found, planes)) return;
  const PairBody self{&shape, body.position, body.orientation};
  thread_local HullContactSearch search;
  const double over = shape.sphere_radius ? find_height_over_triangles(near, body.position) : 1e300;
  std::optional<TriangleSieve> sieve = sieve_of(seeker, time);
  thread_local NearFaces faces;
  faces.take(near, body.position, shape.radius);
  const std::size_t before = found.size();
  for (const PlacedSolid& solid : near) {
    // Those of one part stand together.
    if (wanted == SolidSearch::one_of_a_part && found.size() > before && found.back().part == solid.part)
      continue;
    if (sieve && solid.solid->surface && sieve->is_beyond(solid)) continue;
    if (wanted == SolidSearch::one_of_a_part)
      if (const auto contact = meet_face_below(seeker, solid)) {
        if (may_close(*contact, *solid.part, seeker, time))
          found.push_back({slot, solid.number, solid.part->material, solid.part, *contact});
        continue;
      }
    meet_solid(self, solid, seeker.touching + seeker.way, search, over);
    if (search.contacts.empty()) continue;
    const Vec3 way = (body.velocity - solid.part->velocity_at(body.position)) * time;
    const auto passed = find_passed_face(self, solid, way, seeker.touching);
    if (wanted == SolidSearch::all)
      meet_uncovered(self, solid, seeker.touching + seeker.way, faces, search.contacts);
    if (passed && faces.find_uncovered(solid, passed->lowest, passed->normal))
      std::erase_if(search.contacts, [&](const PairContact& c) { return !passed->holds(c.normal); });
    for (const PairContact& contact : search.contacts)
      if (wanted == SolidSearch::one_of_a_part ? may_close(contact, *solid.part, seeker, time)
                                               : closes(contact, *solid.part, seeker, time))
        found.push_back({slot, solid.number, solid.part->material, solid.part, contact});
  }
}

}  // namespace lodestone
