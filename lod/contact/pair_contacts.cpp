#include "lod/contact/pair_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "lod/contact/hull_contacts.h"

namespace lodestone {

PairBody piece_of(const PairBody& body, int piece) {
  if (body.shape->pieces.empty()) return body;
  PairBody part = body;
  part.shape = &body.shape->pieces[std::size_t(piece)];
  part.position += body.orientation * part.shape->center_of_mass_in_mesh;
  return part;
}

namespace {

// Vertices this near the touching plane, over the lesser R, belong to the touching feature: of a great slab
// not those of its other side.
constexpr double kFeatureMargin = 0.01;

// Cosine, between a face that may come to lie and the touching plane.
constexpr double kLying = 0.9;

PlacedHull place(const PairBody& body) { return {*body.shape, body.position, body.orientation}; }

/// Points of a body that lie nearest to the touching plane, arms from an origin that both bodies share: the
/// nearest of all, then others, but for what they hold together, in no order.
struct TouchingFeature {
  std::array<Vec3, kMostCorners> corner;
  int count = 0;
  std::span<const Vec3> corners() const { return std::span(corner).first(std::size_t(count)); }
};

// m, from its nearest corner.
double width_of(const TouchingFeature& feature) {
  double width = 0.0;
  for (const Vec3& corner : feature.corners()) width = std::max(width, (corner - feature.corner[0]).norm());
  return width;
}

// The vertices that lie within `hair` m of the touching plane, as arms from `origin`. Returns the nearest of
// all; −1 for a sphere.
std::int32_t find_feature(const PairBody& body, const Vec3& normal, std::int32_t vertex, const Vec3& origin,
                          double hair, TouchingFeature& feature) {
  const Vec3 arm = body.position - origin;
  if (body.shape->sphere_radius) {
    feature.corner[0] = arm - *body.shape->sphere_radius * normal;
    feature.count = 1;
    return -1;
  }
  const Hull& hull = body.shape->hull;
  const Vec3 own = body.orientation.conjugate() * normal;
  vertex = find_support(hull, -own, std::max(vertex, 0));
  std::array<std::int32_t, kMostCorners> vertices;
  feature.count = find_vertices_below(*body.shape, own, 0.0,
                                      own.dot(hull.vertices[std::size_t(vertex)]) + hair, vertex, vertices);
  const Mat3 turn = body.orientation.toRotationMatrix();
  for (int i = 0; i < feature.count; ++i)
    feature.corner[std::size_t(i)] = arm + turn * hull.vertices[std::size_t(vertices[std::size_t(i)])];
  return vertex;
}

// The face around a vertex that lies most nearly in the touching plane, its normal outward, in the body's
// axes.
Vec3 find_flattest_face(const Hull& hull, std::int32_t vertex, const Vec3& down) {
  Vec3 flattest = Vec3::Zero();
  for (const std::int32_t face : hull.faces_of(vertex))
    if (const Vec3 outward = hull.face_normals[std::size_t(face)]; outward.dot(down) > flattest.dot(down))
      flattest = outward;
  return flattest;
}

// Where a body comes down on an edge or a corner of a wide face that is about to lie, the whole face: the
// impulse at the edge turns the others down within the same step, the faster the thinner the body is.
// Without, plates that land strike with alternate edges, deeper with each. `ahead`, m: how much farther than
// the nearest vertex those corners may be.
void extend_to_face(const PairBody& body, const Vec3& normal, std::int32_t vertex, const Vec3& origin,
                    double hair, double ahead, TouchingFeature& feature) {
  if (vertex < 0 || feature.count > 2) return;
  const Vec3 down = body.orientation.conjugate() * -normal,
             flattest = find_flattest_face(body.shape->hull, vertex, down);
  if (flattest.dot(down) < kLying) return;
  TouchingFeature face;
  find_feature(body, body.orientation * -flattest, vertex, origin, hair, face);
  double farthest = 0.0;
  for (const Vec3& corner : face.corners())
    farthest = std::max(farthest, (corner - feature.corner[0]).dot(normal));
  if (face.count > 2 && width_of(face) >= body.shape->radius && farthest <= ahead) feature = face;
}

// What is so near of a round body lies on several faces, and the outermost of it would hide the nearest,
// over which it rolls: then what lies on the face that is most nearly in the touching plane.
void keep_one_face(const PairBody& body, const Vec3& normal, std::int32_t vertex, double hair,
                   TouchingFeature& feature) {
  constexpr double kFlat = 0.1;  // over the hair: how far a face's corners may be off its plane
  if (feature.count < 3) return;
  const Vec3 down = body.orientation.conjugate() * -normal,
             outward = body.orientation * find_flattest_face(body.shape->hull, vertex, down);
  const double offset = outward.dot(feature.corner[0]) - kFlat * hair;
  int kept = 0;
  for (int i = 0; i < feature.count; ++i)
    if (const Vec3 corner = feature.corner[std::size_t(i)]; outward.dot(corner) >= offset)
      feature.corner[std::size_t(kept++)] = corner;
  feature.count = kept;
}

/// m: how much farther than the nearest vertex, beyond a hair, others of a touching feature are.
struct Ahead {
  double first = 0.0;  ///< of the first body
  double lying = 0.0;  ///< of a wide face that is about to lie
};

Manifold clip_features(const PairBody& first, const PairBody& second, const HullGap& best, const Ahead& ahead,
                       TouchingFeature& upper, TouchingFeature& lower) {
  const double hair = kFeatureMargin * std::min(first.shape->radius, second.shape->radius);
  const auto find = [&](const PairBody& body, const Vec3& normal, std::int32_t near, double within,
                        TouchingFeature& feature) {
    const std::int32_t nearest = find_feature(body, normal, near, second.position, within, feature);
    keep_one_face(body, normal, nearest, hair, feature);
  };
  find(first, best.normal, best.vertex_first, hair + ahead.first, upper);
  find(second, -best.normal, best.vertex_second, hair, lower);
  if (ahead.lying > 0.0) {
    extend_to_face(first, best.normal, best.vertex_first, second.position, hair, ahead.lying, upper);
    extend_to_face(second, -best.normal, best.vertex_second, second.position, hair, ahead.lying, lower);
  }
  return find_manifold(upper.corners(), lower.corners(), best.normal, best.gap);
}

Manifold find_points(const PairBody& first, const PairBody& second, const HullGap& best, const Ahead& ahead) {
  TouchingFeature upper, lower;
  Manifold manifold = clip_features(first, second, best, ahead, upper, lower);
  if (manifold.count == 0) {  // the axis is not quite that of the nearest features
    // The nearest corner of the smaller one: a point between both may be off it.
    const bool upper_is_smaller = width_of(upper) <= width_of(lower);
    manifold.points[0] = {upper_is_smaller ? Vec3(upper.corner[0] - 0.5 * best.gap * best.normal)
                                           : Vec3(lower.corner[0] + 0.5 * best.gap * best.normal),
                          best.gap};
    manifold.count = 1;
  }
  for (ManifoldPoint& p : manifold.points) p.point += second.position;
  return manifold;
}

PairContact contact_along(const PairBody& first, const PairBody& second, const HullGap& best,
                          const Ahead& ahead) {
  return {best.normal, best.gap, find_points(first, second, best, ahead)};
}

// Closer than `margin`, m, one that its bodies take along for a while.
PairContact contact_to_hold(const PairBody& first, const PairBody& second, const HullGap& best,
                            double margin) {
  return contact_along(first, second, best,
                       {.lying = margin + kTakenAlong * std::min(first.shape->radius, second.shape->radius)});
}

int count_pieces(const PairBody& body) { return std::max<int>(1, int(body.shape->pieces.size())); }

// Deeper than this in a piece, over its R, is inside it.
constexpr double kWithin = 1e-3;

bool is_within(const PairBody& piece, const Vec3& point) {
  const Hull& hull = piece.shape->hull;
  const Vec3 local = piece.orientation.conjugate() * (point - piece.position);
  const double margin = kWithin * piece.shape->radius;
  if (local.squaredNorm() > piece.shape->radius * piece.shape->radius) return false;
  for (int i = 0; i < int(hull.faces.size()); ++i) {
    const Vec3& corner = hull.vertices[std::size_t(hull.faces[std::size_t(i)][0])];
    if (hull.face_normals[std::size_t(i)].dot(local - corner) > -margin) return false;
  }
  return true;
}

// Whether a point on the surface of piece `own` lies inside another piece of the body: nothing can touch it
// there.
bool is_internal(const PairBody& body, int own, const Vec3& point) {
  for (int i = 0; i < int(body.shape->pieces.size()); ++i)
    if (i != own && is_within(piece_of(body, i), point)) return true;
  return false;
}

void drop_internal_points(const PairBody& first, int i, const PairBody& second, int k, PairContact& contact) {
  Manifold kept;
  for (int m = 0; m < contact.manifold.count; ++m) {
    const ManifoldPoint& p = contact.manifold.points[std::size_t(m)];
    const Vec3 half = 0.5 * p.gap * contact.normal;
    if (!is_internal(first, i, p.point + half) && !is_internal(second, k, p.point - half))
      kept.points[std::size_t(kept.count++)] = p;
  }
  contact.manifold = kept;
}

// Of a face of either hull that the other lies over, from the second into the first; none of hulls of many
// faces.
std::optional<Vec3> find_passed_normal(const PairBody& first, const PairBody& second,
                                       const PairContact& contact, const PairWay& way) {
  constexpr std::size_t kMostFaces = 64;  // triangles
  const PlacedHull a = place(first), b = place(second);
  const ManifoldPoint& p = contact.manifold.points[0];
  const Vec3 apart = first.position - second.position;
  std::optional<Vec3> passed;
  double most = -way.hair;  // m
  // A `face` of `one`, the other being at `point`, from the centre of `one`, among other places.
  const auto look_at = [&](const PlacedHull& one, std::size_t face, const Vec3& point, double sign) {
    const Hull& hull = one.shape->hull;
    const Vec3 outward = one.rotation * hull.face_normals[face], normal = sign * outward;
    const double turning = normal.cross(way.first_turn).norm() * first.shape->radius +
                           normal.cross(way.second_turn).norm() * second.shape->radius,
                 least_change = std::min(0.0, way.first.dot(normal) - turning),
                 plane = hull.face_normals[face].dot(hull.vertices[std::size_t(hull.faces[face][0])]);
    if (outward.dot(point) - plane + least_change < most || normal.dot(apart) <= 0.0) return;
    if (passed && passed->dot(normal) > 0.9999) return;
    const double gap = measure_hull_gap(a, b, normal).gap;
    if (gap + least_change >= most) most = gap + least_change, passed = normal;
  };
  const auto look_at_all = [&](const PlacedHull& one, const Vec3& point, double sign) {
    const std::size_t count = one.shape->hull.face_normals.size();
    if (one.shape->sphere_radius || count > kMostFaces) return;
    for (std::size_t face = 0; face < count; ++face) look_at(one, face, point, sign);
  };
  look_at_all(b, p.point + 0.5 * p.gap * contact.normal - second.position, 1.0);
  look_at_all(a, p.point - 0.5 * p.gap * contact.normal - first.position, -1.0);
  return passed;
}

// In place of a contact across a face along which one passes the other that with the face, where they lie
// over each other; none is left where they do not. The next search begins at `axis`.
std::optional<PairContact> pass_over(const PairBody& first, const PairBody& second, const PairWay& way,
                                     const PairContact& contact, HullGap& axis) {
  constexpr double kSameWay = 0.99;  // cosine
  const auto passed = find_passed_normal(first, second, contact, way);
  if (!passed || contact.normal.dot(*passed) > kSameWay) return contact;
  const HullGap along = measure_hull_gap(place(first), place(second), *passed);
  TouchingFeature upper, lower;
  const PairContact with_face{*passed, along.gap, clip_features(first, second, along, {}, upper, lower)};
  const bool is_over = with_face.manifold.count > 0 && along.gap <= way.hair;
  if (!is_over && contact.gap < 0.0) return contact;
  axis = along;
  return is_over ? std::optional(with_face) : std::nullopt;
}

// Pieces overlap, so that one contact of the bodies may be several of theirs.
void add_contact(const PairContact& contact, double grain, std::vector<PairContact>& contacts) {
  for (PairContact& other : contacts)
    if (other.normal.dot(contact.normal) > 0.999 && std::abs(other.gap - contact.gap) < grain) {
      other.manifold = join_manifolds(other.manifold, contact.manifold, other.normal);
      other.gap = std::min(other.gap, contact.gap);
      return;
    }
  contacts.push_back(contact);
}

// At least; above the margin where that is known without a search or two spheres show it.
double gap_of_pieces(const PairBody& a, const PairBody& b, KnownGap& known, double margin, bool exact) {
  if (known.when)
    if (const double left = known.axis.gap - find_motion_since(*known.when, a, b); left > margin) return left;
  const double apart = (a.position - b.position).norm() - a.shape->radius - b.shape->radius;
  if (apart > margin) return apart;
  known.axis = find_hull_gap(place(a), place(b), known.axis, margin, exact);
  known.when = pose_of(a, b);
  return known.axis.gap;
}

// Which go on as their bodies turn, too.
PairWay way_of_pieces(const PairWay& way, const PairBody& first, const PairBody& of_first,
                      const PairBody& second, const PairBody& of_second) {
  PairWay own = way;
  own.first += way.first_turn.cross(of_first.position - first.position) -
               way.second_turn.cross(of_second.position - second.position);
  return own;
}

void find_contacts_of_pieces(const PairBody& first, const PairBody& second, std::span<KnownGap> known,
                             double margin, HullContactSearch& search) {
  search.gap = 1e300;
  for (int i = 0; i < count_pieces(first); ++i)
    for (int k = 0; k < count_pieces(second); ++k) {
      const PairBody a = piece_of(first, i), b = piece_of(second, k);
      KnownGap& of_pieces = known[std::size_t(i * count_pieces(second) + k)];
      const double gap = gap_of_pieces(a, b, of_pieces, margin, search.exact);
      search.gap = std::min(search.gap, gap);
      if (gap > margin) continue;
      std::optional<PairContact> contact = contact_to_hold(a, b, of_pieces.axis, margin);
      if (search.way)
        contact = pass_over(a, b, way_of_pieces(*search.way, first, a, second, b), *contact, of_pieces.axis);
      if (!contact) continue;
      drop_internal_points(first, i, second, k, *contact);
      if (contact->manifold.count > 0)
        add_contact(*contact, kWithin * std::min(a.shape->radius, b.shape->radius), search.contacts);
    }
}

void search_relative(const PairBody& first, const PairBody& second, HullGap& whole,
                     std::vector<KnownGap>& of_pieces, const Enough& margin, HullContactSearch& search) {
  search.contacts.clear();
  if (first.shape->pieces.empty() && second.shape->pieces.empty()) {
    whole = find_hull_gap(place(first), place(second), whole, margin, search.exact);
    search.gap = whole.gap;
    if (search.gap > margin.along(whole.normal)) return;
    std::optional<PairContact> contact = contact_to_hold(first, second, whole, margin.along(whole.normal));
    if (search.way) contact = pass_over(first, second, *search.way, *contact, whole);
    if (contact) search.contacts.push_back(*contact);
    return;
  }
  const bool apart = are_apart(place(first), place(second), margin, whole);
  search.gap = whole.gap;
  if (apart && search.gap > margin.along(whole.normal)) return;
  of_pieces.resize(std::size_t(count_pieces(first) * count_pieces(second)));
  find_contacts_of_pieces(first, second, of_pieces, margin.anywhere(), search);
}

// As std::round does, to the bit, without a call: half away from zero, and the sign of a zero kept. What is
// added is the number below a half, so that a sum is a whole number or more only where it should be.
double round_quickly(double x) {
  constexpr double kLeast = 0x1p51;  // from here on, and for what is no number, by the library
  if (!(std::abs(x) < kLeast)) return std::round(x);
  return std::copysign(double(std::int64_t(x + std::copysign(0x1.fffffffffffffp-2, x))), x);
}

// Rounded well above what the last bits of a state hold (and far below what shows), so that the path of the
// search does not hang on them: the same two bodies meet alike whichever of them is full.
template <class Numbers>
Numbers without_last_bits(const Numbers& values) {
  constexpr double kGrain = 0x1p-36;
  return (values / kGrain).unaryExpr([](double x) { return round_quickly(x); }) * kGrain;
}

std::pair<PairBody, PairBody> relative_to_second(const PairBody& first, const PairBody& second) {
  PairBody a = first, b = second;
  a.position = without_last_bits(Vec3(first.position - second.position));
  b.position.setZero();
  a.orientation.coeffs() = without_last_bits(Eigen::Vector4d(first.orientation.coeffs()));
  b.orientation.coeffs() = without_last_bits(Eigen::Vector4d(second.orientation.coeffs()));
  return {a, b};
}

void shift(PairContact& contact, const Vec3& by) {
  for (ManifoldPoint& p : contact.manifold.points) p.point += by;
}

}  // namespace

PairPose pose_of(const PairBody& first, const PairBody& second) {
  return {(first.position - second.position).cast<float>(), first.orientation.coeffs().cast<float>(),
          second.orientation.coeffs().cast<float>()};
}

namespace {

// m: by how much no gap has shrunk more since then by how both have turned.
double find_turning_since(const PairPose& then, const PairBody& first, const PairBody& second) {
  // Of two quaternions that are a chord c apart the angle is 4 asin(c / 2), up to half a turn at most 2 c +
  // c³/8.
  const auto turned = [](const PairPose::Turn& from, const Quat& to) {
    const Eigen::Vector4d was = from.cast<double>();
    const double square = std::min((was - to.coeffs()).squaredNorm(), (was + to.coeffs()).squaredNorm());
    return std::sqrt(square) * (2.0 + square / 8.0);
  };
  return turned(then.first, first.orientation) * first.shape->radius +
         turned(then.second, second.orientation) * second.shape->radius;
}

}  // namespace

double find_motion_since(const PairPose& then, const PairBody& first, const PairBody& second) {
  return (first.position - second.position - then.apart.cast<double>()).norm() +
         find_turning_since(then, first, second);
}

GapLeft find_gap_left(const HullGap& found, const PairPose& then, const PairBody& first,
                      const PairBody& second) {
  const Vec3 moved = first.position - second.position - then.apart.cast<double>();
  const double turned = find_turning_since(then, first, second);
  return {found.gap - moved.norm() - turned, found.gap + moved.dot(found.normal) - turned};
}

double look_along(HullGap& found, const PairBody& first, const PairBody& second) {
  const auto reach_along = [](const PairBody& body, const Vec3& direction, std::int32_t& vertex) {
    if (body.shape->sphere_radius) return *body.shape->sphere_radius;
    const Vec3 own = body.orientation.conjugate() * direction;
    if (vertex < 0) vertex = body.shape->support_map.find_start(own);
    vertex = find_support(body.shape->hull, own, vertex);
    return own.dot(body.shape->hull.vertices[std::size_t(vertex)]);
  };
  found.gap = found.normal.dot(first.position - second.position) -
              reach_along(first, -found.normal, found.vertex_first) -
              reach_along(second, found.normal, found.vertex_second);
  return found.gap;
}

HeldContact hold(const PairContact& contact, const PairBody& first, const PairBody& second) {
  HeldContact held{contact.normal, contact.manifold.count, {}, {}};
  for (int i = 0; i < contact.manifold.count; ++i) {
    const ManifoldPoint& p = contact.manifold.points[std::size_t(i)];
    const Vec3 half = 0.5 * p.gap * contact.normal;
    held.on_first[std::size_t(i)] =
        (first.orientation.conjugate() * (p.point + half - first.position)).cast<float>();
    held.on_second[std::size_t(i)] =
        (second.orientation.conjugate() * (p.point - half - second.position)).cast<float>();
  }
  return held;
}

// A ball rolls over its contact: that stays under its centre, where a point that turns with it would push it
// from behind.
PairContact follow(const HeldContact& held, const PairBody& first, const PairBody& second) {
  const std::optional<double>&first_ball = first.shape->sphere_radius,
        &second_ball = second.shape->sphere_radius;
  const Mat3 turn_first = first.orientation.toRotationMatrix(),
             turn_second = second.orientation.toRotationMatrix();
  const Vec3 apart = first.position - second.position;
  PairContact contact{
      first_ball && second_ball && apart.squaredNorm() > 0.0 ? Vec3(apart.normalized()) : held.normal,
      1e300,
      {}};
  const Vec3& normal = contact.normal;
  contact.manifold.count = held.count;
  for (int i = 0; i < held.count; ++i) {
    Vec3 on_first = first.position, on_second = second.position;
    on_first += first_ball ? Vec3(-*first_ball * normal)
                           : Vec3(turn_first * held.on_first[std::size_t(i)].cast<double>());
    on_second += second_ball ? Vec3(*second_ball * normal)
                             : Vec3(turn_second * held.on_second[std::size_t(i)].cast<double>());
    const double gap = (on_first - on_second).dot(normal);
    if (first_ball)
      on_second = on_first - gap * normal;
    else if (second_ball)
      on_first = on_second + gap * normal;
    contact.manifold.points[std::size_t(i)] = {0.5 * (on_first + on_second), gap};
    contact.gap = std::min(contact.gap, gap);
  }
  return contact;
}

void find_pair_contacts(const PairBody& first, const PairBody& second, HullGap& whole,
                        std::vector<KnownGap>& of_pieces, const Enough& margin, HullContactSearch& search) {
  const auto [a, b] = relative_to_second(first, second);
  search_relative(a, b, whole, of_pieces, margin, search);
  for (PairContact& contact : search.contacts) shift(contact, second.position);
}

std::optional<PairContact> find_hull_contact(const PairBody& first, const PairBody& second, double margin,
                                             double ahead, const Vec3& axis) {
  const auto [a, b] = relative_to_second(first, second);
  const HullGap best = find_hull_gap(place(a), place(b), {.normal = axis}, margin);
  if (best.gap > margin) return {};
  PairContact contact = contact_along(a, b, best, {.first = ahead});
  shift(contact, second.position);
  return contact;
}

std::optional<PairContact> find_contact_along(const PairBody& first, const PairBody& second,
                                              const Vec3& normal, double margin, double ahead) {
  const HullGap along = measure_hull_gap(place(first), place(second), normal);
  if (along.gap > margin) return {};
  TouchingFeature upper, lower;
  PairContact contact{normal, along.gap, clip_features(first, second, along, {.first = ahead}, upper, lower)};
  if (contact.manifold.count == 0) return {};
  for (ManifoldPoint& p : contact.manifold.points) p.point += second.position;
  return contact;
}

}  // namespace lodestone
