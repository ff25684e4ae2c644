// The start of a step: a loop as in sphere_motion.cpp, in a file of its own, since each takes the compiler
// ten seconds.
#include <algorithm>
#include <cmath>

#include "lod/tables/sphere_motion.h"

namespace lodestone {
namespace {

using namespace lane;

constexpr float kSettleSpeed =
    0.24f;  // radii in the time of the approach to a rest pose: how fast a radius grows into it

template <bool OneKind>
struct StartLoop {
  const Spheres& in;
  const SphereKinds& kinds;
  StepConstants c;
  SphereStep& step;
  Spheres& out;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const double *vx = in.vx.data(), *vy = in.vy.data(), *vz = in.vz.data(), *lx = in.lx.data(),
                 *ly = in.ly.data(), *lz = in.lz.data();
    const float *qw = in.qw.data(), *qx = in.qx.data(), *qy = in.qy.data(), *qz = in.qz.data();
    const std::uint32_t* kind = in.kind.data();
    const std::int16_t* pose = in.pose.data();
    const auto* motion = reinterpret_cast<const std::uint8_t*>(in.motion.data());
    const std::uint8_t *since_crowded = in.since_crowded.data(), *eased = in.eased.data();
    const auto* on_hull = reinterpret_cast<const std::uint8_t*>(in.on_hull.data());
    const float *size = kinds.radius.data(), *height = kinds.height.data(),
                *farthest = kinds.farthest_reach.data(), *pose_height = kinds.pose_height.data(),
                *blend = kinds.blend_time.data();
    const std::int32_t* first_pose = kinds.first_pose.data();
    const Tensors soft = inverse_inertias_of(kinds);
    float *radius = out.radius.data(), *reach = step.reach.data();
    const float* softest = kinds.softest.data();
    Row *p = step.p.data(), *u = step.u.data(), *s = step.s.data();
    std::uint8_t* on_ground = step.on_ground.data();
    std::int32_t* plane = step.plane.data();
    const bool update = c.update_radius;
    const F3 drift{float(c.drift.x()), float(c.drift.y()), float(c.drift.z())};
    const float fall = 0.5f * c.gravity * c.time * c.time,
                hulls = c.hulls ? 1.0f : 0.0f;  // what they reach to others is not the radius
#pragma GCC ivdep
    for (std::int64_t i = begin; i < end; ++i) {
      const int k = OneKind ? 0 : int(kind[i]);
      const F3 v{float(vx[i]), float(vy[i]), float(vz[i])}, spun{float(lx[i]), float(ly[i]), float(lz[i])};
      const F3 omega = in_world(soft, k, {qw[i], {qx[i], qy[i], qz[i]}}, spun);
      const float speed = length(v), spin = size[k] * length(omega), was = radius[i];
      // The sphere's radius: in flight by the tables, at rest by the pose, among others as it was.
      const float at = arc_tangent(spin, speed) * (float(kHeightSamples - 1) / 1.57079633f);
      const int sample = int(least(at, float(kHeightSamples - 1))), from = k * (kHeightSamples + 1) + sample;
      const float low = height[from], high = height[from + 1],
                  measured = low + (at - float(sample)) * (high - low);
      const float way = (speed + spin) * c.time, slow = (kSettleSpeed * size[k] / blend[k]) * c.time,
                  grown = was + choose(eased[i] > 0, least(way, slow), way);
      const float flying =
          least(measured, grown);  // no faster than it moves: bodies that begin to move would leap
      const int number = pose[i], moves = int(motion[i]),
                rest = first_pose[k] + choose(number > 0, number, 0);
      const float settled = was + (pose_height[rest] - was) * least(1.0f, 2.0f * c.time / blend[k]);
      const float resting = least(settled, was + slow);
      const bool sphere = on_hull[i] == 0;  // else as high as it was when it last touched the ground
      const bool flies = update & sphere & (moves == int(Motion::dynamic)) & (since_crowded[i] > 0);
      const float r = choose(sphere & (moves == int(Motion::settling)), resting, choose(flies, flying, was));
      radius[i] = r;
      const float relative = length(F3{v.x - drift.x, v.y - drift.y, v.z - drift.z});
      reach[i] = r + hulls * (farthest[k] - r) + 0.01f * size[k] + relative * c.time + fall;
      p[i].x = v.x + c.gx * c.time, p[i].y = v.y + c.gy * c.time, p[i].z = v.z + c.gz * c.time, p[i].w = 0.0f;
      u[i].x = r * omega.x, u[i].y = r * omega.y, u[i].z = r * omega.z, u[i].w = 1.0f + r * r * softest[k];
      s[i].x = 0.0f, s[i].y = 0.0f, s[i].z = 0.0f, s[i].w = 0.5f * (dot(v, v) + dot(spun, omega));
    }
    std::fill(on_ground + begin, on_ground + end, std::uint8_t(0));
    std::fill(plane + begin, plane + end, 0);
  }
};

}  // namespace

void start_step(const Spheres& spheres, const SphereKinds& kinds, const StepConstants& constants, Simd simd,
                std::int64_t begin, std::int64_t end, SphereStep& step, Spheres& out) {
  if (constants.one_kind)
    run_wide(simd, StartLoop<true>{spheres, kinds, constants, step, out}, begin, end);
  else
    run_wide(simd, StartLoop<false>{spheres, kinds, constants, step, out}, begin, end);
}

}  // namespace lodestone
