#include "signature/measure/make_clips.h"

#include <algorithm>
#include <cmath>

#include "reference/free_rotation.h"
#include "reference/trial.h"
#include "signature/measure/choose_clips.h"
#include "signature/measure/settling_trial.h"
#include "signature/settling_clips.h"

namespace lodestone {
namespace {

constexpr int kEntriesPerClip = 24;

}  // namespace

void add_clips(std::span<const SettlingRecord> records, const Shape& shape, int count, Signature& signature) {
  const double radius = shape.radius;
  signature.clip_frame_interval = float(kSamplesPerFrame * kObservationStep / std::sqrt(radius / kSettlingGravity));
  for (const std::size_t chosen : choose_clips(records, signature.rest_poses, count)) {
    const SettlingRecord& record = records[chosen];
    SettlingClip clip;
    clip.first_frame = std::uint32_t(signature.clip_frames.size());
    clip.frames = std::uint32_t(record.states.size());
    const Vec3 start(record.states.front().position.x(), record.states.front().position.y(), 0.0);
    double extent = 1e-3;
    for (const RigidState& s : record.states) extent = std::max(extent, (s.position - start).head<2>().cwiseAbs().maxCoeff() / radius);
    clip.extent = float(extent);
    std::vector<std::uint32_t> touching;  // frames where a body may join
    for (std::uint32_t i = 0; i < clip.frames; ++i) {
      const RigidState& s = record.states[i];
      signature.clip_frames.push_back(encode_frame({(s.position - start) / radius, s.orientation}, clip.extent));
      const double energy = kinetic_energy(shape, s) / (kSettlingGravity * radius);
      if (energy < kClipEnergy && gap_over_ground(shape, s) < kEntryGap * radius) touching.push_back(i);
    }
    // Spread more closely at the start, where states differ most from clip to clip.
    const auto n = double(touching.size());
    for (int i = 0; i < std::min(kEntriesPerClip, int(n)); ++i) {
      const double part = double(i) / kEntriesPerClip;
      signature.clip_entries.push_back({std::uint32_t(signature.clips.size()), touching[std::size_t(std::max(double(i), n * part * part))]});
    }
    signature.clips.push_back(clip);
  }
}

}  // namespace lodestone
