// Work on many bodies that looks at the ground, on all threads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lod/ground/ground.h"
#include "lod/jobs.h"

namespace lodestone {

/// Calls body(begin, end) for pieces of [0, count), `grain` indices each, for whom Ground::make_near() has
/// been: `by_rays`, as that says, on this thread alone.
template <class Body>
void run_on_ground(const Ground& ground, const JobRunner& jobs, bool by_rays, std::int64_t count,
                   std::int64_t grain, const Body& body) {
  const Ground::MadeOnly made(ground, by_rays);
  if (!by_rays) return run_in_pieces(jobs, count, grain, body);
  for (std::int64_t begin = 0; begin < count; begin += grain) body(begin, std::min(begin + grain, count));
}

inline constexpr std::int64_t kBodiesOfAPiece = 16;

/// The same, to find something: calls find(i, piece), i of each piece one after the other. Of the pieces
/// those for [0, count) are cleared before.
template <class Piece, class Find>
void find_on_ground(const Ground& ground, const JobRunner& jobs, bool by_rays, std::int64_t count,
                    std::vector<Piece>& pieces, const Find& find) {
  pieces.resize(std::max(pieces.size(), std::size_t((count + kBodiesOfAPiece - 1) / kBodiesOfAPiece)));
  run_on_ground(ground, jobs, by_rays, count, kBodiesOfAPiece, [&](std::int64_t begin, std::int64_t end) {
    Piece& piece = pieces[std::size_t(begin / kBodiesOfAPiece)];
    piece.clear();
    for (; begin < end; ++begin) find(begin, piece);
  });
}

}  // namespace lodestone
