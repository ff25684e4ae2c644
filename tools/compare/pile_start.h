// Where the bodies of a pile start: at rest, turned at random, none within another's bounding sphere.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/ground/ground.h"
#include "reference/shape.h"

namespace lodestone {

/// The bodies and the bin that they fall into.
struct PileConditions {
  int bodies = 100;
  double side = 1.6;  ///< m, of the bin's square floor
};

/// Its floor at z = 0 and four walls without end, `side` m apart about the origin.
std::vector<HalfSpace> make_bin(double side);

/// Throws InputError where no body fits between the walls.
void check_pile(const Shape& shape, const PileConditions& conditions);

/// Layers over the bin as in table 1 (Hsu and Keyser, 2009): square cells that hold a bounding sphere each, a
/// little room to place it in, the lowest centre 1.2 m (bodies of .2–.4 m; others scaled as drops are) above
/// the floor. A function of the arguments alone.
std::vector<RigidState> make_pile_start(const Shape& shape, const PileConditions& conditions,
                                        std::uint64_t seed);

/// The same bodies in a cube of cells about the origin, each on its way there: it would arrive after one
/// second.
std::vector<RigidState> make_converging_start(const Shape& shape, int bodies, std::uint64_t seed);

}  // namespace lodestone
