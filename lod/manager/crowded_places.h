// Bodies that were added at nearly one place: ten thousand of them would be fifty million pairs. They take
// part a few at a time, in the order in which they were added, while those before them are pushed apart; the
// others wait where they were put.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/manager/levels.h"

namespace lodestone {

/// At most so many bodies of one size take part at once that are nearer to each other than the radius of the
/// ball inside them (Shape::inner_radius). Bodies in stacks are not, even thin plates. And where bodies were
/// put eight times as densely as they fit by volume, or twice as densely with some that overlap for certain,
/// no more take part than fit.
inline constexpr int kBodiesOfAPlace = 4;

/// The newcomers that wait, by index, ascending. One waits until fewer than kBodiesOfAPlace take part within
/// a radius of it and, where bodies were put too densely, until there is room for it. Every eighth step one
/// more comes in, whether or not those before it are gone (they may sleep, or pass through each other by a
/// filter). Those whose filter bits let their own kind pass never wait, and none waits for one that the pair
/// filter lets pass it. Costs a look at every newcomer; in a step in which there are too many somewhere, at
/// every body.
std::vector<std::uint32_t> find_held_back(const Levels& levels);

/// Whether a full body of `shape` at `position` (m) would be one too many among those that became full last.
bool is_full_place(const Levels& levels, const Vec3& position, const Shape& shape);

}  // namespace lodestone
