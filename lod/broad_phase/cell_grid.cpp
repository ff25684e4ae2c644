#include "lod/broad_phase/cell_grid.h"

#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

namespace lodestone {
namespace {

constexpr int kBaseLevel = 16;  // of 32, each with an edge four times that of the one below
constexpr double kLevelFactor = 4.0;
constexpr double kFitting = 0.995;   // of all balls are at the base level or below
constexpr double kColumnMost = 4.0;  // balls in a column of cells, up to which a layer is thin
constexpr double kSliceMost = 12.0;  // balls in a slice across the longest axis, up to which slices are cells
constexpr double kCellsMost = 2.0;   // for each ball
constexpr std::int32_t kWrapLeast = 4;  // cells: with fewer, a cell would be its neighbour's neighbour
// An axis is so many times as long as all but a few balls need: those have strayed.
constexpr double kStrayFactor = 16.0;
constexpr double kRounding = 4e-7;     // of a position kept as a float, over how far from the origin
constexpr double kFinest = 2e-3;       // of a reach: a rounding that finds hardly a ball too many
constexpr std::size_t kSample = 1000;  // balls that tell where most are
constexpr std::int64_t kOneCell = 24;  // balls: so few are tested each with each
constexpr std::int64_t kPartBalls = 1024;
constexpr std::int64_t kBlock = 8192;  // balls of a job

template <class Task>
void each_block(const BallSpan& balls, const JobRunner& jobs, const Task& task) {
  const auto count = std::int64_t(balls.x.size());
  jobs((count + kBlock - 1) / kBlock,
       TaskRef([&](std::int64_t block) { task(block * kBlock, std::min(count, (block + 1) * kBlock)); }));
}

}  // namespace

int CellGrid::level_of(float reach) const {
  int level = kBaseLevel;
  double edge = base_edge_;
  while (2.0 * double(reach) > edge && level < 31) ++level, edge *= kLevelFactor;
  while (level > 0 && 2.0 * double(reach) * kLevelFactor <= edge) --level, edge /= kLevelFactor;
  return level;
}

// An edge that most balls fit in, from a histogram of reaches with eight bins in an octave.
void CellGrid::choose_edges(const BallSpan& balls, const JobRunner& jobs) {
  constexpr int kBins = 256, kFirstBin = (127 - 20) * 8;
  // Of bins, taken in turn: most reaches fall into one, and would wait for each other there.
  constexpr std::size_t kSets = 4;
  std::array<std::atomic<std::uint32_t>, kBins> bins{};
  each_block(balls, jobs, [&](std::int64_t begin, std::int64_t end) {
    std::array<std::array<std::uint32_t, kBins>, kSets> own{};
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i)
      ++own[i % kSets][std::size_t(
          std::clamp(int(std::bit_cast<std::uint32_t>(balls.reach[i]) >> 20) - kFirstBin, 0, kBins - 1))];
    for (std::size_t bin = 0; bin < kBins; ++bin)
      if (const std::uint32_t sum = own[0][bin] + own[1][bin] + own[2][bin] + own[3][bin]) bins[bin] += sum;
  });
  const double wanted = kFitting * double(balls.reach.size());
  std::uint32_t below = 0;
  int bin = -1;
  while (double(below) < wanted) below += bins[std::size_t(++bin)];
  base_edge_ = 2.0 * double(std::bit_cast<float>(std::uint32_t(bin + 1 + kFirstBin) << 20));
}

BallBounds CellGrid::find_bounds(const BallSpan& balls, const JobRunner& jobs) {
  bounds_.assign(balls.x.size() / kBlock + 1, {});
  each_block(balls, jobs, [&](std::int64_t begin, std::int64_t end) {
    bounds_[std::size_t(begin / kBlock)] = find_ball_bounds(balls, simd_, begin, end);
  });
  BallBounds all;
  for (const BallBounds& bounds : bounds_) all.add(bounds);
  return all;
}

void CellGrid::fill(const BallSpan& balls, const JobRunner& jobs, int shares, const Lent& lent) {
  balls_ = balls;
  lent_ = lent;
  grids_.clear();
  parts_.clear();
  index_.clear();
  level_.clear();
  const std::int64_t count = std::int64_t(balls.x.size());
  if (count == 0) return;
  const BallBounds all = find_bounds(balls, jobs);
  const bool one_cell = count <= kOneCell, one_size = one_cell || all.most_reach <= 1.2f * all.least_reach;
  base_edge_ = std::max(1e-9, 2.02 * double(all.most_reach));  // also where no ball reaches anywhere
  if (!one_size) choose_edges(balls, jobs);
  others_.clear();
  usual_ = 0;
  if (one_size || level_of(all.most_reach) == level_of(all.least_reach))
    lay_out(all, one_cell ? -1 : kBaseLevel);
  else
    lay_out_levels(balls, jobs);
  sort(balls, jobs, shares);
  make_parts();
}

// The least and greatest reaches of the base level.
std::pair<float, float> CellGrid::base_reaches() const {
  constexpr float kMost = std::numeric_limits<float>::max();
  auto least = float(0.5 * base_edge_ / kLevelFactor), most = float(0.5 * base_edge_);
  while (level_of(least) < kBaseLevel) least = std::nextafter(least, kMost);
  while (level_of(most) > kBaseLevel) most = std::nextafter(most, 0.0f);
  return {least, most};
}

// Most balls are of the base level: the others are looked at one by one.
void CellGrid::lay_out_levels(const BallSpan& balls, const JobRunner& jobs) {
  const std::size_t count = balls.x.size();
  level_.take(lent_, count);
  const auto [least, most] = base_reaches();
  constexpr std::uint8_t kOther = 0;
  each_block(balls, jobs, [&, least = least, most = most](std::int64_t begin, std::int64_t end) {
    bounds_[std::size_t(begin / kBlock)] =
        find_bounds_within(balls, least, most, kBaseLevel, level_.data(), simd_, begin, end);
  });
  std::array<BallBounds, 32> bounds;
  for (const BallBounds& block : bounds_) bounds[kBaseLevel].add(block);
  std::uint8_t *at = level_.data(), *const last = at + count;
  for (; at < last && (at = static_cast<std::uint8_t*>(std::memchr(at, kOther, std::size_t(last - at))));
       ++at) {
    const auto i = std::size_t(at - level_.data());
    others_.push_back(std::uint32_t(i));
    *at = std::uint8_t(level_of(balls.reach[i]));
    bounds[*at].add(balls, i);
  }
  for (int level = 0; level < 32; ++level) {
    if (bounds[std::size_t(level)].count == 0) continue;
    grid_of_level_[std::size_t(level)] = std::int32_t(grids_.size());
    if (level == kBaseLevel) usual_ = grids_.size();
    lay_out(bounds[std::size_t(level)], level);
  }
}

// From a sample, each end without a fiftieth of it.
CellGrid::Range CellGrid::find_usual_range(int level) const {
  const std::array<std::span<const double>, 3> centers = {balls_.x, balls_.y, balls_.z};
  const std::size_t count = balls_.x.size(), stride = std::max<std::size_t>(1, count / kSample);
  const bool many = level_.size() > 0;
  Range range;
  range.low.fill(-1e300), range.high.fill(1e300);
  std::array<double, 2 * kSample> sample;
  for (std::size_t a = 0; a < 3; ++a) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < count; i += stride)
      if (!many || level_[i] == level) sample[size++] = centers[a][i];
    if (size == 0) break;
    const auto low = sample.begin() + std::ptrdiff_t(size / 50),
               high = sample.begin() + std::ptrdiff_t(size - 1 - size / 50),
               end = sample.begin() + std::ptrdiff_t(size);
    std::nth_element(sample.begin(), low, end);
    range.low[a] = *low;
    std::nth_element(low, high, end);
    range.high[a] = *high;
  }
  return range;
}

// Level −1: everything in one cell.
void CellGrid::lay_out(const BallBounds& bounds, int level) {
  Grid grid;
  std::array<double, 3> low = bounds.low, high = bounds.high;
  const auto count = double(bounds.count);
  grid.most_reach = double(bounds.most_reach);
  grid.edge = level < 0
                  ? 1.0
                  : std::max(base_edge_ * std::pow(kLevelFactor, level - kBaseLevel), 2.0 * grid.most_reach);
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
  const double slices = std::min(along[2], limit);
  const int axis = grid.axis[2];
  const double extent = high[axis] - low[axis];
  if (along[2] > 1.0 && count <= kSliceMost * slices && kRounding * extent <= kFinest * grid.most_reach) {
    // Few side by side: cells that nobody is in would cost more than the balls.
    grid.edge = std::max(grid.edge, (1.0 + 1e-9) * extent / slices);
    grid.inverse = 1.0 / grid.edge;
    along = {1.0, 1.0, slices};
  }
  if (level < 0) along.fill(1.0);
  while (along[0] * along[1] * along[2] > limit) {
    const int longest = int(std::ranges::max_element(along) - along.begin());
    if (along[longest] < 2.0 * kWrapLeast) break;
    along[longest] =
        std::max(double(kWrapLeast),
                 std::ceil(std::min(along[longest] / 2.0, std::max(along[longest] / 4.0, 4.0 * limit))));
    grid.wraps[longest] = true;
  }
  double length = 0.0;
  for (int a = 0; a < 3; ++a) {
    grid.cells[a] = std::int32_t(along[a]);
    grid.origin[a] = low[grid.axis[a]];
    length =
        std::max(length, along[a] == 1.0 ? high[grid.axis[a]] - low[grid.axis[a]] : along[a] * grid.edge);
  }
  grid.fuzz = float(kRounding * (length + grid.edge));
  grid.first_cell = grids_.empty() ? 0 : grids_.back().end_cell;
  grid.end_cell = grid.first_cell +
                  std::uint32_t(grid.cells[0]) * std::uint32_t(grid.cells[1]) * std::uint32_t(grid.cells[2]);
  grids_.push_back(grid);
}

void CellGrid::make_parts() {
  for (std::size_t g = 0; g < grids_.size(); ++g) {
    const Grid& grid = grids_[g];
    const std::uint32_t slice = std::uint32_t(grid.cells[0]) * std::uint32_t(grid.cells[1]);
    const std::size_t first_part = parts_.size();
    std::int32_t first_row = 0;
    for (std::int32_t row = 1; row <= grid.cells[2]; ++row) {
      const std::int64_t balls = start_[grid.first_cell + std::uint32_t(row) * slice] -
                                 start_[grid.first_cell + std::uint32_t(first_row) * slice];
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
  for (std::int64_t cell = 0; cell < cells(); ++cell)
    used += start_[std::size_t(cell)] < start_[std::size_t(cell) + 1];
  return used;
}

std::size_t CellGrid::bytes() const {
  const auto held = [](const auto& array) { return array.capacity() * sizeof array[0]; };
  std::size_t own = level_.own_bytes() + cell_.own_bytes() + start_.own_bytes();
  for (const auto* array : {&x_, &y_, &z_, &reach_}) own += array->own_bytes();
  return own + held(grids_) + held(parts_) + held(bounds_) + held(others_) + held(index_) + held(grid_begin_);
}

}  // namespace lodestone
