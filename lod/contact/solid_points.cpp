#include "lod/contact/solid_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lod/contact/faces_below.h"
#include "lod/contact/hull_contacts.h"
#include "lod/contact/near_faces.h"
#include "lod/contact/solid_meeting.h"
#include "lod/contact/solid_search.h"

namespace lodestone {
namespace {

constexpr std::size_t kMostBelow = 256;  // vertices that may meet one plane; of more the outermost

/// What a search works in, kept from one to the next.
struct Work {
  std::vector<PlacedSolid> near;
  std::vector<SolidContact> probed;
  NearFaces faces;
  std::vector<bool> held;  // of each point
  std::vector<std::size_t> bearing;
};

/// The points of one body, solid by solid.
class PointSearch {
 public:
  /// `planes`: of the ground, valid as long as this.
  PointSearch(const GroundSeeker& seeker, std::span<const HalfSpace> planes, double time, double margin,
              Work& work, SolidPoints& found)
      : seeker_(seeker),
        planes_(planes),
        self_{&seeker.shape, seeker.body.position, seeker.body.orientation},
        sieve_(sieve_of(seeker, time)),
        time_(time),
        margin_(margin),
        hint_(seeker.body.support_hint),
        near_(work.faces),
        held_(work.held),
        bearing_(work.bearing),
        found_(found),
        turn_(seeker.body.orientation.toRotationMatrix()) {}

  void meet(const PlacedSolid& solid, double ball_is_over);
  void add_probed(const SolidContact& contact);
  void drop_held();   ///< crossings in one plane, over several solids, that vertices hold on both sides
  void drop_inner();  ///< where many bear the body in one plane, those that lie within

 private:
  Vec3 way_along_what_carries(const Vec3& point, Vec3 way, const PlacedSolid& but) const;
  bool passes_its_end(const Vec3& point, double gap, const Vec3& way, const Face& face,
                      const PlacedSolid& solid) const;
  bool is_out_of(const Vec3& point, const Face& face, const PlacedSolid& solid) const;
  bool enters_last(const Vec3& point, const Vec3& way, const Face& face, const PlacedSolid& solid) const;
  void find_vertices_over(const PlacedSolid& solid, const Face& face);
  void add_features(const PairContact& contact, const PlacedSolid& solid);
  bool is_held(const SolidPoint& crossing) const;
  void find_features(const PlacedSolid& solid, double ball_is_over);
  void add(std::int32_t vertex, const Vec3& point, const Vec3& normal, double gap, double least_gap,
           const PlacedSolid& solid, bool along_face = true) {
    const HalfSpace plane{normal, normal.dot(point) - gap, solid.part->material, solid.part->id};
    if (seeker_.may_turn_into(plane, Vec3::Zero(), time_))
      found_.points.push_back({vertex, point, plane, least_gap, along_face});
  }
  /// m, at the step's end, of a gap along `normal`.
  double gap_then(const Vec3& point, const Vec3& normal, double gap) const {
    return gap + seeker_.velocity_at(point).dot(normal) * time_;
  }

  const GroundSeeker& seeker_;
  std::span<const HalfSpace> planes_;
  PairBody self_;
  std::optional<TriangleSieve> sieve_;
  double time_, margin_;  // s, m
  double nearly_ = 1e-3 * seeker_.shape.radius,
         rounding_ = 1e-6 * seeker_.shape.radius;  // m: over a face; of a point's place
  std::int32_t hint_;
  NearFaces& near_;
  std::vector<bool>& held_;
  std::vector<std::size_t>& bearing_;
  SolidPoints& found_;
  Mat3 turn_;          // body axes to the world's
  double over_ = 0.0;  // m: how far the whole body is over one of the faces
  std::optional<PassedFace> passed_;
};

// What is inside leaves through the face that is nearest, of those that no other solid covers.
bool PointSearch::is_out_of(const Vec3& point, const Face& face, const PlacedSolid& solid) const {
  const double height = face.height_of(point);
  return height >= 0.0 || std::ranges::all_of(near_.of(solid).faces, [&](const Face& f) {
           return f.height_of(point) <= height + nearly_ || near_.is_covered(solid, f, point);
         });
}

// Of the planes of several faces that a point is beyond, the one that it crosses last on its way into the
// solid.
bool PointSearch::enters_last(const Vec3& point, const Vec3& way, const Face& face,
                              const PlacedSolid& solid) const {
  const double height = face.height_of(point), fall = -way.dot(face.normal);
  const SolidFaces& own = near_.of(solid);
  return !own.walls.empty() || std::ranges::all_of(own.faces, [&](const Face& other) {
    const double beside = other.height_of(point), nearing = -way.dot(other.normal);
    return beside <= 0.0 || beside * fall <= height * nearing ||
           (beside <= nearing && near_.is_covered(solid, other, point + beside / nearing * way));
  });
}

// Gravity's kick would have a point go into what bears it.
Vec3 PointSearch::way_along_what_carries(const Vec3& point, Vec3 way, const PlacedSolid& but) const {
  const auto keep_out_of = [&](const auto& plane) {
    way -= std::min(0.0, way.dot(plane.normal)) * plane.normal;
  };
  const auto touches = [&](const auto& plane) { return std::abs(plane.height_of(point)) < seeker_.touching; };
  for (const HalfSpace& plane : planes_)
    if (touches(plane)) keep_out_of(plane);
  for (const PlacedSolid& other : near_.solids()) {
    if (&other == &but) continue;
    for (const Face& face : near_.of(other).faces)
      if (touches(face) && near_.of(other).are_under(point, face, nearly_)) keep_out_of(face);
  }
  return way;
}

// Over the face now, but where it comes down no more: a corner that slides off an edge goes along the body's
// own face, which the edge is on, and would strike nothing.
bool PointSearch::passes_its_end(const Vec3& point, double gap, const Vec3& way, const Face& face,
                                 const PlacedSolid& solid) const {
  const auto goes_past = [&](const Vec3& along) {
    const double fall = -along.dot(face.normal);
    if (fall <= gap) return false;
    const Vec3 foot = point - gap * face.normal, end = point + gap / fall * along;
    return std::ranges::any_of(near_.of(solid).bounds(), [&](const Face& beside) {
      return beside.height_of(end) > rounding_ + std::max(0.0, beside.height_of(foot));
    });
  };
  return gap > 0.0 && goes_past(way) && goes_past(way_along_what_carries(point, way, solid));
}

// Vertices that lie over the face, now or at the step's end, and meet its plane.
void PointSearch::find_vertices_over(const PlacedSolid& solid, const Face& plane) {
  const StatisticalBody& body = seeker_.body;
  const Shape& shape = seeker_.shape;
  const double height = plane.height_of(body.position);
  if (height < 0.0) return;
  const double drop = body.velocity.dot(plane.normal) * time_, fall = std::max(0.0, -drop),
               turn = plane.normal.cross(seeker_.omega).norm() * time_ * shape.radius, near = margin_ + fall,
               reach = near + fall + turn;
  const double deepest = kDeepestBelow * shape.inner_radius;
  const auto is_over = [&](const Vec3& point) { return near_.of(solid).are_under(point, plane, nearly_); };
  const auto meets = [&](const Vec3& point, double gap, const Vec3& way) {
    if (is_over(point)) return !passes_its_end(point, gap, way, plane, solid);
    return is_over(point + way) && (passed_ || enters_last(point, way, plane, solid));
  };
  const auto look_at = [&](std::int32_t vertex, const Vec3& point, double gap) {
    const Vec3 way = (shape.sphere_radius ? body.velocity : seeker_.velocity_at(point)) * time_;
    const double then = gap + way.dot(plane.normal), least = std::min(gap, then);
    if (least > near || gap < -deepest || !(passed_ || is_out_of(point, plane, solid))) return;
    if (!meets(point, gap, way)) return;
    const double part = gap > 0.0 && then < 0.0 ? gap / (gap - then) : 0.0;  // of the way, to the face
    if (near_.is_covered(solid, plane, point + part * way)) return;
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
      std::ranges::any_of(near_.of(solid).faces, [&](const Face& f) { return f.normal.dot(normal) > kSame; });
  if (passed_ ? !passed_->holds(normal) : !along_face && over_ >= -seeker_.touching) return;
  for (int i = 0; i < contact.manifold.count; ++i) {
    const double gap = contact.manifold.points[std::size_t(i)].gap;
    const Vec3 point = contact.manifold.points[std::size_t(i)].point + 0.5 * gap * normal;  // the body's own
    const double then = gap_then(point, normal, gap);
    if (std::min(gap, then) > seeker_.touching || near_.find_uncovered(solid, point, normal) != normal)
      continue;
    if (along_face || gap <= seeker_.touching)
      add(-1, point, normal, gap, std::min(gap, then), solid, along_face);
    else
      found_.until = std::min(found_.until, time_ * gap / (gap - then));
  }
}

void PointSearch::meet(const PlacedSolid& solid, double ball_is_over) {
  if (sieve_ && solid.solid->surface && sieve_->is_beyond(solid)) return;
  over_ = -1e300;
  passed_ = find_passed_face(self_, solid, seeker_.body.velocity * time_, seeker_.touching);
  if (passed_ && !near_.find_uncovered(solid, passed_->lowest, passed_->normal)) passed_.reset();
  for (const Face& face : near_.of(solid).faces)
    if (!passed_ || passed_->holds(face.normal)) find_vertices_over(solid, face);
  find_features(solid, ball_is_over);
}

void PointSearch::add_probed(const SolidContact& contact) {
  const Manifold& manifold = contact.contact.manifold;
  for (int i = 0; i < manifold.count; ++i) {
    const auto& [point, gap] = manifold.points[std::size_t(i)];
    const Vec3& normal = contact.contact.normal;
    found_.points.push_back({seeker_.shape.sphere_radius ? -1 : std::int32_t(contact.number) - 1,
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

void PointSearch::drop_inner() {
  constexpr int kMostOfPlane = 12;
  constexpr double kSameWay = 0.9999;  // cosine
  std::vector<SolidPoint>& points = found_.points;
  std::vector<bool>& inner = held_;
  inner.assign(points.size(), false);
  for (std::size_t first = 0; first + kMostOfPlane < points.size(); ++first) {
    const Vec3 &normal = points[first].plane.normal, from = points[first].point;
    bearing_.clear();
    for (std::size_t i = first; i < points.size(); ++i) {
      const SolidPoint& p = points[i];
      if (!inner[i] && std::abs(p.plane.height_of(p.point)) < seeker_.touching &&
          p.plane.normal.dot(normal) > kSameWay && std::abs((p.point - from).dot(normal)) < seeker_.touching)
        bearing_.push_back(i);
    }
    if (bearing_.size() <= kMostOfPlane || bearing_[0] != first) continue;
    for (const std::size_t i : bearing_) inner[i] = true;
    const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
    for (int i = 0; i < kMostOfPlane; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kMostOfPlane;
      const Vec3 way = std::cos(angle) * x + std::sin(angle) * y;
      inner[*std::ranges::max_element(
          bearing_, {}, [&](std::size_t at) { return way.dot(points[at].point - from); })] = false;
    }
  }
  std::size_t i = 0;
  std::erase_if(points, [&](const SolidPoint&) { return inner[i++]; });
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
  work.faces.take(work.near, body.position, kind.shape->radius);
  PointSearch search(seeker, ground.planes(), time, margin, work, found);
  for (const SolidContact& contact : work.probed) search.add_probed(contact);
  if (uneven) {
    const double over =
        kind.shape->sphere_radius ? find_height_over_triangles(work.near, body.position) : 1e300;
    for (const PlacedSolid& solid : work.near) search.meet(solid, over);
    search.drop_held();
    search.drop_inner();
  }
  std::ranges::sort(found.points, {}, &SolidPoint::least_gap);
}

}  // namespace lodestone
