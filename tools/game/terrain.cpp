#include "tools/game/terrain.h"

#include <algorithm>
#include <cmath>

namespace game {

double Terrain::height(double x, double y) {
  const double r = std::hypot(x, y);
  const double hills = std::clamp((r - 7.0) / 9.0, 0.0, 1.0), rim = std::clamp(r - 20.0, 0.0, 12.0);
  return hills * hills * (3.0 - 2.0 * hills) *
             (0.9 * std::sin(0.42 * x + 0.5) * std::cos(0.35 * y) + 0.25 * std::sin(0.9 * y)) +
         0.02 * rim * rim;
}

Terrain::Terrain(dSpaceID space) : heights_(kSamples * kSamples), data_(dGeomHeightfieldDataCreate()) {
  // ODE's height fields have y up; turned upright, their z axis is the world's −y.
  for (int row = 0; row < kSamples; ++row)
    for (int column = 0; column < kSamples; ++column)
      heights_[row * kSamples + column] = height(coordinate(column), -coordinate(row));
  const int copy_heights = 0, wrap = 0;
  dGeomHeightfieldDataBuildDouble(data_, heights_.data(), copy_heights, kSide, kSide, kSamples, kSamples, 1.0,
                                  0.0, 2.0, wrap);
  const dGeomID geom = dCreateHeightfield(space, data_, 1);
  const dQuaternion upright = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  dGeomSetQuaternion(geom, upright);
}

Terrain::~Terrain() { dGeomHeightfieldDataDestroy(data_); }

}  // namespace game
