#include "lod/queries/body_grid.h"

#include <algorithm>

namespace lodestone {
namespace {

constexpr double kDrawn = 1.3;        // over the radius: of the ball in the cells
constexpr std::size_t kFewest = 256;  // cells

}  // namespace

// Cells as large as a ball is across: it meets eight at most.
int BodyGrid::level_of(double radius) {
  return std::clamp(std::ilogb(2.0 * kDrawn * radius) + 1 + kBaseLevel, 0, kLevels - 1);
}

BodyGrid::Range BodyGrid::range_of(const Eigen::AlignedBox3d& box, int level) {
  Range range;
  for (int a = 0; a < 3; ++a)
    range.low[std::size_t(a)] = along(box.min()[a] / edge_of(level)),
    range.high[std::size_t(a)] = along(box.max()[a] / edge_of(level));
  return range;
}

std::size_t BodyGrid::place_of(const Key& key) const {
  std::uint64_t hash = std::uint64_t(std::uint32_t(key.x)) * 0x9e3779b97f4a7c15u;
  hash = (hash ^ std::uint32_t(key.y)) * 0xff51afd7ed558ccdu;
  hash = (hash ^ std::uint32_t(key.z)) * 0xc4ceb9fe1a85ec53u;
  hash = (hash ^ std::uint64_t(key.level)) * 0x9e3779b97f4a7c15u;
  std::size_t at = std::size_t(hash >> 32) & (cells_.size() - 1);
  while (cells_[at].used && !(cells_[at].key == key)) at = (at + 1) & (cells_.size() - 1);
  return at;
}

const BodyGrid::Cell* BodyGrid::find(const Key& key) const {
  const Cell& cell = cells_[place_of(key)];
  return cell.used && cell.head != kNone ? &cell : nullptr;
}

// Empty cells are dropped on the way.
void BodyGrid::grow() {
  if (cells_.empty()) cells_.resize(kFewest);
  if (2 * used_ < cells_.size()) return;
  const auto filled =
      std::size_t(std::ranges::count_if(cells_, [](const Cell& cell) { return cell.head != kNone; }));
  bounds_.fill({});
  for (const Place& place : places_)
    if (place.radius > 0.0) note_bounds(place);
  std::vector<Cell> before(4 * filled < cells_.size() ? cells_.size() : 2 * cells_.size());
  std::swap(before, cells_);
  used_ = 0;
  for (const Cell& cell : before)
    if (cell.head != kNone) cells_[place_of(cell.key)] = cell, ++used_;
}

void BodyGrid::note_bounds(const Place& place) {
  const Vec3 reach = Vec3::Constant(kDrawn * place.radius);
  Eigen::AlignedBox3d& bounds = bounds_[std::size_t(level_of(place.radius))];
  bounds.extend(place.position - reach).extend(place.position + reach);
}

BodyGrid::Part BodyGrid::part_within(const Eigen::AlignedBox3d& bounds, const Vec3& from,
                                     const Vec3& direction, double length, double margin) {
  constexpr double kRounding = 1e-9;  // over how far from the origin all this is
  const double spare = margin + kRounding * (from.cwiseAbs().maxCoeff() + bounds.min().cwiseAbs().maxCoeff() +
                                             bounds.max().cwiseAbs().maxCoeff());
  Part part{0.0, length};
  for (int a = 0; a < 3; ++a) {
    const double low = bounds.min()[a] - spare - from[a], high = bounds.max()[a] + spare - from[a];
    if (direction[a] == 0.0) {
      if (low > 0.0 || high < 0.0) return {1.0, 0.0};
      continue;
    }
    const auto [first, last] = std::minmax({low / direction[a], high / direction[a]});
    part = {std::max(part.from, first), std::min(part.to, last)};
  }
  return part;
}

bool BodyGrid::comes_near(const Place& place, const Vec3& from, const Vec3& direction, double length,
                          double margin) {
  const Vec3 to = place.position - from;
  const double along_ray = std::clamp(to.dot(direction), 0.0, length),
               reach = kDrawn * place.radius + margin + 1e-9 * to.norm();
  return (to - along_ray * direction).squaredNorm() <= reach * reach;
}

template <class Visit>
void BodyGrid::each_cell(const Place& place, const Visit& visit) const {
  const int level = level_of(place.radius);
  const Vec3 reach = Vec3::Constant(kDrawn * place.radius);
  const Range range = range_of({place.position - reach, place.position + reach}, level);
  for (std::int32_t z = range.low[2]; z <= range.high[2]; ++z)
    for (std::int32_t y = range.low[1]; y <= range.high[1]; ++y)
      for (std::int32_t x = range.low[0]; x <= range.high[0]; ++x) visit(Key{x, y, z, level});
}

void BodyGrid::take_out(std::uint32_t body) {
  each_cell(places_[body], [&](const Key& key) {
    std::uint32_t* link = &cells_[place_of(key)].head;
    while (entries_[*link].body != body) link = &entries_[*link].next;
    const std::uint32_t gone = *link;
    *link = entries_[gone].next;
    entries_[gone].next = free_entry_;
    free_entry_ = gone;
  });
  --of_level_[std::size_t(level_of(places_[body].radius))];
  places_[body].radius = 0.0;
  --bodies_;
}

void BodyGrid::forget(std::uint32_t body) {
  if (body < places_.size() && places_[body].radius > 0.0) take_out(body);
}

void BodyGrid::put(std::uint32_t body, const Vec3& position, double radius) {
  if (places_.size() <= body) places_.resize(std::size_t(body) + 1 + places_.size() / 2);
  if (places_[body].radius == radius && (places_[body].position - position).norm() <= (kDrawn - 1.0) * radius)
    return;
  forget(body);
  places_[body] = {position, radius};
  note_bounds(places_[body]);
  each_cell(places_[body], [&](const Key& key) {
    grow();
    Cell& cell = cells_[place_of(key)];
    if (!cell.used) cell = {.key = key, .used = true}, ++used_;
    if (free_entry_ == kNone) {
      free_entry_ = std::uint32_t(entries_.size());
      entries_.emplace_back();
    }
    const std::uint32_t entry = free_entry_;
    free_entry_ = entries_[entry].next;
    entries_[entry] = {body, cell.head};
    cell.head = entry;
  });
  ++of_level_[std::size_t(level_of(radius))];
  ++bodies_;
}

}  // namespace lodestone
