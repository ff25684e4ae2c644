// The game's hills: a height field of ODE's, and the same surface to draw.
#pragma once

#include <ode/ode.h>

#include <vector>

namespace game {

/// Flat about the origin, hills around, a rim at the edge. Owns the height field's data, which must outlive
/// the geom.
class Terrain {
 public:
  static constexpr double kSide = 64.0;  ///< m
  static constexpr int kSamples = 129;   ///< along a side: one each half metre

  explicit Terrain(dSpaceID space);
  ~Terrain();
  Terrain(const Terrain&) = delete;
  Terrain& operator=(const Terrain&) = delete;

  static double height(double x, double y);  ///< m, of the smooth surface
  static double coordinate(int sample) { return kSide * sample / (kSamples - 1) - 0.5 * kSide; }

 private:
  std::vector<double> heights_;
  dHeightfieldDataID data_;
};

}  // namespace game
