#include "lod/tables/cell_grid.h"

#include <bit>
#include <cmath>

namespace lodestone {
namespace {

constexpr int kBaseLevel = 16;         // of 32, each with an edge four times that of the one below
constexpr double kLevelFactor = 4.0;
constexpr double kFitting = 0.995;     // of all balls are at the base level or below
constexpr double kColumnMost = 4.0;    // balls in a column of cells, up to which a layer is thin
constexpr double kCellsMost = 2.0;     // for each ball
constexpr std::int32_t kWrapLeast = 4; // cells: with fewer, a cell would be its neighbour's neighbour
constexpr double kStrayFactor = 16.0;  // an axis is so many times as long as all but a few balls need: those have strayed
constexpr double kRounding = 4e-7;     // of a position kept as a float, over how far from the origin
constexpr std::size_t kSample = 1000;  // balls that tell where most are
constexpr std::int64_t kOneCell = 24;  // balls: so few are tested each with each
constexpr std::int64_t kPartBalls = 1024;
constexpr std::int64_t kBlock = 8192;  // balls of a job

}  // namespace

int CellGrid::level_of(float reach) const {
  int level = kBaseLevel;
  double edge = base_edge_;
  while (2.0 * double(reach) > edge && level < 31) ++level, edge *= kLevelFactor;
  while (level > 0 && 2.0 * double(reach) * kLevelFactor <= edge) --level, edge /= kLevelFactor;
  return level;
}

// An edge that most balls fit in, from a histogram of reaches with eight bins in an octave.
void CellGrid::choose_edges(const BallSpan& balls) {
  constexpr int kBins = 256, kFirstBin = (127 - 20) * 8;
  std::array<std::uint32_t, kBins> bins{};
  for (const float reach : balls.reach) ++bins[std::clamp(int(std::bit_cast<std::uint32_t>(reach) >> 20) - kFirstBin, 0, kBins - 1)];
  const double wanted = kFitting * double(balls.reach.size());
  std::uint32_t below = 0;
  int bin = -1;
  while (double(below) < wanted) below += bins[++bin];
  base_edge_ = 2.0 * double(std::bit_cast<float>(std::uint32_t(bin + 1 + kFirstBin) << 20));
}

void CellGrid::Bounds::add(const BallSpan& balls, std::size_t i) {
  ++count;
  most_reach = std::max(most_reach, balls.reach[i]), least_reach = std::min(least_reach, balls.reach[i]);
  low[0] = std::min(low[0], balls.x[i]), high[0] = std::max(high[0], balls.x[i]);
  low[1] = std::min(low[1], balls.y[i]), high[1] = std::max(high[1], balls.y[i]);
  low[2] = std::min(low[2], balls.z[i]), high[2] = std::max(high[2], balls.z[i]);
}

void CellGrid::Bounds::add(const Bounds& other) {
  count += other.count;
  most_reach = std::max(most_reach, other.most_reach), least_reach = std::min(least_reach, other.least_reach);
  for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], other.low[a]), high[a] = std::max(high[a], other.high[a]);
}

CellGrid::Bounds CellGrid::find_bounds(const BallSpan& balls, const JobRunner& jobs) {
  const auto count = std::int64_t(balls.x.size());
  bounds_.assign(std::size_t((count + kBlock - 1) / kBlock), {});
  jobs(std::int64_t(bounds_.size()), TaskRef([&](std::int64_t block) {
    Bounds bounds;
    for (std::int64_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) bounds.add(balls, std::size_t(i));
    bounds_[std::size_t(block)] = bounds;
  }));
  Bounds all;
  for (const Bounds& bounds : bounds_) all.add(bounds);
  return all;
}

void CellGrid::fill(const BallSpan& balls, const JobRunner& jobs, int shares) {
  balls_ = balls;
  grids_.clear();
  parts_.clear();
  index_.clear();
  level_.clear();
  const std::int64_t count = std::int64_t(balls.x.size());
  if (count == 0) return;
  const Bounds all = find_bounds(balls, jobs);
  const bool one_cell = count <= kOneCell, one_size = one_cell || all.most_reach <= 1.2f * all.least_reach;
  base_edge_ = 2.02 * double(all.most_reach);
  if (!one_size) choose_edges(balls);
  if (one_size || level_of(all.most_reach) == level_of(all.least_reach)) lay_out(all, one_cell ? -1 : kBaseLevel);
  else lay_out_levels(balls);
  sort(balls, jobs, shares);
  make_parts();
}

void CellGrid::lay_out_levels(const BallSpan& balls) {
  std::array<Bounds, 32> bounds;
  level_.resize(balls.x.size());
  for (std::size_t i = 0; i < level_.size(); ++i) {
    level_[i] = std::uint8_t(level_of(balls.reach[i]));
    bounds[level_[i]].add(balls, i);
  }
  for (int level = 0; level < 32; ++level)
    if (bounds[std::size_t(level)].count > 0) grid_of_level_[std::size_t(level)] = std::int32_t(grids_.size()), lay_out(bounds[std::size_t(level)], level);
}

// From a sample, each end without a fiftieth of it.
CellGrid::Range CellGrid::find_usual_range(int level) const {
  const std::array<std::span<const double>, 3> centers = {balls_.x, balls_.y, balls_.z};
  const std::size_t count = balls_.x.size(), stride = std::max<std::size_t>(1, count / kSample);
  const bool many = !level_.empty();
  Range range;
  range.low.fill(-1e300), range.high.fill(1e300);
  std::array<double, 2 * kSample> sample;
  for (std::size_t a = 0; a < 3; ++a) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < count; i += stride)
      if (!many || level_[i] == level) sample[size++] = centers[a][i];
    if (size == 0) break;
    const auto low = sample.begin() + std::ptrdiff_t(size / 50), high = sample.begin() + std::ptrdiff_t(size - 1 - size / 50), end = sample.begin() + std::ptrdiff_t(size);
    std::nth_element(sample.begin(), low, end);
    range.low[a] = *low;
    std::nth_element(low, high, end);
    range.high[a] = *high;
  }
  return range;
}

// Level −1: everything in one cell.
void CellGrid::lay_out(const Bounds& bounds, int level) {
  Grid grid;
  std::array<double, 3> low = bounds.low, high = bounds.high;
  const auto count = double(bounds.count);
  grid.most_reach = double(bounds.most_reach);
  grid.edge = level < 0 ? 1.0 : std::max(base_edge_ * std::pow(kLevelFactor, level - kBaseLevel), 2.0 * grid.most_reach);
  grid.inverse = 1.0 / grid.edge;
  std::array<double, 3> cells;
  for (int a = 0; a < 3; ++a) cells[a] = std::floor((high[a] - low[a]) * grid.inverse * (1.0 + 1e-12)) + 1.0;

  // A ball that has flown off makes no axis longer: it lies in the outermost cell, as do those near it.
  const double limit = std::max(64.0, kCellsMost * count);
  if (level >= 0 && cells[0] * cells[1] * cells[2] > limit) {
    const Range usual = find_usual_range(level);
    for (std::size_t a = 0; a < 3; ++a) {
      const double enough = std::floor((usual.high[a] - usual.low[a]) * grid.inverse) + 3.0;
      if (cells[a] <= kStrayFactor * enough) continue;
      cells[a] = enough, low[a] = usual.low[a] - grid.edge, high[a] = low[a] + enough * grid.edge;
      grid.stray_fuzz = float(kRounding);
    }
  }

  // The slowest axis is the longest, the middle one the shortest: a thin layer's columns are then one cell.
  std::array<int, 3> by_length{0, 1, 2};
  std::ranges::sort(by_length, {}, [&](int a) { return cells[a]; });
  grid.axis = {by_length[1], by_length[0], by_length[2]};
  std::array<double, 3> along{cells[grid.axis[0]], cells[grid.axis[1]], cells[grid.axis[2]]};
  if (count / (along[0] * along[2]) <= kColumnMost) along[1] = 1.0;
  if (level < 0) along.fill(1.0);
  while (along[0] * along[1] * along[2] > limit) {
    const int longest = int(std::ranges::max_element(along) - along.begin());
    if (along[longest] < 2.0 * kWrapLeast) break;
    along[longest] = std::max(double(kWrapLeast), std::ceil(std::min(along[longest] / 2.0, std::max(along[longest] / 4.0, 4.0 * limit))));
    grid.wraps[longest] = true;
  }
  double length = 0.0;
  for (int a = 0; a < 3; ++a) {
    grid.cells[a] = std::int32_t(along[a]);
    grid.origin[a] = low[grid.axis[a]];
    length = std::max(length, along[a] == 1.0 ? high[grid.axis[a]] - low[grid.axis[a]] : along[a] * grid.edge);
  }
  grid.fuzz = float(kRounding * (length + grid.edge));
  grid.first_cell = grids_.empty() ? 0 : grids_.back().end_cell;
  grid.end_cell = grid.first_cell + std::uint32_t(grid.cells[0]) * std::uint32_t(grid.cells[1]) * std::uint32_t(grid.cells[2]);
  grids_.push_back(grid);
}

namespace {

/// Of balls in one grid that does not wrap.
struct CellLoop {
  std::array<const double*, 3> at;
  std::array<double, 3> origin;
  std::array<std::int32_t, 3> cells;
  double inverse;
  std::uint32_t* cell;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const double *x = at[0], *y = at[1], *z = at[2];
    const double ox = origin[0], oy = origin[1], oz = origin[2];
    const std::int32_t nx = cells[0], ny = cells[1], nz = cells[2];
    std::uint32_t* out = cell;
#pragma GCC ivdep
    for (std::int64_t i = begin; i < end; ++i) {
      const auto within = [](double c, std::int32_t count) { return std::int32_t(c < 0.0 ? 0.0 : c < double(count - 1) ? c : double(count - 1)); };
      const std::int32_t cx = within((x[i] - ox) * inverse, nx), cy = within((y[i] - oy) * inverse, ny), cz = within((z[i] - oz) * inverse, nz);
      out[i] = std::uint32_t((cz * ny + cy) * nx + cx);
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
  start_.assign(grids_.back().end_cell + 2, 0);
  cell_.resize(count);
  for (auto* array : {&x_, &y_, &z_, &reach_}) array->resize(count);
  index_.resize(count);
  const Grid& only = grids_.front();
  if (grids_.size() > 1 || only.wraps[0] || only.wraps[1] || only.wraps[2]) sort_one_by_one(balls);
  else sort_plain(balls, jobs, shares);
  grid_begin_.clear();
  for (const Grid& grid : grids_) grid_begin_.push_back(start_[grid.first_cell]);
  grid_begin_.push_back(std::uint32_t(count));
}

void CellGrid::add_up_cells() {
  for (std::size_t c = 2; c < start_.size(); ++c) start_[c] += start_[c - 1];
}

// Each share of the work has cells of its own, and looks at all balls for those that lie there: mostly they follow each other already.
void CellGrid::sort_plain(const BallSpan& balls, const JobRunner& jobs, int shares) {
  const auto count = std::int64_t(balls.x.size());
  const Grid& grid = grids_.front();
  const std::array<std::span<const double>, 3> centers = {balls.x, balls.y, balls.z};
  const double *x = centers[std::size_t(grid.axis[0])].data(), *y = centers[std::size_t(grid.axis[1])].data(), *z = centers[std::size_t(grid.axis[2])].data();
  const CellLoop loop{{x, y, z}, grid.origin, grid.cells, grid.inverse, cell_.data()};
  jobs((count + kBlock - 1) / kBlock, TaskRef([&](std::int64_t block) { run_wide(simd_, loop, block * kBlock, std::min(count, (block + 1) * kBlock)); }));

  const std::uint32_t* cell = cell_.data();
  std::uint32_t *start = start_.data(), *index = index_.data();
  const std::int64_t all = count < kBlock ? 1 : shares;
  const auto each_share = [&](const auto& visit) {
    jobs(all, TaskRef([&](std::int64_t share) {
      const auto first = std::uint32_t(grid.end_cell * share / all), last = std::uint32_t(grid.end_cell * (share + 1) / all);
      for (std::int64_t i = 0; i < count; ++i)
        if (cell[i] - first < last - first) visit(i);
    }));
  };
  each_share([&](std::int64_t i) { ++start[cell[i] + 2]; });
  add_up_cells();
  float *to_x = x_.data(), *to_y = y_.data(), *to_z = z_.data(), *to_reach = reach_.data();
  const float* reach = balls.reach.data();
  const double ox = grid.origin[0], oy = grid.origin[1], oz = grid.origin[2];
  each_share([&](std::int64_t i) {
    const std::uint32_t at = start[cell[i] + 1]++;
    to_x[at] = float(x[i] - ox), to_y[at] = float(y[i] - oy), to_z[at] = float(z[i] - oz);
    to_reach[at] = reach[i] + (grid.fuzz + grid.stray_fuzz * (std::abs(to_x[at]) + std::abs(to_y[at]) + std::abs(to_z[at])));
    index[at] = std::uint32_t(i);
  });
}

void CellGrid::sort_one_by_one(const BallSpan& balls) {
  const std::size_t count = balls.x.size();
  const std::array<std::span<const double>, 3> centers = {balls.x, balls.y, balls.z};
  const bool many = grids_.size() > 1;
  for (std::size_t i = 0; i < count; ++i) {
    const Grid& grid = many ? grids_[std::size_t(grid_of_level_[level_[i]])] : grids_.front();
    std::array<std::int32_t, 3> c;
    for (int a = 0; a < 3; ++a) find_cell(grid, a, centers[grid.axis[a]][i] - grid.origin[a], c[a]);
    cell_[i] = grid.first_cell + std::uint32_t((c[2] * grid.cells[1] + c[1]) * grid.cells[0] + c[0]);
    ++start_[cell_[i] + 2];
  }
  add_up_cells();
  for (std::size_t i = 0; i < count; ++i) {
    const Grid& grid = many ? grids_[std::size_t(grid_of_level_[level_[i]])] : grids_.front();
    const std::uint32_t at = start_[cell_[i] + 1]++;
    std::int32_t cell;
    x_[at] = float(find_cell(grid, 0, centers[grid.axis[0]][i] - grid.origin[0], cell));
    y_[at] = float(find_cell(grid, 1, centers[grid.axis[1]][i] - grid.origin[1], cell));
    z_[at] = float(find_cell(grid, 2, centers[grid.axis[2]][i] - grid.origin[2], cell));
    reach_[at] = balls.reach[i] + (grid.fuzz + grid.stray_fuzz * (std::abs(x_[at]) + std::abs(y_[at]) + std::abs(z_[at])));
    index_[at] = std::uint32_t(i);
  }
}

void CellGrid::make_parts() {
  for (std::size_t g = 0; g < grids_.size(); ++g) {
    const Grid& grid = grids_[g];
    const std::uint32_t slice = std::uint32_t(grid.cells[0]) * std::uint32_t(grid.cells[1]);
    const std::size_t first_part = parts_.size();
    std::int32_t first_row = 0;
    for (std::int32_t row = 1; row <= grid.cells[2]; ++row) {
      const std::int64_t balls = start_[grid.first_cell + std::uint32_t(row) * slice] - start_[grid.first_cell + std::uint32_t(first_row) * slice];
      if (balls < kPartBalls && row < grid.cells[2]) continue;
      parts_.push_back({std::int32_t(g), first_row, row, std::int32_t(parts_.size() - first_part) % 2});
      first_row = row;
    }
    // Where the last part meets the first, and both would have one colour.
    const std::size_t made = parts_.size() - first_part;
    if (grid.wraps[2] && made > 1 && made % 2 == 1) parts_.back().colour = 2;
  }
  if (grids_.size() > 1) parts_.push_back({.grid = -1, .colour = 3});
}

std::int64_t CellGrid::used_cells() const {
  std::int64_t used = 0;
  for (std::int64_t cell = 0; cell < cells(); ++cell) used += start_[std::size_t(cell)] < start_[std::size_t(cell) + 1];
  return used;
}

std::size_t CellGrid::bytes() const {
  const auto held = [](const auto& array) { return array.capacity() * sizeof array[0]; };
  return held(grids_) + held(parts_) + held(bounds_) + held(level_) + held(cell_) + held(start_) + held(x_) + held(y_) + held(z_) + held(reach_) + held(index_) +
         held(grid_begin_);
}

}  // namespace lodestone
