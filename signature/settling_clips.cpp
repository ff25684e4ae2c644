#include "signature/settling_clips.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

using Packed = std::array<std::int16_t, 3>;

std::int16_t to_16_bits(double fraction) { return std::int16_t(std::lround(std::clamp(fraction, -1.0, 1.0) * 32767.0)); }
double from_16_bits(std::int16_t value) { return value / 32767.0; }
Vec3 unpack(const Packed& p, double range) { return range * Vec3(from_16_bits(p[0]), from_16_bits(p[1]), from_16_bits(p[2])); }

// Between two frames, which differ by little: along the chord, with hardly an error against the arc.
Quat blend(const Quat& a, const Quat& b, double part) {
  const double sign = a.dot(b) < 0.0 ? -1.0 : 1.0;
  return Quat((1.0 - part) * a.coeffs() + sign * part * b.coeffs()).normalized();
}

// Rotation vector from a to b, rad, in world axes.
Vec3 small_turn(const Quat& a, const Quat& b) {
  const Quat turn = b * a.conjugate();
  const Vec3 half = turn.w() < 0.0 ? Vec3(-turn.vec()) : Vec3(turn.vec());
  const double s = half.norm();
  return s < 1e-9 ? Vec3(2.0 * half) : Vec3(2.0 * std::asin(std::min(1.0, s)) / s * half);
}

// The cell of a cube of directions: face, then position on it.
int cube_cell(const Eigen::Vector3f& direction, int side) {
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  const float largest = std::max(std::abs(direction[axis]), 1e-12f);
  const auto along = [&](int i) { return std::clamp(int((direction[(axis + i) % 3] / largest + 1.0f) * 0.5f * float(side)), 0, side - 1); };
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

ClipFrame encode_frame(const ClipPose& pose, float extent) {
  const Quat& q = pose.orientation;
  return {{to_16_bits(pose.position.x() / extent), to_16_bits(pose.position.y() / extent), to_16_bits(pose.position.z() / kClipHeightRange)},
          {to_16_bits(q.w()), to_16_bits(q.x()), to_16_bits(q.y()), to_16_bits(q.z())}};
}

ClipPose decode_frame(const ClipFrame& frame, float extent) {
  return {unpack(frame.position, 1.0).cwiseProduct(Vec3(extent, extent, kClipHeightRange)),
          Quat(frame.orientation[0], frame.orientation[1], frame.orientation[2], frame.orientation[3]).normalized()};
}

ClipState find_clip_state(const Signature& signature, const SettlingClip& clip, double frame) {
  frame = std::clamp(frame, 0.0, clip.frames - 1.0);
  const auto pose_at = [&](std::uint32_t i) { return decode_frame(signature.clip_frames[clip.first_frame + i], clip.extent); };
  const auto index = std::uint32_t(frame);
  const double part = frame - index;
  const bool between = part > 1e-9;
  const std::uint32_t before = between || index == 0 ? index : index - 1, after = std::min(index + 1, clip.frames - 1);
  const ClipPose a = pose_at(before), b = pose_at(after);
  ClipState state;
  if (between) {
    state.position = a.position + part * (b.position - a.position);
    state.orientation = blend(a.orientation, b.orientation, part);
  } else {
    const ClipPose here = pose_at(index);
    state.position = here.position;
    state.orientation = here.orientation;
  }
  const double rate = after > before ? 1.0 / ((after - before) * double(signature.clip_frame_interval)) : 0.0;
  state.velocity = rate * (b.position - a.position);
  state.angular_velocity = rate * small_turn(a.orientation, b.orientation);
  return state;
}

ClipIndex::ClipIndex(const Signature& signature, const Mat3& inertia_per_mass, float max_distance)
    : max_distance_(max_distance), entries_(signature.clip_entries) {
  for (const ClipEntry& entry : entries_)
    keys_.push_back(key_of(find_clip_state(signature, signature.clips[entry.clip], entry.frame), inertia_per_mass));
  constexpr float kCellReach = 1.5f / kSide;  // no direction in a cell is farther from its middle than this
  const float reach = kCellReach + 0.5f * std::sqrt(max_distance);
  for (int cell = 0; cell < 6 * kSide * kSide; ++cell) {
    start_.push_back(std::uint32_t(near_.size()));
    const Eigen::Vector3f middle = cube_cell_direction(cell, kSide);
    for (std::size_t i = 0; i < keys_.size(); ++i)
      if ((keys_[i].normal - middle).norm() < reach) near_.push_back(std::uint32_t(i));
  }
  start_.push_back(std::uint32_t(near_.size()));
}

std::optional<ClipEntry> ClipIndex::find_nearest(const SettlingKey& key, float energy_slack) const {
  if (empty()) return {};
  const int cell = cube_cell(key.normal, kSide);
  std::optional<ClipEntry> best;
  float best_distance = max_distance_;
  for (std::uint32_t i = start_[cell]; i < start_[cell + 1]; ++i) {
    const SettlingKey& k = keys_[near_[i]];
    const float from_normal = 4.0f * (k.normal - key.normal).squaredNorm();
    if (from_normal >= best_distance || k.energy > key.energy + energy_slack) continue;
    const float distance = from_normal + (k.velocity - key.velocity).squaredNorm() + (k.angular_velocity - key.angular_velocity).squaredNorm();
    if (distance < best_distance) best_distance = distance, best = entries_[near_[i]];
  }
  return best;
}

}  // namespace lodestone
