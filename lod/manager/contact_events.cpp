#include "lod/manager/contact_events.h"

#include <algorithm>

#include "reference/ode/callers_bodies.h"

namespace lodestone {
namespace {

constexpr double kApart = 0.1;  // s: then they touch no more

}  // namespace

void ContactEvents::archive(StateArchive& a) {
  const auto is_callers = [](const ContactEvent& event) {
    return event.second.kind == ContactSide::Kind::callers;
  };
  const auto own_of = [&](std::vector<Pair> pairs) {
    std::erase_if(pairs, [&](const Pair& pair) { return is_callers(pair.last); });
    return pairs;
  };
  std::vector<Pair> live = own_of(live_);
  std::unordered_map<std::uint32_t, std::vector<Pair>> aside;
  for (const auto& [body, pairs] : aside_)
    if (auto own = own_of(pairs); !own.empty()) aside.emplace(body, std::move(own));
  std::vector<ContactEvent> events = events_;
  std::erase_if(events, is_callers);
  a(asking_, live, aside, events);
  if (a.reading()) live_ = std::move(live), aside_ = std::move(aside), events_ = std::move(events);
}

void ContactEvents::ask(std::uint32_t body, bool asks) {
  if (asks)
    asking_.insert(body);
  else
    asking_.erase(body);
}

// What it lay on is told at the end of the next step.
void ContactEvents::forget(std::uint32_t body) {
  asking_.erase(body);
  bring_back(body);
}

std::pair<dxGeom*, dxBody*> ContactEvents::callers_of(const ContactRecord& record) const {
  if (record.second != ContactRecord::kGround)
    return {nullptr, is_own(record.second) ? nullptr : levels_.callers.bodies.body_of(record.second)};
  dxGeom* const geom = record.callers_geom ? record.callers_geom
                       : record.ground     ? levels_.callers.ground.geom_of(record.ground)
                                           : nullptr;
  dxBody* const body = record.callers_geom ? callers::body_of(geom) : nullptr;
  return body && !callers::is_kinematic(body) ? std::pair<dxGeom*, dxBody*>(nullptr, body)
                                              : std::pair<dxGeom*, dxBody*>(geom, nullptr);
}

ContactEvents::Key ContactEvents::key_of(const ContactRecord& record) {
  if (record.second != ContactRecord::kGround && is_own(record.second))
    return {record.first, Key::Second::body, record.second};
  const auto [geom, body] = callers_of(record);
  if (!geom && !body)
    return {record.first, Key::Second::ground, record.ground.index, record.ground.generation};
  const void* const callers = geom ? static_cast<const void*>(geom) : body;
  return {record.first, Key::Second::callers,
          number_of_callers_.try_emplace(callers, std::uint32_t(number_of_callers_.size())).first->second};
}

void ContactEvents::take_full_touches() {
  if (!wanted() || !levels_.full.world()) return;
  const FullLevel& full = levels_.full;
  for (const OdeTouch& touch : full.world()->touches()) {
    const std::int32_t first = full.index_of(touch.first),
                       second = touch.second ? full.index_of(touch.second) : -1;
    const bool gone = first < 0 || (touch.second && second < 0);
    if (gone) continue;
    const auto owner = [&](std::int32_t member) { return full.members()[std::size_t(member)].owner; };
    log_.add({.first = owner(first),
              .second = second >= 0 ? owner(second) : ContactRecord::kGround,
              .ground = full.ground_of(touch.ground),
              .ground_material = touch.second_material,
              .callers_geom = touch.callers_geom,
              .point = touch.point,
              .normal = touch.normal,
              .impulse = touch.impulse,
              .approach = touch.approach});
  }
}

ContactSide ContactEvents::body_side(std::uint32_t body) const {
  return {.kind = ContactSide::Kind::body,
          .body = levels_.bodies.id(body),
          .material = levels_.bodies[body].material};
}

ContactSide ContactEvents::second_side(const ContactRecord& record) const {
  if (record.second != ContactRecord::kGround && is_own(record.second)) return body_side(record.second);
  const auto [geom, body] = callers_of(record);
  if (geom || body)
    return {.kind = ContactSide::Kind::callers,
            .geom = geom,
            .callers = body,
            .material = record.ground_material};
  return {.kind = ContactSide::Kind::ground, .ground = record.ground, .material = record.ground_material};
}

// One entry for each pair, with the sum of what its touches gave.
void ContactEvents::take_touches() {
  std::vector<ContactRecord>& records = log_.records();
  std::erase_if(records, [&](const ContactRecord& r) {
    return !is_own(r.first) && (r.second == ContactRecord::kGround || !is_own(r.second));
  });  // the caller's own affair
  for (ContactRecord& record : records) {
    if (record.second == ContactRecord::kGround || record.first < record.second) continue;
    std::swap(record.first, record.second);
    record.normal = -record.normal;
  }
  if (!settings_.all_bodies)
    std::erase_if(records, [&](const ContactRecord& r) {
      return !asking_.contains(r.first) &&
             (r.second == ContactRecord::kGround || !asking_.contains(r.second));
    });
  order_.clear();
  for (std::uint32_t i = 0; i < records.size(); ++i) order_.emplace_back(key_of(records[i]), i);
  std::ranges::sort(order_);
  touches_.clear();
  double most = 0.0;  // N s, of a touch of the last pair
  for (const auto& [key, index] : order_) {
    const ContactRecord& record = records[index];
    if (touches_.empty() || touches_.back().key != key) {
      touches_.push_back({.key = key,
                          .last = {.first = body_side(record.first), .second = second_side(record)},
                          .touches = true});
      most = -1.0;
    }
    ContactEvent& event = touches_.back().last;
    event.impulse += record.impulse;
    event.speed = std::max(event.speed, record.approach);
    if (record.impulse > most)
      most = record.impulse, event.point = record.point, event.normal = record.normal;
  }
  records.clear();
}

void ContactEvents::tell(ContactPhase phase, const Pair& pair) {
  ContactEvent& event = events_.emplace_back(pair.last);
  event.phase = phase;
  if (phase == ContactPhase::end) event.impulse = event.speed = 0.0;
}

// A removed one does not, nor does a body of the caller's that he has destroyed.
bool ContactEvents::rests(const ContactSide& side) const {
  if (side.callers)
    return levels_.callers.bodies.contains(side.callers) && !callers::is_enabled(side.callers);
  return side.kind != ContactSide::Kind::body ||
         (levels_.bodies.valid(side.body) && levels_.asleep(side.body.index));
}

void ContactEvents::set_aside(const Pair& pair) {
  aside_[pair.key.first].push_back(pair);
  if (pair.key.kind == Key::Second::body) aside_[pair.key.second].push_back(pair);
}

void ContactEvents::take_from(std::uint32_t body, const Key& key) {
  const auto own = aside_.find(body);
  if (own == aside_.end()) return;
  std::erase_if(own->second, [&](const Pair& pair) { return pair.key == key; });
  if (own->second.empty()) aside_.erase(own);
}

// Its pairs are looked at again.
void ContactEvents::bring_back(std::uint32_t body) {
  const auto own = aside_.find(body);
  if (own == aside_.end()) return;
  const std::vector<Pair> pairs = std::move(own->second);
  aside_.erase(own);
  for (const Pair& pair : pairs) {
    live_.push_back(pair);
    if (pair.key.kind == Key::Second::body)
      take_from(pair.key.first == body ? pair.key.second : pair.key.first, pair.key);
  }
}

bool ContactEvents::bring_back(const Key& key, Pair& pair) {
  const auto own = aside_.find(key.first);
  if (own == aside_.end()) return false;
  const auto found = std::ranges::find(own->second, key, &Pair::key);
  if (found == own->second.end()) return false;
  pair = *found;
  if (key.kind == Key::Second::body) take_from(key.second, key);
  take_from(key.first, key);
  return true;
}

void ContactEvents::finish(double dt, std::span<const BodyId> woke) {
  if (!wanted() && live_.empty()) return aside_.clear();  // asked again, they begin anew
  for (const BodyId body : woke) bring_back(body.index);
  std::ranges::sort(live_, {}, &Pair::key);
  take_touches();
  kept_.clear();
  const auto keep = [&](Pair pair) {
    const bool there =
        levels_.bodies.valid(pair.last.first.body) &&
        (pair.last.second.kind != ContactSide::Kind::body || levels_.bodies.valid(pair.last.second.body));
    const bool rest = rests(pair.last.first) && rests(pair.last.second);
    pair.since_s = pair.touches || rest ? 0.0 : pair.since_s + dt;
    pair.touches = false;
    if (!there || pair.since_s >= kApart)
      tell(ContactPhase::end, pair);
    else if (rest && !pair.last.second.callers)  // of whose waking nobody tells
      set_aside(pair);
    else
      kept_.push_back(pair);
  };
  auto before = live_.begin();
  for (Pair& touch : touches_) {
    for (; before != live_.end() && before->key < touch.key; ++before) keep(*before);
    bool known = false;
    if (before != live_.end() && before->key == touch.key) {
      known = before->last.first.body == touch.last.first.body &&
              before->last.second.body == touch.last.second.body;
      if (!known) tell(ContactPhase::end, *before);  // another body has its index now
      ++before;
    } else {
      Pair aside;
      known = bring_back(touch.key, aside);
    }
    if (!known) tell(ContactPhase::begin, touch);
    if (touch.last.speed >= settings_.least_speed && touch.last.impulse >= settings_.least_impulse)
      tell(ContactPhase::hit, touch);
    keep(touch);
  }
  for (; before != live_.end(); ++before) keep(*before);
  std::swap(live_, kept_);
}

}  // namespace lodestone
