// The caller's boxes and convexes as shapes of ours, so that bodies meet them as they meet each other:
// exactly. Made as they are first touched.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "reference/ode/space_mirror.h"
#include "reference/shape.h"

namespace lodestone::ode {

/// In the geom's own frame, about `center` (m).
struct CallersShape {
  std::shared_ptr<const Shape> shape;
  Vec3 center = Vec3::Zero();
};

class CallersShapes {
 public:
  /// After a refresh: forgets those of slots that another has taken.
  void forget(const SpaceMirror& mirror);
  /// Null where the geom of `slot` is neither a box nor a convex.
  const CallersShape* find(const SpaceMirror& mirror, std::uint32_t slot);

 private:
  enum class Known : char { no, none, yes };
  CallersShape make(dxGeom* geom);
  std::shared_ptr<const Shape> box_of(const Vec3& sides);

  std::vector<CallersShape> shapes_;                                   // by slot
  std::vector<Known> known_;                                           // one of each
  std::map<std::array<double, 3>, std::weak_ptr<const Shape>> boxes_;  // by their sides
};

}  // namespace lodestone::ode
