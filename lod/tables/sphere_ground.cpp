#include "lod/tables/sphere_ground.h"

#include <algorithm>

#include "lod/tables/hull_separation.h"

namespace lodestone {
namespace {

using namespace lane;

constexpr auto kNear = std::uint8_t(GroundState::near), kLies = std::uint8_t(GroundState::lies),
               kSettles = std::uint8_t(GroundState::settles);
static_assert(kSettles == kLies + 1);
constexpr float kFootprint = 0.3f;  // lever of pivoting friction over R
constexpr float kRise = 0.25f;      // of a sphere that has grown into the plane, part a step
constexpr float kLeastLoad =
    0.25f;  // of what gravity gives in a step: what presses less is not held by friction

constexpr auto kWithin = std::uint8_t(GroundState::within);

// Of the ground at a plane.
template <bool OnePlane>
LODESTONE_INLINE F3 velocity_of(const SphereGround& ground, int plane) {
  if constexpr (OnePlane)
    return {0.0f, 0.0f, 0.0f};
  else
    return {ground.ux.data()[plane], ground.uy.data()[plane], ground.uz.data()[plane]};
}

template <bool Hulls>
struct NearLoop {
  const Spheres& spheres;
  const SphereKinds& kinds;
  F3 n;
  double wide_x, wide_y, wide_z, offset;
  F3 moving;               // m/s: of the ground at the plane
  const float* pressures;  // m/s², of all planes
  std::int32_t number;
  StepConstants c;
  SphereStep& step;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const double *x = spheres.x.data(), *y = spheres.y.data(), *z = spheres.z.data();
    const double *vx = spheres.vx.data(), *vy = spheres.vy.data(), *vz = spheres.vz.data();
    const float* radius = spheres.radius.data();
    std::uint8_t* on_ground = step.on_ground.data();
    std::int32_t* plane = step.plane.data();
    float* gap = step.gap.data();
    const float pressure = pressures[number], same = 1e-3f * c.gravity;
    const float pull = least(0.0f, n.x * c.gx + n.y * c.gy + n.z * c.gz), rising = dot(moving, n);
    [[maybe_unused]] const std::uint32_t* kind = spheres.kind.data();
    [[maybe_unused]] const float *size = kinds.radius.data(), *heights = kinds.hull_height.data();
    [[maybe_unused]] const Row* face = kinds.pair_face.data();
    [[maybe_unused]] const float* unsteady = kinds.unsteady.data();
    [[maybe_unused]] const std::uint8_t* since_crowded = spheres.since_crowded.data();
    [[maybe_unused]] std::uint8_t* flush = step.flush.data();
    [[maybe_unused]] const float *qw = spheres.qw.data(), *qx = spheres.qx.data(), *qy = spheres.qy.data(),
                                 *qz = spheres.qz.data();
#pragma GCC ivdep
    for (std::int64_t i = begin; i < end; ++i) {
      const float height = float(wide_x * x[i] + wide_y * y[i] + wide_z * z[i] - offset);
      float own = radius[i];
      [[maybe_unused]] int lies_flush = 0;
      if constexpr (Hulls) {  // among others it has its hull's height, as they meet it
        const Turn q{qw[i], {qx[i], qy[i], qz[i]}};
        const int map = int(kind[i]) * kHullHeights;
        const MapPlace place = place_in_map(turned(back(q), -1.0f * n));
        own = choose(int(since_crowded[i]) < kLeaningTicks, read_map(heights, map, place), own);
        const Row& under = face[map + place.nearest];
        const float cosine = -dot(turned(q, {under.x, under.y, under.z}), n);
        lies_flush = int(cosine > kFlushCosine + unsteady[map + place.nearest]);
      }
      const float above = height - own;
      const float speed = n.x * float(vx[i]) + n.y * float(vy[i]) + n.z * float(vz[i]);
      const float way = least(0.0f, speed - rising) * c.time + 0.5f * pull * c.time * c.time;
      const int state = on_ground[i], other = plane[i];
      const float known = gap[i];
      const int near = -int(above + 1.001f * way < 0.002f * radius[i]),
                carries = -(int(pressure > pressures[other] + same) |
                            (int(pressure > pressures[other] - same) & int(above < known))),
                nearest = near & (-int(state != int(kNear)) | carries);  // masks
      int otherwise = state;
      if constexpr (Hulls) {
        const int within =
            -(int(height - size[kind[i]] + 1.001f * way < 0.002f * radius[i]) & int(state == 0));
        otherwise = (int(kWithin) & within) | (state & ~within);
        flush[i] = std::uint8_t((lies_flush & nearest) | (int(flush[i]) & ~nearest));
      }
      on_ground[i] = std::uint8_t((int(kNear) & near) | (otherwise & ~near));
      gap[i] = select(nearest, above, known);
      plane[i] = (number & nearest) | (other & ~nearest);
    }
  }
};

template <bool OneKind, bool OnePlane>
struct SortLoop {
  const Spheres& spheres;
  const SphereKinds& kinds;
  const SphereGround& ground;
  StepConstants c;
  float bounce;  // m/s
  SphereStep& step;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const double *vx = spheres.vx.data(), *vy = spheres.vy.data(), *vz = spheres.vz.data();
    const float* held = spheres.held.data();
    const float* size = kinds.radius.data();
    const float *nx = ground.nx.data(), *ny = ground.ny.data(), *nz = ground.nz.data(),
                *pressure = ground.pressure.data();
    const float* slope = ground.slope.data();
    const std::uint32_t* kind = spheres.kind.data();
    const auto* motion = reinterpret_cast<const std::uint8_t*>(spheres.motion.data());
    const std::int32_t* plane = step.plane.data();
    const Row* s = step.s.data();
    Row *given = step.a.data(), *start = step.p.data();
    std::uint8_t* on_ground = step.on_ground.data();
    const int published = -int(!c.hulls);
#pragma GCC ivdep
    for (std::int64_t i = begin; i < end; ++i) {
      const int k = OneKind ? 0 : int(kind[i]), p = OnePlane ? 0 : int(plane[i]), moves = int(motion[i]);
      const int state = on_ground[i];
      const F3 n{nx[p], ny[p], nz[p]},
          v = F3{float(vx[i]), float(vy[i]), float(vz[i])} - velocity_of<OnePlane>(ground, p);
      const float touching = start[i].w, moving = s[i].x + s[i].y + s[i].z + s[i].w,
                  threshold = c.resting_energy * c.gravity * size[k];
      const float kept = c.held * held[i], weight = pressure[p] * c.time;
      // Masks: 0 or −1.
      // Who comes off it so fast that it rises by twice its radius lies there no more.
      const float leaves = dot(v, n);
      const int rises =
          -int(leaves > bounce) & -int(leaves * leaves > 4.0f * c.gravity * size[k]) & ~published;
      const int near = -int(state == int(kNear)), presses = -int(leaves > -bounce) & ~rises,
                others = -int(touching > 0.0f), level = -int(slope[p] == 0.0f);
      const int settling = -int(moves == int(Motion::settling)) & level & -int(moving <= 2.0f * threshold);
      const int settles = (-int(moves == int(Motion::dynamic)) | ~level) & -int(moving < threshold);
      const int lies = near & presses & (others | settling), among = lies & others;
      const float known = select(among, kept, 0.0f);
      start[i].x += known * n.x, start[i].y += known * n.y, start[i].z += known * n.z,
          start[i].w = touching + select(among, 1.0f, 0.0f);
      given[i].x = 0.0f, given[i].y = 0.0f, given[i].z = 0.0f, given[i].w = select(others, known, weight);
      on_ground[i] = std::uint8_t((lies & (int(kLies) - settles)) | (state & ~lies));
    }
  }
};

// The paper's spheres are answered as they were before the round; those that know their hulls as its contacts
// left them, so that what is pressed against the ground has no velocity into it in the end.
template <bool OnePlane>
struct SweepLoop {
  const SphereGround& ground;
  StepConstants c;
  SphereStep& step;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const float *nx = ground.nx.data(), *ny = ground.ny.data(), *nz = ground.nz.data();
    const Row* start = step.p.data();
    const float* gap = step.gap.data();
    const std::int32_t* plane = step.plane.data();
    const std::uint8_t* on_ground = step.on_ground.data();
    Row* added = step.a.data();
    const float per_time = 1.0f / c.time, seen = c.hulls ? 1.0f : 0.0f;
#pragma GCC ivdep
    for (std::int64_t i = begin; i < end; ++i) {
      const int p = OnePlane ? 0 : int(plane[i]), state = on_ground[i];
      const float touching = start[i].w;
      const bool lies = (state >= int(kLies)) & (state <= int(kSettles)) & (touching > 0.0f);
      const F3 v{start[i].x + seen * added[i].x, start[i].y + seen * added[i].y,
                 start[i].z + seen * added[i].z};
      const F3 u = velocity_of<OnePlane>(ground, p);
      const float speed = (v.x - u.x) * nx[p] + (v.y - u.y) * ny[p] + (v.z - u.z) * nz[p],
                  shut = least(0.0f, -gap[i] * per_time), before = added[i].w;
      const float raised = most(0.0f, before + (shut - speed)), after = choose(lies, raised, before),
                  change = after - before;
      added[i].x += change * nx[p], added[i].y += change * ny[p], added[i].z += change * nz[p],
          added[i].w = after;
    }
  }
};

template <bool OneKind, bool OnePlane>
struct LieLoop {
  Spheres& spheres;
  const SphereKinds& kinds;
  const SphereGround& ground;
  StepConstants c;
  SphereStep& step;

  static constexpr std::int64_t kBlock = 64;

  // By blocks, with integers in place of bytes: with those a vector instruction takes more bodies at a time
  // than there often are.
  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    auto* motion = reinterpret_cast<std::uint8_t*>(spheres.motion.data());
    SmallNumbers own;
    for (std::int64_t at = begin; at < end; at += kBlock) {
      const std::int64_t count = std::min(kBlock, end - at);
      for (std::int64_t i = 0; i < count; ++i) {
        own.motion[i] = motion[at + i], own.pose[i] = spheres.pose[std::size_t(at + i)];
        own.kind[i] = std::int32_t(spheres.kind[std::size_t(at + i)]);
        own.plane[i] = step.plane[std::size_t(at + i)],
        own.on_ground[i] = step.on_ground[std::size_t(at + i)];
        own.flush[i] = step.flush[std::size_t(at + i)];
      }
      lie(own, at, count);
      for (std::int64_t i = 0; i < count; ++i) motion[at + i] = std::uint8_t(own.motion[i]);
    }
  }

 private:
  struct SmallNumbers {
    std::int32_t motion[kBlock], pose[kBlock], kind[kBlock], plane[kBlock], on_ground[kBlock], flush[kBlock];
  };

  LODESTONE_INLINE void lie(SmallNumbers& numbers, std::int64_t begin, std::int64_t count) const {
    const float *qw = spheres.qw.data() + begin, *qx = spheres.qx.data() + begin,
                *qy = spheres.qy.data() + begin, *qz = spheres.qz.data() + begin,
                *radius = spheres.radius.data() + begin;
    const double *lx = spheres.lx.data() + begin, *ly = spheres.ly.data() + begin,
                 *lz = spheres.lz.data() + begin;
    float* held = spheres.held.data() + begin;
    const double* inverse_mass = spheres.inverse_mass.data() + begin;
    const std::int32_t *kind = numbers.kind, *pose = numbers.pose, *plane = numbers.plane,
                       *on_ground = numbers.on_ground, *flush = numbers.flush;
    std::int32_t* motion = numbers.motion;
    const float *size = kinds.radius.data(), *blend_time = kinds.blend_time.data();
    const float *pose_x = kinds.pose_x.data(), *pose_y = kinds.pose_y.data(), *pose_z = kinds.pose_z.data();
    const std::int32_t* first_pose = kinds.first_pose.data();
    const Tensors soft{kinds.ixx.data(), kinds.iyy.data(), kinds.izz.data(),
                       kinds.ixy.data(), kinds.ixz.data(), kinds.iyz.data()};
    const Tensors hard{kinds.jxx.data(), kinds.jyy.data(), kinds.jzz.data(),
                       kinds.jxy.data(), kinds.jxz.data(), kinds.jyz.data()};
    const float *nx = ground.nx.data(), *ny = ground.ny.data(), *nz = ground.nz.data(),
                *slope = ground.slope.data(), *friction = ground.friction.data();
    const std::int32_t* row = ground.row.data();
    const int kind_count = int(ground.kinds);
    const float least_load = kLeastLoad * c.gravity * c.time;  // m/s
    const Row* begun = step.p.data() + begin;
    const float* gap = step.gap.data() + begin;
    Row *a = step.a.data() + begin, *s = step.s.data() + begin, *d = step.d.data() + begin;
#pragma GCC ivdep
    for (std::int64_t i = 0; i < count; ++i) {
      const int k = OneKind ? 0 : int(kind[i]), p = OnePlane ? 0 : int(plane[i]), number = pose[i],
                at = first_pose[k] + choose(number > 0, number, 0);
      const int state = on_ground[i], moves = int(motion[i]);
      const bool lies = (state >= int(kLies)) & (state <= int(kSettles)), others = begun[i].w > 0.0f;
      const F3 n{nx[p], ny[p], nz[p]}, start{begun[i].x, begun[i].y, begun[i].z},
          start_spin{float(lx[i]), float(ly[i]), float(lz[i])}, old{a[i].x, a[i].y, a[i].z},
          old_turn{s[i].x, s[i].y, s[i].z};
      const F3 out{d[i].x, d[i].y, d[i].z};
      const Turn q{qw[i], {qx[i], qy[i], qz[i]}};
      const float r = radius[i], above = gap[i], given_speed = a[i].w, moving = s[i].w, lifted = d[i].w,
                  big = size[k];
      const F3 solved = start + old;
      const F3 u = velocity_of<OnePlane>(ground, p);
      F3 v = solved - choose(others, 0.0f, dot(solved - u, n)) * n, spin = start_spin + old_turn;

      // Under the resting conditions the spin is that of the turn into the rest pose; its energy comes from
      // what the body still moves with. The pose's normal `up` goes to n by `angle` about up × n within the
      // blend time: `ask`, rad/s; `ask_spin` is its angular momentum over mass, m²/s, `cost` its energy,
      // J/kg. Where that exceeds the budget (energy at the start less what v keeps), it is slower by the root
      // of their ratio.
      const bool rests =
          (moves == int(Motion::settling)) & (moving <= 2.0f * c.resting_energy * c.gravity * big);
      const F3 up = turned(q, {pose_x[at], pose_y[at], pose_z[at]}), axis = cross(up, n);
      const float sine = length(axis), cosine = dot(up, n), steep = arc_tangent(sine, absolute(cosine)),
                  angle = choose(cosine < 0.0f, 3.14159265f - steep, steep);
      const float blend = most(blend_time[k], c.time);
      const F3 ask = angle / (most(sine, 1e-9f) * blend) * axis, ask_spin = in_world(hard, k, q, ask);
      const float cost = 0.5f * dot(ask, ask_spin), budget = most(0.0f, moving - 0.5f * dot(v, v));
      const float slowest = least(1.0f, 0.25f / (blend * most(length(ask), 1e-12f)));
      const float part = least(budget, cost) / most(cost, 1e-30f);  // of the energy asked for
      const float scale = choose(cost > budget, most(square_root(part), slowest), 1.0f);
      spin = choose(rests, scale * ask_spin, spin);

      // Coulomb friction of the lowest point: the impulse that ends its slip, at most μ times the normal one.
      // The patch that the body stands on, of which the sphere knows nothing, brakes pivoting about n: by
      // kFootprint R, its mean lever, times the same bound.
      const bool lies_flush = others & (flush[i] != 0),
                 on_face = (rests & (slope[p] > 0.0f)) | lies_flush;  // which does not roll
      const F3 omega = in_world(soft, k, q, spin), arm = choose(on_face, 0.0f, -r) * n,
               touching = v - u + cross(omega, arm), slip = touching - dot(touching, n) * n;
      const float speed = length(slip), available = friction[row[p] * kind_count + k] * given_speed;
      const F3 direction = 1.0f / most(speed, 1e-12f) * slip, lever = cross(arm, direction);
      const float needed = speed / (1.0f + dot(lever, in_world(soft, k, q, lever)));
      const F3 rub = -least(available, needed) * direction;
      v = v + rub;
      spin = spin + cross(arm, rub);
      // A torque about the normal turns a leaning body about other axes, too: τ changes ω·n by τ n·I⁻¹n.
      const F3 per_torque = in_world(soft, k, q, n);
      const float turning = OnePlane ? 0.0f : ground.turn.data()[p];
      const float pivot = (dot(spin, per_torque) - turning) / most(dot(n, per_torque), 1e-12f),
                  most_pivot = kFootprint * big * available;
      spin = spin - most(-most_pivot, least(pivot, most_pivot)) * n;

      const F3 change = choose(lies, v - start, old), turn = choose(lies, spin - start_spin, old_turn);
      a[i].x = change.x, a[i].y = change.y, a[i].z = change.z, a[i].w = given_speed;
      const bool slides =
          lies & lies_flush & (slope[p] > 0.0f) & (available < needed) & (given_speed > least_load);
      s[i].x = turn.x, s[i].y = turn.y, s[i].z = turn.z, s[i].w = choose(slides, kSlides, moving);
      const float at_once = kLoadAtOnce * c.pressing * c.time * (c.heaviest * float(inverse_mass[i])),
                  grown = choose(c.hulls, kLoadGrowth * held[i] + at_once, given_speed);
      held[i] = choose(lies & others, least(given_speed, grown), 0.0f);
      motion[i] = choose(lies & !rests, int(Motion::dynamic), moves);
      // The ground has the last word: among others no sinking in; alone down onto it; out of it gradually.
      const float height = above + dot(v - u, n) * c.time + dot(out, n), sunk = most(0.0f, -above),
                  alone = choose(above < 0.0f, kRise * sunk, -above),
                  among = most(0.0f, -height - (1.0f - kRise) * sunk);
      const float raise = choose(lies, choose(others, among, alone), 0.0f);
      d[i].x = out.x + raise * n.x, d[i].y = out.y + raise * n.y, d[i].z = out.z + raise * n.z,
      d[i].w = lifted + raise;
    }
  }
};

// Calls that which needs the least looking up. Each of these costs seconds of compilation: several planes
// under one kind are rare.
template <class Run>
void choose_loop(const StepConstants& constants, const SphereGround& ground, const Run& run) {
  const bool one_plane = ground.is_one_plane();
  if (constants.one_kind && one_plane)
    run.template operator()<true, true>();
  else if (one_plane)
    run.template operator()<false, true>();
  else
    run.template operator()<false, false>();
}

}  // namespace

Vec3 SphereGround::velocity(std::size_t plane) const {
  return {double(ux[plane]), double(uy[plane]), double(uz[plane])};
}

void SphereGround::clear(std::size_t kinds_now) {
  for (auto* array : {&nx, &ny, &nz, &ux, &uy, &uz, &turn, &pressure, &slope, &friction}) array->clear();
  row.clear();
  row_of_material.clear();
  any_moves = false;
  kinds = kinds_now;
}

std::int32_t SphereGround::add(const HalfSpace& plane, const MaterialTable& materials, const SphereKinds& of,
                               const Vec3& gravity, const Vec3& velocity, const Vec3& angular_velocity) {
  ux.push_back(float(velocity.x())), uy.push_back(float(velocity.y())), uz.push_back(float(velocity.z()));
  any_moves |= !velocity.isZero(0.0) || !angular_velocity.isZero(0.0);
  turn.push_back(float(angular_velocity.dot(plane.normal)));
  nx.push_back(float(plane.normal.x())), ny.push_back(float(plane.normal.y())),
      nz.push_back(float(plane.normal.z()));
  pressure.push_back(float(std::max(0.0, -gravity.dot(plane.normal))));
  slope.push_back(StepWorld{.gravity = gravity}.is_horizontal(plane) ? 0.0f : 1.0f);
  row_of_material.resize(std::max(row_of_material.size(), std::size_t(plane.material) + 1), -1);
  std::int32_t& own_row = row_of_material[std::size_t(plane.material)];
  if (own_row < 0) {
    own_row = std::int32_t(friction.size() / std::max<std::size_t>(1, kinds));
    of_material.assign(std::size_t(materials.size()), -1.0f);  // far fewer than kinds
    for (const MaterialId material : of.material) {
      float& known = of_material[std::size_t(material)];
      if (known < 0.0f) known = float(materials.law(material, plane.material).friction);
      friction.push_back(known);
    }
  }
  row.push_back(own_row);
  return std::int32_t(nx.size()) - 1;
}

void find_near_ground(const Spheres& spheres, const SphereKinds& kinds, const SphereGround& ground,
                      const HalfSpace& plane, std::int32_t number, const StepConstants& constants, Simd simd,
                      std::int64_t begin, std::int64_t end, SphereStep& step) {
  const Vec3& n = plane.normal;
  const auto run = [&]<bool Hulls>() {
    run_wide(simd,
             NearLoop<Hulls>{spheres,
                             kinds,
                             {float(n.x()), float(n.y()), float(n.z())},
                             n.x(),
                             n.y(),
                             n.z(),
                             plane.offset,
                             velocity_of<false>(ground, number),
                             ground.pressure.data(),
                             number,
                             constants,
                             step},
             begin, end);
  };
  if (constants.hulls)
    run.template operator()<true>();
  else
    run.template operator()<false>();
}

void sort_near_ground(const Spheres& spheres, const SphereKinds& kinds, const SphereGround& ground,
                      const StepConstants& constants, float bounce_velocity, Simd simd, std::int64_t begin,
                      std::int64_t end, SphereStep& step) {
  std::fill(step.d.begin() + begin, step.d.begin() + end, Row{});
  choose_loop(constants, ground, [&]<bool OneKind, bool OnePlane>() {
    run_wide(simd, SortLoop<OneKind, OnePlane>{spheres, kinds, ground, constants, bounce_velocity, step},
             begin, end);
  });
}

void sweep_ground(const SphereGround& ground, const StepConstants& constants, Simd simd, std::int64_t begin,
                  std::int64_t end, SphereStep& step) {
  if (ground.is_one_plane())
    run_wide(simd, SweepLoop<true>{ground, constants, step}, begin, end);
  else
    run_wide(simd, SweepLoop<false>{ground, constants, step}, begin, end);
}

void keep_on_ground(const SphereGround& ground, std::int64_t begin, std::int64_t end, SphereStep& step) {
  for (auto i = std::size_t(begin); i < std::size_t(end); ++i) {
    const std::uint8_t state = step.on_ground[i];
    if (state < kNear || state > kSettles || step.p[i].w <= 0.0f) continue;
    const auto p = std::size_t(step.plane[i]);
    Row& d = step.d[i];
    const float into =
        -(d.x * ground.nx[p] + d.y * ground.ny[p] + d.z * ground.nz[p]) - most(0.0f, step.gap[i]);
    if (into > 0.0f) add_to(d, into * RowLanes{ground.nx[p], ground.ny[p], ground.nz[p], 0.0f});
  }
}

void lie_on_ground(Spheres& spheres, const SphereKinds& kinds, const SphereGround& ground,
                   const StepConstants& constants, Simd simd, std::int64_t begin, std::int64_t end,
                   SphereStep& step) {
  choose_loop(constants, ground, [&]<bool OneKind, bool OnePlane>() {
    run_wide(simd, LieLoop<OneKind, OnePlane>{spheres, kinds, ground, constants, step}, begin, end);
  });
}

}  // namespace lodestone
