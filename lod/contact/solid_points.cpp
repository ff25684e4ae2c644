#include "lod/contact/solid_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lod/contact/faces_below.h"
#include "lod/contact/hull_contacts.h"
#include "lod/contact/solid_meeting.h"
#include "lod/contact/solid_search.h"

namespace lodestone {
namespace {

constexpr std::size_t kMostBelow = 256;  // vertices that may meet one plane; of more the outermost

/// A face of a solid, in the world.
struct Face {
  Vec3 normal;
  double offset;  // m
  double height_of(const Vec3& point) const { return normal.dot(point) - offset; }
};

/// What a search works in, kept from one to the next.
struct Work {
  std::vector<PlacedSolid> near;
  std::vector<SolidContact> probed;
  std::vector<Face> faces, walls;  // of the solid at hand; of a triangle the planes across its edges
  std::vector<bool> held;          // of each point
};

/// The points of one body, solid by solid.
class PointSearch {
 public:
  PointSearch(const GroundSeeker& seeker, double time, double margin, Work& work, SolidPoints& found)
      : seeker_(seeker),
        self_{&seeker.shape, seeker.body.position, seeker.body.orientation},
        sieve_(sieve_of(seeker, time)),
        time_(time),
        margin_(margin),
        hint_(seeker.body.support_hint),
        faces_(work.faces),
        walls_(work.walls),
        held_(work.held),
        found_(found),
        turn_(seeker.body.orientation.toRotationMatrix()) {}

  void meet(const PlacedSolid& solid, double ball_is_over);
  void add_probed(const SolidContact& contact);
  void drop_held();  ///< crossings in one plane, over several solids, that vertices hold on both sides

 private:
  void find_faces(const PlacedSolid& solid);
  bool is_over(const Vec3& point, const Face& face, double rounding = 1e-3) const;
  bool passes_its_end(const Vec3& point, double gap, const Vec3& way, const Face& face) const;
  bool is_out_of(const Vec3& point, std::size_t face) const;
  bool enters_last(const Vec3& point, const Vec3& way, const Face& face) const;
  void find_vertices_over(const PlacedSolid& solid, std::size_t face);
  void add_features(const PairContact& contact, const PlacedSolid& solid);
  bool is_held(const SolidPoint& crossing) const;
  void find_features(const PlacedSolid& solid, double ball_is_over);
  void add(std::int32_t vertex, const Vec3& point, const Vec3& normal, double gap, double least_gap,
           const PlacedSolid& solid, bool along_face = true) {
    found_.points.push_back({vertex,
                             point,
                             {normal, normal.dot(point) - gap, solid.part->material, solid.part->id},
                             least_gap,
                             along_face});
  }
  /// m, at the step's end, of a gap along `normal`.
  double gap_then(const Vec3& point, const Vec3& normal, double gap) const {
    return gap + seeker_.velocity_at(point).dot(normal) * time_;
  }

  const GroundSeeker& seeker_;
  PairBody self_;
  std::optional<TriangleSieve> sieve_;
  double time_, margin_;  // s, m
  std::int32_t hint_;
  std::vector<Face>&faces_, &walls_;
  std::vector<bool>& held_;
  SolidPoints& found_;
  Mat3 turn_;          // body axes to the world's
  double over_ = 0.0;  // m: how far the whole body is over one of the faces
  std::optional<PassedFace> passed_;
};

void PointSearch::find_faces(const PlacedSolid& solid) {
  faces_.clear(), walls_.clear();
  const auto add = [&](std::vector<Face>& to, const Vec3& normal, double offset) {
    const Vec3 outward = solid.orientation * normal;
    to.push_back({outward, offset + outward.dot(solid.position)});
  };
  const auto& t = solid.solid->surface;
  for (std::size_t i = 0; t && i < 3; ++i) {
    const Vec3 from = t->corner[i] - solid.solid->center,
               outward = (t->corner[(i + 1) % 3] - t->corner[i]).cross(t->normal).normalized();
    if (i == 0) add(faces_, t->normal, t->normal.dot(from));
    add(walls_, outward, outward.dot(from));
  }
  for (std::size_t i = 0; !t && i < solid.solid->faces.size(); ++i)
    add(faces_, solid.solid->faces[i].normal, solid.solid->faces[i].offset);
}

// Along the face's normal. `rounding`: over R.
bool PointSearch::is_over(const Vec3& point, const Face& face, double rounding) const {
  rounding *= seeker_.shape.radius;
  const auto is_within = [&](const Vec3& at) {
    return [&, rounding](const Face& f) { return f.height_of(at) <= rounding; };
  };
  if (!walls_.empty()) return std::ranges::all_of(walls_, is_within(point));
  return std::ranges::all_of(faces_, is_within(point - face.height_of(point) * face.normal));
}

// What is inside leaves through the face that is nearest.
bool PointSearch::is_out_of(const Vec3& point, std::size_t face) const {
  const double height = faces_[face].height_of(point);
  return height >= 0.0 ||
         std::ranges::all_of(faces_, [&](const Face& f) { return f.height_of(point) <= height; });
}

// Of the planes of several faces that a point is beyond, the one that it crosses last on its way into the
// solid.
bool PointSearch::enters_last(const Vec3& point, const Vec3& way, const Face& face) const {
  const double height = face.height_of(point), fall = -way.dot(face.normal);
  return !walls_.empty() || std::ranges::all_of(faces_, [&](const Face& other) {
    const double beside = other.height_of(point), nearing = -way.dot(other.normal);
    return beside <= 0.0 || beside * fall <= height * nearing;
  });
}

// Over the face now, but where it comes down no more: a corner that slides off an edge goes along the body's
// own face, which the edge is on, and would strike nothing.
bool PointSearch::passes_its_end(const Vec3& point, double gap, const Vec3& way, const Face& face) const {
  constexpr double kRounding = 1e-6;  // over R
  const double fall = -way.dot(face.normal);
  return gap > 0.0 && fall > gap && !is_over(point + gap / fall * way, face, kRounding);
}

// Vertices that lie over the face, now or at the step's end, and meet its plane.
void PointSearch::find_vertices_over(const PlacedSolid& solid, std::size_t face) {
  const Face& plane = faces_[face];
  const StatisticalBody& body = seeker_.body;
  const Shape& shape = seeker_.shape;
  const double height = plane.height_of(body.position);
  if (height < 0.0) return;
  const double drop = body.velocity.dot(plane.normal) * time_, fall = std::max(0.0, -drop),
               turn = plane.normal.cross(seeker_.omega).norm() * time_ * shape.radius, near = margin_ + fall,
               reach = near + fall + turn;
  const double deepest = kDeepestBelow * shape.inner_radius;
  const auto look_at = [&](std::int32_t vertex, const Vec3& point, double gap) {
    const Vec3 way = (shape.sphere_radius ? body.velocity : seeker_.velocity_at(point)) * time_;
    const double least = std::min(gap, gap + way.dot(plane.normal));
    if (least > near || gap < -deepest || !(passed_ || is_out_of(point, face))) return;
    const bool meets = is_over(point, plane)
                           ? !passes_its_end(point, gap, way, plane)
                           : is_over(point + way, plane) && (passed_ || enters_last(point, way, plane));
    if (!meets) return;
    add(vertex, point, plane.normal, gap, least, solid);
  };
  const HullContact lowest = find_lowest_point(shape, body.orientation, plane.normal, height, hint_);
  over_ = std::max(over_, lowest.gap);
  if (lowest.gap > reach) return;
  if (shape.sphere_radius) return look_at(-1, body.position + lowest.arm, lowest.gap);
  std::array<std::int32_t, kMostBelow> below;
  const Vec3 own = turn_.transpose() * plane.normal;
  const auto count = std::size_t(find_vertices_below(shape, own, height, reach, hint_, below));
  for (const std::int32_t vertex : std::span(below).first(count)) {
    const Vec3 point = body.position + turn_ * shape.hull.vertices[std::size_t(vertex)];
    look_at(vertex, point, plane.height_of(point));
  }
}

// Where its features touch those of the solid.
void PointSearch::find_features(const PlacedSolid& solid, double ball_is_over) {
  thread_local HullContactSearch search;
  const double margin = seeker_.touching + seeker_.way;
  if (over_ > margin) return;
  meet_solid(self_, solid, margin, search, ball_is_over, MeetAhead::nothing);
  for (const PairContact& contact : search.contacts) add_features(contact, solid);
}

// What is over one of the solid's faces wholly meets it along that, and passes over its edges; across one
// that it does not touch yet nothing holds it.
void PointSearch::add_features(const PairContact& contact, const PlacedSolid& solid) {
  constexpr double kSame = 0.999;  // cosine
  const Vec3& normal = contact.normal;
  const bool along_face =
      std::ranges::any_of(faces_, [&](const Face& f) { return f.normal.dot(normal) > kSame; });
  if (passed_ ? !passed_->holds(normal) : !along_face && over_ >= -seeker_.touching) return;
  for (int i = 0; i < contact.manifold.count; ++i) {
    const double gap = contact.manifold.points[std::size_t(i)].gap;
    const Vec3 point = contact.manifold.points[std::size_t(i)].point + 0.5 * gap * normal;  // the body's own
    const double then = gap_then(point, normal, gap);
    if (std::min(gap, then) > seeker_.touching) continue;
    if (along_face || gap <= seeker_.touching)
      add(-1, point, normal, gap, std::min(gap, then), solid, along_face);
    else
      found_.until = std::min(found_.until, time_ * gap / (gap - then));
  }
}

void PointSearch::meet(const PlacedSolid& solid, double ball_is_over) {
  if (sieve_ && solid.solid->surface && sieve_->is_beyond(solid)) return;
  find_faces(solid);
  over_ = -1e300;
  passed_ = find_passed_face(self_, solid, seeker_.body.velocity * time_, seeker_.touching);
  for (std::size_t face = 0; face < faces_.size(); ++face)
    if (!passed_ || passed_->holds(faces_[face].normal)) find_vertices_over(solid, face);
  find_features(solid, ball_is_over);
}

void PointSearch::add_probed(const SolidContact& contact) {
  const Manifold& manifold = contact.contact.manifold;
  for (int i = 0; i < manifold.count; ++i) {
    const auto& [point, gap] = manifold.points[std::size_t(i)];
    const Vec3& normal = contact.contact.normal;
    found_.points.push_back({std::int32_t(contact.number) - 1,
                             point,
                             {normal, normal.dot(point) - gap, contact.material, contact.part->id},
                             std::min(gap, gap_then(point, normal, gap))});
  }
}

bool PointSearch::is_held(const SolidPoint& crossing) const {
  constexpr double kSameWay = 0.9999;           // cosine
  constexpr double kSame = 1e-3, kNear = 0.03;  // over R
  if (crossing.vertex >= 0 || !crossing.along_face) return false;
  const double same = kSame * seeker_.shape.radius, near = kNear * seeker_.shape.radius;
  const Vec3 &normal = crossing.plane.normal, x = normal.unitOrthogonal(), y = normal.cross(x);
  std::array<double, kMostBelow> angle;
  std::size_t count = 0;
  for (const SolidPoint& p : found_.points) {
    if (p.vertex < 0 || p.plane.normal.dot(normal) < kSameWay ||
        std::abs(crossing.plane.height_of(p.point) - p.plane.height_of(p.point)) > same)
      continue;
    const Vec3 way = p.point - crossing.point;
    const double along = way.dot(x), across = way.dot(y);
    if (along * along + across * across < near * near) return true;
    if (count < angle.size()) angle[count++] = std::atan2(across, along);
  }
  if (count < 2) return false;
  std::ranges::sort(std::span(angle).first(count));
  double widest = angle[0] + 2.0 * std::numbers::pi - angle[count - 1];
  for (std::size_t i = 1; i < count; ++i) widest = std::max(widest, angle[i] - angle[i - 1]);
  return widest < std::numbers::pi + 0.1;
}

void PointSearch::drop_held() {
  held_.clear();
  for (const SolidPoint& p : found_.points) held_.push_back(is_held(p));
  std::size_t i = 0;
  std::erase_if(found_.points, [&](const SolidPoint&) { return held_[i++]; });
}

}  // namespace

void find_solid_points(const StatisticalBody& body, const BodyKind& kind, const MetGround& ground,
                       double time, double margin, SolidPoints& found) {
  thread_local Work work;
  work.near.clear(), work.probed.clear();
  found.points.clear(), found.planes.clear();
  found.until = time;
  const GroundSeeker seeker = seeker_of(body, *kind.shape, 0, time);
  const bool uneven = find_uneven_ground(seeker, ground, 0.0, time, work.near, work.probed, found.planes);
  PointSearch search(seeker, time, margin, work, found);
  for (const SolidContact& contact : work.probed) search.add_probed(contact);
  if (uneven) {
    const double over =
        kind.shape->sphere_radius ? find_height_over_triangles(work.near, body.position) : 1e300;
    for (const PlacedSolid& solid : work.near) search.meet(solid, over);
    search.drop_held();
  }
  std::ranges::sort(found.points, {}, &SolidPoint::least_gap);
}

}  // namespace lodestone
