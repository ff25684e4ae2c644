#include "signature/measure/choose_clips.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "signature/measure/rest_poses.h"
#include "signature/measure/settling_trial.h"

namespace lodestone {
namespace {

double travel_of(const SettlingRecord& r) {
  return (r.states.back().position - r.states.front().position).head<2>().norm();
}

bool may_be_clip(const SettlingRecord& r) { return r.rests && r.states.size() >= 2; }

// The candidates that end in each pose, shortest first; those that end in none of the poses in a last group.
std::vector<std::vector<std::size_t>> group_by_pose(std::span<const SettlingRecord> records,
                                                    std::span<const RestPose> poses) {
  std::vector<std::vector<std::size_t>> groups(poses.size() + 1);
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!may_be_clip(records[i])) continue;
    const auto nearest = std::ranges::max_element(
        poses, {}, [&](const RestPose& p) { return p.normal.dot(records[i].normal); });
    const bool is_one =
        nearest != poses.end() && nearest->normal.dot(records[i].normal) > std::cos(kSamePose);
    groups[is_one ? std::size_t(nearest - poses.begin()) : poses.size()].push_back(i);
  }
  for (auto& group : groups)
    std::ranges::stable_sort(group, {}, [&](std::size_t i) { return records[i].states.size(); });
  return groups;
}

// `count` shared out as the frequencies ask, none getting more than there are; what is left goes where most
// is owed.
std::vector<std::size_t> share_out(std::size_t count, std::span<const double> frequencies,
                                   std::span<const std::vector<std::size_t>> groups) {
  std::vector<std::size_t> shares(groups.size(), 0);
  for (std::size_t given = 0; given < count; ++given) {
    std::size_t next = groups.size();
    double most_owed = 0.0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const double owed = frequencies[g] * double(count) - double(shares[g]);
      if (shares[g] < groups[g].size() && (next == groups.size() || owed > most_owed))
        next = g, most_owed = owed;
    }
    if (next == groups.size()) break;
    ++shares[next];
  }
  return shares;
}

void choose_from(std::span<const SettlingRecord> records, std::span<const std::size_t> group,
                 std::size_t share, std::vector<std::size_t>& chosen) {
  double owed = 0.0;  // travel of the strata so far, less that of their chosen
  for (std::size_t k = 0; k < share; ++k) {
    const auto stratum =
        group.subspan(k * group.size() / share, (k + 1) * group.size() / share - k * group.size() / share);
    const double mean =
        std::accumulate(stratum.begin(), stratum.end(), 0.0,
                        [&](double sum, std::size_t i) { return sum + travel_of(records[i]); }) /
        double(stratum.size());
    owed += mean;
    const std::size_t best = *std::ranges::min_element(
        stratum, {}, [&](std::size_t i) { return std::abs(owed - travel_of(records[i])); });
    owed -= travel_of(records[best]);
    chosen.push_back(best);
  }
}

}  // namespace

std::vector<std::size_t> choose_clips(std::span<const SettlingRecord> records,
                                      std::span<const RestPose> poses, int count) {
  const auto groups = group_by_pose(records, poses);
  std::vector<double> frequencies;
  for (const RestPose& p : poses) frequencies.push_back(p.frequency);
  frequencies.push_back(std::max(0.0, 1.0 - std::accumulate(frequencies.begin(), frequencies.end(), 0.0)));
  const std::vector<std::size_t> shares = share_out(std::size_t(std::max(count, 0)), frequencies, groups);
  std::vector<std::size_t> chosen;
  for (std::size_t g = 0; g < groups.size(); ++g) choose_from(records, groups[g], shares[g], chosen);
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace lodestone
