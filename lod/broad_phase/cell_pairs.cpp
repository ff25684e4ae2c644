// The pairs that CellGrid finds: row by row, each cell's balls against those that follow in its row and in
// half of the rows around.
#include "lod/broad_phase/cell_grid.h"

namespace lodestone {

CellGrid::Neighbour CellGrid::neighbour(const Grid& grid, int axis, std::int32_t at) {
  const std::int32_t n = grid.cells[axis];
  if (at >= 0 && at < n) return {at, 0.0f};
  if (!grid.wraps[axis]) return {};
  return at < 0 ? Neighbour{at + n, float(-n * grid.edge)} : Neighbour{at - n, float(n * grid.edge)};
}

CellGrid::Rows CellGrid::find_rows(const Grid& grid, std::int32_t slow, std::int32_t mid) const {
  Rows found;
  const auto add = [&](std::int32_t s, std::int32_t m, float shift_m, float shift_s) {
    const std::uint32_t cell =
        grid.first_cell + std::uint32_t(s * grid.cells[1] + m) * std::uint32_t(grid.cells[0]);
    found.rows[std::size_t(found.count++)] = {cell, {0.0f, shift_m, shift_s}};
  };
  add(slow, mid, 0.0f, 0.0f);
  if (const Neighbour m = neighbour(grid, 1, mid + 1); m.at >= 0) add(slow, m.at, m.shift, 0.0f);
  const Neighbour s = neighbour(grid, 2, slow + 1);
  if (s.at < 0) return found;
  for (std::int32_t step = -1; step <= 1; ++step)
    if (const Neighbour m = neighbour(grid, 1, mid + step); m.at >= 0) add(s.at, m.at, m.shift, s.shift);
  return found;
}

LODESTONE_INLINE void CellGrid::find_runs(const Grid& grid, const Rows& rows, std::int32_t fast,
                                          Runs& found) const {
  found.count = 0;
  const std::int32_t n = grid.cells[0];
  const float length = float(n * grid.edge);
  const auto add = [&](const Row& row, std::int32_t first, std::int32_t last, float shift) {
    const std::uint32_t begin = start_[row.first_cell + std::uint32_t(first)],
                        end = start_[row.first_cell + std::uint32_t(last) + 1];
    if (begin < end)
      found.runs[std::size_t(found.count++)] = {begin, end, {shift, row.shift[1], row.shift[2]}};
  };
  for (int i = 0; i < rows.count; ++i) {
    const Row& row = rows.rows[std::size_t(i)];
    const bool own = i == 0;
    add(row, own ? fast : std::max(fast - 1, 0), std::min(fast + 1, n - 1), 0.0f);
    if (!grid.wraps[0]) continue;
    if (fast == 0 && !own) add(row, n - 1, n - 1, -length);
    if (fast == n - 1) add(row, 0, 0, length);
  }
}

template <Simd kSimd>
LODESTONE_INLINE void CellGrid::search(const Part& part, BallPairs& pairs) const {
  const Grid& grid = grids_[std::size_t(part.grid)];
  const BallArrays balls{x_.data(), y_.data(), z_.data(), reach_.data(), index_.data()};
  const std::uint32_t* start = start_.data();
  const std::int32_t row_length = grid.cells[0];
  Runs near;
  for (std::int32_t slow = part.first_row; slow < part.last_row; ++slow)
    for (std::int32_t mid = 0; mid < grid.cells[1]; ++mid) {
      const Rows rows = find_rows(grid, slow, mid);
      const std::uint32_t* row = start + rows.rows[0].first_cell;
      if (row[0] == row[row_length]) continue;
      for (std::int32_t fast = 0; fast < row_length; ++fast) {
        const std::uint32_t begin = row[fast], end = row[fast + 1];
        if (begin == end) continue;
        find_runs(grid, rows, fast, near);
        std::int64_t most = 0;
        for (int i = 0; i < near.count; ++i)
          most += near.runs[std::size_t(i)].end - near.runs[std::size_t(i)].begin;
        pairs.make_room(most * (end - begin));
        std::uint32_t *first = pairs.end_first(), *second = pairs.end_second(), count = 0;
        for (std::uint32_t ball = begin; ball < end; ++ball) {
          near.runs[0].begin = ball + 1;  // its own cell: those after it
          const NearBall here{balls.x[ball], balls.y[ball], balls.z[ball], balls.reach[ball],
                              balls.index[ball]};
          for (int i = 0; i < near.count; ++i) {
            const Run& run = near.runs[std::size_t(i)];
            const NearBall seen{here.x - run.shift[0], here.y - run.shift[1], here.z - run.shift[2],
                                here.reach, here.index};
            count += find_near_balls<kSimd>(balls, seen, run.begin, run.end, first + count, second + count);
          }
        }
        pairs.grow(count);
      }
    }
}

template <Simd kSimd>
struct CellGrid::Search {
  const CellGrid& grid;
  const Part& part;
  BallPairs& pairs;
  LODESTONE_INLINE void operator()(std::int64_t, std::int64_t) const { grid.search<kSimd>(part, pairs); }
};

void CellGrid::find_pairs(std::int64_t number, BallPairs& pairs) const {
  const Part& part = parts_[std::size_t(number)];
  if (part.grid < 0) return find_across(pairs);
#if defined(__x86_64__) && defined(__GNUC__)
  if (simd_ == Simd::avx512)
    run_avx512(Search<Simd::avx512>{*this, part, pairs}, 0, 0);
  else if (simd_ == Simd::avx2)
    run_avx2(Search<Simd::avx2>{*this, part, pairs}, 0, 0);
  else
#endif
    search<Simd::portable>(part, pairs);
  const Grid& grid = grids_[std::size_t(part.grid)];
  if (!grid.wraps[0] && !grid.wraps[1] && !grid.wraps[2]) return;
  pairs.filter([&](std::uint32_t a, std::uint32_t b) {  // balls that only share a place
    const double limit = double(balls_.reach[a]) + double(balls_.reach[b]);
    return Vec3(balls_.x[a] - balls_.x[b], balls_.y[a] - balls_.y[b], balls_.z[a] - balls_.z[b])
               .squaredNorm() < limit * limit;
  });
}

// Pairs of different sizes: those of the coarser grid look into the finer one, whose cells they know to be
// many but whose balls they would have to be tested with in any case.
void CellGrid::find_across(BallPairs& pairs) const {
  for (std::size_t coarse = 1; coarse < grids_.size(); ++coarse)
    for (std::size_t fine = 0; fine < coarse; ++fine)
      for (std::uint32_t i = grid_begin_[coarse]; i < grid_begin_[coarse + 1]; ++i) {
        const std::uint32_t ball = index_[i];
        const Vec3 center(balls_.x[ball], balls_.y[ball], balls_.z[ball]);
        find_in(grids_[fine], center, balls_.reach[ball], [&](std::uint32_t other) {
          const double limit = double(balls_.reach[ball]) + double(balls_.reach[other]);
          if ((Vec3(balls_.x[other], balls_.y[other], balls_.z[other]) - center).squaredNorm() <
              limit * limit)
            pairs.add(ball, other);
        });
      }
}

}  // namespace lodestone
