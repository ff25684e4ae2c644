#include "lod/manager/share_by_error.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr double kLeastCost = 1e-9;

// So many that do not fit are passed over, and no more.
constexpr int kMostPassedOver = 200;

struct Upgrade {
  std::int32_t candidate = 0;
  Rung from = Rung::tables, to = Rung::support;
  double saved_per_cost = 0.0;
};

double saved_per_cost(const LevelCandidate& c, Rung from, Rung to) {
  const double lasting = c.cost_at(to) - (to == c.rung ? double(c.passing) : 0.0);
  return (c.error_at(from) - c.error_at(to)) / std::max(kLeastCost, lasting - c.cost_at(from));
}

/// What saves nothing is left out. A rung that the body has already counts for more, so that none of two
/// alike goes up and down by turns.
void add_upgrade(const LevelCandidate& c, std::int32_t index, Rung from, Rung to, double hysteresis,
                 std::vector<Upgrade>& upgrades) {
  const double saved = saved_per_cost(c, from, to) * (!c.newcomer && c.rung >= to ? 1.0 + hysteresis : 1.0);
  if (saved > 0.0) upgrades.push_back({index, from, to, saved});
}

void add_upgrades(const LevelCandidate& c, std::int32_t index, const ErrorShareLimits& limits,
                  std::vector<Upgrade>& upgrades) {
  if (c.decided()) return;
  const Rung lowest = c.open.lowest();
  const bool full = may_be_full_now(c),
             between = lowest == Rung::tables && c.open.has(Rung::support);
  if (!between) {
    if (full) add_upgrade(c, index, lowest, Rung::full, limits.hysteresis, upgrades);
    return;
  }
  const bool at_once =
      full && saved_per_cost(c, Rung::support, Rung::full) >= saved_per_cost(c, Rung::tables, Rung::support);
  if (at_once) return add_upgrade(c, index, Rung::tables, Rung::full, limits.hysteresis, upgrades);
  add_upgrade(c, index, Rung::tables, Rung::support, limits.hysteresis, upgrades);
  if (full) add_upgrade(c, index, Rung::support, Rung::full, limits.hysteresis, upgrades);
}

}  // namespace

std::vector<Rung> share_by_error(std::span<const LevelCandidate> candidates, FullBill bill,
                                 const ErrorRoom& room, const ErrorShareLimits& limits) {
  std::vector<Rung> rungs;
  std::vector<Upgrade> upgrades;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    rungs.push_back(candidates[i].open.lowest());
    add_upgrades(candidates[i], std::int32_t(i), limits, upgrades);
  }
  std::ranges::stable_sort(upgrades, std::ranges::greater{}, &Upgrade::saved_per_cost);
  const double before = bill.total();
  double of_support = 0.0;
  std::int64_t full = 0, support = 0;
  // A body that goes on to full leaves its place at `support` to another, which was refused it before.
  for (bool again = true; again;) {
    again = false;
    bool refused = false;
    int passed_over = 0;
    for (const Upgrade& u : upgrades) {
      const LevelCandidate& c = candidates[std::size_t(u.candidate)];
      Rung& rung = rungs[std::size_t(u.candidate)];
      if (rung != u.from) continue;  // made already, or the step before was not
      const bool to_full = u.to == Rung::full, has_it = !c.newcomer && c.rung >= u.to,
                 leaves_support = to_full && rung == Rung::support && c.open.lowest() == Rung::tables;
      if (to_full ? full + c.bodies > limits.most_full : support + c.bodies > limits.most_support) {
        refused |= !to_full;
        continue;
      }
      const double refund = leaves_support ? raise(c, Rung::support) : 0.0;
      const double price = raise(c, u.to) + (to_full ? bill.price_of_pairs(c) : 0.0);
      if (bill.total() - before + of_support - refund + price > (has_it ? room.keep : room.grow)) {
        if (++passed_over > kMostPassedOver) break;
        continue;
      }
      rung = u.to;
      if (leaves_support) support -= c.bodies, of_support -= refund, again |= refused;
      if (to_full)
        bill.add(c), full += c.bodies;
      else
        of_support += price, support += c.bodies;
    }
  }
  return rungs;
}

}  // namespace lodestone
