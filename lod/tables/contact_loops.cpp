#include "lod/tables/contact_loops.h"

#include <algorithm>

#include "lod/tables/hull_separation.h"

namespace lodestone {
namespace {

using namespace lane;

constexpr auto kChunk = std::int64_t(kContactChunk);
constexpr std::int64_t kLanes = 16;

// m/s along the normal, into the first body: how fast two may close in once a third stops one of them, as
// those of a column that lands do. `speed` is that of the first against the second, `own` its own.
LODESTONE_INLINE float if_one_stops(float speed, float own) { return least(speed, least(own, speed - own)); }

// m/s: what of `speed` a pair strikes with. One that only may meet once a third stops it is held apart, and
// does not bounce before it touches.
LODESTONE_INLINE float striking_speed(float speed, float gap, float time, float touching) {
  return choose(gap + speed * time > touching, most(speed, 0.0f), speed);
}

// Squared cosine of 45°: what stands steeper beside another does not lie on it.
constexpr float kLying = 0.5f;

template <bool OneKind, bool Oriented>
struct TouchLoop {
  const BallPairs& pairs;
  const Spheres& spheres;
  const SphereKinds& kinds;
  StepConstants c;
  float touching;  // m over R
  ContactArrays& out;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const double *x = spheres.x.data(), *y = spheres.y.data(), *z = spheres.z.data(), *vx = spheres.vx.data(),
                 *vy = spheres.vy.data(), *vz = spheres.vz.data();
    const float *radius = spheres.radius.data(), *size = kinds.radius.data();
    [[maybe_unused]] const float *qw = spheres.qw.data(), *qx = spheres.qx.data(), *qy = spheres.qy.data(),
                                 *qz = spheres.qz.data(), *height = kinds.pair_height.data();
    [[maybe_unused]] const Row* face = kinds.pair_face.data();
    [[maybe_unused]] const float lying = kLying * c.gravity * c.gravity;
    [[maybe_unused]] const float* unsteady = kinds.unsteady.data();
    [[maybe_unused]] const std::uint32_t* kind = spheres.kind.data();
    alignas(64) float bx[kChunk]{}, by[kChunk]{}, bz[kChunk]{}, ux[kChunk]{}, uy[kChunk]{}, uz[kChunk]{},
        limit[kChunk]{}, first_arm[kChunk]{}, second_arm[kChunk]{};
    [[maybe_unused]] alignas(64) float first_w[kChunk]{}, first_x[kChunk]{}, first_y[kChunk]{},
        first_z[kChunk]{}, second_w[kChunk]{}, second_x[kChunk]{}, second_y[kChunk]{}, second_z[kChunk]{};
    [[maybe_unused]] alignas(64) std::int32_t first_map[kChunk]{}, second_map[kChunk]{};
    [[maybe_unused]] alignas(64) float wx[kChunk]{}, wy[kChunk]{}, wz[kChunk]{};  // m/s, of the first
    alignas(64) float nx[kChunk], ny[kChunk], nz[kChunk], gap[kChunk], closing[kChunk];
    alignas(64) std::int32_t touches[kChunk];
    [[maybe_unused]] alignas(64) float apart_by[kChunk], face_x[kChunk], face_y[kChunk], face_z[kChunk],
        face_gap[kChunk], face_closing[kChunk];
    [[maybe_unused]] alignas(64) std::int32_t face_touches[kChunk], face_flush[kChunk];
    [[maybe_unused]] const auto first_hull = [&](std::int64_t i) {
      return MappedHull{OneKind ? 0 : first_map[i], {first_w[i], {first_x[i], first_y[i], first_z[i]}}};
    };
    [[maybe_unused]] const auto second_hull = [&](std::int64_t i) {
      return MappedHull{OneKind ? 0 : second_map[i], {second_w[i], {second_x[i], second_y[i], second_z[i]}}};
    };
    [[maybe_unused]] alignas(64) std::int32_t first_face[kChunk], second_face[kChunk], kept[kChunk]{};
    std::size_t count = out.count;
    for (std::int64_t chunk = begin; chunk < end; chunk += kChunk) {
      const std::int64_t n = std::min(kChunk, end - chunk);
      for (std::int64_t i = 0; i < n; ++i) {
        const std::uint32_t a = pairs.first(chunk + i), b = pairs.second(chunk + i);
        bx[i] = float(x[a] - x[b]), by[i] = float(y[a] - y[b]), bz[i] = float(z[a] - z[b]);
        ux[i] = float(vx[a] - vx[b]), uy[i] = float(vy[a] - vy[b]), uz[i] = float(vz[a] - vz[b]);
        if constexpr (Oriented) {
          first_w[i] = qw[a], first_x[i] = qx[a], first_y[i] = qy[a], first_z[i] = qz[a];
          wx[i] = float(vx[a]), wy[i] = float(vy[a]), wz[i] = float(vz[a]);
          second_w[i] = qw[b], second_x[i] = qx[b], second_y[i] = qy[b], second_z[i] = qz[b];
          if constexpr (!OneKind)
            first_map[i] = int(kind[a]) * kHullHeights, second_map[i] = int(kind[b]) * kHullHeights;
        } else {
          first_arm[i] = radius[a], second_arm[i] = radius[b];
        }
        limit[i] = touching * (OneKind ? size[0] : least(size[kind[a]], size[kind[b]]));
      }
#pragma GCC ivdep
      for (std::int64_t i = 0; i < kChunk; ++i) {
        const float distance = square_root(bx[i] * bx[i] + by[i] * by[i] + bz[i] * bz[i]);
        const float inverse = 1.0f / most(distance, 1e-12f);
        const bool apart = distance > 1e-12f;
        const F3 normal{choose(apart, bx[i] * inverse, 0.0f), choose(apart, by[i] * inverse, 0.0f),
                        choose(apart, bz[i] * inverse, 1.0f)};
        float between = distance - first_arm[i] - second_arm[i];
        if constexpr (Oriented) {
          const LineSeparation found =
              separate_along_line(height, first_hull(i), second_hull(i), normal, distance);
          between = found.gap, apart_by[i] = distance;
          first_face[i] = found.first, second_face[i] = found.second;
        }
        const float speed = ux[i] * normal.x + uy[i] * normal.y + uz[i] * normal.z;
        nx[i] = normal.x, ny[i] = normal.y, nz[i] = normal.z;
        gap[i] = between, closing[i] = striking_speed(speed, between, c.time, limit[i]);
        float may_close = speed;
        if constexpr (Oriented)
          may_close = if_one_stops(speed, wx[i] * normal.x + wy[i] * normal.y + wz[i] * normal.z);
        touches[i] = choose(between + may_close * c.time > limit[i], 0, 1);
      }
      // What the line does not keep apart until the end of the step, a face may.
      if constexpr (Oriented) {
        std::int64_t left = 0;
        for (std::int64_t i = 0; i < n; ++i) kept[left] = std::int32_t(i), left += touches[i];
        const std::int64_t whole = (left + kLanes - 1) / kLanes * kLanes;
        const float per_gravity = -1.0f / most(c.gravity, 1e-30f);
        const F3 up{c.gx * per_gravity, c.gy * per_gravity, c.gz * per_gravity};
#pragma GCC ivdep
        for (std::int64_t k = 0; k < whole; ++k) {
          const std::int32_t i = kept[k];
          const HullSeparation found =
              separate_hulls(height, face, unsteady, first_hull(i), second_hull(i), {nx[i], ny[i], nz[i]},
                             apart_by[i], {gap[i], first_face[i], second_face[i]},
                             {up, {ux[i] * c.time, uy[i] * c.time, uz[i] * c.time}, limit[i]});
          const F3 normal = found.normal;
          const float speed = ux[i] * normal.x + uy[i] * normal.y + uz[i] * normal.z;
          const float down = dot(normal, {c.gx, c.gy, c.gz});
          const bool lies = choose(found.flush, down * down, 0.0f) > lying;
          face_x[k] = normal.x, face_y[k] = normal.y, face_z[k] = normal.z, face_gap[k] = found.gap,
          face_closing[k] = striking_speed(speed, found.gap, c.time, limit[i]),
          face_flush[k] = choose(lies, 0, kNotFlush);
          const float may_close = if_one_stops(speed, wx[i] * normal.x + wy[i] * normal.y + wz[i] * normal.z);
          face_touches[k] = choose(found.gap + may_close * c.time > limit[i], 0, 1);
        }
        for (std::int64_t k = 0; k < left; ++k) {  // without a branch
          out.first[count] = pairs.first(chunk + kept[k]), out.second[count] = pairs.second(chunk + kept[k]);
          out.nx[count] = face_x[k], out.ny[count] = face_y[k], out.nz[count] = face_z[k];
          out.gap[count] = face_gap[k], out.closing[count] = face_closing[k];
          out.flush[count] = face_flush[k];  // which one is not known yet
          count += std::size_t(face_touches[k]);
        }
        continue;
      }
      for (std::int64_t i = 0; i < n; ++i) {
        out.first[count] = pairs.first(chunk + i), out.second[count] = pairs.second(chunk + i);
        out.nx[count] = nx[i], out.ny[count] = ny[i], out.nz[count] = nz[i];
        out.gap[count] = gap[i], out.closing[count] = closing[i], out.flush[count] = kNotFlush;
        count += std::size_t(touches[i]);
      }
    }
    out.count = count;
  }
};

// Gauss and Seidel's method: a contact sees what those before it have given, and is answered by the masses of
// its two bodies. Neighbours in the run mostly share a body, so sixteen are taken at a time from as many
// places far apart in it; what two of those still share gets both of their answers.
template <bool OneKind, bool Last, bool Eased>
struct SweepContacts {
  SweepSettings settings;
  const Spheres& spheres;
  const SphereKinds& kinds;
  StepConstants c;
  ContactArrays& contacts;
  SphereStep& step;
  SweepOutcome& outcome;

  static constexpr std::int64_t kFew = 8 * kLanes;
  // Of what gravity gives in a step: what is pressed by less does not slide, whatever its friction.
  static constexpr float kLeastLoad = 0.5f;
  static constexpr float kLevel = 0.996f;  // cosine of 5°: on what is as level nothing draws a body on

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const std::int64_t stride = end - begin < kFew ? 0 : (end - begin) / kLanes,
                       beside = begin + stride * kLanes;
    for (std::int64_t i = begin; i < begin + stride; ++i) answer<kLanes>(i, stride);
    for (std::int64_t i = beside; i < end; ++i) answer<1>(i, 0);
  }

 private:
  LODESTONE_INLINE FlushContact* flush_of(std::size_t contact) const {
    const std::int32_t flush = contacts.flush[contact];
    return flush == kNotFlush ? nullptr : &contacts.flush_contacts[std::size_t(flush)];
  }
  /// Those at `at`, `at` + `stride`, …
  template <std::int64_t Lanes>
  LODESTONE_INLINE void answer(std::int64_t at, std::int64_t stride) const {
    const auto awake = std::uint32_t(spheres.awake);  // the row of what does not move: sleepers, ground
    const double* inverse_mass = spheres.inverse_mass.data();
    const float* size_of = kinds.radius.data();
    [[maybe_unused]] const float* radius = spheres.radius.data();
    [[maybe_unused]] const std::uint32_t* kind = spheres.kind.data();
    [[maybe_unused]] const std::uint8_t* eased = spheres.eased.data();
    const float per_time = 1.0f / c.time, bounce = settings.bounce_velocity;
    [[maybe_unused]] const float slop = settings.contact.slop, push_out = settings.contact.push_out;
    [[maybe_unused]] const float parting =
        settings.contact.parting * square_root(most(1.0f, c.gravity)) * c.time;  // m over √m
    [[maybe_unused]] const float least_load = kLeastLoad * c.gravity * c.time,   // m/s
        level = kLevel * kLevel * c.gravity * c.gravity;                         // m²/s⁴
    const Row *p = step.p.data(), *u = step.u.data(), *ground = settings.ground_velocities.data();
    Row *added = step.a.data(), *turned_by = step.s.data(), *pushed = step.d.data(),
        *turning_of = step.u.data();
    alignas(64) Row relative[Lanes], given[Lanes];
    alignas(64) float nx[Lanes], ny[Lanes], nz[Lanes], gap[Lanes], nearing[Lanes], gave[Lanes], e[Lanes];
    alignas(64) [[maybe_unused]] Row turning[Lanes], moved[Lanes], torque[Lanes], out[Lanes];
    alignas(64) float changed[Lanes];
    alignas(64) [[maybe_unused]] Row rubbed[Lanes];  // N s, of friction; 1 where the two roll on each other
    alignas(64) [[maybe_unused]] float friction[Lanes], size[Lanes], farthest[Lanes], deep[Lanes],
        slides[Lanes];
    const auto index = [&](std::int64_t i) { return std::size_t(at + i * stride); };
    const auto mass_of = [&](std::uint32_t place) {
      return place < awake ? float(inverse_mass[OneKind ? 0 : place]) : 0.0f;
    };
    for (std::int64_t i = 0; i < Lanes; ++i) {
      const std::size_t k = index(i);
      const std::uint32_t a = contacts.first[k], other = contacts.second[k], b = std::min(other, awake);
      const float wa = mass_of(a), wb = mass_of(b);
      nx[i] = contacts.nx[k], ny[i] = contacts.ny[k], nz[i] = contacts.nz[k];
      gap[i] = contacts.gap[k], nearing[i] = contacts.closing[k], gave[i] = contacts.impulse[k];
      e[i] = OneKind ? float(settings.only_law.restitution) : contacts.restitution[k];
      const Row& of_second = other >= kGroundPlace ? ground[other - kGroundPlace] : p[b];
      relative[i] = row_of(lanes_of(p[a]) + lanes_of(added[a]) - lanes_of(of_second) - lanes_of(added[b]));
      relative[i].w = wa + wb;
      if constexpr (Last) {
        friction[i] = OneKind ? float(settings.only_law.friction) : contacts.friction[k];
        const FlushContact* flush = flush_of(k);
        const F3 known = flush ? flush->friction : F3{};
        const float rolls = flush ? 0.0f : 1.0f;
        rubbed[i] = {known.x, known.y, known.z, rolls};
        turning[i] = row_of(rolls * (lanes_of(u[a]) + lanes_of(u[b])));
        turning[i].w = flush ? wa + wb : wa * u[a].w + wb * u[b].w;
        moved[i] = row_of(lanes_of(pushed[a]) - lanes_of(pushed[b]));
        size[i] = OneKind     ? size_of[0]
                  : b < awake ? least(size_of[kind[a]], size_of[kind[b]])
                              : size_of[kind[a]];
        if constexpr (Eased)
          farthest[i] = eased[a] != 0 || (other < kGroundPlace && eased[other] != 0)
                            ? parting * square_root(size[i])
                            : 1e9f;
      }
    }
#pragma GCC ivdep
    for (std::int64_t i = 0; i < Lanes; ++i) {
      // By components: GCC keeps vectors in memory, and then makes no loop of vector instructions.
      const float x = nx[i], y = ny[i], z = nz[i], vx = relative[i].x, vy = relative[i].y, vz = relative[i].z;
      const float speed = vx * x + vy * y + vz * z, share = 1.0f / relative[i].w, before = gave[i];
      const float shut = least(0.0f, -gap[i] * per_time), bounced = most(-e[i] * nearing[i], shut);
      const float target = choose(nearing[i] < -bounce, bounced, shut);
      const float after = most(0.0f, before + share * (target - speed)), change = after - before;
      gave[i] = after;
      changed[i] = absolute(change) * relative[i].w;
      float ix = change * x, iy = change * y, iz = change * z;
      if constexpr (Last) {
        // Friction on the slip of the touching points, with the inertia under which it changes most.
        const float tx = turning[i].x, ty = turning[i].y, tz = turning[i].z;
        // What friction is known to give is part of it, as the slip that there would be without.
        const float known_x = rubbed[i].x, known_y = rubbed[i].y, known_z = rubbed[i].z, rolls = rubbed[i].w,
                    inertia = turning[i].w;
        const float slip_x = vx - speed * x - (ty * z - tz * y) - inertia * known_x,
                    slip_y = vy - speed * y - (tz * x - tx * z) - inertia * known_y,
                    slip_z = vz - speed * z - (tx * y - ty * x) - inertia * known_z;
        const float slipping = square_root(slip_x * slip_x + slip_y * slip_y + slip_z * slip_z) + 1e-12f,
                    most_rub = friction[i] * after / slipping, held = 1.0f / inertia,
                    rub = least(most_rub, held);
        rubbed[i].x = -rub * slip_x, rubbed[i].y = -rub * slip_y, rubbed[i].z = -rub * slip_z;
        const float fx = rubbed[i].x - known_x, fy = rubbed[i].y - known_y, fz = rubbed[i].z - known_z;
        ix += fx, iy += fy, iz += fz;
        torque[i].x = rolls * (fy * z - fz * y), torque[i].y = rolls * (fz * x - fx * z),
        torque[i].z = rolls * (fx * y - fy * x), torque[i].w = 0.0f;  // over the arm
        const float down = c.gx * x + c.gy * y + c.gz * z;
        const bool slips = (most_rub < held) & (after * relative[i].w > least_load) & (down * down < level);
        slides[i] = choose(slips, (1.0f - rolls) * kSlides, 0.0f);
        // Of an overlap, what is left of it by then.
        const float overlap = -gap[i] - slop * size[i] - (moved[i].x * x + moved[i].y * y + moved[i].z * z);
        deep[i] = overlap / size[i];
        float way = push_out * most(0.0f, overlap);
        if constexpr (Eased) way = least(way, farthest[i]);
        out[i].x = x, out[i].y = y, out[i].z = z, out[i].w = way * share;
      }
      given[i].x = ix, given[i].y = iy, given[i].z = iz, given[i].w = 0.0f;
    }
    for (std::int64_t i = 0; i < Lanes; ++i) {
      const std::size_t k = index(i);
      const std::uint32_t a = contacts.first[k], b = std::min(contacts.second[k], awake);
      const float wa = mass_of(a), wb = mass_of(b);
      contacts.impulse[k] = gave[i];
      outcome.changed = most(outcome.changed, changed[i]);
      const RowLanes impulse = lanes_of(given[i]);
      add_to(added[a], wa * impulse);
      add_to(added[b], -wb * impulse);
      if constexpr (Last) {
        const RowLanes turns = lanes_of(torque[i]);
        if (FlushContact* flush = flush_of(k)) flush->friction = {rubbed[i].x, rubbed[i].y, rubbed[i].z};
        outcome.deepest = most(outcome.deepest, deep[i]);
        add_to(turned_by[a], (radius[a] * wa) * turns);
        add_to(turned_by[b], (b < awake ? radius[b] * wb : 0.0f) * turns);
        turned_by[a].w += slides[i], turned_by[b].w += slides[i];
        add_to(turning_of[a], ((u[a].w - 1.0f) * wa) * turns);  // the slip that the next contacts see
        add_to(turning_of[b], ((u[b].w - 1.0f) * wb) * turns);
        const RowLanes pushes{out[i].x, out[i].y, out[i].z, 0.0f};
        add_to(pushed[a], (out[i].w * wa) * pushes);
        add_to(pushed[b], (-out[i].w * wb) * pushes);
      }
    }
  }
};

}  // namespace

ContactRun find_touching(const BallPairs& pairs, const Spheres& spheres, const SphereKinds& kinds,
                         const StepConstants& constants, float touching, Simd simd, ContactArrays& contacts) {
  const std::size_t begin = (contacts.count + kContactChunk - 1) / kContactChunk * kContactChunk;
  contacts.count = begin;
  contacts.make_room(begin + std::size_t(pairs.size()), constants.one_kind);
  const auto run = [&]<bool OneKind, bool Oriented>() {
    run_wide(simd, TouchLoop<OneKind, Oriented>{pairs, spheres, kinds, constants, touching, contacts}, 0,
             pairs.size());
  };
  if (constants.one_kind)
    constants.hulls ? run.template operator()<true, true>() : run.template operator()<true, false>();
  else
    constants.hulls ? run.template operator()<false, true>() : run.template operator()<false, false>();
  return {&contacts, begin, contacts.count};
}

SweepOutcome sweep_contacts(const SweepSettings& settings, const Spheres& spheres, const SphereKinds& kinds,
                            const StepConstants& constants, Simd simd, const ContactRun& contacts,
                            SphereStep& step) {
  SweepOutcome outcome;
  const auto run = [&]<bool OneKind, bool Last, bool Eased>() {
    run_wide(simd,
             SweepContacts<OneKind, Last, Eased>{settings, spheres, kinds, constants, *contacts.arrays, step,
                                                 outcome},
             std::int64_t(contacts.begin), std::int64_t(contacts.end));
  };
  const auto run_last = [&]<bool OneKind>() {
    settings.eased ? run.template operator()<OneKind, true, true>()
                   : run.template operator()<OneKind, true, false>();
  };
  if (settings.one_law && settings.last)
    run_last.template operator()<true>();
  else if (settings.one_law)
    run.template operator()<true, false, false>();
  else if (settings.last)
    run_last.template operator()<false>();
  else
    run.template operator()<false, false, false>();
  return outcome;
}

void move_apart(const SphereContactSettings& settings, const Spheres& spheres, const SphereKinds& kinds,
                const ContactRun& contacts, SphereStep& step) {
  const ContactArrays& c = *contacts.arrays;
  const auto awake = std::uint32_t(spheres.awake);
  for (std::size_t k = contacts.begin; k < contacts.end; ++k) {
    const std::uint32_t a = c.first[k], other = c.second[k], b = std::min(other, awake);
    if (spheres.eased[a] != 0 || (other < kGroundPlace && spheres.eased[other] != 0)) continue;
    const float wa = float(spheres.inverse_mass[a]), wb = b < awake ? float(spheres.inverse_mass[b]) : 0.0f,
                own = kinds.radius[spheres.kind[a]],
                size = b < awake ? least(own, kinds.radius[spheres.kind[b]]) : own;
    const RowLanes normal{c.nx[k], c.ny[k], c.nz[k], 0.0f};
    const Row moved = row_of((lanes_of(step.d[a]) - lanes_of(step.d[b])) * normal);
    const float overlap = -c.gap[k] - settings.deep * size - (moved.x + moved.y + moved.z);
    if (overlap <= 0.0f) continue;
    const float way = settings.push_out * overlap / (wa + wb);
    add_to(step.d[a], way * wa * normal);
    add_to(step.d[b], -way * wb * normal);
  }
}

}  // namespace lodestone
