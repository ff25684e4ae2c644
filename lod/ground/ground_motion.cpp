// How parts of the ground move in a step: with the velocity that their caller gave them, or with the one that
// is inferred for those that he puts elsewhere step by step.
#include <algorithm>
#include <utility>

#include "lod/ground/ground.h"

namespace lodestone {
namespace {

// rad: a vector along the axis.
Vec3 turn_between(const GroundPose& from, const GroundPose& to) {
  const Eigen::AngleAxisd turn(to.orientation * from.orientation.conjugate());
  return turn.angle() * turn.axis();
}

// The pose and velocity of a part that was put elsewhere in the last `since` s, as it seems to go, and its
// speed (m/s). The velocity is limited to that of the step before: what is put elsewhere once throws nobody.
std::pair<GroundPose, double> inferred_pose(const GroundPart& part, double since) {
  GroundPose pose =
      put_from(part.inferred->from, {part.pose.position, part.pose.orientation}, part.rim(), since);
  const double speed = pose.velocity.norm() + pose.angular_velocity.norm() * part.rim();
  const double share = speed > 0.0 ? std::min(1.0, part.inferred->last_speed / speed) : 0.0;
  pose.velocity *= share, pose.angular_velocity *= share;
  return {pose, speed};
}

}  // namespace

GroundPose pose_after(const GroundPose& pose, double after) {
  if (pose.goes_on_s == 0.0 || after == 0.0) return pose;
  GroundPose later = pose;
  later.position += pose.velocity * after;
  later.orientation = (rotation_from_vector(pose.angular_velocity * after) * pose.orientation).normalized();
  return later;
}

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

void Ground::move_part(GroundId id, const GroundPose& pose) {
  const auto index = std::size_t(entries_[id.index].part);
  if (pose.comes_back) note_repositioned(*parts_[index], pose);
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

void Ground::note_repositioned(GroundPart& part, const GroundPose& pose) {
  if (!pose.velocity.isZero(0.0) || !pose.angular_velocity.isZero(0.0)) return;
  if (part.inferred) {
    part.inferred->moved = true;
  } else {
    part.inferred = {part.pose};
    inferred_.push_back(part.id);
  }
}

void Ground::begin_step(double dt, double since,
                        const std::function<void(const Eigen::AlignedBox3d&)>& stands_again) {
  keep_step();
  if (since > 0.0) {
    began_ = true;
    std::swap(going_, moved_);
    moved_.clear();
    note_inferred();
    if (!inferred_.empty()) go_as_inferred(dt, since, stands_again);
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

void Ground::note_inferred() {
  for (const GroundId id : inferred_)
    if (valid(id)) inferred_before_.push_back({id, *part(id).inferred, part(id).pose});
}

void Ground::undo_step() {
  for (const Noted& noted : inferred_before_) {
    if (!valid(noted.id)) continue;
    const auto index = std::size_t(entries_[noted.id.index].part);
    if (!std::exchange(parts_[index]->inferred, noted.inferred)) inferred_.push_back(noted.id);
    stand(index, noted.pose);
  }
  if (began_) moved_.insert(moved_.begin(), going_.begin(), going_.end());
  keep_step();
}

void Ground::go_as_inferred(double dt, double since,
                            const std::function<void(const Eigen::AlignedBox3d&)>& stands_again) {
  std::erase_if(inferred_, [&](GroundId id) {
    if (!valid(id)) return true;
    const auto index = std::size_t(entries_[id.index].part);
    GroundPart& held = *parts_[index];
    const bool has_own_velocity = held.pose.comes_back && held.moves();
    if (!has_own_velocity && held.inferred->moved) {
      const auto [pose, speed] = inferred_pose(held, since);
      stand(index, held.shape.probe ? pose : coming_to(pose, since, dt));
      held.inferred = {.from = pose, .moved = false, .last_speed = speed};
      return false;
    }
    if (!has_own_velocity && held.moves()) {
      stands_again(bounds(id));
      stand(index, {held.inferred->from.position, held.inferred->from.orientation});
    }
    held.inferred.reset();
    return true;
  });
}

// From a snapshot. The reader's own parts whose motion was inferred first stand where they were put last.
void Ground::take_inferred(std::vector<Noted> inferred) {
  for (const GroundId id : inferred_) {
    if (!valid(id)) continue;
    const auto index = std::size_t(entries_[id.index].part);
    const std::optional<InferredMotion> own = std::exchange(parts_[index]->inferred, std::nullopt);
    if (!parts_[index]->pose.comes_back && parts_[index]->moves())
      stand(index, {own->from.position, own->from.orientation});
  }
  std::erase_if(inferred, [&](const Noted& noted) { return !valid(noted.id) || is_plane(noted.id); });
  inferred_.clear();
  for (const Noted& noted : inferred) {
    const auto index = std::size_t(entries_[noted.id.index].part);
    inferred_.push_back(noted.id), parts_[index]->inferred = noted.inferred;
    stand(index, noted.pose);
  }
}

}  // namespace lodestone
