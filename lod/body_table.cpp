#include "lod/body_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "reference/error.h"

namespace lodestone {

BodyId BodyTable::add(const BodyDefinition& definition, double mass) {
  std::uint32_t index = indices();
  if (free_.empty()) {
    records_.emplace_back();
    candidates_.emplace_back();
  } else {
    index = free_.back();
    free_.pop_back();
  }
  const std::uint32_t generation = std::max(1u, records_[index].generation + 1);  // zero is null, after 2³² bodies too
  records_[index] = {.definition = definition, .mass = mass, .generation = generation, .birth = ++births_};
  candidates_[index] = {.position = definition.state.position,
                        .radius = definition.shape->radius,
                        .importance = definition.importance,
                        .choice = definition.level,
                        .newcomer = true};
  return {index, generation};
}

void BodyTable::remove(BodyId id) {
  const std::uint32_t index = index_of(id);
  records_[index] = {.definition = {}, .generation = id.generation};
  candidates_[index] = {.choice = LevelChoice::statistical};  // asks for nothing
  free_.push_back(index);
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
