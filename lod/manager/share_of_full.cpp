#include "lod/manager/share_of_full.h"

#include <algorithm>
#include <limits>

namespace lodestone {
namespace {

FullPairs::Body body_of(const LevelCandidate& c) {
  return {c.position, c.radius, c.mesh, c.asleep, c.motion};
}

double most_radius(std::span<const LevelCandidate> candidates) {
  double most = 0.0;
  for (const LevelCandidate& c : candidates) most = std::max(most, c.radius);
  return most;
}

}  // namespace

FullBill::FullBill(std::span<const LevelCandidate> candidates, const StepOverhead& overhead)
    : overhead_(&overhead), pairs_(most_radius(candidates)) {}

double FullBill::price_of(const PairWeights& pairs) const {
  return overhead_->pair * (pairs.awake + kChargeOfSleepers * pairs.asleep) +
         overhead_->spike * std::max(0.0, pairs.dearest - dearest_);
}

PairWeights FullBill::pairs_of(const LevelCandidate& candidate) const {
  PairWeights pairs = pairs_.meet(body_of(candidate));
  return pairs += candidate.pairs_within;
}

double FullBill::price_of_pairs(const LevelCandidate& candidate) const {
  return price_of(pairs_of(candidate));
}

void FullBill::add(const LevelCandidate& candidate) {
  const PairWeights met = pairs_of(candidate);
  total_ += raise(candidate, Rung::full) + price_of(met);
  dearest_ = std::max(dearest_, met.dearest);
  pairs_.add(body_of(candidate));
}

ShareOfFull share_full(std::span<const LevelCandidate> candidates, std::vector<Ranked> ranked, FullBill bill,
                       double room, std::int64_t most) {
  ShareOfFull share;
  const double before = bill.total();
  std::ranges::make_heap(ranked, farther);
  int passed_over = 0;
  std::int64_t bodies = 0;
  share.reach = std::numeric_limits<double>::infinity();
  while (!ranked.empty()) {
    const Ranked nearest = ranked.front();
    const LevelCandidate& c = candidates[std::size_t(nearest.index)];
    const double left = room - (bill.total() - before), price = raise(c, Rung::full);
    const bool too_many = bodies + c.bodies > most,
               fits = !too_many && price + bill.price_of_pairs(c) <= left;
    share.most_reached |= too_many;
    if (bodies >= most || price > left || (!fits && ++passed_over > int(kPassedOver))) {
      share.reach = nearest.distance;
      break;
    }
    std::ranges::pop_heap(ranked, farther);
    ranked.pop_back();
    (fits ? share.taken : share.rest).push_back(nearest);
    if (fits) bill.add(c), bodies += c.bodies;
  }
  if (bodies >= most && ranked.empty()) share.reach = share.taken.empty() ? 0.0 : share.taken.back().distance;
  share.rest.insert(share.rest.end(), ranked.begin(), ranked.end());
  share.used = bill.total() - before;
  return share;
}

}  // namespace lodestone
