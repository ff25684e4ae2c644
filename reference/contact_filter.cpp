#include "reference/contact_filter.h"

#include <algorithm>
#include <vector>

namespace lodestone {
namespace {

constexpr double kSameGroup = 0.9;   // least cosine between normals of one group
constexpr double kDepthRatio = 3.0;  // believed without question: this times the shallowest group's depth …
constexpr double kDepthSlack = 2e-3; // … plus this times the size
constexpr double kClearance = 1e-4;  // a way out goes this times the size farther than the depth

struct Group {
  Vec3 normal;
  double depth;  // of its deepest contact
};

std::vector<Group> group_by_normal(std::span<const ContactPoint> contacts) {
  std::vector<Group> groups;
  for (const ContactPoint& contact : contacts) {
    const auto same = [&](const Group& group) { return group.normal.dot(contact.normal) > kSameGroup; };
    const auto group = std::ranges::find_if(groups, same);
    if (group == groups.end())
      groups.push_back({contact.normal, contact.depth});
    else
      group->depth = std::max(group->depth, contact.depth);
  }
  return groups;
}

}  // namespace

int filter_contacts(std::span<ContactPoint> contacts, double size, const OverlapTest& still_overlaps) {
  if (contacts.empty()) return 0;
  std::vector<Group> groups = group_by_normal(contacts);
  const double shallowest = std::ranges::min(groups, {}, &Group::depth).depth;
  const double believed_depth = kDepthRatio * shallowest + kDepthSlack * size;
  std::erase_if(groups, [&](const Group& group) { return group.depth > believed_depth; });

  const auto resolved_by = [&](const ContactPoint& contact, const Group& group) {
    return !still_overlaps(contact, group.normal * (group.depth + kClearance * size));
  };
  const auto is_false = [&](const ContactPoint& contact) {
    return contact.depth > believed_depth &&
           std::ranges::any_of(groups, [&](const Group& group) { return resolved_by(contact, group); });
  };
  const auto removed = std::ranges::stable_partition(contacts, std::not_fn(is_false));
  return int(removed.begin() - contacts.begin());
}

int reduce_contacts(std::span<ContactPoint> contacts, int max_contacts) {
  const int kept = std::min(int(contacts.size()), max_contacts);
  std::ranges::stable_sort(contacts, std::ranges::greater{}, &ContactPoint::depth);
  return kept;
}

}  // namespace lodestone
