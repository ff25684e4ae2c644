// The forces on bodies of a level, as they act through one step.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "reference/geometry.h"

namespace lodestone {

struct ActingForce {
  std::int32_t slot = -1;
  Vec3 acceleration = Vec3::Zero();  ///< m/s²
  Vec3 turning = Vec3::Zero();       ///< m²/s²: torque over mass, by which the spin changes
  bool is_none() const { return acceleration.isZero(0.0) && turning.isZero(0.0); }
};

class ActingForces {
 public:
  void clear() { forces_.clear(); }
  bool empty() const { return forces_.empty(); }
  std::span<const ActingForce> all() const { return forces_; }  ///< by slot
  void add(const ActingForce& force) { forces_.push_back(force); }
  /// Before of(): several on one body become their sum.
  void put_in_order() {
    std::ranges::stable_sort(forces_, {}, &ActingForce::slot);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      if (kept > 0 && forces_[kept - 1].slot == forces_[i].slot) {
        forces_[kept - 1].acceleration += forces_[i].acceleration;
        forces_[kept - 1].turning += forces_[i].turning;
      } else {
        forces_[kept++] = forces_[i];
      }
    }
    forces_.resize(kept);
  }
  /// Of a body by its slot; a force of nothing where none acts.
  const ActingForce& of(std::int32_t slot) const {
    static const ActingForce none;
    if (forces_.empty()) return none;
    const auto found = std::ranges::lower_bound(forces_, slot, {}, &ActingForce::slot);
    return found != forces_.end() && found->slot == slot ? *found : none;
  }

 private:
  std::vector<ActingForce> forces_;
};

}  // namespace lodestone
