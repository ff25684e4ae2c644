#include "lod/statistical/pair_contacts.h"

namespace lodestone {
namespace {

// Vertices this near the touching plane, over R, belong to the touching feature.
constexpr double kFeatureMargin = 0.01;

struct Separation {
  Vec3 normal = Vec3::UnitZ();  // from second to first
  double gap = -1e300;
  std::int32_t vertex_first = 0, vertex_second = 0;
  Vec3 point_first, point_second;  // world, relative to the second body's centre
};

// The gap between the hulls along `normal`, and the two vertices that bound it.
Separation separation_along(const PairBody& first, const PairBody& second, const Vec3& normal, std::int32_t hint_first, std::int32_t hint_second) {
  Separation s{normal, 0.0, hint_first, hint_second, {}, {}};
  const Vec3 between = first.position - second.position;
  const HullContact low = find_lowest_point(*first.shape, first.orientation, normal, 0.0, s.vertex_first);
  const HullContact high = find_lowest_point(*second.shape, second.orientation, -normal, 0.0, s.vertex_second);
  s.point_first = between + low.arm;
  s.point_second = high.arm;
  s.gap = normal.dot(s.point_first - s.point_second);
  return s;
}

// A hull vertex near the one farthest along `direction` in the world.
std::int32_t find_start(const PairBody& body, const Vec3& direction) {
  return body.shape->sphere_radius ? 0 : body.shape->support_map.find_start(body.orientation.conjugate() * direction);
}

void try_axis(const PairBody& first, const PairBody& second, const Vec3& normal, Separation& best) {
  const Separation s = separation_along(first, second, normal, best.vertex_first, best.vertex_second);
  if (s.gap > best.gap) best = s;
}

void try_rest_normals(const PairBody& owner, const PairBody& first, const PairBody& second, Separation& best) {
  if (!owner.signature) return;
  const Vec3 towards = first.position - second.position;
  for (const RestPose& pose : owner.signature->rest_poses) {
    const Vec3 axis = owner.orientation * pose.normal;
    const double side = axis.dot(towards);
    // An axis across the line of centres cannot separate two bodies that nearly touch.
    if (std::abs(side) > 0.3 * towards.norm()) try_axis(first, second, side > 0.0 ? axis : Vec3(-axis), best);
  }
}

void try_face_normals(const PairBody& first, const PairBody& second, Separation& best) {
  for (const Vec3& normal : second.face_normals) try_axis(first, second, second.orientation * normal, best);
}

// Up the gradient until the gap is above `enough`.
void climb(const PairBody& first, const PairBody& second, double enough, Separation& best) {
  const double size = first.shape->radius + second.shape->radius;
  double stride = 0.5;
  for (int i = 0; i < 6 && best.gap <= enough; ++i) {
    const Vec3 between = best.point_first - best.point_second;
    const Vec3 uphill = between - best.normal.dot(between) * best.normal;
    if (uphill.squaredNorm() < 1e-8 * size * size) return;
    const double before = best.gap;
    try_axis(first, second, (best.normal + stride / size * uphill).normalized(), best);
    if (best.gap <= before) stride *= 0.4;
  }
}

// The vertices that lie within a hair of the touching plane, as arms from `origin`.
HullContacts find_feature(const PairBody& body, const Vec3& normal, std::int32_t vertex, const Vec3& origin) {
  const HullContact lowest = find_lowest_point(*body.shape, body.orientation, normal, 0.0, vertex);
  const double margin = lowest.gap + kFeatureMargin * body.shape->radius;
  HullContacts feature = find_hull_contacts(*body.shape, body.orientation, normal, 0.0, margin, vertex);
  for (int i = 0; i < feature.count; ++i) feature.contact[i].arm += body.position - origin;
  return feature;
}

Vec3 middle_of(const HullContacts& feature) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < feature.count; ++i) sum += feature.contact[i].arm;
  return sum / feature.count;
}

Manifold clip_features(const PairBody& first, const PairBody& second, const Separation& best, HullContacts& upper, HullContacts& lower) {
  upper = find_feature(first, best.normal, best.vertex_first, second.position);
  lower = find_feature(second, -best.normal, best.vertex_second, second.position);
  return find_manifold(upper, lower, best.normal, best.gap);
}

Manifold find_points(const PairBody& first, const PairBody& second, const Separation& best) {
  HullContacts upper, lower;
  Manifold manifold = clip_features(first, second, best, upper, lower);
  if (manifold.count == 0) {  // the axis is not quite that of the nearest features
    manifold.points[0] = {0.5 * (middle_of(upper) + middle_of(lower)), best.gap};
    manifold.count = 1;
  }
  for (ManifoldPoint& p : manifold.points) p.point += second.position;
  return manifold;
}

// Most near pairs do not touch, and the last step's axis or a few steps uphill show it. A contact itself is found without memory, so that it is
// a function of the two poses alone.
HullContactSearch search_relative(const PairBody& first, const PairBody& second, const Vec3& start, double margin) {
  const auto from = [&](const Vec3& axis) {
    Separation best = separation_along(first, second, axis, find_start(first, -axis), find_start(second, axis));
    climb(first, second, margin, best);
    return best;
  };
  if (!start.isZero(0.0))
    if (const Separation apart = from(start); apart.gap > margin) return {apart.normal, apart.gap, {}};
  const Vec3& line = first.position;
  Separation best = from(line.norm() > 1e-12 ? Vec3(line.normalized()) : Vec3::UnitZ());
  const double before = best.gap;
  if (best.gap <= margin) try_rest_normals(first, first, second, best);
  if (best.gap <= margin) try_rest_normals(second, first, second, best);
  if (best.gap <= margin) try_face_normals(first, second, best);
  if (best.gap > before) climb(first, second, margin, best);
  HullContactSearch search{best.normal, best.gap, {}};
  if (best.gap <= margin) search.contact = PairContact{best.normal, best.gap, find_points(first, second, best)};
  return search;
}

// Rounded well above what the last bits of a state hold (and far below what shows), so that the path of the search does not hang on them: the same
// two bodies meet alike whichever of them is full.
template <class Numbers>
Numbers without_last_bits(const Numbers& values) {
  constexpr double kGrain = 0x1p-36;
  return ((values / kGrain).array().round() * kGrain).matrix();
}

}  // namespace

std::optional<PairContact> find_sphere_contact(const PairBody& first, const PairBody& second, double margin) {
  const Vec3 between = first.position - second.position;
  const double distance = between.norm(), gap = distance - first.sphere_radius - second.sphere_radius;
  if (gap > margin) return {};
  const Vec3 normal = distance > 1e-12 ? Vec3(between / distance) : Vec3::UnitZ();
  PairContact contact{normal, gap, {}};
  contact.manifold.points[0] = {second.position + (second.sphere_radius + 0.5 * gap) * normal, gap};
  contact.manifold.count = 1;
  return contact;
}

HullContactSearch find_hull_contact(const PairBody& first, const PairBody& second, const Vec3& start, double margin) {
  PairBody a = first, b = second;
  a.position = without_last_bits(Vec3(first.position - second.position));
  b.position.setZero();
  a.orientation.coeffs() = without_last_bits(Eigen::Vector4d(first.orientation.coeffs()));
  b.orientation.coeffs() = without_last_bits(Eigen::Vector4d(second.orientation.coeffs()));
  HullContactSearch search = search_relative(a, b, start, margin);
  if (search.contact)
    for (ManifoldPoint& p : search.contact->manifold.points) p.point += second.position;
  return search;
}

std::optional<PairContact> find_contact_along(const PairBody& first, const PairBody& second, const Vec3& normal, double margin) {
  const Separation s = separation_along(first, second, normal, find_start(first, -normal), find_start(second, normal));
  if (s.gap > margin) return {};
  HullContacts upper, lower;
  PairContact contact{normal, s.gap, clip_features(first, second, s, upper, lower)};
  if (contact.manifold.count == 0) return {};
  for (ManifoldPoint& p : contact.manifold.points) p.point += second.position;
  return contact;
}

}  // namespace lodestone
