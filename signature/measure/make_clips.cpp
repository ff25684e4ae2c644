#include "signature/measure/make_clips.h"

#include <algorithm>
#include <cmath>

#include "reference/drop_trial.h"
#include "reference/free_rotation.h"
#include "signature/measure/choose_clips.h"
#include "signature/measure/settling_trial.h"
#include "signature/settling_clips.h"

namespace lodestone {
namespace {

constexpr std::uint32_t kEntriesPerClip = 24;

double energy_over_gr(const Shape& shape, const RigidState& s) {
  return kinetic_energy(shape, s) / (kSettlingGravity * shape.radius);
}

SettlingClip add_frames(std::span<const RigidState> states, double radius, Signature& signature) {
  const double speed_unit = std::sqrt(kSettlingGravity * radius);
  const Vec3 start(states.front().position.x(), states.front().position.y(), 0.0);
  double extent = 1e-3;
  for (const RigidState& s : states)
    extent = std::max(extent, (s.position - start).head<2>().cwiseAbs().maxCoeff() / radius);
  const SettlingClip clip{.first_frame = std::uint32_t(signature.clip_frames.size()),
                          .frames = std::uint32_t(states.size()),
                          .extent = float(extent)};
  for (const RigidState& s : states)
    signature.clip_frames.push_back(
        encode_frame({(s.position - start) / radius, s.orientation, s.velocity / speed_unit,
                      s.angular_velocity * (radius / speed_unit)},
                     clip.extent));
  return clip;
}

// At contacts, more closely at the start, where states differ most from clip to clip.
void add_entries(const Shape& shape, std::span<const RigidState> states, std::uint32_t clip,
                 Signature& signature) {
  std::vector<std::uint32_t> touching;
  for (std::uint32_t i = 0; i < states.size(); ++i)
    if (energy_over_gr(shape, states[i]) < kClipEnergy &&
        gap_over_ground(shape, states[i]) < kEntryGap * shape.radius)
      touching.push_back(i);
  const auto n = std::uint32_t(touching.size());
  for (std::uint32_t i = 0; i < std::min(kEntriesPerClip, n); ++i) {
    const double part = double(i) / kEntriesPerClip;
    signature.clip_entries.push_back({clip, touching[std::max(i, std::uint32_t(n * part * part))]});
  }
}

}  // namespace

void add_clips(std::span<const SettlingRecord> records, const Shape& shape, int count, Signature& signature) {
  signature.clip_frame_interval = float(kObservationStep / std::sqrt(shape.radius / kSettlingGravity));
  for (const std::size_t chosen : choose_clips(records, signature.rest_poses, count)) {
    const std::vector<RigidState>& states = records[chosen].states;
    add_entries(shape, states, std::uint32_t(signature.clips.size()), signature);
    signature.clips.push_back(add_frames(states, shape.radius, signature));
  }
}

}  // namespace lodestone
