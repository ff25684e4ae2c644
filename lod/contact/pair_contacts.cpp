#include "lod/contact/pair_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "lod/contact/touching_features.h"

namespace lodestone {
namespace {

PairContact contact_along(const PairBody& first, const PairBody& second, const HullGap& best,
                          const Ahead& ahead) {
  return {best.normal, best.gap, find_shared_points(first, second, best, ahead)};
}

// Of bodies closer than `margin`, m: one that they can take along for a while.
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

// Adds a contact of two pieces. Pieces of a body overlap, so that several of theirs may be one contact of the
// bodies: those within `grain`, m, are joined.
void add_contact(const PairContact& contact, double grain, std::vector<PairContact>& contacts) {
  for (PairContact& other : contacts)
    if (other.normal.dot(contact.normal) > 0.999 && std::abs(other.gap - contact.gap) < grain) {
      other.manifold = join_manifolds(other.manifold, contact.manifold, other.normal);
      other.gap = std::min(other.gap, contact.gap);
      return;
    }
  contacts.push_back(contact);
}

// m: the gap of the two pieces, or less. Above the margin where that follows from what is known or from two
// spheres about them, without a search.
double gap_of_pieces(const PairBody& a, const PairBody& b, KnownGap& known, double margin, bool exact) {
  if (known.when)
    if (const double left = known.axis.gap - find_motion_since(*known.when, a, b); left > margin) return left;
  const double apart = (a.position - b.position).norm() - a.shape->radius - b.shape->radius;
  if (apart > margin) return apart;
  known.axis = find_hull_gap(placed_hull(a), placed_hull(b), known.axis, margin, exact);
  known.when = pose_of(a, b);
  return known.axis.gap;
}

// Pieces also move as the bodies that they belong to turn.
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

// For bodies that relative_to_second() gave.
void search_relative(const PairBody& first, const PairBody& second, HullGap& whole,
                     std::vector<KnownGap>& of_pieces, const Enough& margin, HullContactSearch& search) {
  search.contacts.clear();
  if (first.shape->pieces.empty() && second.shape->pieces.empty()) {
    whole = find_hull_gap(placed_hull(first), placed_hull(second), whole, margin, search.exact);
    search.gap = whole.gap;
    if (search.gap > margin.along(whole.normal)) return;
    std::optional<PairContact> contact = contact_to_hold(first, second, whole, margin.along(whole.normal));
    if (search.way) contact = pass_over(first, second, *search.way, *contact, whole);
    if (contact) search.contacts.push_back(*contact);
    return;
  }
  const bool apart = are_apart(placed_hull(first), placed_hull(second), margin, whole);
  search.gap = whole.gap;
  if (apart && search.gap > margin.along(whole.normal)) return;
  of_pieces.resize(std::size_t(count_pieces(first) * count_pieces(second)));
  find_contacts_of_pieces(first, second, of_pieces, margin.anywhere(), search);
}

// The same as std::round, to the bit, without a call: half away from zero, keeping the sign of a zero. What
// is added is the greatest number below a half: a half itself would round the number just below it up to one.
double round_quickly(double x) {
  constexpr double kLeast = 0x1p51;  // from here on, and for what is no number, by the library
  if (!(std::abs(x) < kLeast)) return std::round(x);
  return std::copysign(double(std::int64_t(x + std::copysign(0x1.fffffffffffffp-2, x))), x);
}

// Rounds far above the last bits of a state, and far below what can be seen. The path of the search then does
// not depend on those bits: the same two bodies meet alike, whichever of them is full.
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

void find_pair_contacts(const PairBody& first, const PairBody& second, HullGap& whole,
                        std::vector<KnownGap>& of_pieces, const Enough& margin, HullContactSearch& search) {
  const auto [a, b] = relative_to_second(first, second);
  search_relative(a, b, whole, of_pieces, margin, search);
  for (PairContact& contact : search.contacts) shift(contact, second.position);
}

std::optional<PairContact> find_hull_contact(const PairBody& first, const PairBody& second, double margin,
                                             double ahead, const Vec3& axis) {
  const auto [a, b] = relative_to_second(first, second);
  const HullGap best = find_hull_gap(placed_hull(a), placed_hull(b), {.normal = axis}, margin);
  if (best.gap > margin) return {};
  PairContact contact = contact_along(a, b, best, {.first = ahead});
  shift(contact, second.position);
  return contact;
}

std::optional<PairContact> find_contact_along(const PairBody& first, const PairBody& second,
                                              const Vec3& normal, double margin, double ahead) {
  const HullGap along = measure_hull_gap(placed_hull(first), placed_hull(second), normal);
  if (along.gap > margin) return {};
  PairContact contact{normal, along.gap, clip_features(first, second, along, {.first = ahead})};
  if (contact.manifold.count == 0) return {};
  shift(contact, second.position);
  return contact;
}

}  // namespace lodestone
