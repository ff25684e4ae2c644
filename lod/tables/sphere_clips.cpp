#include "lod/tables/sphere_clips.h"

#include <algorithm>
#include <utility>

namespace lodestone {

void SphereClips::end(std::int64_t place) {
  const std::int32_t clip = std::exchange(spheres_.clip[std::size_t(place)], -1);
  if (clip < 0) return;
  if (std::size_t(clip) + 1 < playing_.size()) {
    playing_[std::size_t(clip)] = playing_.back();
    spheres_.clip[scene_.place_of(playing_[std::size_t(clip)].slot)] = clip;
  }
  playing_.pop_back();
  Motion& motion = spheres_.motion[std::size_t(place)];
  if (motion == Motion::settling) motion = Motion::dynamic;
}

void SphereClips::end_all() {
  while (!playing_.empty()) end(std::int64_t(scene_.place_of(playing_.back().slot)));
}

void SphereClips::end_of_touched() {
  for (auto clip = std::ssize(playing_) - 1; clip >= 0; --clip) {
    const auto place = std::int64_t(scene_.place_of(playing_[std::size_t(clip)].slot));
    if (scene_.step.touches(place)) end(place);
  }
}

// After the bodies have moved, on any threads: by block, so that the order does not depend on these.
void SphereClips::update() {
  for (auto clip = std::ssize(playing_) - 1; clip >= 0; --clip) {
    const Playing& played = playing_[std::size_t(clip)];
    if (played.state == Playing::ended) end(std::int64_t(scene_.place_of(played.slot)));
  }
  for (std::vector<Playing>& joined : joined_) {
    for (const Playing& clip : joined) {
      if (playing_.size() == playing_.capacity())
        playing_.reserve(playing_.size() + playing_.size() / 8 + 16);
      spheres_.clip[scene_.place_of(clip.slot)] = std::int32_t(playing_.size());
      playing_.push_back(clip);
    }
    joined.clear();
  }
}

}  // namespace lodestone
