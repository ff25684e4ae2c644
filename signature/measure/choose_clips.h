// Which settling trials become clips: few that stand for many.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "reference/shape.h"
#include "signature/signature.h"

namespace lodestone {

struct SettlingRecord;

/// Trials recorded whole for each clip that is kept of them.
inline constexpr int kCandidatesPerClip = 4;

/// Indices, ascending, of at most `count` of the records that were recorded whole and rest. Of each rest pose
/// as many as its frequency asks for, spread evenly over how long they take (strata of equal probability),
/// each drawn so that the distance travelled stays true in the mean.
std::vector<std::size_t> choose_clips(std::span<const SettlingRecord> records,
                                      std::span<const RestPose> poses, int count);

}  // namespace lodestone
