#include "reference/ode/plane_contacts.h"

#include <algorithm>

namespace lodestone {
namespace {

// Below this many vertices to look at them all is quicker than to climb.
constexpr std::size_t kScanBelow = 24;

bool deeper(const PlaneContact& a, const PlaneContact& b) {
  return a.depth != b.depth ? a.depth > b.depth : a.vertex < b.vertex;
}

}  // namespace

std::span<const PlaneContact> PlaneContactFinder::find(const Hull& hull, const Vec3& normal, double offset,
                                                       int max_contacts, int& start, std::int64_t* dropped) {
  found_.clear();
  if (hull.vertices.size() < kScanBelow) {
    gather_by_scan(hull, normal, offset);
  } else {
    start = find_support(hull, -normal, start);
    gather_by_flood(hull, normal, offset, start);
  }
  const std::size_t kept = std::min<std::size_t>(found_.size(), max_contacts);
  std::partial_sort(found_.begin(), found_.begin() + kept, found_.end(), deeper);
  if (dropped) *dropped = std::int64_t(found_.size() - kept);
  return {found_.data(), kept};
}

void PlaneContactFinder::gather_by_scan(const Hull& hull, const Vec3& normal, double offset) {
  for (int i = 0; i < int(hull.vertices.size()); ++i) {
    const double depth = offset - normal.dot(hull.vertices[i]);
    if (depth > 0.0) found_.push_back({i, depth});
  }
}

void PlaneContactFinder::gather_by_flood(const Hull& hull, const Vec3& normal, double offset, int start) {
  visited_.resize(std::max(visited_.size(), hull.vertices.size()), round_);
  ++round_;
  const auto visit = [&](int i) {
    if (visited_[i] == round_) return;
    visited_[i] = round_;
    const double depth = offset - normal.dot(hull.vertices[i]);
    if (depth > 0.0) found_.push_back({i, depth});
  };
  visit(start);
  for (std::size_t next = 0; next < found_.size(); ++next)  // found_ is also the queue
    for (const int i : hull.neighbors(found_[next].vertex)) visit(i);
}

}  // namespace lodestone
