#include "reference/contact_filter.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace lodestone {
namespace {

constexpr double kSameDirection = 0.9;  // least cosine between contacts of one direction
constexpr double kShallow = 2e-2;       // × size: depths below it need no second look where all directions agree
constexpr double kDepthSlack = 2e-3;    // × size: depths below it cost about the same
constexpr double kDepthRatio = 1.5;     // a way out clears depths up to this times its own, and the slack
constexpr int kSample = 16;             // places that directions are judged by
// Places lie on edges, where any way out seems short; they are measured this part of the way towards their middle, as far as that is inside.
constexpr double kInward = 0.15, kBarelyInward = 1e-3;

/// A displacement of the first body.
struct WayOut {
  Vec3 direction = Vec3::UnitZ();
  double depth = 0.0;
};

class Cover {
 public:
  Cover(std::span<const ContactPoint> contacts, double size, const OverlapMeasure& overlap)
      : slack_(kDepthSlack * size), overlap_(overlap), middle_(Vec3::Zero()) {
    for (const ContactPoint& contact : contacts) middle_ += contact.point / double(contacts.size());
  }

  std::optional<double> depth_along(const Vec3& direction, const Vec3& place) const {
    if (const auto depth = overlap_(place + kInward * (middle_ - place), direction)) return depth;
    return overlap_(place + kBarelyInward * (middle_ - place), direction);
  }

  bool clears(const WayOut& way, double depth) const { return depth <= kDepthRatio * way.depth + slack_; }

  /// Whether the contact says itself what the way out says.
  bool agrees(const ContactPoint& contact, const WayOut& way) const {
    return contact.normal.dot(way.direction) > kSameDirection && clears(way, contact.depth);
  }

  /// The displacement with the least depth for each of the places that it clears.
  std::optional<WayOut> best_of(std::span<const Vec3> directions, std::span<const ContactPoint> sample) const {
    std::optional<WayOut> best;
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& direction : directions) {
      depths_.clear();
      for (const ContactPoint& contact : sample)
        if (const auto depth = depth_along(direction, contact.point)) depths_.push_back(*depth);
      std::ranges::sort(depths_);
      for (std::size_t i = 0; i < depths_.size(); ++i)
        if (const double each = (depths_[i] + slack_) / double(i + 1); each < least) least = each, best = WayOut{direction, depths_[i]};
    }
    return best;
  }

 private:
  double slack_;
  const OverlapMeasure& overlap_;
  Vec3 middle_;
  mutable std::vector<double> depths_;
};

void add_unlike(std::vector<Vec3>& directions, const Vec3& direction, double least_cosine) {
  const auto like = [&](const Vec3& other) { return other.dot(direction) > least_cosine; };
  if (std::ranges::none_of(directions, like)) directions.push_back(direction);
}

std::vector<Vec3> directions_of(std::span<const ContactPoint> contacts, std::span<const Vec3> proposals) {
  std::vector<Vec3> directions;
  for (const Vec3& proposal : proposals) add_unlike(directions, proposal, 0.999);
  for (const ContactPoint& contact : contacts) add_unlike(directions, contact.normal, 0.99);
  return directions;
}

/// Turns the contacts that `way` clears to its direction and moves them to the front; returns the others.
std::span<ContactPoint> turn_cleared(std::span<ContactPoint> contacts, const WayOut& way, const Cover& cover) {
  const auto turn = [&](ContactPoint& contact) {
    if (cover.agrees(contact, way)) return true;
    const double depth = cover.depth_along(way.direction, contact.point).value_or(0.0);
    if (!cover.clears(way, depth)) return false;
    contact = {contact.point, way.direction, depth};
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

int filter_contacts(std::span<ContactPoint> contacts, std::span<const Vec3> proposals, double size, const OverlapMeasure& overlap) {
  const Cover cover(contacts, size, overlap);
  std::span<ContactPoint> left = contacts;
  while (!left.empty()) {
    const auto sample = left.first(reduce_contacts(left, kSample, size));
    const auto way = cover.best_of(directions_of(left, proposals), sample);
    if (!way) break;
    left = turn_cleared(left, *way, cover);
  }
  return int(contacts.size() - left.size());
}

int reduce_contacts(std::span<ContactPoint> contacts, int max_contacts, double size) {
  if (int(contacts.size()) <= max_contacts) return int(contacts.size());
  std::iter_swap(contacts.begin(), std::ranges::max_element(contacts, {}, &ContactPoint::depth));
  std::vector<double> distance(contacts.size(), std::numeric_limits<double>::infinity());
  for (int taken = 1; taken < max_contacts; ++taken) {
    const ContactPoint& last = contacts[taken - 1];
    for (std::size_t i = taken; i < contacts.size(); ++i)
      distance[i] = std::min(distance[i], (contacts[i].point - last.point).squaredNorm() +
                                              size * size * (contacts[i].normal - last.normal).squaredNorm());
    const auto farthest = std::max_element(distance.begin() + taken, distance.end()) - distance.begin();
    std::swap(contacts[taken], contacts[farthest]);
    std::swap(distance[taken], distance[farthest]);
  }
  return max_contacts;
}

}  // namespace lodestone
