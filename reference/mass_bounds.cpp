#include "reference/mass_bounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reference/error.h"
#include "reference/mesh/mass_properties.h"

namespace lodestone {

void check_mass(double mass) {
  if (!(mass >= kLeastMass && mass <= kGreatestMass))
    throw_input_error("mass", fmt::format("{:g} kg", mass),
                      fmt::format("{:g} … {:g} kg", kLeastMass, kGreatestMass));
}

void check_inertia(const Shape& shape) {
  if (!is_possible_inertia(shape.inertia_per_mass))
    throw_input_error("inertia of " + shape.name, "one that no body can have",
                      "a symmetric, positive definite one with I1 + I2 ≥ I3");
  const PrincipalAxes principal = find_principal_axes(shape.inertia_per_mass);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 along = principal.axes.col(axis);
    double farthest = 0.0;  // m², from the axis
    for (const Vec3& vertex : shape.hull.vertices)
      farthest = std::max(farthest, vertex.squaredNorm() - std::pow(along.dot(vertex), 2));
    const double moment = principal.moments[axis];
    if (!(moment >= kLeastMoment * farthest))
      throw_input_error("inertia of " + shape.name, fmt::format("a moment of {:g} m² over the mass", moment),
                        fmt::format("{:g} m² or more, by its extent", kLeastMoment * farthest));
  }
}

}  // namespace lodestone
