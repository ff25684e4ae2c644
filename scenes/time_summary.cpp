#include "scenes/time_summary.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lodestone {
namespace {

// Cells of the histogram: from a nanosecond to twelve days.
constexpr double kLeastMs = 1e-6;
constexpr int kCellsPerOctave = 128, kOctaves = 50;

std::size_t cell_of(double ms) {
  if (!(ms > kLeastMs)) return 0;
  return std::size_t(
      std::min(std::log2(ms / kLeastMs) * kCellsPerOctave, double(kCellsPerOctave * kOctaves - 1)));
}

double middle_ms_of(std::size_t cell) { return kLeastMs * std::exp2((double(cell) + 0.5) / kCellsPerOctave); }

}  // namespace

TimeSummary summarize(std::span<const double> sample_ms) {
  if (sample_ms.empty()) return {};
  std::vector<double> sorted(sample_ms.begin(), sample_ms.end());
  std::ranges::sort(sorted);
  const auto percentile = [&](double part) {
    const double rank = part * double(sorted.size() - 1);
    const std::size_t below = std::size_t(rank), above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (rank - double(below)) * (sorted[above] - sorted[below]);
  };
  const double mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / double(sorted.size());
  return {percentile(0.5), percentile(0.95), percentile(0.99), mean, sorted.back()};
}

void TimeTally::add(double ms) {
  ++count_;
  sum_ += ms;
  max_ = count_ == 1 ? ms : std::max(max_, ms);
  if (cells_.empty() && exact_.size() < kExactTimes) return exact_.push_back(ms);
  if (cells_.empty()) {
    cells_.resize(kCellsPerOctave * kOctaves);
    for (const double earlier : exact_) ++cells_[cell_of(earlier)];
    exact_ = {};
  }
  ++cells_[cell_of(ms)];
}

double TimeTally::percentile(double part) const {
  const auto rank = std::uint64_t(part * double(count_ - 1));
  std::uint64_t below = 0;
  std::size_t cell = 0;
  while (below + cells_[cell] <= rank) below += cells_[cell++];
  return std::min(middle_ms_of(cell), max_);
}

TimeSummary TimeTally::summary() const {
  if (cells_.empty()) return summarize(exact_);
  return {percentile(0.5), percentile(0.95), percentile(0.99), sum_ / double(count_), max_};
}

}  // namespace lodestone
