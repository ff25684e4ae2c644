#include "lod/manager/change_queue.h"

#include <algorithm>
#include <limits>

namespace lodestone {
namespace {

constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max() / 2;

/// How many of the limited places on a rung it takes: those of `support` are for bodies that are awake.
std::int64_t places_of(const LevelCandidate& c, Rung rung) {
  return rung == Rung::support && c.asleep ? 0 : c.bodies;
}

/// Whether its caller has closed the rung that it is on.
bool must_leave(const LevelCandidate& c) { return !c.open.has(c.present()); }

/// Of the wishes that are in order, from `at` on, moves the first that `may` come true to `at`. False: none
/// of the next few may.
template <class May>
bool bring_forward(std::vector<Ranked>& wishes, std::size_t at, std::size_t in_order, const May& may) {
  const std::size_t end = std::min(at + 1 + kPassedOver, in_order);
  for (std::size_t k = at; k < end; ++k) {
    if (!may(wishes[k])) continue;
    std::rotate(wishes.begin() + std::ptrdiff_t(at), wishes.begin() + std::ptrdiff_t(k),
                wishes.begin() + std::ptrdiff_t(k + 1));
    return true;
  }
  return false;
}

}  // namespace

ChangeQueue::ChangeQueue(std::span<const LevelCandidate> candidates, const PolicySettings& settings,
                         const StepOverhead& overhead)
    : candidates_(candidates),
      settings_(settings),
      overhead_(overhead),
      stays_full_(candidates, overhead),
      price_of_pairs_(candidates.size()),
      goes_down_(candidates.size()) {
  decision_.reasons.resize(candidates.size());
  count_places();
}

// How many more bodies the policy may put on each rung.
void ChangeQueue::count_places() {
  places_.fill(kNoLimit);
  if (settings_.most_full < kUnlimited) places_[std::size_t(Rung::full)] = settings_.most_full;
  if (settings_.most_support < kUnlimited) places_[std::size_t(Rung::support)] = settings_.most_support;
  for (const LevelCandidate& c : candidates_)
    if (!c.decided() && !c.newcomer) places_[std::size_t(c.rung)] -= places_of(c, c.rung);
}

bool ChangeQueue::has_place(const Ranked& wish) const {
  const std::int64_t needed = places_of(candidate(wish), wish.to);
  return needed == 0 || places_[std::size_t(wish.to)] >= needed;
}

bool ChangeQueue::is_one_too_many(const LevelCandidate& c) const {
  return places_of(c, c.rung) > 0 && places_[std::size_t(c.rung)] < 0;
}

// To its lowest rung it may fall whatever the limit.
bool ChangeQueue::can_fall(const Ranked& wish) const {
  return wish.to == candidate(wish).open.lowest() || has_place(wish);
}

// Whether each goes where the other comes from, and both have a place there once the other has left.
bool ChangeQueue::can_exchange(const Ranked& fall, const Ranked& rise) {
  const LevelCandidate &falls = candidate(fall), &rises = candidate(rise);
  if (falls.rung != rise.to || rises.rung != fall.to) return false;
  update_price_of_pairs(rise);
  const auto fit = [this](const LevelCandidate& comes, const LevelCandidate& goes, Rung rung) {
    return places_[std::size_t(rung)] + places_of(goes, rung) >= places_of(comes, rung);
  };
  return fit(rises, falls, rise.to) && fit(falls, rises, fall.to) && cost_of(fall) + cost_of(rise) <= room_;
}

// Whether others make room for it once their dwell is over.
bool ChangeQueue::leaves_place_later(const Ranked& wish) const {
  return places_[std::size_t(wish.to)] + held_by_dwell_[std::size_t(wish.to)] >=
         places_of(candidate(wish), wish.to);
}

void ChangeQueue::add(const Ranked& by_distance, Target target) {
  const LevelCandidate& c = candidate(by_distance);
  Rule& reason = decision_.reasons[std::size_t(by_distance.index)];
  if (c.decided()) target = {c.open.lowest(), c.decided_by, true};
  reason = c.put_off && c.rung != Rung::full && target.rung == c.rung ? Rule::overlap_put_off : target.reason;
  if (target.rung == c.present() && (!c.decided() || !c.newcomer || target.rung != Rung::full)) return;

  const bool up = c.newcomer || target.rung > c.rung;
  const Ranked wish{by_distance.distance, by_distance.index, target.rung};
  if (up && target.rung == Rung::full && c.put_off && !c.newcomer) {
    reason = Rule::overlap_put_off;
  } else if (c.decided()) {
    (up ? decision_.promote : decision_.demote).push_back({wish.index, wish.to});
  } else if (c.newcomer || must_leave(c) || (!up && (target.at_once || is_one_too_many(c)))) {
    (up ? promote_at_once_ : demote_at_once_).push_back(wish);
  } else {
    hold_or_queue(wish, up ? promote_ : demote_);
  }
}

void ChangeQueue::hold_or_queue(const Ranked& wish, std::vector<Ranked>& queue) {
  const LevelCandidate& c = candidate(wish);
  const bool pauses = overhead_.pauses && &queue == &promote_;
  if (c.dwell_left == 0 && !pauses) return queue.push_back(wish);
  decision_.reasons[std::size_t(wish.index)] = c.dwell_left > 0 ? Rule::dwell : Rule::paused;
  held_by_dwell_[std::size_t(c.rung)] += places_of(c, c.rung);
}

LevelDecision ChangeQueue::grant() {
  demote_at_once();
  Turns turns = put_in_order();
  note_staying_full();
  promote_at_once();
  take_turns(turns);
  rise_past_waiting(turns);
  leave_queued(turns);
  return std::move(decision_);
}

// Until the budget and the limits are kept again, the farthest first; the others take their turns.
void ChangeQueue::demote_at_once() {
  // Of a sleeper most of what it is charged is a reserve: its going down frees hardly any time.
  std::ranges::sort(demote_at_once_, [this](const Ranked& a, const Ranked& b) {
    const bool sleeps = candidate(a).asleep, other_sleeps = candidate(b).asleep;
    return sleeps != other_sleeps ? other_sleeps : farther(a, b);
  });
  for (Ranked& wish : demote_at_once_) {
    const LevelCandidate& c = candidate(wish);
    if (!must_leave(c) && room_ >= 0.0 && !is_one_too_many(c)) {  // enough went down
      hold_or_queue(wish, demote_);
      continue;
    }
    if (!has_place(wish)) wish.to = c.open.lowest();
    decision_.sent_back += !must_leave(c) && room_ < 0.0 && c.dwell_left > 0;
    make(wish, decision_.demote);
  }
}

// As many as can have their turn in this step, with those that may be passed over.
ChangeQueue::Turns ChangeQueue::put_in_order() {
  const auto cap = std::size_t(std::max(0, settings_.max_transitions_per_frame));
  const Turns turns{.left = cap,
                    .rises_in_order = std::min(cap + kPassedOver, promote_.size()),
                    .falls_in_order = std::min(cap + kPassedOver, demote_.size())};
  std::ranges::partial_sort(promote_, promote_.begin() + std::ptrdiff_t(turns.rises_in_order), nearer);
  std::ranges::partial_sort(demote_, demote_.begin() + std::ptrdiff_t(turns.falls_in_order), farther);
  return turns;
}

// Whoever goes up makes pairs with these, too, whether or not the policy wants them to be full.
void ChangeQueue::note_staying_full() {
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const LevelCandidate& c = candidates_[i];
    const bool stays = c.decided() ? c.open.has(Rung::full) : c.present() == Rung::full && !goes_down_[i];
    if (stays) stays_full_.add(c);
  }
}

void ChangeQueue::promote_at_once() {
  std::ranges::sort(promote_at_once_, nearer);
  for (const Ranked& wish : promote_at_once_)
    if (fits(wish))
      make(wish, decision_.promote);
    else
      decision_.reasons[std::size_t(wish.index)] = Rule::over_budget;
}

void ChangeQueue::take_turns(Turns& turns) {
  for (; turns.left > 0; --turns.left) {
    skip_dear_pairs(turns);
    if (!take_turn(turns)) return;
  }
}

// Those next to go up that would fit but for their pairs wait, and let others pass.
void ChangeQueue::skip_dear_pairs(Turns& turns) {
  for (; turns.up < turns.rises_in_order; ++turns.up) {
    const Ranked& wish = promote_[turns.up];
    if (places_[std::size_t(wish.to)] <= 0 || fits(wish) || !fits_but_for_pairs(wish)) return;
    decision_.reasons[std::size_t(wish.index)] = Rule::queued;
  }
}

// One change: up and down by turns, or both at once where each waits for the other's place. False: none can
// be made.
bool ChangeQueue::take_turn(Turns& turns) {
  const bool rises = turns.up < turns.rises_in_order && fits(promote_[turns.up]);
  const bool falls = bring_forward(demote_, turns.down, turns.falls_in_order,
                                   [this](const Ranked& wish) { return can_fall(wish); });
  if (rises && (turns.up <= turns.down || !falls)) {
    make(promote_[turns.up++], decision_.promote);
    return true;
  }
  if (falls) {
    make(demote_[turns.down++], decision_.demote);
    return true;
  }
  if (turns.down == demote_.size()) return false;
  // An exchange takes two turns. Where one is left it waits for the next step, unless the cap allows no more
  // than one in any.
  if (turns.left == 1 && settings_.max_transitions_per_frame > 1) return false;
  const auto takes_its_place = [&](const Ranked& wish) { return can_exchange(demote_[turns.down], wish); };
  if (turns.left > 1 && bring_forward(promote_, turns.up, turns.rises_in_order, takes_its_place)) {
    make(demote_[turns.down++], decision_.demote);
    make(promote_[turns.up++], decision_.promote);
    --turns.left;
    return true;
  }
  if (leaves_place_later(demote_[turns.down])) return false;
  demote_[turns.down].to = candidate(demote_[turns.down]).open.lowest();
  make(demote_[turns.down++], decision_.demote);
  return true;
}

// The nearest may wait for a place on a rung that another leaves by rising farther: that one goes first.
void ChangeQueue::rise_past_waiting(Turns& turns) {
  if (turns.up >= turns.rises_in_order || has_place(promote_[turns.up])) return;
  for (std::size_t k = turns.up + 1; k < turns.rises_in_order && turns.left > 0; ++k) {
    if (promote_[k].to == promote_[turns.up].to || !fits(promote_[k])) continue;
    make(promote_[k], decision_.promote);
    std::rotate(promote_.begin() + std::ptrdiff_t(turns.up), promote_.begin() + std::ptrdiff_t(k),
                promote_.begin() + std::ptrdiff_t(k + 1));
    ++turns.up, --turns.left;
  }
}

void ChangeQueue::leave_queued(const Turns& turns) {
  for (std::size_t k = turns.up; k < promote_.size(); ++k)
    decision_.reasons[std::size_t(promote_[k].index)] = Rule::queued;
  for (std::size_t k = turns.down; k < demote_.size(); ++k)
    decision_.reasons[std::size_t(demote_[k].index)] = Rule::queued;
}

// What the change adds to the cost of the step.
double ChangeQueue::cost_of(const Ranked& wish) const {
  const LevelCandidate& c = candidate(wish);
  const double pairs = double(price_of_pairs_[std::size_t(wish.index)]);
  const double change_of_pairs = wish.to == Rung::full ? pairs : c.present() == Rung::full ? -pairs : 0.0;
  return c.cost_at(wish.to) - c.cost_at(c.present()) + change_of_pairs +
         double(c.bodies) * overhead_.change[std::size_t(wish.to)];
}

void ChangeQueue::update_price_of_pairs(const Ranked& wish) {
  if (wish.to == Rung::full) set_price_of_pairs(wish.index, stays_full_.price_of_pairs(candidate(wish)));
}

bool ChangeQueue::fits(const Ranked& wish) {
  update_price_of_pairs(wish);
  return has_place(wish) && cost_of(wish) <= room_;
}

bool ChangeQueue::fits_but_for_pairs(const Ranked& wish) const {
  return wish.to == Rung::full && cost_of(wish) - double(price_of_pairs_[std::size_t(wish.index)]) <= room_;
}

void ChangeQueue::make(const Ranked& wish, std::vector<LevelDecision::Change>& changes) {
  const LevelCandidate& c = candidate(wish);
  changes.push_back({wish.index, wish.to});
  room_ -= cost_of(wish);
  places_[std::size_t(wish.to)] -= places_of(c, wish.to);
  if (!c.newcomer) places_[std::size_t(c.rung)] += places_of(c, c.rung);
  if (wish.to == Rung::full)
    stays_full_.add(c);
  else
    goes_down_[std::size_t(wish.index)] = true;
}

}  // namespace lodestone
