#include "scenes/trajectory.h"

#include <algorithm>
#include <cmath>

#include "reference/error.h"

namespace lodestone {
namespace {

Trajectory::Position packed(const Vec3& position) {
  return {float(position.x()), float(position.y()), float(position.z())};
}

Trajectory::Orientation packed(const Quat& q) {
  const auto pack = [](double x) { return std::int16_t(std::lround(std::clamp(x, -1.0, 1.0) * 32767.0)); };
  return {pack(q.x()), pack(q.y()), pack(q.z()), pack(q.w())};
}

/// q and −q are one rotation; viewers interpolate the shorter way only between neighbours of one sign.
Trajectory::Orientation with_sign_of(Trajectory::Orientation q, const Trajectory::Orientation& before) {
  std::int64_t dot = 0;
  for (int i = 0; i < 4; ++i) dot += std::int64_t(q[std::size_t(i)]) * before[std::size_t(i)];
  if (dot < 0)
    for (std::int16_t& x : q) x = std::int16_t(-x);
  return q;
}

}  // namespace

void Trajectory::set_first_statuses(std::span<const BodyStatus> statuses) {
  check_that(frames() > 0 && int(statuses.size()) == bodies_, "a first frame has one status for each body");
  std::ranges::copy(statuses, statuses_.begin());
}

void Trajectory::add_frame(double time_s, std::span<const RigidState> states,
                           std::span<const BodyStatus> statuses) {
  check_that(int(states.size()) == bodies_ && int(statuses.size()) == bodies_,
             "one state and status for each body");
  if (!times_.empty() && float(time_s) <= times_.back()) return;
  times_.push_back(float(time_s));
  for (int body = 0; body < bodies_; ++body) {
    const RigidState& state = states[std::size_t(body)];
    positions_.push_back(packed(state.position));
    const Orientation q = packed(state.orientation);
    orientations_.push_back(frames() == 1 ? q : with_sign_of(q, orientation(frames() - 2, body)));
  }
  statuses_.insert(statuses_.end(), statuses.begin(), statuses.end());
}

int Trajectory::moving_frames(int body) const {
  int last = frames() - 1;
  while (last > 0 && position(last, body) == position(last - 1, body) &&
         orientation(last, body) == orientation(last - 1, body))
    --last;
  return last + 1;
}

int max_trajectory_frames(int bodies) {
  constexpr double kBytes = 3.5e9,
                   kBytesOfABodyAndFrame = sizeof(Trajectory::Position) + sizeof(Trajectory::Orientation);
  return int(std::clamp(kBytes / (kBytesOfABodyAndFrame * std::max(bodies, 1)), 1.0, 1e9));
}

}  // namespace lodestone
