#include "lod/tables/driven_spheres.h"

#include <algorithm>

#include "lod/contact/free_way.h"

namespace lodestone {
namespace {

constexpr double kDrivenFar = 0.25;  // over R: whoever is driven less far passes no other

}  // namespace

void DrivenSpheres::begin_blocks(std::size_t blocks) {
  blocks_ = blocks;
  driven_.resize(std::max(driven_.size(), blocks));
}

void DrivenSpheres::note(std::size_t block, std::int64_t begin, std::int64_t end) {
  std::vector<Driven>& driven = driven_[block];
  driven.clear();
  for (std::int64_t i = begin; i < end; ++i) {
    if (!step_.touches(i)) continue;
    const Vec3 velocity = spheres_.velocity(i), driven_at = step_.velocity(i);
    const double before = velocity.norm(), more = driven_at.norm() - before,
                 far = kDrivenFar * double(kinds_.radius[spheres_.kind[std::size_t(i)]]);
    if ((more > 0.0 && ground_.has_parts()) || more * constants_.wide_time > far ||
        is_driven(i, velocity, driven_at))
      driven.push_back({i, spheres_.position(i), velocity});
  }
}

// As seen by others: made faster in the frame of the drift, or driven off a long way.
bool DrivenSpheres::is_driven(std::int64_t place, const Vec3& before, const Vec3& velocity) const {
  const Vec3& drift = constants_.drift;
  const bool off = scene_.is_bound_to(scene_.way(place, spheres_.position(place), before));
  const double more = off ? (velocity - before).norm() : (velocity - drift).norm() - (before - drift).norm();
  return more * constants_.wide_time > kDrivenFar * double(kinds_.radius[spheres_.kind[std::size_t(place)]]);
}

// m: of what it has to others.
double DrivenSpheres::farthest_reach(std::int64_t place) const {
  return double(constants_.hulls ? kinds_.farthest_reach[spheres_.kind[std::size_t(place)]]
                                 : spheres_.radius[std::size_t(place)]);
}

// Whether it has gone so far from where it would be, `reach` m about which all were looked for that it might
// touch.
bool DrivenSpheres::is_beyond(const Driven& driven, const Vec3& would_be, double reach) const {
  const double off = (spheres_.position(driven.place) - would_be).norm();
  return off > kDrivenFar * double(kinds_.radius[spheres_.kind[std::size_t(driven.place)]]) &&
         off + farthest_reach(driven.place) > reach;
}

// For others in the frame of the drift; for sleepers, whom those that wake within a step were not asked for,
// in that of the ground.
bool DrivenSpheres::leaves_its_reach(const Driven& driven) const {
  const double time = constants_.wide_time, reach = double(step_.reach[std::size_t(driven.place)]);
  return is_beyond(driven, driven.from + time * constants_.drift, reach) ||
         is_beyond(driven, driven.from, way_of(driven).radius + time * driven.velocity.norm());
}

// On which it passes others.
bool DrivenSpheres::leaves_its_way(const Driven& driven) const {
  const BallWay way = way_of(driven);
  return scene_.is_bound_to(way) &&
         is_beyond(driven, driven.from + constants_.wide_time * driven.velocity, way.radius);
}

void DrivenSpheres::stop_before_unseen() {
  constexpr std::ptrdiff_t kFew = 32;  // for whom it is not worth while to sort all
  const auto of_step = std::span(driven_).first(blocks_);
  const auto count_leaving = [&](std::span<const Driven> all) {
    return std::ranges::count_if(
        all, [&](const Driven& driven) { return leaves_its_reach(driven) || leaves_its_way(driven); });
  };
  std::ptrdiff_t leaving = count_leaving(guests_);
  for (const std::vector<Driven>& of_block : of_step) leaving += count_leaving(of_block);
  by_x_.clear();
  if (leaving > kFew) sort_by_x();
  for (const std::vector<Driven>& of_block : of_step)
    for (const Driven& driven : of_block) stop_before_unseen(driven);
  for (const Driven& driven : guests_) stop_before_unseen(driven);
  guests_.clear();
}

void DrivenSpheres::stop_before_unseen(const Driven& driven) {
  const Vec3 way = spheres_.position(driven.place) - driven.from;
  double free = find_way_to_ground(driven, way);
  const bool to_all = leaves_its_reach(driven);
  if (to_all || leaves_its_way(driven)) free = std::min(free, find_way_to_others(driven, way, to_all));
  if (free < 1.0) spheres_.set_position(driven.place, driven.from + free * way);
}

void DrivenSpheres::sort_by_x() {
  for (std::int64_t i = 0; i < spheres_.awake; ++i) by_x_.emplace_back(spheres_.x[std::size_t(i)], i);
  std::ranges::sort(by_x_);
}

// And others. (The cells are gone by then.)
void DrivenSpheres::find_awake_near(const Vec3& center, double reach,
                                    std::vector<std::int64_t>& found) const {
  const double least = center.x() - reach - kinds_.most_reach, most = center.x() + reach + kinds_.most_reach;
  if (by_x_.empty()) {
    for (std::int64_t i = 0; i < spheres_.awake; ++i)
      if (const double x = spheres_.x[std::size_t(i)]; x >= least && x <= most) found.push_back(i);
    return;
  }
  const auto x_of = [](const auto& other) { return other.first; };
  for (auto other = std::ranges::lower_bound(by_x_, least, {}, x_of);
       other != by_x_.end() && other->first <= most; ++other)
    found.push_back(other->second);
}

// The part of the way, 0 to 1.
double DrivenSpheres::find_way_to_ground(const Driven& driven, const Vec3& way) const {
  const double radius = double(kinds_.radius[spheres_.kind[std::size_t(driven.place)]]);
  if (!ground_.has_parts() ||
      way.norm() + radius <= near_ground_.reach_of(driven.place, driven.velocity.norm()))
    return 1.0;
  return find_free_way(ground_, driven.from, way, radius, [&](const Vec3& direction) {
    return double(scene_.ground_height(driven.place, direction));
  });
}

// How it was when the step began.
DrivenSpheres::Driven DrivenSpheres::find_start_of(std::int64_t place) const {
  if (place >= spheres_.awake) return {place, spheres_.position(place), Vec3::Zero()};
  if (const auto guest = std::ranges::find(guests_, place, &Driven::place); guest != guests_.end())
    return *guest;
  const std::vector<Driven>& of_block = driven_[SphereScene::block_of(place)];
  const auto driven = std::ranges::lower_bound(of_block, place, {}, &Driven::place);
  if (driven != of_block.end() && driven->place == place) return *driven;
  const Vec3 velocity = spheres_.velocity(place);
  return {place, spheres_.position(place) - constants_.wide_time * velocity, velocity};
}

// `to_all`, or to those alone that it would pass on its way.
double DrivenSpheres::find_way_to_others(const Driven& driven, const Vec3& way, bool to_all) {
  const std::int64_t self = driven.place;
  const Vec3 middle = driven.from + 0.5 * way;
  const double reach = 0.5 * way.norm() + farthest_reach(self);
  in_the_way_.clear();
  find_awake_near(middle, reach, in_the_way_);
  still_.find_near(middle, reach,
                   [&](std::uint32_t slot) { in_the_way_.push_back(spheres_.place_of_slot[slot]); });
  const auto may_be_met = [&](std::int64_t other) {
    const double limit = reach + farthest_reach(other);
    return other != self && (spheres_.position(other) - middle).squaredNorm() < limit * limit &&
           (to_all || pass(way_of(driven), way_of(find_start_of(other)))) &&
           (!settings_.pair_filter ||
            settings_.pair_filter(spheres_.owner[std::size_t(self)], spheres_.owner[std::size_t(other)]));
  };
  double free = 1.0;
  for (const std::int64_t other : in_the_way_)
    if (may_be_met(other)) free = std::min(free, find_way_to(driven, way, other));
  return free;
}

// By conservative advancement of both (Mirtich, Impulse-based dynamic simulation of rigid body systems,
// 1996); what it touches where it begins only if it would go deep into that.
double DrivenSpheres::find_way_to(const Driven& driven, const Vec3& way, std::int64_t other) {
  constexpr int kMostSteps = 12;
  constexpr double kTouching = 0.01;  // over the lesser R
  const std::int64_t self = driven.place;
  const double radius = std::min(double(kinds_.radius[spheres_.kind[std::size_t(self)]]),
                                 double(kinds_.radius[spheres_.kind[std::size_t(other)]]));
  const Vec3 own_end = spheres_.position(self), end = spheres_.position(other),
             start = find_start_of(other).from;
  const Vec3 relative = way - (end - start);
  double free = 1.0, gone = 0.0;
  for (int i = 0; i < kMostSteps && gone < 1.0; ++i) {
    spheres_.set_position(self, driven.from + gone * relative);
    spheres_.set_position(other, start);
    const auto [normal, gap] = scene_.separate(self, other);
    const double closing = -relative.dot(normal);  // m, on all of the way
    if (closing <= 0.0 || way.dot(normal) >= 0.0) break;  // stopped, it would be met all the same
    if (gap <= kTouching * radius) {
      if (i > 0 || closing > kDrivenFar * radius + gap) free = gone;
      break;
    }
    gone += gap / closing;
  }
  spheres_.set_position(self, own_end);
  spheres_.set_position(other, end);
  return free;
}

}  // namespace lodestone
