// The ground as one body meets it: of a caller's geoms only those that their bits and its own let meet; a
// body of the caller's meets nothing but his geoms.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "lod/ground/ground.h"

namespace lodestone {

class MetGround {
 public:
  /// As most bodies do: all of it.
  MetGround(const Ground& ground) : ground_(ground) {}  // NOLINT: to most bodies it is the same
  MetGround(const Ground& ground, const BodyProperties& own)
      : ground_(ground), category_(own.category), collide_(own.collide) {}
  /// As a body of the caller's whose geoms have these bits.
  MetGround(const Ground& ground, const GroundBits& callers)
      : ground_(ground), category_(callers.category), collide_(callers.collide), callers_alone_(true) {}

  bool meets(const GroundBits& bits) const {
    return may_meet(category_, collide_, bits.category, bits.collide) && (bits.callers || !callers_alone_);
  }
  /// As Ground::find_parts.
  void find_parts(const Vec3& center, double reach, std::vector<const GroundPart*>& found) const {
    const auto before = std::ptrdiff_t(found.size());
    ground_.find_parts(center, reach, found);
    if (meets_all()) return;
    const auto passed = [this](const GroundPart* part) { return !meets(part->shape.bits); };
    found.erase(std::remove_if(found.begin() + before, found.end(), passed), found.end());
  }
  /// Of some of the ground's planes or faces; valid until this thread calls it again.
  std::span<const HalfSpace> of(std::span<const HalfSpace> planes) const {
    if (meets_all()) return planes;
    thread_local std::vector<HalfSpace> met;
    met.clear();
    for (const HalfSpace& plane : planes)
      if (meets(plane.bits)) met.push_back(plane);
    return met;
  }
  std::span<const HalfSpace> planes() const { return of(ground_.planes()); }

 private:
  bool meets_all() const { return (category_ & collide_) == ~0u && !callers_alone_; }

  const Ground& ground_;
  unsigned category_ = ~0u, collide_ = ~0u;
  bool callers_alone_ = false;
};

}  // namespace lodestone
