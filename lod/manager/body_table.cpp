#include "lod/manager/body_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "reference/error.h"

namespace lodestone {
namespace {

// Elements that a list keeps room for once it is cleared: a whole scene is added only once.
constexpr std::size_t kRoomKept = 64;

template <class List>
void clear(List& list) {
  if (list.size() > kRoomKept) list = List();
  list.clear();
}

}  // namespace

BodyId BodyTable::add(const BodyDefinition& definition, double mass) {
  std::uint32_t index = indices();
  if (free_.empty()) {
    records_.emplace_back();
    levels_.emplace_back();
  } else {
    index = free_.back();
    free_.pop_back();
  }
  const std::uint32_t generation =
      std::max(1u, records_[index].generation + 1);  // zero is null, after 2³² bodies too
  records_[index] = {.mass = mass,
                     .birth = ++births_,
                     .generation = generation,
                     .shape = share(definition.shape),
                     .material = definition.material,
                     .newcomer = std::int32_t(newcomers_.size()),
                     .user_data = definition.user_data};
  levels_[index] = {.importance = definition.importance,
                    .choice = definition.level,
                    .least = definition.least_rung,
                    .greatest = definition.greatest_rung,
                    .newcomer = true};
  set_properties(index, definition.properties);
  newcomers_.push_back({.index = index, .state = definition.state});
  ++counts_[std::size_t(definition.level)];
  greatest_importance_ = std::max(greatest_importance_, definition.importance);
  return {index, generation};
}

void BodyTable::remove(BodyId id) {
  const std::uint32_t index = index_of(id);
  if (levels_[index].newcomer) remove_newcomer(index);
  --counts_[std::size_t(levels_[index].choice)];
  give_back(records_[index].shape);
  drop_force(index);
  properties_.forget(index);
  records_[index] = {.generation = id.generation};
  levels_[index] = {};
  removed_.push_back(index);
}

void BodyTable::reuse_indices() {
  free_.insert(free_.end(), removed_.begin(), removed_.end());
  clear(removed_);
}

void BodyTable::archive(StateArchive& a) {
  std::vector<std::uint32_t> pushed = this->pushed();
  a(records_, levels_, free_, removed_, shapes_, free_shapes_, newcomers_, forces_, pushed, properties_,
    births_, counts_, greatest_importance_);
  if (!a.reading()) return;
  pushed_ = std::move(pushed);
  for (std::size_t i = 0; i < pushed_.size(); ++i) forces_[pushed_[i]].place = i;
  newcomers_gone_ = 0;
  for (std::size_t i = 0; i < newcomers_.size(); ++i) newcomers_gone_ += !waits_at(i);
  number_of_shape_.clear();
  for (std::size_t i = 0; i < shapes_.size(); ++i)
    if (shapes_[i].shape) number_of_shape_[shapes_[i].shape.get()] = std::uint32_t(i);
}

void BodyTable::set_choice(std::uint32_t index, LevelChoice choice) {
  --counts_[std::size_t(levels_[index].choice)], ++counts_[std::size_t(choice)];
  levels_[index].choice = choice;
}

void BodyTable::forget_newcomers() {
  std::vector<Newcomer> waiting;
  for (std::size_t i = 0; i < newcomers_.size(); ++i)
    if (waits_at(i)) waiting.push_back(newcomers_[i]);
  clear(newcomers_);
  for (const Newcomer& newcomer : waiting) {
    records_[newcomer.index].newcomer = std::int32_t(newcomers_.size());
    newcomers_.push_back(newcomer);
  }
  newcomers_gone_ = 0;
}

// Its place stays, as that of one that was placed since, until there are more such places than others.
void BodyTable::remove_newcomer(std::uint32_t index) {
  records_[index].newcomer = -1;
  if (++newcomers_gone_ < kRoomKept || 2 * newcomers_gone_ < newcomers_.size()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < newcomers_.size(); ++i) {
    if (!waits_at(i)) continue;
    newcomers_[kept] = newcomers_[i];
    records_[newcomers_[kept].index].newcomer = std::int32_t(kept);
    ++kept;
  }
  newcomers_.resize(kept);
  newcomers_gone_ = 0;
}

void BodyTable::add_force(std::uint32_t index, const Force& force) {
  const Force before = this->force(index), sum{before.force + force.force, before.torque + force.torque};
  if (!sum.force.allFinite() || !sum.torque.allFinite())
    throw_input_error("force", "a sum with those given before that is not finite", "a finite one");
  const auto [held, fresh] = forces_.try_emplace(index);
  if (fresh) {
    held->second.place = pushed_.size();
    pushed_.push_back(index);
  }
  held->second.sum = sum;
}

// Its place stays, until there are more such places than others.
void BodyTable::drop_force(std::uint32_t index) {
  const auto held = forces_.find(index);
  if (held == forces_.end()) return;
  pushed_[held->second.place] = kDropped;
  forces_.erase(held);
  if (pushed_.size() < kRoomKept || 2 * forces_.size() > pushed_.size()) return;
  pushed_ = pushed();
  for (std::size_t i = 0; i < pushed_.size(); ++i) forces_[pushed_[i]].place = i;
}

std::vector<std::uint32_t> BodyTable::pushed() const {
  std::vector<std::uint32_t> bodies = pushed_;
  std::erase(bodies, kDropped);
  return bodies;
}

BodyTable::Forces BodyTable::forces() const {
  Forces all;
  for (const std::uint32_t body : pushed()) all.held.emplace_back(body, force(body));
  return all;
}

void BodyTable::hold(const Forces& forces) {
  for (const auto& [body, force] : forces.held) add_force(body, force);
}

void BodyTable::set_importance(std::uint32_t index, double importance) {
  levels_[index].importance = importance;
  greatest_importance_ = std::max(greatest_importance_, importance);
}

void BodyTable::set_properties(std::uint32_t index, const BodyProperties& properties) {
  properties_.set(index, properties);
  levels_[index].own_properties = properties_.has(index);
}

BodyTable::Force BodyTable::force(std::uint32_t index) const {
  if (forces_.empty()) return {};
  const auto held = forces_.find(index);
  return held == forces_.end() ? Force{} : held->second.sum;
}

void BodyTable::clear_forces() {
  clear(forces_);
  clear(pushed_);
}

std::uint32_t BodyTable::share(const std::shared_ptr<const Shape>& shape) {
  const auto [known, fresh] = number_of_shape_.try_emplace(shape.get(), std::uint32_t(shapes_.size()));
  if (fresh) {
    if (free_shapes_.empty()) {
      shapes_.emplace_back();
    } else {
      known->second = free_shapes_.back();
      free_shapes_.pop_back();
    }
    shapes_[known->second] = {shape, 0};
  }
  ++shapes_[known->second].bodies;
  return known->second;
}

void BodyTable::give_back(std::uint32_t shape) {
  if (--shapes_[shape].bodies > 0) return;
  number_of_shape_.erase(shapes_[shape].shape.get());
  shapes_[shape] = {};
  free_shapes_.push_back(shape);
}

std::uint32_t BodyTable::index_of(BodyId id) const {
  if (!valid(id))
    throw_input_error("body", fmt::format("the id {{{}, {}}}", id.index, id.generation),
                      "that of a body of this manager which was not removed");
  return id.index;
}

std::vector<std::uint32_t> BodyTable::in_order_of_creation() const {
  std::vector<std::uint32_t> order;
  order.reserve(size());
  for (std::uint32_t i = 0; i < indices(); ++i)
    if (alive(i)) order.push_back(i);
  std::ranges::sort(order, {}, [this](std::uint32_t i) { return records_[i].birth; });
  return order;
}

}  // namespace lodestone
