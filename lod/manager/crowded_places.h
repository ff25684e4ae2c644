// Bodies that were added at nearly one place: ten thousand of them would be fifty million pairs. They take
// part a few at a time, in the order in which they came, while those before them are pushed apart; the others
// wait as they were given.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/manager/levels.h"

namespace lodestone {

/// So many of one size at a time, nearer to each other than the radius of the ball inside them
/// (Shape::inner_radius): stacks, of thin plates too, are none. Nor do they come in but as many as fit by
/// volume where they were given eight times as densely, or twice with such as overlap for certain.
inline constexpr int kBodiesOfAPlace = 4;

/// The newcomers that wait, ascending: until less than kBodiesOfAPlace take part within a radius of them, and
/// where they were given too densely until there is room for them in theirs. Whatever stays there (asleep, or
/// let through by a filter), one more comes every eighth step. Those that meet none of their own kind
/// never wait, and those that the pair filter lets through each other not for one another. Costs a look at
/// every body in a step in which there are too many at a place or in a room, else one at the newcomers.
std::vector<std::uint32_t> find_held_back(const Levels& levels);

/// Whether a full body of `shape` at `position` (m) would be one too many, by the members that came last.
bool is_full_place(const Levels& levels, const Vec3& position, const Shape& shape);

}  // namespace lodestone
