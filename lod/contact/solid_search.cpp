#include "lod/contact/solid_search.h"

#include <algorithm>
#include <array>
#include <numbers>

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

bool GroundSeeker::may_turn_into(const HalfSpace& plane, const Vec3& velocity, double time) const {
  const double approach = (velocity - body.velocity).dot(plane.normal);
  return plane.height_of(body.position) - std::max(0.0, approach) * time <= shape.radius + touching;
}

bool closes(const PairContact& contact, const GroundPart& part, const GroundSeeker& seeker, double time) {
  const auto points = std::span(contact.manifold.points).first(std::size_t(contact.manifold.count));
  return std::ranges::any_of(points, [&](const ManifoldPoint& p) {
    const Vec3 of_part = part.velocity_at(p.point), velocity = seeker.velocity_at(p.point) - of_part;
    const HalfSpace plane{contact.normal, contact.normal.dot(p.point) - 0.5 * p.gap};
    return p.gap + velocity.dot(contact.normal) * time <= seeker.touching &&
           (seeker.omega.isZero(0.0) || seeker.may_turn_into(plane, of_part, time));
  });
}

namespace {

/// A part of the ground that is known by rays from above, beside a body.
class ProbedGround {
 public:
  ProbedGround(const GroundSeeker& seeker, const GroundPart& part, double time,
               std::vector<SolidContact>& found)
      : s_(seeker),
        part_(part),
        time_(time),
        up_(part.pose.orientation * part.shape.up),
        ahead_(seeker.shape.sphere_radius ? seeker.half_way(time) : Vec3(Vec3::Zero())),
        hint_(seeker.body.support_hint),
        found_(found) {}

  void find(std::vector<HalfSpace>& planes) {
    constexpr double kHollow = 3.0;  // how far below its centre the bottom of a hollow is in which it fits
    const double reach = s_.reach();
    below_ = cast_below(Vec3::Zero(), kHollow);
    const Vec3 normal = below_ ? below_->normal : up_;
    const double height = below_ ? height_over(*below_) : 0.0;
    const HullContacts low =
        find_hull_contacts(s_.shape, s_.body.orientation, normal, height, below_ ? margin() : reach, hint_);
    std::array<std::optional<GroundHit>, kMaxGroundContacts + 1> hits;
    even_ = below_.has_value();
    for (int i = 0; i < low.count; ++i) {
      hits[std::size_t(i)] = hit_below(low.contact[std::size_t(i)]);
      note(hits[std::size_t(i)]);
    }
    if (below_ && low.count > 0 && low.contact[0].gap < margin()) look_around();
    if (even_ && !part_.moves())
      return planes.push_back({normal, normal.dot(below_->point), part_.material, part_.id});
    for (int i = 0; i < low.count; ++i) add(low.contact[std::size_t(i)], hits[std::size_t(i)]);
    if (even_ || !below_) return;
    for (std::size_t i = 0; i < faces_; ++i) add_low(face_[i]);
    if (low.count >= 3) add_low_vertices(normal, height, low.contact[0].vertex);  // of two there are no more
  }

 private:
  static constexpr std::size_t kMostFaces = 6;

  double margin() const { return s_.touching + s_.way + 0.25 * s_.shape.radius; }  // m: so uneven it may be
  double height_over(const GroundHit& hit) const { return hit.normal.dot(s_.body.position - hit.point); }
  /// `deepest`: how far below, over the reach.
  std::optional<GroundHit> cast_below(const Vec3& arm, double deepest = 1.0) const {
    const double reach = s_.reach();
    return part_.shape.probe(s_.body.position + arm + ahead_ + reach * up_, -up_, (1.0 + deepest) * reach);
  }
  /// Of a vertex by one ray, however often it is asked for.
  std::optional<GroundHit> hit_below(const HullContact& low) {
    if (low.vertex < 0) return cast_below(low.arm);
    const auto end = asked_.begin() + std::ptrdiff_t(asked_count_);
    const auto known = std::find(asked_.begin(), end, low.vertex);
    if (known != end) return hit_of_[std::size_t(known - asked_.begin())];
    const std::optional<GroundHit> hit = cast_below(low.arm);
    if (asked_count_ < asked_.size())
      asked_[asked_count_] = low.vertex, hit_of_[asked_count_] = hit, ++asked_count_;
    return hit;
  }
  /// Another face than that below the centre.
  void note(const std::optional<GroundHit>& hit) {
    const bool is_below = hit && below_ && (hit->normal - below_->normal).squaredNorm() < 1e-12 &&
                          std::abs(below_->normal.dot(hit->point - below_->point)) < 1e-6 * s_.shape.radius;
    even_ = even_ && is_below;
    if (!hit || is_below || faces_ == kMostFaces) return;
    const auto is_it = [&](const GroundHit& known) {
      return (hit->normal - known.normal).squaredNorm() < 1e-12;
    };
    if (std::none_of(face_.begin(), face_.begin() + std::ptrdiff_t(faces_), is_it)) face_[faces_++] = *hit;
  }
  /// In a hollow a body touches what rises beside it.
  void look_around() {
    constexpr int kAround = 8;
    constexpr double kAside = 0.8660254037844386;  // sin 60°: a wall as steep is met when it is touched
    const Vec3 x = up_.unitOrthogonal(), y = up_.cross(x);
    for (int i = 0; i < kAround; ++i) {
      const double turn = 2.0 * std::numbers::pi * i / kAround;
      const Vec3 out = 0.5 * up_ + kAside * (std::cos(turn) * x + std::sin(turn) * y);
      note(hit_below(find_lowest_point(s_.shape, s_.body.orientation, out, 0.0, hint_)));
    }
  }
  void add_low(const GroundHit& face) {
    const HullContacts low =
        find_hull_contacts(s_.shape, s_.body.orientation, face.normal, height_over(face), margin(), hint_);
    for (int i = 0; i < low.count; ++i)
      add(low.contact[std::size_t(i)], hit_below(low.contact[std::size_t(i)]));
  }
  void add_low_vertices(const Vec3& normal, double height, std::int32_t lowest) {
    std::array<std::int32_t, kMostProbed> room;
    for (const std::int32_t vertex : find_low_vertices(s_, normal, height, margin(), lowest, room)) {
      const Vec3 arm = s_.body.orientation * s_.shape.hull.vertices[std::size_t(vertex)];
      const HullContact low{arm, 0.0, vertex};
      add(low, hit_below(low));
    }
  }
  /// A vertex once, a ball's point once for each face.
  void add(const HullContact& low, const std::optional<GroundHit>& hit) {
    if (!hit) return;
    const auto number = low.vertex < 0 ? added_ : std::uint32_t(low.vertex + 1);
    if (low.vertex >= 0 && std::any_of(known_.begin(), known_.begin() + added_,
                                       [&](std::uint32_t known) { return known == number; }))
      return;
    if (added_ == known_.size()) return;
    known_[added_++] = number;
    const Vec3 point = s_.body.position + low.arm;
    PairContact contact;
    contact.normal = hit->normal;
    contact.gap = hit->normal.dot(point - hit->point);
    contact.manifold.count = 1;
    contact.manifold.points[0] = {point, contact.gap};
    if (contact.gap > -s_.shape.radius && closes(contact, part_, s_, time_))
      found_.push_back({s_.slot, number, part_.material, &part_, contact});
  }

  const GroundSeeker& s_;
  const GroundPart& part_;
  const double time_;  // s, of the step
  const Vec3 up_, ahead_;
  std::int32_t hint_;
  std::vector<SolidContact>& found_;
  std::optional<GroundHit> below_;
  bool even_ = false;
  std::array<GroundHit, kMostFaces> face_;
  std::size_t faces_ = 0;
  static constexpr std::size_t kMostAsked = 24;
  std::array<std::int32_t, kMostAsked> asked_;  // vertices, and what is below them
  std::array<std::optional<GroundHit>, kMostAsked> hit_of_;
  std::size_t asked_count_ = 0;
  std::array<std::uint32_t, 64> known_;
  std::uint32_t added_ = 0;
};

}  // namespace

void find_probed_contacts(const GroundSeeker& seeker, const GroundPart& part, double time,
                          std::vector<SolidContact>& found, std::vector<HalfSpace>& planes) {
  ProbedGround(seeker, part, time, found).find(planes);
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
  const double reach = seeker.reach(), from_half_way = reach + seeker.half_way(time).norm();
  thread_local std::vector<const GroundPart*> parts;
  parts.clear();
  ground.find_parts(center, from_half_way, parts);
  if (parts.empty()) return false;
  bool any_moves = false;
  for (const GroundPart* part : parts) {
    any_moves |= part->moves();
    if (part->shape.probe)
      find_probed_contacts(seeker, *part, time, found, planes);
    else
      find_solids(*part, center, from_half_way, after, near);
  }
  if (any_moves && time > 0.0) return true;
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
