#include "signature/settling_clips.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace lodestone {
namespace {

using Packed = std::array<std::int16_t, 3>;

std::int16_t to_16_bits(double fraction) {
  return std::int16_t(std::lround(std::clamp(fraction, -1.0, 1.0) * 32767.0));
}
double from_16_bits(std::int16_t value) { return value * (1.0 / 32767.0); }
Packed pack(const Vec3& v, double range) {
  return {to_16_bits(v.x() / range), to_16_bits(v.y() / range), to_16_bits(v.z() / range)};
}
Vec3 unpack(const Packed& p, double range) {
  return range * Vec3(from_16_bits(p[0]), from_16_bits(p[1]), from_16_bits(p[2]));
}

Vec3 position_of(const ClipFrame& frame, double extent) {
  return unpack(frame.position, 1.0).cwiseProduct(Vec3(extent, extent, double(kClipHeightRange)));
}
// Of unit length but for the rounding to 16 bits.
Quat orientation_of(const ClipFrame& frame) {
  const auto& q = frame.orientation;
  return {from_16_bits(q[0]), from_16_bits(q[1]), from_16_bits(q[2]), from_16_bits(q[3])};
}

// Between two frames, which differ by little: along the chord, with hardly an error against the arc.
Quat blend(const Quat& a, const Quat& b, double part) {
  const double sign = a.dot(b) < 0.0 ? -1.0 : 1.0;
  return Quat((1.0 - part) * a.coeffs() + sign * part * b.coeffs()).normalized();
}

SettlingKey key_of(const ClipState& s, const Mat3& inertia_per_mass) {
  const Quat to_body = s.orientation.conjugate();
  const Vec3 w = to_body * s.angular_velocity;
  return {(to_body * Vec3::UnitZ()).cast<float>(), (to_body * s.velocity).cast<float>(), w.cast<float>(),
          float(0.5 * (s.velocity.squaredNorm() + w.dot(inertia_per_mass * w)) + s.position.z())};
}

std::array<float, 9> coordinates_of(const SettlingKey& key) {
  const Eigen::Vector3f &n = key.normal, &v = key.velocity, &w = key.angular_velocity;
  return {n.x(), n.y(), n.z(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
}

/// Of entries side by side: each one's squared distance from a key, as find_nearest measures it; huge where
/// there is too much energy.
struct DistanceLoop {
  std::array<const float*, 9> at;  // coordinates
  const float* energy;
  std::array<float, 9> key;
  float greatest_energy;

  void operator()(std::size_t count, float* distance) const {
    const float *nx = at[0], *ny = at[1], *nz = at[2], *vx = at[3], *vy = at[4], *vz = at[5], *wx = at[6],
                *wy = at[7], *wz = at[8], *e = energy;
    const auto [knx, kny, knz, kvx, kvy, kvz, kwx, kwy, kwz] = key;
    const float most = greatest_energy;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) {
      const float ax = nx[i] - knx, ay = ny[i] - kny, az = nz[i] - knz;
      const float bx = vx[i] - kvx, by = vy[i] - kvy, bz = vz[i] - kvz;
      const float cx = wx[i] - kwx, cy = wy[i] - kwy, cz = wz[i] - kwz;
      const float from_normal = ax * ax + ay * ay + az * az, from_velocity = bx * bx + by * by + bz * bz,
                  from_turning = cx * cx + cy * cy + cz * cz;
      const float excess = e[i] > most ? 1e30f : 0.0f;
      distance[i] = 4.0f * from_normal + from_velocity + from_turning + excess;
    }
  }
};

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
  return {position_of(frame, extent), orientation_of(frame).normalized(),
          unpack(frame.velocity, kClipSpeedRange), unpack(frame.angular_velocity, kClipSpeedRange)};
}

ClipState find_clip_state(const Signature& signature, const SettlingClip& clip, double frame) {
  frame = std::clamp(frame, 0.0, clip.frames - 1.0);
  const auto index = std::uint32_t(frame);
  const ClipFrame* const at = &signature.clip_frames[clip.first_frame + index];
  const double part = frame - index;
  if (part <= 1e-9 || index + 1 >= clip.frames) return decode_frame(at[0], clip.extent);
  ClipState state;
  state.position = (1.0 - part) * position_of(at[0], clip.extent) + part * position_of(at[1], clip.extent);
  state.orientation = blend(orientation_of(at[0]), orientation_of(at[1]), part);
  state.velocity = unpack(at->velocity, kClipSpeedRange);
  state.angular_velocity = unpack(at->angular_velocity, kClipSpeedRange);
  return state;
}

int ClipIndex::cell_along(float coordinate) {
  return int(std::clamp((coordinate + 1.0f) * (0.5f * float(kSide)), 0.0f, float(kSide - 1)));
}

std::size_t ClipIndex::cell_of(const std::array<int, 3>& place) {
  return std::size_t((place[0] * kSide + place[1]) * kSide + place[2]);
}

ClipIndex::ClipIndex(const Signature& signature, const Mat3& inertia_per_mass) {
  if (signature.clip_entries.empty()) return;
  struct Placed {
    SettlingKey key;
    ClipEntry entry;
    std::size_t cell;
  };
  std::vector<Placed> placed;
  placed.reserve(signature.clip_entries.size());
  for (const ClipEntry& entry : signature.clip_entries) {
    const SettlingKey key =
        key_of(find_clip_state(signature, signature.clips[entry.clip], entry.frame), inertia_per_mass);
    const Eigen::Vector3f& n = key.normal;
    placed.push_back({key, entry, cell_of({cell_along(n.x()), cell_along(n.y()), cell_along(n.z())})});
  }
  std::ranges::stable_sort(placed, {}, [](const Placed& p) { return std::pair(p.cell, p.key.energy); });
  start_.assign(kSide * kSide * kSide + 1, 0);
  entries_.reserve(placed.size());
  for (const Placed& p : placed) {
    entries_.push_back(p.entry);
    energy_.push_back(p.key.energy);
    for (std::size_t i = 0; i < kCoordinates; ++i) coordinates_[i].push_back(coordinates_of(p.key)[i]);
    ++start_[p.cell + 1];
  }
  energy_.resize(energy_.size() + kEight - 1);
  for (std::vector<float>& along : coordinates_) along.resize(energy_.size());
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
}

// Of entries [begin, end), eight at a time; past the end there are others, or none.
void ClipIndex::search(std::size_t begin, std::size_t end, const SettlingKey& key, float greatest_energy,
                       Nearest& nearest) const {
  constexpr std::size_t kBlock = 64;
  std::array<float, kBlock> distance;
  DistanceLoop loop{{}, nullptr, coordinates_of(key), greatest_energy};
  for (std::size_t from = begin; from < end; from += kBlock) {
    const std::size_t count = std::min(kBlock, end - from);
    for (std::size_t i = 0; i < kCoordinates; ++i) loop.at[i] = coordinates_[i].data() + from;
    loop.energy = energy_.data() + from;
    const std::size_t eights = (count + kEight - 1) / kEight * kEight;
    loop(eights, distance.data());
    const float limit = nearest.distance;
    int nearer = 0;  // mostly none is
    for (std::size_t i = 0; i < eights; ++i) nearer += distance[i] < limit;
    if (nearer == 0) continue;
    for (std::size_t i = 0; i < count; ++i)
      if (distance[i] < nearest.distance) nearest = {distance[i], std::int64_t(from + i)};
  }
}

std::optional<ClipEntry> ClipIndex::find_nearest(const SettlingKey& key, float energy_slack,
                                                 float distance_limit) const {
  if (empty()) return {};
  Nearest nearest{distance_limit};
  // Its own cell first: what is near there leaves less to look at.
  const std::size_t own =
      cell_of({cell_along(key.normal.x()), cell_along(key.normal.y()), cell_along(key.normal.z())});
  if (start_[own] != start_[own + 1])
    search(start_[own], start_[own + 1], key, key.energy + energy_slack, nearest);
  // Normals farther off than this are too far by themselves: of each row of cells those within it count.
  const float reach = 0.5f * std::sqrt(nearest.distance) + kRounding, square = reach * reach;
  const auto first_of = [&](int axis, float way) { return cell_along(key.normal[axis] - way); };
  const auto last_of = [&](int axis, float way) { return cell_along(key.normal[axis] + way); };
  const auto square_to = [&](int axis, int cell) {
    const float low = float(cell) * (2.0f / float(kSide)) - 1.0f, at = key.normal[axis];
    const float way = std::max({0.0f, low - at - kRounding, at - low - 2.0f / float(kSide) - kRounding});
    return way * way;
  };
  const int first_x = first_of(0, reach), last_x = last_of(0, reach), first_y = first_of(1, reach),
            last_y = last_of(1, reach);
  for (int x = first_x; x <= last_x; ++x)
    for (int y = first_y; y <= last_y; ++y) {
      const float left = square - square_to(0, x) - square_to(1, y);
      if (left < 0.0f) continue;
      const float way = std::sqrt(left) + kRounding;
      const std::size_t begin = cell_of({x, y, first_of(2, way)}), end = cell_of({x, y, last_of(2, way)}) + 1;
      if (start_[begin] == start_[end]) continue;  // most lie off the sphere
      search(start_[begin], start_[end], key, key.energy + energy_slack, nearest);
    }
  if (nearest.entry < 0) return {};
  return entries_[std::size_t(nearest.entry)];
}

}  // namespace lodestone
