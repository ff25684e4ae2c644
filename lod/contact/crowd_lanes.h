// The contacts of a crowd in lanes: manifolds are coloured so that those of one colour share no body that
// moves (greedy colouring; Fratarcangeli, Tibaldo and Pellacini, Vivace, 2016). Any number of them can be
// answered at a time, with one result.
#pragma once

#include <array>
#include <bit>

#include "lod/contact/contact_lanes.h"
#include "lod/jobs.h"

namespace lodestone::lane {

template <Lanes L>
class CrowdLanes {
 public:
  explicit CrowdLanes(Simd simd) : lanes_(simd) {}

  /// Takes the manifolds `which` of the contacts and prepares them.
  void take(const CrowdContacts& contacts, std::span<const std::uint32_t> which, const JobRunner& jobs);
  /// One round over all points, colour by colour, as ContactLanes::sweep. Returns by how much a velocity
  /// changed at most, m/s. (Impulses say nothing of a crowd's lighter bodies.)
  template <class Answer>
  double sweep(const Answer& answer, const JobRunner& jobs);
  void hand_out(const CrowdContacts& contacts, const JobRunner& jobs) const;

  ContactLanes<L>& lanes() { return lanes_; }

 private:
  static constexpr int kWidth = kLanes<L>;
  static constexpr int kColours = 64;  // the last: manifolds for which no other was left, one by one
  static constexpr std::uint32_t kMostPoints = 4;  // of a manifold; more make no difference to its place
  static constexpr std::size_t kGroups =
      2 * kMostPoints;  // of a colour: by whether it carried something, and its points
  static constexpr std::int64_t kGrain = 256 / kWidth;  // batches of a job

  void make_batches(const CrowdContacts& contacts, std::span<const std::uint32_t> which);
  template <class Visit>
  void each_block(const JobRunner& jobs, const Visit& visit) const;

  ContactLanes<L> lanes_;
  std::vector<std::uint64_t> used_;         // of each body, as bits: colours that its manifolds have
  std::vector<std::uint16_t> group_of_;     // of each manifold, over all colours
  std::vector<std::uint32_t> order_;        // manifolds by group
  std::vector<std::uint32_t> first_of_;     // of each group, in `order_`
  std::vector<std::uint32_t> first_batch_;  // of each colour; one more
  std::vector<double> changes_;             // m/s, of each block of a colour
};

// Visits the batches of a colour in blocks, one colour after the other.
template <Lanes L>
template <class Visit>
void CrowdLanes<L>::each_block(const JobRunner& jobs, const Visit& visit) const {
  for (std::size_t colour = 0; colour < kColours; ++colour) {
    const std::int64_t begin = first_batch_[colour], end = first_batch_[colour + 1];
    if (begin == end) continue;
    if (const std::int64_t blocks = (end - begin + kGrain - 1) / kGrain; blocks > 1 && colour != kColours - 1)
      jobs(blocks, TaskRef([&](std::int64_t block) {
             visit(block, begin + block * kGrain, std::min(end, begin + (block + 1) * kGrain));
           }));
    else
      visit(0, begin, end);
  }
}

template <Lanes L>
template <class Answer>
double CrowdLanes<L>::sweep(const Answer& answer, const JobRunner& jobs) {
  changes_.assign(lanes_.batches().size() / kGrain + 1, 0.0);
  each_block(jobs, [&](std::int64_t block, std::int64_t begin, std::int64_t end) {
    const LaneChange<L> change = lanes_.sweep(answer, begin, end);
    double& greatest = changes_[std::size_t(block)];
    for (int i = 0; i < kWidth; ++i) greatest = std::max(greatest, double(change.of_velocity[i]));
  });
  return *std::ranges::max_element(changes_);
}

// Which manifolds each holds, and where its points will be. Each manifold gets the first colour that none of
// its bodies has yet; what does not move may be shared. Those that carried something lie side by side, since
// a sweep is quick where none of a batch does.
template <Lanes L>
void CrowdLanes<L>::make_batches(const CrowdContacts& contacts, std::span<const std::uint32_t> which) {
  const auto& [bodies, manifolds, points, step, settings] = contacts;
  used_.assign(bodies.size(), 0);
  group_of_.resize(which.size());
  first_of_.assign(kColours * kGroups + 1, 0);
  const auto carries = [&](const CrowdManifold& m) {
    return std::ranges::any_of(contacts.points.subspan(m.begin, m.count),
                               [](const CrowdPoint& point) { return !point.guess.isZero(0.0); });
  };
  for (std::size_t i = 0; i < which.size(); ++i) {
    const CrowdManifold& m = manifolds[which[i]];
    const auto used_of = [&](std::int32_t body, std::uint64_t& none) -> std::uint64_t& {
      const bool moves = body >= 0 && contacts.bodies[std::size_t(body)].inverse_mass > 0.0;
      return moves ? used_[std::size_t(body)] : none;
    };
    std::uint64_t none[2] = {0, 0};
    std::uint64_t &first = used_of(m.first, none[0]), &second = used_of(m.second, none[1]);
    const int colour = std::min(std::countr_one(first | second), kColours - 1);
    if (colour < kColours - 1) first |= std::uint64_t(1) << colour, second |= std::uint64_t(1) << colour;
    group_of_[i] = std::uint16_t(std::size_t(colour) * kGroups + carries(m) * kMostPoints +
                                 std::min(m.count, kMostPoints) - 1);
    ++first_of_[group_of_[i] + 1U];
  }
  for (std::size_t g = 1; g < first_of_.size(); ++g) first_of_[g] += first_of_[g - 1];
  order_.resize(which.size());
  for (std::size_t i = 0; i < which.size(); ++i) order_[first_of_[group_of_[i]]++] = which[i];

  std::array<double, kWidth> unit_mass;
  unit_mass.fill(unit_mass_of(contacts, manifolds[which.front()]));
  first_batch_.assign(1, 0);
  std::uint32_t at = 0;
  for (int colour = 0; colour < kColours; ++colour) {
    const std::uint32_t end = first_of_[std::size_t(colour + 1) * kGroups - 1];
    const std::uint32_t width = colour == kColours - 1 ? 1 : kWidth;
    for (; at < end; at = std::min(at + width, end)) {
      const std::size_t count = std::min(width, end - at);
      lanes_.add_batch(contacts, std::span(order_).subspan(at, count), std::span(unit_mass).first(count));
    }
    first_batch_.push_back(std::uint32_t(lanes_.batches().size()));
  }
  lanes_.end();
}

template <Lanes L>
void CrowdLanes<L>::take(const CrowdContacts& contacts, std::span<const std::uint32_t> which,
                         const JobRunner& jobs) {
  lanes_.clear();
  if (which.empty()) return;
  lanes_.take_motions(contacts.bodies);
  make_batches(contacts, which);
  run_in_pieces(jobs, std::int64_t(lanes_.batches().size()), kGrain,
                [&](std::int64_t begin, std::int64_t end) { lanes_.prepare(contacts, begin, end); });
}

template <Lanes L>
void CrowdLanes<L>::hand_out(const CrowdContacts& contacts, const JobRunner& jobs) const {
  if (lanes_.empty()) return;
  each_block(jobs, [&](std::int64_t, std::int64_t begin, std::int64_t end) {
    lanes_.hand_out(contacts, begin, end);
  });
}

}  // namespace lodestone::lane
