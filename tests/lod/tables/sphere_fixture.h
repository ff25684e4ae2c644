// Spheres of `tables` on their own: the arrays that its loops run over, and what a step tells them.
#pragma once

#include "lod/tables/sphere_motion.h"
#include "lod/tables/spheres.h"
#include "reference/random.h"
#include "tests/reference/ode/ode_fixture.h"

namespace lodestone::testing {

inline constexpr Simd kEverySimd[] = {Simd::portable, Simd::avx2, Simd::avx512};
inline bool has(Simd simd) { return simd <= find_simd(); }

struct SphereScene {
  explicit SphereScene(double dt = 1.0 / 60.0, const Vec3& gravity = {0, 0, -kGravity}) {
    constants.time = float(dt), constants.wide_time = dt;
    constants.gx = float(gravity.x()), constants.gy = float(gravity.y()), constants.gz = float(gravity.z());
    constants.wide_gx = gravity.x(), constants.wide_gy = gravity.y(), constants.wide_gz = gravity.z();
    constants.gravity = float(gravity.norm());
    constants.one_kind = true;
  }

  /// Of the kind that all others are; its signature has these collision heights over α, and stands on z.
  std::int64_t add(const std::shared_ptr<const Shape>& shape, double mass, const RigidState& state,
                   const std::vector<float>& heights = {}) {
    if (!signature) {
      auto made = std::make_shared<Signature>();
      made->collision_heights = {heights, std::vector<float>(heights.size())};
      made->rest_poses = {{.normal = Vec3::UnitZ(), .height = 1.0}};
      signature = made;
    }
    const std::uint32_t kind = kinds.take(StatisticalModel::tables, shape, 0, signature);
    dense.take(kinds, kind, constants.gravity);
    const std::int64_t place = spheres.add(std::uint32_t(spheres.size()));
    StatisticalBody body;
    body.position = state.position, body.orientation = state.orientation, body.velocity = state.velocity;
    body.spin = spin_of(state.orientation, state.angular_velocity, *shape);
    body.sphere_radius = float(shape->radius);
    body.kind = kind, body.owner = std::uint32_t(place);
    spheres.put(place, body);
    spheres.inverse_mass[std::size_t(place)] = 1.0 / mass;
    step.resize(std::size_t(spheres.awake));
    return place;
  }

  void start(Simd simd = Simd::portable) {
    start_step(spheres, dense, constants, simd, 0, spheres.awake, step, spheres);
    clear_added(0, spheres.awake, step);
  }
  void end(Simd simd = Simd::portable) { end_step(spheres, dense, constants, simd, 0, spheres.awake, step); }

  /// All that a step leaves, to the bit.
  std::vector<double> numbers() const {
    std::vector<double> all;
    const auto append = [&](const auto& array) { all.insert(all.end(), array.begin(), array.end()); };
    append(spheres.x), append(spheres.y), append(spheres.z), append(spheres.vx), append(spheres.vy),
        append(spheres.vz), append(spheres.lx), append(spheres.ly), append(spheres.lz);
    append(spheres.qw), append(spheres.qx), append(spheres.qy), append(spheres.qz), append(spheres.radius),
        append(spheres.held), append(step.reach), append(step.on_ground);
    for (const Motion motion : spheres.motion) all.push_back(double(motion));
    for (const auto* rows : {&step.p, &step.u, &step.a, &step.s, &step.d})
      for (const lane::Row& row : *rows) all.insert(all.end(), {row.x, row.y, row.z, row.w});
    return all;
  }

  StepConstants constants;
  std::shared_ptr<const Signature> signature;
  Kinds kinds;
  SphereKinds dense;
  Spheres spheres;
  SphereStep step;
};

}  // namespace lodestone::testing
