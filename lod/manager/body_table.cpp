#include "lod/manager/body_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "reference/error.h"

namespace lodestone {
namespace {

constexpr std::size_t kKept = 64;  // elements that a list keeps room for once it is cleared: a whole scene is added only once

template <class List>
void clear(List& list) {
  if (list.size() > kKept) list = List();
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
  const std::uint32_t generation = std::max(1u, records_[index].generation + 1);  // zero is null, after 2³² bodies too
  records_[index] = {.mass = mass,
                     .birth = ++births_,
                     .generation = generation,
                     .shape = share(definition.shape),
                     .material = definition.material,
                     .newcomer = std::int32_t(newcomers_.size())};
  levels_[index] = {.importance = definition.importance, .choice = definition.level, .newcomer = true};
  newcomers_.push_back({index, definition.state});
  ++counts_[std::size_t(definition.level)];
  greatest_importance_ = std::max(greatest_importance_, definition.importance);
  return {index, generation};
}

void BodyTable::remove(BodyId id) {
  const std::uint32_t index = index_of(id);
  if (levels_[index].newcomer) remove_newcomer(index);
  --counts_[std::size_t(levels_[index].choice)];
  give_back(records_[index].shape);
  forces_.erase(index);
  std::erase(pushed_, index);
  forget_rare(index);
  records_[index] = {.generation = id.generation};
  levels_[index] = {};
  free_.push_back(index);
}

void BodyTable::set_choice(std::uint32_t index, LevelChoice choice) {
  --counts_[std::size_t(levels_[index].choice)], ++counts_[std::size_t(choice)];
  levels_[index].choice = choice;
}

void BodyTable::forget_newcomers() { clear(newcomers_); }

void BodyTable::remove_newcomer(std::uint32_t index) {
  const auto place = std::size_t(records_[index].newcomer);
  for (std::size_t i = place + 1; i < newcomers_.size(); ++i)
    if (waits_at(i)) --records_[newcomers_[i].index].newcomer;
  newcomers_.erase(newcomers_.begin() + std::ptrdiff_t(place));
  records_[index].newcomer = -1;
}

void BodyTable::add_force(std::uint32_t index, const Force& force) {
  const auto [held, fresh] = forces_.try_emplace(index);
  if (fresh) pushed_.push_back(index);
  held->second.force += force.force;
  held->second.torque += force.torque;
}

BodyTable::Force BodyTable::force(std::uint32_t index) const {
  if (forces_.empty()) return {};
  const auto held = forces_.find(index);
  return held == forces_.end() ? Force{} : held->second;
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
  if (!valid(id)) check_that(false, "a body's id is valid:", fmt::format("index {}, generation {}", id.index, id.generation));
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
