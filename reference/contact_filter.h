// Which of ODE's trimesh–trimesh contacts to believe. OPCODE measures each pair of crossing triangles by itself, against the two
// triangles' own planes, so two stacked cubes half a millimetre deep also get contacts through the whole of a cube, sideways.
// A contact much deeper than the shallowest direction is believed only where it would outlast the way out along that direction.
#pragma once

#include <functional>
#include <span>

#include "reference/geometry.h"

namespace lodestone {

/// Where two bodies touch. `normal` (unit) points into the first body; moved along it by `depth` (m), the first body is clear.
struct ContactPoint {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  double depth = 0.0;
};

/// Whether the bodies would still overlap at `contact` if the first were moved by `shift` (m, world).
using OverlapTest = std::function<bool(const ContactPoint& contact, const Vec3& shift)>;

/// Moves the contacts to believe to the front, keeping their order, and returns how many they are. Contacts are grouped by normal; the
/// group whose deepest contact is shallowest is always believed; so is every contact up to 3 × that depth + .002 × `size` (m, of the
/// smaller body), and a deeper one that `still_overlaps` after each believed group's own way out.
int filter_contacts(std::span<ContactPoint> contacts, double size, const OverlapTest& still_overlaps);

/// Moves to the front the at most `max_contacts` that hold the bodies apart best, the deepest first, and returns how many they are.
int reduce_contacts(std::span<ContactPoint> contacts, int max_contacts);

}  // namespace lodestone
