// Loops without branches that compilers turn into vector instructions. Built without errno and traps of
// mathematical functions, which would prevent that and change no result.
#include "lod/tables/sphere_motion.h"

#include <algorithm>
#include <cmath>

#include "lod/tables/free_turn.h"

namespace lodestone {
namespace {

using namespace lane;

constexpr float kCalming = 4.0f;                        // 1/s
constexpr float kStopRate = 30.0f, kStopping = 0.005f;  // 1/s; J/kg over g R
constexpr float kStruck = 0.08f;                        // J/kg over g R: .6 m/s at R = .2 m
constexpr float kPressed = 0.01f;                       // of its weight: less is none
constexpr float kRolls = 0.03f;                         // lever over R about an axis: with less it just rolls
constexpr int kLying = 110;                             // ms in a row on others: no passing blow in the air

template <bool OneKind>
struct EndLoop {
  Spheres& spheres;
  const SphereKinds& kinds;
  StepConstants c;
  SphereStep& step;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    double *x = spheres.x.data(), *y = spheres.y.data(), *z = spheres.z.data();
    double *vx = spheres.vx.data(), *vy = spheres.vy.data(), *vz = spheres.vz.data(), *lx = spheres.lx.data(),
           *ly = spheres.ly.data(), *lz = spheres.lz.data();
    float *qw = spheres.qw.data(), *qx = spheres.qx.data(), *qy = spheres.qy.data(), *qz = spheres.qz.data(),
          *twice_energy = spheres.twice_energy.data();
    const std::uint32_t* kind = spheres.kind.data();
    const Tensors soft = inverse_inertias_of(kinds), levers = rolling_levers_of(kinds);
    const Row *p = step.p.data(), *a = step.a.data(), *s = step.s.data(), *d = step.d.data();
    std::uint8_t* on_ground = step.on_ground.data();
    std::uint8_t *crowded_for = spheres.crowded_for.data(), *since_crowded = spheres.since_crowded.data();
    auto* motion = reinterpret_cast<std::uint8_t*>(spheres.motion.data());
    const float *size = kinds.radius.data(), *friction = kinds.own_friction.data();
    const float rolling = c.hulls ? c.gravity * c.time : 0.0f;  // m/s over the lever
    const double calm = c.hulls ? 1.0 : double(most(0.0f, 1.0f - kCalming * c.time)),
                 stop = double(most(0.0f, 1.0f - kStopRate * c.time));
    const bool published = !c.hulls;
    const float least_energy = c.hulls ? kStopping * c.gravity : 0.0f;
    constexpr int kMoved = int(GroundState::moved), kFree = int(GroundState::free),
                  kLies = int(GroundState::lies), kSettles = int(GroundState::settles);
#pragma GCC ivdep
    for (std::int64_t i = begin; i < end; ++i) {
      const int k = OneKind ? 0 : int(kind[i]);
      const int state = on_ground[i];
      const bool here = state != kMoved, touches = p[i].w > 0.0f,
                 slides = (state >= kLies) & (state <= kSettles), flies = !touches & !slides;
      const double old_x = vx[i], old_y = vy[i], old_z = vz[i], spun_x = lx[i], spun_y = ly[i],
                   spun_z = lz[i];
      const int lonely = int(since_crowded[i]) + c.ticks, crowded = int(crowded_for[i]) + c.ticks,
                moves = int(motion[i]);
      since_crowded[i] = std::uint8_t(choose(touches, 0, choose(lonely > 255, 255, lonely)));
      // Among others and off the ground it settles no more.
      motion[i] = std::uint8_t(
          choose(touches & (moves == int(Motion::settling)) & (state == kFree), int(Motion::dynamic), moves));
      // In flight a body follows its parabola; else the velocity that its contacts left it.
      const std::int64_t flight = -std::int64_t(flies), stays = -std::int64_t(!here);
      const F3 given{p[i].x + a[i].x - (float(old_x) + c.gx * c.time),
                     p[i].y + a[i].y - (float(old_y) + c.gy * c.time),
                     p[i].z + a[i].z - (float(old_z) + c.gz * c.time)};
      const double fallen_x = old_x + c.wide_gx * c.wide_time, fallen_y = old_y + c.wide_gy * c.wide_time,
                   fallen_z = old_z + c.wide_gz * c.wide_time;
      const double solved_x = fallen_x + double(given.x), solved_y = fallen_y + double(given.y),
                   solved_z = fallen_z + double(given.z), half = 0.5 * c.wide_time;
      // On others a near-still body just stops (3.4): so do the turns of the paper's spheres, which would go
      // on for ever, and what knows its hull once it is no faster than what a few rounds of contacts leave
      // undone. A hull there resists rolling by its weight, however fast it turns, where anything
      // presses it.
      // What has just been struck is not near-still.
      const float leaves = 0.5f * float(solved_x * solved_x + solved_y * solved_y + solved_z * solved_z);
      const bool lies = touches & (crowded > kLying) & (published | (leaves < kStruck * c.gravity * size[k]));
      // What rolls as it likes rests on the ground only where that holds it. Without a turn: about any axis.
      const F3 turned_to{float(spun_x) + s[i].x, float(spun_y) + s[i].y, float(spun_z) + s[i].z};
      const float turning = most(length(turned_to), 1e-20f);
      const F3 axis = (1.0f / turning) * turned(back(Turn{qw[i], {qx[i], qy[i], qz[i]}}), turned_to);
      const float any = (1.0f - dot(axis, axis)) * (levers.xx[k] + levers.yy[k] + levers.zz[k]) / 3.0f;
      const float lever = square_root(most(0.0f, dot(axis, times(levers, k, axis)) + any));
      const bool rolls = slides & (lever <= kRolls * size[k]);
      const bool calms = lies & !rolls & (s[i].w < c.resting_energy * c.gravity * size[k]);
      const bool stops = lies & !rolls & (s[i].w < least_energy * size[k]);
      crowded_for[i] = std::uint8_t(choose(touches, choose(crowded > 255, 255, crowded), 0));
      // By friction at most: what is struck on ice goes on.
      const float slowed = choose(
          published, 1.0f, friction[k] * c.gravity * c.time / most(square_root(2.0f * leaves), 1e-20f));
      const double slid = 1.0 - double(slowed);
      const double stopping =
          select(-std::int64_t(stops), select(-std::int64_t(slid > stop), slid, stop), 1.0);
      const float pressing = choose(length(given) > kPressed * rolling, rolling, 0.0f),
                  braked = most(0.0f, 1.0f - choose(touches, pressing * lever, 0.0f) / turning);
      const double kept = double(braked) * select(-std::int64_t(calms), calm, 1.0);
      const double by_x = kept * (spun_x + double(s[i].x)), by_y = kept * (spun_y + double(s[i].y)),
                   by_z = kept * (spun_z + double(s[i].z));
      // What only takes a near-still body out of an overlap is no motion.
      const F3 out{d[i].x, d[i].y, d[i].z};
      const float out_squared = most(dot(out, out), 1e-20f),
                  against = -dot(F3{float(solved_x), float(solved_y), float(solved_z)}, out) / out_squared;
      // By what drives it in at most, its weight and friction: on ice others do, and keep their momentum.
      const float driven = choose(
          published, 1e20f,
          (absolute(dot(F3{c.gx, c.gy, c.gz}, out)) + friction[k] * c.gravity * square_root(out_squared)) *
              c.time / out_squared);
      const float undone = choose(calms, least(least(most(against, 0.0f), 1.0f / c.time), driven), 0.0f);
      const double to_vx = select(flight, fallen_x, stopping * (solved_x + double(undone * out.x))),
                   to_vy = select(flight, fallen_y, stopping * (solved_y + double(undone * out.y)));
      const double to_vz = select(flight, fallen_z, stopping * (solved_z + double(undone * out.z)));
      const double way_x = select(flight, old_x + c.wide_gx * half, solved_x),
                   way_y = select(flight, old_y + c.wide_gy * half, solved_y);
      const double way_z = select(flight, old_z + c.wide_gz * half, solved_z);
      const double to_x = x[i] + select(stays, 0.0, way_x * c.wide_time + double(d[i].x)),
                   to_y = y[i] + select(stays, 0.0, way_y * c.wide_time + double(d[i].y));
      const double to_z = z[i] + select(stays, 0.0, way_z * c.wide_time + double(d[i].z));
      const double new_vx = select(stays, old_x, to_vx), new_vy = select(stays, old_y, to_vy),
                   new_vz = select(stays, old_z, to_vz);
      const double new_lx = select(stays, spun_x, by_x), new_ly = select(stays, spun_y, by_y),
                   new_lz = select(stays, spun_z, by_z);
      x[i] = to_x, y[i] = to_y, z[i] = to_z;
      vx[i] = new_vx, vy[i] = new_vy, vz[i] = new_vz;
      lx[i] = new_lx, ly[i] = new_ly, lz[i] = new_lz;
      const F3 spin{float(by_x), float(by_y), float(by_z)},
          new_v{float(new_vx), float(new_vy), float(new_vz)},
          new_spin{float(new_lx), float(new_ly), float(new_lz)};
      const Turn q{qw[i], {qx[i], qy[i], qz[i]}};
      float energy = choose(flies, twice_energy[i], 0.0f);
      const Turn to = turned_freely(soft, k, q, spin, c.time, energy);
      twice_energy[i] = energy;
      // Renormalised without a root: a Newton step.
      const float scale = 1.5f - 0.5f * (to.w * to.w + dot(to.v, to.v));
      const F3 new_q = choose(here, scale * to.v, q.v);
      qw[i] = choose(here, scale * to.w, q.w), qx[i] = new_q.x, qy[i] = new_q.y, qz[i] = new_q.z;
      constexpr float kFast = 1e6f;  // m/s, m²/s: beyond it someone looks closer
      const float sum = absolute(new_v.x) + absolute(new_v.y) + absolute(new_v.z) + absolute(new_spin.x) +
                        absolute(new_spin.y) + absolute(new_spin.z) + absolute(a[i].w) + absolute(d[i].w);
      const float far = most(absolute(float(to_x)), most(absolute(float(to_y)), absolute(float(to_z))));
      const float wrong = choose(sum < kFast, 0.0f, 1.0f) +
                          choose(absolute(scale - 1.0f) < 0.1f, 0.0f, 1.0f) +
                          choose(far + absolute(float(to_x - to_x)) < 0.999e8f, 0.0f, 1.0f);
      on_ground[i] = std::uint8_t(choose(wrong > 0.0f, int(GroundState::unsound), state));
    }
  }
};

struct TakeLoop {
  SphereStep& step;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    Row *p = step.p.data(), *a = step.a.data();
    for (std::int64_t i = begin; i < end; ++i) {
      add_to(p[i], RowLanes{1.0f, 1.0f, 1.0f, 0.0f} * lanes_of(a[i]));
      a[i] = row_of(RowLanes{0.0f, 0.0f, 0.0f, 1.0f} * lanes_of(a[i]));
    }
  }
};

}  // namespace

void SphereStep::resize(std::size_t count) {
  for (auto* rows : {&p, &u, &a, &s, &d}) rows->resize(count + 1);
  for (auto* array : {&reach, &gap}) array->resize(count);
  on_ground.resize(count), flush.resize(count), plane.resize(count);
}

std::size_t SphereStep::bytes() const {
  std::size_t bytes = 0;
  for (const auto* rows : {&p, &u, &a, &s, &d}) bytes += rows->capacity() * sizeof(Row);
  for (const auto* array : {&reach, &gap}) bytes += array->capacity() * sizeof(float);
  bytes += on_ground.capacity() + flush.capacity() + plane.capacity() * sizeof(std::int32_t);
  return bytes;
}

void clear_added(std::int64_t begin, std::int64_t end, SphereStep& step) {
  for (auto* rows : {&step.a, &step.d}) std::fill(rows->begin() + begin, rows->begin() + end, Row{});
}

void take_impulses(Simd simd, std::int64_t begin, std::int64_t end, SphereStep& step) {
  run_wide(simd, TakeLoop{step}, begin, end);
}

void end_step(Spheres& spheres, const SphereKinds& kinds, const StepConstants& constants, Simd simd,
              std::int64_t begin, std::int64_t end, SphereStep& step) {
  if (constants.one_kind)
    run_wide(simd, EndLoop<true>{spheres, kinds, constants, step}, begin, end);
  else
    run_wide(simd, EndLoop<false>{spheres, kinds, constants, step}, begin, end);
}

}  // namespace lodestone
