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

// Where a part is `after` seconds into the step.
GroundPose pose_after(const GroundPose& pose, double after) {
  if (pose.goes_on_s == 0.0 || after == 0.0) return pose;
  GroundPose later = pose;
  later.position += pose.velocity * after;
  later.orientation = (rotation_from_vector(pose.angular_velocity * after) * pose.orientation).normalized();
  return later;
}

// rad: a vector along the axis.
Vec3 turn_between(const GroundPose& from, const GroundPose& to) {
  const Eigen::AngleAxisd turn(to.orientation * from.orientation.conjugate());
  return turn.angle() * turn.axis();
}

// One that was put on in the last `since` s, as it seems to go, and its speed, m/s. No faster than it went in
// the step before: what is put elsewhere once throws nobody.
std::pair<GroundPose, double> pose_put_on(const GroundPart& part, double since) {
  GroundPose pose =
      put_from(part.put_on->from, {part.pose.position, part.pose.orientation}, part.rim(), since);
  const double speed = pose.velocity.norm() + pose.angular_velocity.norm() * part.rim();
  const double share = speed > 0.0 ? std::min(1.0, part.put_on->last_speed / speed) : 0.0;
  pose.velocity *= share, pose.angular_velocity *= share;
  return {pose, speed};
}

}  // namespace

GroundPose put_from(const GroundPose& from, const GroundPose& to, double rim, double dt) {
  constexpr double kLeap = 50.0;    // m/s
  constexpr double kFarTurn = 0.5;  // rad
  const Vec3 velocity = (to.position - from.position) / dt, turn = turn_between(from, to);
  GroundPose going = to;
  if (velocity.norm() > kLeap || (turn.norm() > kFarTurn && turn.norm() * rim > kLeap * dt)) return going;
  going.velocity = velocity;
  going.angular_velocity = turn / dt;
  return going;
}

GroundPose coming_to(const GroundPose& put, double dt) {
  if (put.velocity.isZero(0.0) && put.angular_velocity.isZero(0.0)) return put;
  GroundPose coming = put;
  coming.position -= dt * put.velocity;
  coming.orientation = rotation_from_vector(-dt * put.angular_velocity) * put.orientation;
  coming.goes_on_s = dt;
  return coming;
}

GroundPose coming_to(const GroundPose& put, double dt, double part) {
  GroundPose coming = coming_to(put, dt);
  if (coming.goes_on_s > 0.0) coming.goes_on_s = part;
  return coming;
}

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

void Ground::move_part(GroundId id, const GroundPose& pose) {
  const auto index = std::size_t(entries_[id.index].part);
  if (pose.comes_back) note_put(*parts_[index], pose);
  stand(index, pose);
  if (pose.comes_back && parts_[index]->moves()) moved_.push_back(id);
}

void Ground::stand(std::size_t index, const GroundPose& pose) {
  GroundPart& part = *parts_[index];
  moving_ -= part.moves();
  const bool stays = part.pose.position == pose.position &&
                     part.pose.orientation.coeffs() == pose.orientation.coeffs() &&
                     part.pose.goes_on_s == 0.0 && pose.goes_on_s == 0.0;
  part.pose = pose;
  moving_ += part.moves();
  if (!stays) hold_anew(std::int32_t(index));
}

void Ground::note_put(GroundPart& part, const GroundPose& pose) {
  if (!pose.velocity.isZero(0.0) || !pose.angular_velocity.isZero(0.0)) return;
  if (part.put_on) {
    part.put_on->moved = true;
  } else {
    part.put_on = {part.pose};
    put_on_.push_back(part.id);
  }
}

void Ground::begin_step(double dt, double since, const std::function<void(const Box&)>& stands_again) {
  keep_step();
  if (since > 0.0) {
    began_ = true;
    std::swap(going_, moved_);
    moved_.clear();
    note_put_on();
    if (!put_on_.empty()) go_as_put(dt, since, stands_again);
  }
  if (moving_ == 0) return;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (!parts_[i] || !parts_[i]->pose.comes_back || !parts_[i]->moves()) continue;
    if (parts_[i]->pose.goes_on_s == dt) continue;
    parts_[i]->pose.goes_on_s = dt;
    hold_anew(std::int32_t(i));
  }
}

void Ground::go_on() {
  const auto move = [&](std::size_t index) {
    const GroundPose& pose = parts_[index]->pose;
    stand(index, pose_after(pose, pose.goes_on_s));
  };
  std::ranges::sort(going_, {}, &GroundId::index);
  const auto are_one = [](GroundId a, GroundId b) { return a.index == b.index; };
  going_.erase(std::unique(going_.begin(), going_.end(), are_one), going_.end());
  const bool first = was_put_.empty();
  for (const GroundId id : going_) {
    if (!valid(id) || !part(id).pose.comes_back || !part(id).moves()) continue;
    const auto index = std::size_t(entries_[id.index].part);
    if (first) was_put_.emplace_back(id, parts_[index]->pose);
    move(index);
  }
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (parts_[i] && !parts_[i]->pose.comes_back && parts_[i]->pose.goes_on_s > 0.0) move(i);
}

void Ground::come_back() {
  for (const auto& [id, pose] : was_put_)
    if (valid(id)) stand(std::size_t(entries_[id.index].part), pose);
  was_put_.clear();
}

void Ground::note_put_on() {
  for (const GroundId id : put_on_)
    if (valid(id)) put_on_before_.push_back({id, *part(id).put_on, part(id).pose});
}

void Ground::undo_step() {
  for (const Noted& noted : put_on_before_) {
    if (!valid(noted.id)) continue;
    const auto index = std::size_t(entries_[noted.id.index].part);
    if (!std::exchange(parts_[index]->put_on, noted.put_on)) put_on_.push_back(noted.id);
    stand(index, noted.pose);
  }
  if (began_) moved_.insert(moved_.begin(), going_.begin(), going_.end());
  keep_step();
}

void Ground::go_as_put(double dt, double since, const std::function<void(const Box&)>& stands_again) {
  std::erase_if(put_on_, [&](GroundId id) {
    if (!valid(id)) return true;
    const auto index = std::size_t(entries_[id.index].part);
    GroundPart& held = *parts_[index];
    const bool has_own_velocity = held.pose.comes_back && held.moves();
    if (!has_own_velocity && held.put_on->moved) {
      const auto [pose, speed] = pose_put_on(held, since);
      stand(index, held.shape.probe ? pose : coming_to(pose, since, dt));
      held.put_on = {.from = pose, .moved = false, .last_speed = speed};
      return false;
    }
    if (!has_own_velocity && held.moves()) {
      stands_again(bounds(id));
      stand(index, {held.put_on->from.position, held.put_on->from.orientation});
    }
    held.put_on.reset();
    return true;
  });
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
  if (bounds_of_parts_) bounds_of_parts_->extend(bounds_[std::size_t(part)]);
}

void Ground::forget_bounds(std::int32_t part) {
  const Box& box = bounds_[std::size_t(part)];
  if (bounds_of_parts_ && ((box.min().array() <= bounds_of_parts_->min().array()).any() ||
                           (box.max().array() >= bounds_of_parts_->max().array()).any()))
    bounds_of_parts_.reset();
}

// From the tree it goes when that is next built: until then it is passed over there.
void Ground::let_go(std::int32_t part) {
  forget_bounds(part);
  if (in_tree_[std::size_t(part)])
    in_tree_[std::size_t(part)] = false;
  else
    std::erase(loose_, part);
}

// Where it is now. One that is loose already stays so.
void Ground::hold_anew(std::int32_t part) {
  forget_bounds(part);
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

Eigen::AlignedBox3d Ground::bounds_of_parts() const {
  if (bounds_of_parts_) return *bounds_of_parts_;
  Box all;
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (parts_[i]) all.extend(bounds_[i]);
  bounds_of_parts_ = all;
  return all;
}

void Ground::find_parts(const Vec3& center, double reach, std::vector<const GroundPart*>& found) const {
  if (parts_used_ == 0) return;
  if (!made_only_) prepare_tree();
  thread_local std::vector<int> near;
  near.clear();
  const auto add = [&](int i) {
    if (bounds_[std::size_t(i)].squaredExteriorDistance(center) <= reach * reach) near.push_back(i);
  };
  tree_.visit_near(center, reach, [&](std::int32_t place) {
    const std::int32_t i = standing_[std::size_t(place)];
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
  struct Put {
    GroundId id;
    PutOn on;
    GroundPose pose;  // as it goes, of which its caller knows nothing
  };
  std::vector<Put> put;
  for (const GroundId id : put_on_)
    if (valid(id)) put.push_back({id, *part(id).put_on, part(id).pose});
  a(first, numbers, put, moved_);
  if (!a.reading()) return;
  std::erase_if(moved_, [&](GroundId id) { return !valid(id) || is_plane(id); });
  for (const GroundId id : put_on_) {  // the reader's own: each stands where it was put last
    if (!valid(id)) continue;
    const auto index = std::size_t(entries_[id.index].part);
    const std::optional<PutOn> on = std::exchange(parts_[index]->put_on, std::nullopt);
    if (!parts_[index]->pose.comes_back && parts_[index]->moves())
      stand(index, {on->from.position, on->from.orientation});
  }
  std::erase_if(put, [&](const Put& p) { return !valid(p.id) || is_plane(p.id); });
  put_on_.clear();
  for (const Put& p : put) {
    const auto index = std::size_t(entries_[p.id.index].part);
    put_on_.push_back(p.id), parts_[index]->put_on = p.on;
    stand(index, p.pose);
  }
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
