// Which points of a body that touches nothing else may meet static boxes and meshes in a step, each with the
// plane through what it meets there.
#pragma once

#include <optional>
#include <vector>

#include "lod/ground/met_ground.h"
#include "lod/statistical/statistical_body.h"

namespace lodestone {

struct SolidPoint {
  std::int32_t vertex = -1;   ///< of the hull; −1: where features cross, or of a sphere
  Vec3 point = Vec3::Zero();  ///< m, world
  HalfSpace plane;
  double least_gap = 0.0;  ///< m: now or, as the body moves, at the step's end
  bool along_face = true;  ///< of the solid; else across an edge or a corner
};

struct SolidPoints {
  std::vector<SolidPoint> points;  ///< the nearest first
  std::vector<HalfSpace> planes;   ///< to the body wholly (see find_solid_contacts)
  /// s: no edge or corner that is farther now than what touches is struck sooner. Held in a plane across the
  /// way to it, the body would stop before an edge that it passes over.
  double until = 0.0;
};

/// Of the body as it moves for `time` seconds. `margin`, m: what is nearer can carry.
void find_solid_points(const StatisticalBody& body, const BodyKind& kind, const MetGround& ground,
                       double time, double margin, SolidPoints& found);

}  // namespace lodestone
