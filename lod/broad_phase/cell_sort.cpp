// How CellGrid sorts its balls: counts of each cell, their sums, then each ball to its place. Several at a
// time, and on several threads, for the grid of the usual size; one by one for the few balls of other sizes,
// and for grids that wrap.
#include <algorithm>
#include <cmath>

#include "lod/broad_phase/cell_grid.h"

namespace lodestone {
namespace {

constexpr std::int64_t kBlock = 8192;  // balls of a job

/// Cells of balls in a grid that does not wrap; of balls beyond it, any.
struct CellLoop {
  std::array<const double*, 3> at;
  std::array<double, 3> origin;
  std::array<std::int32_t, 3> cells;
  double inverse;
  std::uint32_t first_cell;
  std::uint32_t* cell;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const double *x = at[0], *y = at[1], *z = at[2];
    const double ox = origin[0], oy = origin[1], oz = origin[2];
    const double last_x = cells[0] - 1, last_y = cells[1] - 1, last_z = cells[2] - 1;
    const std::int32_t nx = cells[0], ny = cells[1];
    const std::uint32_t first = first_cell;
    std::uint32_t* out = cell;
#pragma GCC ivdep
    for (std::int64_t i = begin; i < end; ++i) {
      const double ax = (x[i] - ox) * inverse, ay = (y[i] - oy) * inverse, az = (z[i] - oz) * inverse;
      const auto within = [](double a, double last) {
        const double below = a < last ? a : last;
        return std::int32_t(below > 0.0 ? below : 0.0);
      };
      out[i] =
          first + std::uint32_t((within(az, last_z) * ny + within(ay, last_y)) * nx + within(ax, last_x));
    }
  }
};

}  // namespace

// Where a ball is along axis `a`, in the cell and from the grid's origin, within its length where it wraps.
double CellGrid::find_cell(const Grid& grid, int a, double at, std::int32_t& cell) {
  double c = std::floor(at * grid.inverse);
  if (grid.wraps[a]) {
    const double turns = std::floor(c / grid.cells[a]);
    c -= turns * grid.cells[a];
    at -= turns * grid.cells[a] * grid.edge;
  }
  cell = std::int32_t(std::clamp(c, 0.0, double(grid.cells[a] - 1)));
  return at;
}

void CellGrid::sort(const BallSpan& balls, const JobRunner& jobs, int shares) {
  const std::size_t count = balls.x.size();
  start_.take(lent_, grids_.back().end_cell + 2);
  std::fill_n(start_.data(), start_.size(), 0u);
  cell_.take(lent_, count);
  for (auto* array : {&x_, &y_, &z_, &reach_}) array->take(lent_, count);
  index_.resize(count);
  const std::array<bool, 3>& wraps = grids_[usual_].wraps;
  const bool any_usual = !(wraps[0] || wraps[1] || wraps[2]) && others_.size() < count;
  const std::int64_t at_once = !any_usual ? 0 : std::int64_t(count) < kBlock ? 1 : shares;
  if (any_usual) find_usual_cells(balls, jobs);
  count_others(balls, !any_usual);
  count_usual(jobs, at_once);
  for (std::size_t c = 2; c < start_.size(); ++c) start_[c] += start_[c - 1];
  place_usual(balls, jobs, at_once);
  place_others(balls, !any_usual);
  grid_begin_.clear();
  for (const Grid& grid : grids_) grid_begin_.push_back(start_[grid.first_cell]);
  grid_begin_.push_back(std::uint32_t(count));
}

std::array<std::span<const double>, 3> CellGrid::along_axes(const Grid& grid, const BallSpan& balls) {
  const std::array<std::span<const double>, 3> centers = {balls.x, balls.y, balls.z};
  return {centers[std::size_t(grid.axis[0])], centers[std::size_t(grid.axis[1])],
          centers[std::size_t(grid.axis[2])]};
}

void CellGrid::find_usual_cells(const BallSpan& balls, const JobRunner& jobs) {
  const Grid& grid = grids_[usual_];
  const auto [x, y, z] = along_axes(grid, balls);
  const CellLoop loop{
      {x.data(), y.data(), z.data()}, grid.origin, grid.cells, grid.inverse, grid.first_cell, cell_.data()};
  const auto count = std::int64_t(x.size());
  jobs((count + kBlock - 1) / kBlock, TaskRef([&](std::int64_t block) {
         run_wide(simd_, loop, block * kBlock, std::min(count, (block + 1) * kBlock));
       }));
}

// Each share of the work has cells of its own, and looks at all balls for those that lie there: mostly they
// follow each other already.
template <class Visit>
void CellGrid::each_usual(const JobRunner& jobs, std::int64_t shares, const Visit& visit) const {
  const Grid& grid = grids_[usual_];
  const auto count = std::int64_t(cell_.size());
  const std::uint32_t *cell = cell_.data(), cells = grid.end_cell - grid.first_cell;
  jobs(shares, TaskRef([&](std::int64_t share) {
         const auto first = grid.first_cell + std::uint32_t(cells * share / shares),
                    last = grid.first_cell + std::uint32_t(cells * (share + 1) / shares);
         for (std::int64_t i = 0; i < count; ++i)
           if (cell[i] - first < last - first) visit(i);
       }));
}

void CellGrid::count_usual(const JobRunner& jobs, std::int64_t shares) {
  const std::uint32_t* cell = cell_.data();
  std::uint32_t* start = start_.data();
  each_usual(jobs, shares, [=](std::int64_t i) { ++start[cell[i] + 2]; });
}

void CellGrid::place_usual(const BallSpan& balls, const JobRunner& jobs, std::int64_t shares) {
  const Grid& grid = grids_[usual_];
  const auto [x, y, z] = along_axes(grid, balls);
  const double *at_x = x.data(), *at_y = y.data(), *at_z = z.data(), ox = grid.origin[0], oy = grid.origin[1],
               oz = grid.origin[2];
  const std::uint32_t* cell = cell_.data();
  std::uint32_t *start = start_.data(), *index = index_.data();
  float *to_x = x_.data(), *to_y = y_.data(), *to_z = z_.data(), *to_reach = reach_.data();
  const float *reach = balls.reach.data(), fuzz = grid.fuzz, stray_fuzz = grid.stray_fuzz;
  each_usual(jobs, shares, [=](std::int64_t i) {
    const std::uint32_t at = start[cell[i] + 1]++;
    const auto within_x = float(at_x[i] - ox), within_y = float(at_y[i] - oy), within_z = float(at_z[i] - oz);
    to_x[at] = within_x, to_y[at] = within_y, to_z[at] = within_z;
    to_reach[at] =
        reach[i] + (fuzz + stray_fuzz * (std::abs(within_x) + std::abs(within_y) + std::abs(within_z)));
    index[at] = std::uint32_t(i);
  });
}

const CellGrid::Grid& CellGrid::grid_of(std::uint32_t ball) const {
  return grids_.size() > 1 ? grids_[std::size_t(grid_of_level_[level_[ball]])] : grids_.front();
}

// Calls visit(i) for those that are not sorted many at a time, in order.
template <class Visit>
void CellGrid::each_other(bool all, const Visit& visit) const {
  if (!all) {
    for (const std::uint32_t i : others_) visit(i);
    return;
  }
  for (std::uint32_t i = 0; i < std::uint32_t(cell_.size()); ++i) visit(i);
}

void CellGrid::count_others(const BallSpan& balls, bool all) {
  each_other(all, [&](std::uint32_t i) {
    const Grid& grid = grid_of(i);
    const auto centers = along_axes(grid, balls);
    std::array<std::int32_t, 3> c;
    for (int a = 0; a < 3; ++a) find_cell(grid, a, centers[std::size_t(a)][i] - grid.origin[a], c[a]);
    cell_[i] = grid.first_cell + std::uint32_t((c[2] * grid.cells[1] + c[1]) * grid.cells[0] + c[0]);
    ++start_[cell_[i] + 2];
  });
}

void CellGrid::place_others(const BallSpan& balls, bool all) {
  each_other(all, [&](std::uint32_t i) {
    const Grid& grid = grid_of(i);
    const auto [x, y, z] = along_axes(grid, balls);
    const std::uint32_t at = start_[cell_[i] + 1]++;
    std::int32_t cell;
    x_[at] = float(find_cell(grid, 0, x[i] - grid.origin[0], cell));
    y_[at] = float(find_cell(grid, 1, y[i] - grid.origin[1], cell));
    z_[at] = float(find_cell(grid, 2, z[i] - grid.origin[2], cell));
    reach_[at] = balls.reach[i] +
                 (grid.fuzz + grid.stray_fuzz * (std::abs(x_[at]) + std::abs(y_[at]) + std::abs(z_[at])));
    index_[at] = i;
  });
}

}  // namespace lodestone
