#include "signature/settling_clips.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lodestone {
namespace {

using Packed = std::array<std::int16_t, 3>;

std::int16_t to_16_bits(double fraction) {
  return std::int16_t(std::lround(std::clamp(fraction, -1.0, 1.0) * 32767.0));
}
double from_16_bits(std::int16_t value) { return value / 32767.0; }
Packed pack(const Vec3& v, double range) {
  return {to_16_bits(v.x() / range), to_16_bits(v.y() / range), to_16_bits(v.z() / range)};
}
Vec3 unpack(const Packed& p, double range) {
  return range * Vec3(from_16_bits(p[0]), from_16_bits(p[1]), from_16_bits(p[2]));
}

// Between two frames, which differ by little: along the chord, with hardly an error against the arc.
Quat blend(const Quat& a, const Quat& b, double part) {
  const double sign = a.dot(b) < 0.0 ? -1.0 : 1.0;
  return Quat((1.0 - part) * a.coeffs() + sign * part * b.coeffs()).normalized();
}

// The cell of a cube of directions: face, then position on it.
int cube_cell(const Eigen::Vector3f& direction, int side) {
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  const float largest = std::max(std::abs(direction[axis]), 1e-12f);
  const auto along = [&](int i) {
    return std::clamp(int((direction[(axis + i) % 3] / largest + 1.0f) * 0.5f * float(side)), 0, side - 1);
  };
  return ((2 * axis + (direction[axis] < 0.0f)) * side + along(1)) * side + along(2);
}

Eigen::Vector3f cube_cell_direction(int cell, int side) {
  const int face = cell / (side * side), axis = face / 2;
  Eigen::Vector3f direction;
  direction[axis] = face % 2 ? -1.0f : 1.0f;
  direction[(axis + 1) % 3] = (float(cell / side % side) + 0.5f) / float(side) * 2.0f - 1.0f;
  direction[(axis + 2) % 3] = (float(cell % side) + 0.5f) / float(side) * 2.0f - 1.0f;
  return direction.normalized();
}

SettlingKey key_of(const ClipState& s, const Mat3& inertia_per_mass) {
  const Quat to_body = s.orientation.conjugate();
  const Vec3 w = to_body * s.angular_velocity;
  return {(to_body * Vec3::UnitZ()).cast<float>(), (to_body * s.velocity).cast<float>(), w.cast<float>(),
          float(0.5 * (s.velocity.squaredNorm() + w.dot(inertia_per_mass * w)) + s.position.z())};
}

}  // namespace

ClipFrame encode_frame(const ClipState& state, float extent) {
  const Quat& q = state.orientation;
  return {{to_16_bits(state.position.x() / extent), to_16_bits(state.position.y() / extent),
           to_16_bits(state.position.z() / kClipHeightRange)},
          {to_16_bits(q.w()), to_16_bits(q.x()), to_16_bits(q.y()), to_16_bits(q.z())},
          pack(state.velocity, kClipSpeedRange),
          pack(state.angular_velocity, kClipSpeedRange)};
}

ClipState decode_frame(const ClipFrame& frame, float extent) {
  ClipState state;
  state.position = unpack(frame.position, 1.0).cwiseProduct(Vec3(extent, extent, kClipHeightRange));
  state.orientation =
      Quat(frame.orientation[0], frame.orientation[1], frame.orientation[2], frame.orientation[3])
          .normalized();
  state.velocity = unpack(frame.velocity, kClipSpeedRange);
  state.angular_velocity = unpack(frame.angular_velocity, kClipSpeedRange);
  return state;
}

ClipState find_clip_state(const Signature& signature, const SettlingClip& clip, double frame) {
  frame = std::clamp(frame, 0.0, clip.frames - 1.0);
  const auto index = std::uint32_t(frame);
  ClipState state = decode_frame(signature.clip_frames[clip.first_frame + index], clip.extent);
  const double part = frame - index;
  if (part <= 1e-9 || index + 1 >= clip.frames) return state;
  const ClipState next = decode_frame(signature.clip_frames[clip.first_frame + index + 1], clip.extent);
  state.position += part * (next.position - state.position);
  state.orientation = blend(state.orientation, next.orientation, part);
  return state;
}

ClipIndex::ClipIndex(const Signature& signature, const Mat3& inertia_per_mass, float max_distance)
    : max_distance_(max_distance) {
  std::vector<Near> all;
  for (const ClipEntry& entry : signature.clip_entries)
    all.push_back(
        {key_of(find_clip_state(signature, signature.clips[entry.clip], entry.frame), inertia_per_mass),
         entry});
  std::ranges::stable_sort(all, {}, [](const Near& n) { return n.key.energy; });
  constexpr float kCellReach = 1.5f / kSide;  // no direction in a cell is farther from its middle than this
  const float reach = kCellReach + 0.5f * std::sqrt(max_distance);
  for (int cell = 0; cell < 6 * kSide * kSide; ++cell) {
    start_.push_back(std::uint32_t(near_.size()));
    const Eigen::Vector3f middle = cube_cell_direction(cell, kSide);
    std::ranges::copy_if(all, std::back_inserter(near_),
                         [&](const Near& n) { return (n.key.normal - middle).norm() < reach; });
  }
  start_.push_back(std::uint32_t(near_.size()));
}

std::optional<ClipEntry> ClipIndex::find_nearest(const SettlingKey& key, float energy_slack,
                                                 float distance_limit) const {
  if (empty()) return {};
  const int cell = cube_cell(key.normal, kSide);
  std::optional<ClipEntry> best;
  float best_distance = std::min(max_distance_, distance_limit);
  for (const Near& n : std::span(near_).subspan(start_[cell], start_[cell + 1] - start_[cell])) {
    if (n.key.energy > key.energy + energy_slack) break;
    const float from_normal = 4.0f * (n.key.normal - key.normal).squaredNorm();
    if (from_normal >= best_distance) continue;
    const float distance = from_normal + (n.key.velocity - key.velocity).squaredNorm() +
                           (n.key.angular_velocity - key.angular_velocity).squaredNorm();
    if (distance < best_distance) best_distance = distance, best = n.entry;
  }
  return best;
}

}  // namespace lodestone
