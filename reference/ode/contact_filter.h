// Makes ODE's trimesh–trimesh contacts believable. OPCODE measures each pair of crossing triangles by itself,
// against the two triangles' own planes, so two stacked cubes half a millimetre deep also get contacts
// through the whole of a cube, sideways. Where contacts share a point ODE keeps the deepest, so the false one
// replaces the true, or averages directions that have nothing in common. So the places are believed and the
// directions are proposals. The directions taken are those of the cheapest set of displacements that clears
// every place (greedy weighted set cover; Chvátal, A greedy heuristic for the set-covering problem, 1979),
// measured in the solid: a false direction goes far and clears little. A place cleared along another
// direction than its own is measured anew along that.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>

#include "reference/contact_point.h"

namespace lodestone {

/// What moving the first body along a direction meets.
struct WayOut {
  double depth = 0.0;  ///< m until the two are clear of each other at the place; 0 where they are already
  /// The directions (unit) that the faces met last ask for: the outward normal of the second body's and the
  /// inward normal of the first's; without the latter where the way is too long to be measured to its end.
  Vec3 second_face = Vec3::UnitZ();
  std::optional<Vec3> first_face = {};
};

/// Measures the way out along `direction` (unit) at `place`, of one longer than `longest` (m) perhaps a part
/// that is; nothing where the place is outside either body by more than rounding.
using WayOutMeasure =
    std::function<std::optional<WayOut>(const Vec3& place, const Vec3& direction, double longest)>;

/// Moves the contacts to believe to the front and returns how many they are. `size` (m) is the smaller body's
/// radius. Once about `most_measures` ways out were measured, the best directions known so far are taken: the
/// search mostly needs three hundred of them, but where two concave meshes are deep in each other ten
/// thousand.
int filter_contacts(std::span<ContactPoint> contacts, double size, const WayOutMeasure& measure,
                    int most_measures = std::numeric_limits<int>::max());

/// Whether filter_contacts would let `contacts` pass as they are: their directions agree and they are
/// shallow.
bool plainly_believable(std::span<const ContactPoint> contacts, double size);

/// Where all contacts have one direction and those on their outline are as deep as each other, moves these to
/// the front, and within it what is deeper: a point in the midst of a face that touches, as where the
/// diagonals of two squares cross, would carry what the corners should, and on one point a body turns freely.
/// Returns how many they are.
int drop_inner_contacts(std::span<ContactPoint> contacts, double size);

/// Moves to the front the at most `max_contacts` that hold the bodies apart best: the deepest, then each time
/// the one farthest (in place and in direction) from those taken, until none is farther than .02 × `size`.
/// Returns how many they are.
int reduce_contacts(std::span<ContactPoint> contacts, int max_contacts, double size);

}  // namespace lodestone
