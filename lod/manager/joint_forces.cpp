#include "lod/manager/joint_forces.h"

#include <algorithm>

namespace lodestone {
namespace {

Vec3 lasting(const Vec3& one, const Vec3& other) {
  if (one.dot(other) <= 0.0) return Vec3::Zero();
  return one.squaredNorm() < other.squaredNorm() ? one : other;
}

}  // namespace

const JointForces::Held* JointForces::find(std::uint32_t owner) const {
  const auto at = std::ranges::lower_bound(held_, owner, {}, &Held::owner);
  return at != held_.end() && at->owner == owner ? &*at : nullptr;
}

void JointForces::add_to(std::span<FullNeighbor> neighbors) const {
  if (held_.empty()) return;
  for (FullNeighbor& neighbor : neighbors)
    if (const Held* held = find(neighbor.owner)) {
      neighbor.force += held->lasting.force;
      neighbor.torque += held->lasting.torque;
    }
}

void JointForces::begin(std::span<const FullNeighbor> neighbors, std::span<dxBody* const> bodies) {
  listened_.clear();
  for (const FullNeighbor& neighbor : neighbors) listened_.push_back(neighbor.owner);
  listener_.listen(bodies);
}

void JointForces::end() {
  const std::span<const JointForce> forces = listener_.stop();
  std::vector<Held> now;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const JointForce& last = forces[i];
    if (last.force.isZero(0.0) && last.torque.isZero(0.0)) continue;
    Held& held = now.emplace_back(Held{.owner = listened_[i], .last = last, .lasting = {}});
    if (const Held* before = find(held.owner))
      held.lasting = {lasting(last.force, before->last.force), lasting(last.torque, before->last.torque)};
  }
  std::ranges::sort(now, {}, &Held::owner);
  held_ = std::move(now);
}

}  // namespace lodestone
