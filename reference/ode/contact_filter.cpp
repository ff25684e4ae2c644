#include "reference/ode/contact_filter.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace lodestone {
namespace {

constexpr double kSameDirection = 0.9;  // least cosine between contacts of one direction …
constexpr double kTried = 0.995;        // … and of what need not be tried again
constexpr double kShallow = 2e-2;  // × size: depths below it need no second look where all directions agree
constexpr double kDepthSlack = 2e-3;  // × size: depths below it cost about the same
constexpr double kDepthRatio = 1.5;   // a displacement clears depths up to this times its own, and the slack
constexpr int kSample = 12;           // places that directions are judged by
constexpr double kTooNear = 2e-2;     // × size: contacts nearer to each other say the same
// Places lie on edges, where any way out seems short; they are measured part of the way towards their middle,
// as far as that is inside: far along where directions are compared, not so far where a depth is wanted.
constexpr double kToCompare = 0.5, kToMeasure = 0.15, kBarely = 1e-3;

/// Of the first body.
struct Displacement {
  Vec3 direction = Vec3::UnitZ();
  double depth = 0.0;
  int cleared = 0;  // places of the sample
};

/// Ways out at the contacts' places.
class Places {
 public:
  Places(std::span<const ContactPoint> contacts, const WayOutMeasure& measure)
      : measure_(measure), middle_(Vec3::Zero()) {
    for (const ContactPoint& contact : contacts) middle_ += contact.point / double(contacts.size());
  }
  std::optional<WayOut> measure(const Vec3& place, const Vec3& direction, double inward,
                                double longest = std::numeric_limits<double>::infinity()) const {
    ++measured_;
    if (auto way = measure_(place + inward * (middle_ - place), direction, longest)) return way;
    return measure_(place + kBarely * (middle_ - place), direction, longest);
  }
  int measured() const { return measured_; }  ///< so far

 private:
  const WayOutMeasure& measure_;
  Vec3 middle_;
  mutable int measured_ = 0;
};

void add_unlike(std::vector<Vec3>& normals, const Vec3& normal) {
  constexpr std::size_t kEnough = 4;
  const auto like = [&](const Vec3& other) { return other.dot(normal) > kSameDirection; };
  if (normals.size() < kEnough && std::ranges::none_of(normals, like)) normals.push_back(normal);
}

std::vector<Vec3> edges_between(std::span<const Vec3> normals) {
  std::vector<Vec3> edges;
  for (std::size_t i = 0; i < normals.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const Vec3 edge = normals[i].cross(normals[j]); edge.norm() > 0.1)
        edges.push_back(edge.normalized());
  return edges;
}

/// Looks for the displacement with the least depth for each of the places that it clears.
class Search {
 public:
  /// Tries no new direction once `places` has measured `until` ways out.
  Search(std::span<const ContactPoint> sample, double slack, const Places& places, int until)
      : sample_(sample), slack_(slack), places_(places), until_(until) {}

  void consider(const Vec3& direction) {
    if (places_.measured() >= until_) return;
    if (std::ranges::any_of(tried_, [&](const Vec3& other) { return other.dot(direction) > kTried; })) return;
    tried_.push_back(direction);
    const auto ways = measure(direction);
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const double each = (ways[i].depth + slack_) / double(i + 1);
      if (each >= least_) continue;
      least_ = each;
      best_ = Displacement{direction, ways[i].depth, int(i) + 1};
      faces_of_best_ = ways;
    }
  }

  /// The faces met on the best way out ask for their own normals.
  void refine() {
    for (std::size_t tried = 0; tried != tried_.size();) {
      tried = tried_.size();
      for (const WayOut& way : std::vector(faces_of_best_)) consider_faces(way);
    }
  }

  /// Where edge meets edge the way out is across both: faces of a body that differ meet in an edge.
  void consider_edges() {
    const auto first_edges = edges_between(first_faces_), second_edges = edges_between(second_faces_);
    for (const Vec3& first : first_edges)
      for (const Vec3& second : second_edges)
        if (const Vec3 across = first.cross(second); across.norm() > 0.1) {
          consider(across.normalized());
          consider(-across.normalized());
        }
  }

  /// The faces around a few of the places.
  void look_around() {
    for (const ContactPoint& contact : sample_.first(std::min<std::size_t>(sample_.size(), 3)))
      for (int axis = 0; axis < 6; ++axis)
        if (const auto way = places_.measure(
                contact.point, axis < 3 ? Vec3::Unit(axis) : Vec3(-Vec3::Unit(axis - 3)), kToCompare))
          consider_faces(*way);
  }

  const std::optional<Displacement>& best() const { return best_; }
  bool clears_all_within(double depth) const {
    return best_ && best_->cleared == int(sample_.size()) && best_->depth <= depth;
  }

 private:
  void consider_faces(const WayOut& way) {
    consider(way.second_face);
    if (way.first_face) consider(*way.first_face);
  }

  /// Shallowest first; gives up where the direction can no longer be the best.
  std::vector<WayOut> measure(const Vec3& direction) {
    std::vector<WayOut> ways;
    const double longest = least_ * double(sample_.size()) - slack_;
    std::size_t left = sample_.size();
    for (const ContactPoint& contact : sample_) {
      const auto way = places_.measure(contact.point, direction, kToCompare, longest);
      --left;
      if (way) add_unlike(second_faces_, way->second_face);
      if (way && way->first_face) add_unlike(first_faces_, *way->first_face);
      if (way && way->depth < longest) {
        const auto longer = std::ranges::upper_bound(ways, way->depth, {}, &WayOut::depth);
        ways.insert(longer, *way);
      }
      if (!can_be_best(ways, left)) return {};
    }
    return ways;
  }
  /// With these `ways`, if nothing is in the way of the places that are `left`.
  bool can_be_best(std::span<const WayOut> ways, std::size_t left) const {
    if (left > 0 && slack_ < least_ * double(left)) return true;
    for (std::size_t i = 0; i < ways.size(); ++i)
      if (ways[i].depth + slack_ < least_ * double(left + i + 1)) return true;
    return false;
  }

  std::span<const ContactPoint> sample_;
  double slack_;
  const Places& places_;
  int until_;
  std::vector<Vec3> tried_;
  std::optional<Displacement> best_;
  std::vector<WayOut> faces_of_best_;
  std::vector<Vec3> first_faces_, second_faces_;  // a few of those met
  double least_ = std::numeric_limits<double>::infinity();
};

std::optional<Displacement> find_displacement(std::span<ContactPoint> contacts, double size,
                                              const Places& places, int until) {
  Search search(contacts.first(reduce_contacts(contacts, kSample, size)), kDepthSlack * size, places, until);
  std::vector<ContactPoint> shallow_first(contacts.begin(), contacts.end());
  std::ranges::stable_sort(shallow_first, {}, &ContactPoint::depth);
  for (const ContactPoint& contact : shallow_first) search.consider(contact.normal);
  search.refine();
  search.consider_edges();
  if (!search.clears_all_within(kShallow * size)) {
    search.look_around();
    search.refine();
    search.consider_edges();
  }
  return search.best();
}

/// Turns the contacts that `way` clears to its direction and moves them to the front; returns the others.
std::span<ContactPoint> turn_cleared(std::span<ContactPoint> contacts, const Displacement& way, double slack,
                                     const Places& places) {
  const auto clears = [&](double depth) { return depth <= kDepthRatio * way.depth + slack; };
  const auto turn = [&](ContactPoint& contact) {
    if (contact.normal.dot(way.direction) > kSameDirection && clears(contact.depth)) return true;
    const auto compared = places.measure(contact.point, way.direction,
                                         kToCompare);  // as in the search, which cleared at least one
    if (compared && !clears(compared->depth)) return false;
    // It comes out its own way, so it is inside; ground that is a sheet has no other side, nor an end that a
    // way along it would reach.
    if (!compared && places.measure(contact.point, contact.normal, kToCompare)) return false;
    const auto measured = places.measure(contact.point, way.direction, kToMeasure);
    contact = {contact.point, way.direction, measured ? measured->depth : 0.0};
    return true;
  };
  auto end = contacts.begin();
  for (ContactPoint& contact : contacts)
    if (turn(contact)) std::swap(contact, *end++);
  return {end, contacts.end()};
}

}  // namespace

bool plainly_believable(std::span<const ContactPoint> contacts, double size) {
  return std::ranges::all_of(contacts, [&](const ContactPoint& contact) {
    return contact.depth < kShallow * size && contact.normal.dot(contacts[0].normal) > kSameDirection;
  });
}

int filter_contacts(std::span<ContactPoint> contacts, double size, const WayOutMeasure& measure,
                    int most_measures) {
  constexpr int kLeast = 5 * kSample;  // of a round: those that are left want a direction, too
  const Places places(contacts, measure);
  std::span<ContactPoint> left = contacts;
  while (!left.empty()) {
    const auto way =
        find_displacement(left, size, places, std::max(most_measures, places.measured() + kLeast));
    if (!way) break;
    left = turn_cleared(left, *way, kDepthSlack * size, places);
  }
  return int(contacts.size() - left.size());
}

int drop_inner_contacts(std::span<ContactPoint> contacts, double size) {
  constexpr double kOneWay = 0.9999,                  // cosine
      kInside = 1e-2, kFlush = 1e-3, kDeeper = 1e-4;  // over size
  const auto count = int(contacts.size());
  if (count < 4) return count;
  const Vec3 normal = contacts[0].normal;
  if (!std::ranges::all_of(contacts, [&](const ContactPoint& c) { return c.normal.dot(normal) > kOneWay; }))
    return count;
  const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
  std::vector<Eigen::Vector2d> outline;  // counter-clockwise (Andrew's monotone chain)
  for (const ContactPoint& c : contacts) outline.emplace_back(c.point.dot(x), c.point.dot(y));
  std::ranges::sort(outline, {}, [](const Eigen::Vector2d& p) { return std::pair(p.x(), p.y()); });
  const auto side = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& p) {
    const Eigen::Vector2d along = to - from, out = p - from;
    return along.x() * out.y() - along.y() * out.x();
  };
  const auto chain = [&](auto begin, auto end) {
    std::vector<Eigen::Vector2d> corners;
    for (auto p = begin; p != end; ++p) {
      while (corners.size() > 1 && side(corners[corners.size() - 2], corners.back(), *p) <= 0.0)
        corners.pop_back();
      corners.push_back(*p);
    }
    corners.pop_back();  // the other one's first
    return corners;
  };
  std::vector<Eigen::Vector2d> corners = chain(outline.begin(), outline.end());
  const std::vector<Eigen::Vector2d> upper = chain(outline.rbegin(), outline.rend());
  corners.insert(corners.end(), upper.begin(), upper.end());
  const auto is_inside = [&](const ContactPoint& c) {
    const Eigen::Vector2d p(c.point.dot(x), c.point.dot(y));
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d &from = corners[i], &to = corners[(i + 1) % corners.size()];
      if (side(from, to, p) < kInside * size * (to - from).norm()) return false;
    }
    return corners.size() > 2;
  };
  double deepest = 0.0, shallowest = std::numeric_limits<double>::infinity();  // of the outline
  for (const ContactPoint& c : contacts)
    if (!is_inside(c)) deepest = std::max(deepest, c.depth), shallowest = std::min(shallowest, c.depth);
  if (deepest - shallowest > kFlush * size) return count;
  const auto carries = [&](const ContactPoint& c) {
    return !is_inside(c) || c.depth > deepest + kDeeper * size;
  };
  return int(std::stable_partition(contacts.begin(), contacts.end(), carries) - contacts.begin());
}

int reduce_contacts(std::span<ContactPoint> contacts, int max_contacts, double size) {
  if (contacts.empty()) return 0;
  std::iter_swap(contacts.begin(), std::ranges::max_element(contacts, {}, &ContactPoint::depth));
  std::vector<double> distance(contacts.size(), std::numeric_limits<double>::infinity());
  const int most = std::min(int(contacts.size()), max_contacts);
  for (int taken = 1; taken < most; ++taken) {
    const ContactPoint& last = contacts[taken - 1];
    for (std::size_t i = taken; i < contacts.size(); ++i)
      distance[i] = std::min(distance[i], (contacts[i].point - last.point).squaredNorm() +
                                              size * size * (contacts[i].normal - last.normal).squaredNorm());
    const auto farthest = std::max_element(distance.begin() + taken, distance.end()) - distance.begin();
    if (distance[farthest] < kTooNear * size * kTooNear * size) return taken;
    std::swap(contacts[taken], contacts[farthest]);
    std::swap(distance[taken], distance[farthest]);
  }
  return most;
}

}  // namespace lodestone
