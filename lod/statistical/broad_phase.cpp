#include "lod/statistical/broad_phase.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace lodestone {
namespace {

using Cell = Eigen::Vector3i;

Cell cell_of(const Vec3& p, double inverse) {
  // Far beyond any scene the coordinate saturates; such bodies then share a cell, which costs time only.
  const auto along = [&](double x) { return int(std::floor(std::clamp(x * inverse, -1e9, 1e9))); };
  return {along(p.x()), along(p.y()), along(p.z())};
}

std::uint32_t hash_of(const Cell& c) {
  return std::uint32_t(c.x()) * 73856093u ^ std::uint32_t(c.y()) * 19349663u ^ std::uint32_t(c.z()) * 83492791u;
}

bool overlap(const Bound& a, const Bound& b) {
  const double reach = a.reach + b.reach;
  return (a.center - b.center).squaredNorm() < reach * reach;
}

// A cell edge that most bounds fit in: twice a high quantile of the reach, so that one very fast or large body does not spoil the grid.
double cell_edge(std::span<const Bound> bounds) {
  if (bounds.empty()) return 1.0;
  std::vector<double> reach(bounds.size());
  std::transform(bounds.begin(), bounds.end(), reach.begin(), [](const Bound& b) { return b.reach; });
  const auto high = reach.begin() + std::ptrdiff_t(0.98 * double(reach.size() - 1));
  std::nth_element(reach.begin(), high, reach.end());
  return std::max(1e-9, 2.02 * *high);
}

// One of each pair of opposite neighbour cells, and the cell itself first.
constexpr std::array<std::array<int, 3>, 14> kHalf{{{0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}, {-1, -1, 1}, {0, -1, 1},
                                                    {1, -1, 1}, {-1, 0, 1}, {0, 0, 1}, {1, 0, 1}, {-1, 1, 1}, {0, 1, 1}, {1, 1, 1}}};

}  // namespace

void BroadPhase::Grid::fill(std::span<const Bound> given, double edge) {
  cell = edge;
  const std::size_t n = given.size();
  mask = std::uint32_t(std::bit_ceil(std::max<std::size_t>(16, 2 * n)) - 1);
  start.assign(mask + 2, 0);
  bucket_of.resize(n);
  outsized.clear();
  constexpr std::uint32_t kOutsized = ~0u;
  const double inverse = 1.0 / cell;
  for (std::size_t i = 0; i < n; ++i) {
    if (2.0 * given[i].reach > cell) {
      outsized.push_back(std::int32_t(i));
      bucket_of[i] = kOutsized;
    } else {
      bucket_of[i] = hash_of(cell_of(given[i].center, inverse)) & mask;
      ++start[bucket_of[i] + 1];
    }
  }
  for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
  bounds.resize(n - outsized.size());
  index.resize(bounds.size());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    if (bucket_of[i] == kOutsized) continue;
    const std::uint32_t place = next[bucket_of[i]]++;
    bounds[place] = given[i];
    index[place] = std::int32_t(i);
  }
}

void BroadPhase::set_still(std::span<const Bound> still) {
  still_bounds_.assign(still.begin(), still.end());
  still_.fill(still_bounds_, cell_edge(still));
}

void BroadPhase::find_pairs(std::span<const Bound> moving, std::vector<NearPair>& pairs) {
  moving_.fill(moving, cell_edge(moving));
  const auto add = [&](std::int32_t i, std::int32_t j) { pairs.push_back(i < j ? NearPair{i, j} : NearPair{j, i}); };

  // 1. Movers with movers, each pair of cells once. Hashing may bring strangers into a bucket: the cell is compared too.
  const double inverse = 1.0 / moving_.cell;
  for (std::size_t p = 0; p < moving_.bounds.size(); ++p) {
    const Bound& a = moving_.bounds[p];
    const Cell home = cell_of(a.center, inverse);
    for (const auto& step : kHalf) {
      const Cell cell = home + Cell(step[0], step[1], step[2]);
      const bool own = &step == &kHalf[0];
      const std::uint32_t bucket = hash_of(cell) & moving_.mask;
      for (std::uint32_t q = own ? std::uint32_t(p) + 1 : moving_.start[bucket]; q < moving_.start[bucket + 1]; ++q)
        if (overlap(a, moving_.bounds[q]) && cell_of(moving_.bounds[q].center, inverse) == cell) add(moving_.index[p], moving_.index[q]);
    }
  }
  for (std::size_t k = 0; k < moving_.outsized.size(); ++k) {
    const std::int32_t i = moving_.outsized[k];
    for (std::size_t q = 0; q < moving_.bounds.size(); ++q)
      if (overlap(moving[i], moving_.bounds[q])) add(i, moving_.index[q]);
    for (std::size_t m = k + 1; m < moving_.outsized.size(); ++m)
      if (overlap(moving[i], moving[moving_.outsized[m]])) add(i, moving_.outsized[m]);
  }

  // 2. Movers with what stands still: all cells that the mover reaches.
  if (still_bounds_.empty()) return;
  const double still_inverse = 1.0 / still_.cell;
  for (std::int32_t i = 0; i < std::int32_t(moving.size()); ++i) {
    const Bound& a = moving[i];
    const Vec3 grown = Vec3::Constant(a.reach + 0.5 * still_.cell);
    const Cell low = cell_of(a.center - grown, still_inverse), high = cell_of(a.center + grown, still_inverse);
    const std::int64_t cells = std::int64_t(high.x() - low.x() + 1) * (high.y() - low.y() + 1) * (high.z() - low.z() + 1);
    if (cells > std::int64_t(still_.bounds.size()) + 27) {  // larger than the whole grid: look at every one
      for (std::size_t q = 0; q < still_.bounds.size(); ++q)
        if (overlap(a, still_.bounds[q])) pairs.push_back({i, -1 - still_.index[q]});
    } else {
      for (int z = low.z(); z <= high.z(); ++z)
        for (int y = low.y(); y <= high.y(); ++y)
          for (int x = low.x(); x <= high.x(); ++x) {
            const Cell cell(x, y, z);
            const std::uint32_t bucket = hash_of(cell) & still_.mask;
            for (std::uint32_t q = still_.start[bucket]; q < still_.start[bucket + 1]; ++q)
              if (overlap(a, still_.bounds[q]) && cell_of(still_.bounds[q].center, still_inverse) == cell)
                pairs.push_back({i, -1 - still_.index[q]});
          }
    }
    for (const std::int32_t q : still_.outsized)
      if (overlap(a, still_bounds_[q])) pairs.push_back({i, -1 - q});
  }
}

}  // namespace lodestone
