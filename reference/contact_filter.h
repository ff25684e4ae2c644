// Makes ODE's trimesh–trimesh contacts believable. OPCODE measures each pair of crossing triangles by itself, against the two
// triangles' own planes, so two stacked cubes half a millimetre deep also get contacts through the whole of a cube, sideways. Where
// contacts share a point ODE keeps the deepest, so the false one replaces the true, or averages directions that have nothing in common.
// So the places are believed and the directions are proposals. The directions taken are those of the cheapest set of displacements that
// clears every place (greedy weighted set cover; Chvátal, A greedy heuristic for the set-covering problem, 1979), measured in the solid:
// a false direction goes far and clears little. A place cleared along another direction than its own is measured anew along that.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "reference/geometry.h"

namespace lodestone {

/// Where two bodies touch. `normal` (unit) points into the first body; moved along it by `depth` (m), the first body is clear.
struct ContactPoint {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  double depth = 0.0;
};

/// How far (m) the first body must move along `direction` (unit) for the two to be clear of each other at `place`, 0 where they are clear
/// already; nothing where the place is outside either of them by more than rounding.
using OverlapMeasure = std::function<std::optional<double>(const Vec3& place, const Vec3& direction)>;

/// Moves the contacts to believe to the front and returns how many they are. `proposals` are unit directions to try besides the contacts' own;
/// `size` (m) is the smaller body's radius.
int filter_contacts(std::span<ContactPoint> contacts, std::span<const Vec3> proposals, double size, const OverlapMeasure& overlap);

/// Whether filter_contacts would let `contacts` pass as they are: their directions agree and they are shallow.
bool plainly_believable(std::span<const ContactPoint> contacts, double size);

/// Moves to the front the at most `max_contacts` that hold the bodies apart best: the deepest, then each time the one farthest (in place
/// and in direction) from those taken. Returns how many they are.
int reduce_contacts(std::span<ContactPoint> contacts, int max_contacts, double size);

}  // namespace lodestone
