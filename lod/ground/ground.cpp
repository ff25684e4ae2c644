#include "lod/ground/ground.h"

#include <algorithm>
#include <utility>

namespace lodestone {
namespace {

using Box = Eigen::AlignedBox3d;

Box placed(const Box& box, const GroundPose& pose) {
  const Vec3 reach = pose.orientation.toRotationMatrix().cwiseAbs() * (0.5 * box.sizes()),
             center = pose.position + pose.orientation * box.center();
  return {center - reach, center + reach};
}

}  // namespace

GroundId Ground::new_id(Entry entry) {
  if (free_entries_.empty()) {
    free_entries_.push_back(std::uint32_t(entries_.size()));
    entries_.emplace_back();
  }
  const std::uint32_t index = free_entries_.back();
  free_entries_.pop_back();
  entry.generation = entries_[index].generation + 1;
  entries_[index] = entry;
  return {index, entry.generation};
}

bool Ground::valid(GroundId id) const {
  return id.index < entries_.size() && entries_[id.index].generation == id.generation &&
         (entries_[id.index].plane >= 0 || entries_[id.index].part >= 0);
}

GroundId Ground::add_plane(const HalfSpace& plane) {
  const GroundId id = new_id({.plane = std::int32_t(planes_.size())});
  planes_.push_back(plane);
  planes_.back().id = id;
  plane_ids_.push_back(id);
  return id;
}

GroundId Ground::add_part(const GroundShape& shape, const GroundPose& pose, MaterialId material, bool eager) {
  auto part = std::make_unique<GroundPart>(GroundPart{{}, shape, pose, {}, material, {}, 0});
  if (free_parts_.empty()) {
    free_parts_.push_back(std::int32_t(parts_.size()));
    parts_.emplace_back();
    bounds_.emplace_back();
    in_tree_.push_back(false);
  }
  const std::int32_t index = free_parts_.back();
  free_parts_.pop_back();
  moving_ += part->moves();
  unmade_ += bool(shape.make), probed_ += bool(shape.probe);
  parts_[std::size_t(index)] = std::move(part);
  ++parts_used_;
  hold(index);
  if (eager && shape.make) solids_of(index);
  return parts_[std::size_t(index)]->id = new_id({.part = index});
}

GroundId Ground::add_mesh(const Mesh& mesh, MaterialId material) {
  auto solids = std::make_shared<GroundSolids>();
  solids->add_mesh(mesh);
  solids->prepare();
  return add_part({.bounds = solids->bounds(), .make = [solids] { return *solids; }}, {}, material, true);
}

GroundId Ground::add_box(const Vec3& sides, const Vec3& position, const Quat& orientation,
                         MaterialId material) {
  const auto make = [sides] {
    GroundSolids solids;
    solids.add_hull(make_box(sides).vertices);
    return solids;
  };
  return add_part({.bounds = Box(-0.5 * sides, 0.5 * sides), .make = make},
                  {position, orientation.normalized()}, material, true);
}

void Ground::remove(GroundId id) {
  Entry& entry = entries_[id.index];
  if (entry.plane >= 0) {
    planes_.erase(planes_.begin() + entry.plane);
    plane_ids_.erase(plane_ids_.begin() + entry.plane);
    for (std::size_t i = std::size_t(entry.plane); i < plane_ids_.size(); ++i)
      entries_[plane_ids_[i].index].plane = std::int32_t(i);
  } else {
    const std::int32_t index = entry.part;
    let_go(index);
    const GroundPart& part = *parts_[std::size_t(index)];
    moving_ -= part.moves();
    unmade_ -= part.shape.make && !part.solids, probed_ -= bool(part.shape.probe);
    parts_[std::size_t(index)].reset();
    free_parts_.push_back(index);
    --parts_used_;
  }
  entry.plane = entry.part = -1;
  free_entries_.push_back(id.index);
}

void Ground::move_plane(GroundId id, const HalfSpace& plane) {
  HalfSpace& moved = planes_[std::size_t(entries_[id.index].plane)];
  moved = plane;
  moved.id = id;
}

Box Ground::bounds(GroundId id) const { return bounds_[std::size_t(entries_[id.index].part)]; }

void Ground::hold(std::int32_t part) {
  take_bounds(part);
  loose_.push_back(part);
}

void Ground::take_bounds(std::int32_t part) {
  const GroundPart& held = *parts_[std::size_t(part)];
  const Box box = placed(held.shape.bounds, held.pose);
  const Vec3 way = Vec3::Constant(held.greatest_speed() * held.pose.goes_on_s);
  bounds_[std::size_t(part)] = {box.min() - way, box.max() + way};
}

// From the tree it goes when that is next built: until then it is passed over there.
void Ground::let_go(std::int32_t part) {
  if (in_tree_[std::size_t(part)])
    in_tree_[std::size_t(part)] = false;
  else
    std::erase(loose_, part);
}

// Where it is now. One that is loose already stays so.
void Ground::hold_anew(std::int32_t part) {
  take_bounds(part);
  if (std::exchange(in_tree_[std::size_t(part)], false)) loose_.push_back(part);
}

void Ground::prepare_tree() const {
  constexpr std::size_t kFewLoose = 16;
  if (loose_.size() <= kFewLoose + standing_.size() / 8) return;
  standing_.clear();
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    in_tree_[i] = bool(parts_[i]);
    if (!parts_[i]) continue;
    standing_.push_back(std::int32_t(i));
    boxes.push_back(bounds_[i]);
  }
  loose_.clear();
  tree_ = BoxHierarchy(boxes);
}

// In boxes that `meets`, those that stand in the tree and those that are loose.
template <class Meets>
void Ground::find_parts_in(const Meets& meets, std::vector<const GroundPart*>& found) const {
  if (parts_used_ == 0) return;
  if (!made_only_) prepare_tree();
  thread_local std::vector<int> near;
  near.clear();
  const auto add = [&](int i) {
    if (meets(bounds_[std::size_t(i)])) near.push_back(i);
  };
  tree_.visit_places(meets, [&](std::int32_t place) {
    const std::int32_t i = standing_[std::size_t(tree_.number_at(place))];
    if (in_tree_[std::size_t(i)]) add(i);
  });
  for (const std::int32_t i : loose_) add(i);
  std::ranges::sort(near);
  for (const int i : near) {
    const GroundPart& part = *parts_[std::size_t(i)];
    if (part.shape.make && !part.solids) {
      if (made_only_) continue;
      solids_of(i);
    }
    if (part.shape.probe && without_rays_) continue;
    found.push_back(&part);
  }
}

void Ground::find_parts(const Vec3& center, double reach, std::vector<const GroundPart*>& found) const {
  find_parts_in([&](const Box& box) { return box.squaredExteriorDistance(center) <= reach * reach; }, found);
}

void Ground::find_parts_along(const Vec3& from, const Vec3& direction, double length, double margin,
                              std::vector<const GroundPart*>& found) const {
  find_parts_in([&](const Box& box) { return enters_box(box, margin, from, direction, length); }, found);
}

bool Ground::make_near(const Vec3& center, double reach) const {
  if (unmade_ == 0 && probed_ == 0) return false;
  thread_local std::vector<const GroundPart*> parts;
  parts.clear();
  find_parts(center, reach, parts);
  return std::ranges::any_of(parts, [](const GroundPart* part) { return bool(part->shape.probe); });
}

void Ground::archive(StateArchive& a) {
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> first;
  for (const auto& part : parts_) first.push_back(part && part->solids ? part->first_number : kNone);
  std::uint32_t numbers = numbers_;
  std::vector<Noted> inferred;
  for (const GroundId id : inferred_)
    if (valid(id)) inferred.push_back({id, *part(id).inferred, part(id).pose});
  a(first, numbers, inferred, moved_);
  if (!a.reading()) return;
  std::erase_if(moved_, [&](GroundId id) { return !valid(id) || is_plane(id); });
  take_inferred(std::move(inferred));
  for (std::size_t i = 0; i < std::min(first.size(), parts_.size()); ++i) {
    if (!parts_[i]) continue;
    if (first[i] == kNone) {
      unmade_ += parts_[i]->shape.make && parts_[i]->solids;
      parts_[i]->solids.reset();  // to be numbered when they are next made
    } else if (parts_[i]->shape.make) {
      solids_of(std::int32_t(i));
      parts_[i]->first_number = first[i];
    }
  }
  numbers_ = numbers;
}

const GroundSolids& Ground::solids_of(std::int32_t index) const {
  GroundPart& part = *parts_[std::size_t(index)];
  if (!part.solids) {
    part.solids = part.shape.make();
    part.solids->prepare();
    --unmade_;
    part.first_number = numbers_;
    numbers_ += std::uint32_t(part.solids->size());
  }
  return *part.solids;
}

std::optional<HalfSpace> probe_below(const GroundPart& part, const Vec3& center, double reach) {
  if (!part.shape.probe) return {};
  const Vec3 up = part.pose.orientation * part.shape.up;
  const auto hit = part.shape.probe(center + reach * up, -up, 3.0 * reach);
  return hit ? std::optional(HalfSpace{hit->normal, hit->normal.dot(hit->point), part.material, part.id})
             : std::nullopt;
}

void find_solids(const GroundPart& part, const Vec3& center, double reach, double after,
                 std::vector<PlacedSolid>& found) {
  if (!part.solids) return;
  thread_local std::vector<int> near;
  const GroundPose pose = pose_after(part.pose, after);
  near.clear();
  part.solids->find_near(pose.orientation.conjugate() * (center - pose.position), reach, near);
  std::ranges::sort(near);
  for (const int i : near) {
    const GroundSolid& solid = (*part.solids)[i];
    found.push_back({&solid, &part, pose.position + pose.orientation * solid.center, pose.orientation,
                     part.first_number + std::uint32_t(i)});
  }
}

}  // namespace lodestone
