#include "signature/settling_clips.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

std::int16_t to_16_bits(double fraction) { return std::int16_t(std::lround(std::clamp(fraction, -1.0, 1.0) * 32767.0)); }
double from_16_bits(std::int16_t value) { return value / 32767.0; }

}  // namespace

ClipFrame encode_frame(const ClipPose& pose, float extent) {
  const Quat& q = pose.orientation;
  return {{to_16_bits(pose.position.x() / extent), to_16_bits(pose.position.y() / extent), to_16_bits(pose.position.z() / kClipHeightRange)},
          {to_16_bits(q.w()), to_16_bits(q.x()), to_16_bits(q.y()), to_16_bits(q.z())}};
}

ClipPose decode_frame(const ClipFrame& frame, float extent) {
  ClipPose pose;
  pose.position = {from_16_bits(frame.position[0]) * extent, from_16_bits(frame.position[1]) * extent,
                   from_16_bits(frame.position[2]) * kClipHeightRange};
  pose.orientation = Quat(frame.orientation[0], frame.orientation[1], frame.orientation[2], frame.orientation[3]).normalized();
  return pose;
}

ClipPose find_clip_pose(const Signature& signature, const SettlingClip& clip, double frame) {
  const double last = clip.frames - 1.0;
  frame = std::clamp(frame, 0.0, last);
  const auto index = std::min<std::uint32_t>(std::uint32_t(frame), clip.frames - 1);
  const ClipPose a = decode_frame(signature.clip_frames[clip.first_frame + index], clip.extent);
  const double part = frame - index;
  if (part <= 0.0 || index + 1 >= clip.frames) return a;
  const ClipPose b = decode_frame(signature.clip_frames[clip.first_frame + index + 1], clip.extent);
  return {a.position + part * (b.position - a.position), a.orientation.slerp(part, b.orientation)};
}

std::optional<int> find_nearest_entry(const Signature& signature, const SettlingState& state, float max_distance) {
  std::optional<int> best;
  float best_distance = max_distance;
  for (int i = 0; i < int(signature.clip_entries.size()); ++i) {
    const ClipEntry& e = signature.clip_entries[i];
    if (e.energy > state.energy) continue;
    const float from_normal = 4.0f * (e.normal - state.normal).squaredNorm();
    if (from_normal >= best_distance) continue;
    const float distance = from_normal + (e.velocity - state.velocity).squaredNorm() +
                           (e.angular_velocity - state.angular_velocity).squaredNorm();
    if (distance < best_distance) best_distance = distance, best = i;
  }
  return best;
}

}  // namespace lodestone
