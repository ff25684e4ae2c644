// Which of many moving balls are near each other: cells filled by one counting sort, balls of a cell together
// in memory, rows of cells one after the other (Teschner et al., Optimized spatial hashing, 2003; Green,
// Particle simulation using CUDA, 2010). A thin layer has one cell across. Where balls are few in much space,
// cells that lie a multiple of the grid's length apart share a place, and distance tells their balls apart.
// Balls of other sizes have grids of their own, each edge four times the one before.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "lod/broad_phase/ball_bounds.h"
#include "lod/broad_phase/ball_pairs.h"
#include "lod/jobs.h"
#include "reference/geometry.h"

namespace lodestone {

class CellGrid {
 public:
  /// Memory that serves for other things before and after a search, aligned as floats are: 16 bytes a ball
  /// each are enough.
  using Lent = std::array<std::span<std::byte>, 2>;

  explicit CellGrid(Simd simd = find_simd()) : simd_(simd) {}
  CellGrid(CellGrid&&) = default;
  CellGrid(const CellGrid&) = delete;  // arrays lie in memory that is lent

  /// Takes the balls in. The result does not depend on `shares`, into how many the work is divided: as many
  /// as `jobs` has threads are enough. What is lent is needed for as long as pairs or balls near a place are
  /// looked for, not for order().
  void fill(const BallSpan& balls, const JobRunner& jobs = make_job_runner(1), int shares = 1,
            const Lent& lent = {});

  /// Parts of the search for pairs. No two parts of one colour find pairs of the same ball.
  std::int64_t parts() const { return std::int64_t(parts_.size()); }
  int colour_of(std::int64_t part) const { return parts_[part].colour; }
  static constexpr int kColours = 4;

  /// Adds each pair of `part` whose reaches meet, once, perhaps also where they miss by a rounding. The order
  /// depends on the balls alone.
  void find_pairs(std::int64_t part, BallPairs& pairs) const;

  /// Calls found(a) for each ball whose reach may meet a ball elsewhere, and for some a cell beyond.
  template <class Found>
  void find_near(const Vec3& center, double reach, const Found& found) const;

  /// Indices of the balls given, in the order of the cells.
  std::span<const std::uint32_t> order() const { return index_; }

  // How the balls were laid out, for reports.
  int grids() const { return int(grids_.size()); }
  std::int64_t cells() const { return grids_.empty() ? 0 : grids_.back().end_cell; }
  std::int64_t used_cells() const;  ///< in which there are balls
  /// Whether the finest grid has one layer of cells.
  bool flat() const { return !grids_.empty() && grids_.front().cells[1] == 1; }
  std::size_t bytes() const;

 private:
  /// Cells of one size. Axes are in the order along which cells follow each other, fastest first.
  struct Grid {
    std::array<int, 3> axis{0, 1, 2};  // which coordinate
    std::array<double, 3> origin{};    // m
    std::array<std::int32_t, 3> cells{1, 1, 1};
    std::array<bool, 3> wraps{};
    double edge = 1.0, inverse = 1.0;            // m, 1/m
    double most_reach = 0.0;                     // m, of its balls
    std::uint32_t first_cell = 0, end_cell = 0;  // in start_
    float fuzz = 0.0f;                           // m, rounding of the positions kept here
    float stray_fuzz = 0.0f;  // over how far from the origin a ball is: where some have strayed beyond the
                              // cells, and lie in the outermost
  };
  struct Part {
    std::int32_t grid = 0, first_row = 0,
                 last_row = 0;  // rows along the slowest axis; grid −1: pairs of different grids
    std::int32_t colour = 0;
  };
  /// Balls [begin, end), seen from elsewhere at where they are kept plus `shift`.
  struct Run {
    std::uint32_t begin = 0, end = 0;
    std::array<float, 3> shift{};
  };
  /// A row of cells whose balls may meet those of another row.
  struct Row {
    std::uint32_t first_cell = 0;
    std::array<float, 3> shift{};
  };
  struct Rows {
    std::array<Row, 5> rows{};
    int count = 0;
  };
  struct Runs {
    std::array<Run, 15> runs{};
    int count = 0;
  };
  /// The neighbour of a row or cell along one axis, −1: none.
  struct Neighbour {
    std::int32_t at = -1;
    float shift = 0.0f;
  };

  BallBounds find_bounds(const BallSpan& balls, const JobRunner& jobs);
  void choose_edges(const BallSpan& balls, const JobRunner& jobs);
  std::pair<float, float> base_reaches() const;
  void lay_out_levels(const BallSpan& balls, const JobRunner& jobs);
  void lay_out(const BallBounds& bounds, int level);
  /// Where all but a few balls of a level are, along each axis.
  struct Range {
    std::array<double, 3> low{}, high{};  // m
  };
  Range find_usual_range(int level) const;
  void sort(const BallSpan& balls, const JobRunner& jobs, int shares);
  void find_usual_cells(const BallSpan& balls, const JobRunner& jobs);
  template <class Visit>
  void each_usual(const JobRunner& jobs, std::int64_t shares, const Visit& visit) const;
  void count_usual(const JobRunner& jobs, std::int64_t shares);
  void place_usual(const BallSpan& balls, const JobRunner& jobs, std::int64_t shares);
  template <class Visit>
  void each_other(bool all, const Visit& visit) const;
  void count_others(const BallSpan& balls, bool all);
  void place_others(const BallSpan& balls, bool all);
  const Grid& grid_of(std::uint32_t ball) const;
  static std::array<std::span<const double>, 3> along_axes(const Grid& grid, const BallSpan& balls);
  static double find_cell(const Grid& grid, int axis, double at, std::int32_t& cell);
  void make_parts();
  int level_of(float reach) const;
  static Neighbour neighbour(const Grid& grid, int axis, std::int32_t at);
  /// Itself, and one of each pair of opposite neighbours.
  Rows find_rows(const Grid& grid, std::int32_t slow, std::int32_t mid) const;
  /// The cells fast − 1 … fast + 1 of each row, of the first one only those from `fast` on: one run, or two
  /// where the row wraps.
  void find_runs(const Grid& grid, const Rows& rows, std::int32_t fast, Runs& found) const;
  template <Simd kSimd>
  void search(const Part& part, BallPairs& pairs) const;
  template <Simd kSimd>
  struct Search;
  template <class Found>
  void find_in(const Grid& grid, const Vec3& center, double reach, const Found& found) const;
  void find_across(BallPairs& pairs) const;

  /// An array in memory that is lent or, where that is too small, in its own.
  template <class Value>
  class Array {
   public:
    void take(Lent& lent, std::size_t count) {
      const std::size_t bytes = (count * sizeof(Value) + 3) / 4 * 4;
      const auto place =
          std::ranges::find_if(lent, [&](std::span<std::byte> room) { return room.size() >= bytes; });
      if (place == lent.end()) {
        own_.resize(count);
        values_ = own_;
      } else {
        values_ = {reinterpret_cast<Value*>(place->data()), count};
        *place = place->subspan(bytes);
      }
    }
    void clear() { values_ = {}; }
    Value* data() { return values_.data(); }
    const Value* data() const { return values_.data(); }
    std::size_t size() const { return values_.size(); }
    Value& operator[](std::size_t i) { return values_[i]; }
    const Value& operator[](std::size_t i) const { return values_[i]; }
    std::size_t own_bytes() const { return own_.capacity() * sizeof(Value); }

   private:
    std::vector<Value> own_;
    std::span<Value> values_;
  };

  Simd simd_;
  Lent lent_;  // what is left of it
  std::vector<Grid> grids_;
  std::array<std::int32_t, 32> grid_of_level_{};
  double base_edge_ = 1.0;  // m, of level kBaseLevel
  std::vector<Part> parts_;
  std::size_t usual_ = 0;              // grid of the base level
  std::vector<BallBounds> bounds_;     // of blocks of balls
  Array<std::uint8_t> level_;          // of each ball, where they are of several
  std::vector<std::uint32_t> others_;  // balls that are not sorted many at a time
  Array<std::uint32_t> cell_;          // of each ball
  Array<std::uint32_t> start_;         // of each cell, and the end of the last
  Array<float> x_, y_, z_, reach_;     // in order; positions within the grid, along its axes
  std::vector<std::uint32_t> index_;
  std::vector<std::uint32_t> grid_begin_;  // of each grid in the order, and the end
  BallSpan balls_;
};

template <class Found>
void CellGrid::find_in(const Grid& grid, const Vec3& center, double reach, const Found& found) const {
  // Along each axis the cells that the ball may meet; where it spans the whole axis, every cell once.
  std::array<std::int64_t, 3> low{}, high{};
  for (int a = 0; a < 3; ++a) {
    const double at = center[grid.axis[a]] - grid.origin[a], span = reach + grid.most_reach;
    const double first = std::floor((at - span) * grid.inverse),
                 last = std::floor((at + span) * grid.inverse), n = grid.cells[a];
    if (grid.cells[a] == 1) {
      low[a] = high[a] = 0;  // however far it reaches
    } else if (!grid.wraps[a]) {
      const double beyond = grid.stray_fuzz > 0.0f ? 0.0 : 1.0;  // where nothing lies, or strays
      low[a] = std::int64_t(std::clamp(first, 0.0, n - 1 + beyond)),
      high[a] = std::int64_t(std::clamp(last, -beyond, n - 1));
    } else if (last - first >= n - 1) {
      low[a] = 0, high[a] = std::int64_t(n) - 1;
    } else {
      low[a] = std::int64_t(first - n * std::floor(first / n)), high[a] = low[a] + std::int64_t(last - first);
    }
  }
  for (std::int64_t slow = low[2]; slow <= high[2]; ++slow)
    for (std::int64_t mid = low[1]; mid <= high[1]; ++mid) {
      const std::int64_t row =
          grid.first_cell + (slow % grid.cells[2] * grid.cells[1] + mid % grid.cells[1]) * grid.cells[0];
      const std::int64_t last = std::min<std::int64_t>(high[0], grid.cells[0] - 1);
      if (low[0] <= last)
        for (std::uint32_t i = start_[row + low[0]]; i < start_[row + last + 1]; ++i) found(index_[i]);
      if (high[0] > last)  // round the end of the row
        for (std::uint32_t i = start_[row]; i < start_[row + high[0] - grid.cells[0] + 1]; ++i)
          found(index_[i]);
    }
}

template <class Found>
void CellGrid::find_near(const Vec3& center, double reach, const Found& found) const {
  for (const Grid& grid : grids_) find_in(grid, center, reach, found);
}

}  // namespace lodestone
