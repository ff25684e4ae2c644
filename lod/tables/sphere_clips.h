// The settling clips along which bodies of `tables` come to rest on their hulls. Spheres::clip has the number
// of each body's.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/support/clip_player.h"
#include "lod/tables/sphere_scene.h"
#include "reference/state_archive.h"

namespace lodestone {

class SphereClips {
 public:
  struct Playing {
    ClipPlayback playback = {};
    std::int32_t slot = 0;
    enum State : std::int32_t {
      plays,
      over,   // the body rests
      ended,  // the body moves on without it
    } state = plays;
  };

  explicit SphereClips(const SphereScene& scene) : scene_(scene) {}

  /// Null where none is under way.
  Playing* of(std::int64_t place) {
    const std::int32_t clip = spheres_.clip[std::size_t(place)];
    return clip < 0 ? nullptr : &playing_[std::size_t(clip)];
  }
  const Playing* of(std::int64_t place) const { return const_cast<SphereClips*>(this)->of(place); }
  void end(std::int64_t place);
  void end_all();
  /// Who is struck goes on as a sphere: a clip has no rest pose for it.
  void end_of_touched();

  /// The bodies are about to move, in so many blocks.
  void begin_blocks(std::size_t blocks) { joined_.resize(std::max(joined_.size(), blocks)); }
  /// Clips that the bodies of a block join.
  std::vector<Playing>& joined(std::size_t block) { return joined_[block]; }
  /// After all blocks: clips that have ended go, those that were joined are added.
  void update();

  void archive(StateArchive& a) { a(playing_); }
  std::size_t bytes() const { return playing_.capacity() * sizeof playing_[0]; }

 private:
  const SphereScene& scene_;
  Spheres& spheres_ = scene_.spheres;

  std::vector<Playing> playing_;
  std::vector<std::vector<Playing>> joined_;  // in this step, by block
};

}  // namespace lodestone
