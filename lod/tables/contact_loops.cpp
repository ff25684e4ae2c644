#include "lod/tables/contact_loops.h"

#include <algorithm>

namespace lodestone {
namespace {

using namespace lane;

constexpr auto kChunk = std::int64_t(kContactChunk);

template <bool OneKind>
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
    [[maybe_unused]] const std::uint32_t* kind = spheres.kind.data();
    alignas(64) float bx[kChunk]{}, by[kChunk]{}, bz[kChunk]{}, ux[kChunk]{}, uy[kChunk]{}, uz[kChunk]{},
        sum[kChunk]{}, limit[kChunk]{};
    alignas(64) float nx[kChunk], ny[kChunk], nz[kChunk], gap[kChunk], closing[kChunk];
    alignas(64) std::int32_t touches[kChunk];
    std::size_t count = out.count;
    for (std::int64_t chunk = begin; chunk < end; chunk += kChunk) {
      const std::int64_t n = std::min(kChunk, end - chunk);
      for (std::int64_t i = 0; i < n; ++i) {
        const std::uint32_t a = pairs.first(chunk + i), b = pairs.second(chunk + i);
        bx[i] = float(x[a] - x[b]), by[i] = float(y[a] - y[b]), bz[i] = float(z[a] - z[b]);
        ux[i] = float(vx[a] - vx[b]), uy[i] = float(vy[a] - vy[b]), uz[i] = float(vz[a] - vz[b]);
        sum[i] = radius[a] + radius[b];
        limit[i] = touching * (OneKind ? size[0] : least(size[kind[a]], size[kind[b]]));
      }
#pragma GCC ivdep
      for (std::int64_t i = 0; i < kChunk; ++i) {
        const float distance = square_root(bx[i] * bx[i] + by[i] * by[i] + bz[i] * bz[i]),
                    between = distance - sum[i];
        const float inverse = 1.0f / most(distance, 1e-12f);
        const bool apart = distance > 1e-12f;
        const F3 normal{choose(apart, bx[i] * inverse, 0.0f), choose(apart, by[i] * inverse, 0.0f),
                        choose(apart, bz[i] * inverse, 1.0f)};
        const float speed = ux[i] * normal.x + uy[i] * normal.y + uz[i] * normal.z;
        nx[i] = normal.x, ny[i] = normal.y, nz[i] = normal.z;
        gap[i] = between, closing[i] = speed;
        touches[i] = choose(between + speed * c.time > limit[i], 0, 1);
      }
      for (std::int64_t i = 0; i < n; ++i) {  // without a branch
        out.first[count] = pairs.first(chunk + i), out.second[count] = pairs.second(chunk + i);
        out.nx[count] = nx[i], out.ny[count] = ny[i], out.nz[count] = nz[i];
        out.gap[count] = gap[i], out.closing[count] = closing[i];
        count += std::size_t(touches[i]);
      }
    }
    out.count = count;
  }
};

template <bool OneKind, bool Last, bool Eased>
struct SweepContacts {
  SweepSettings settings;
  const Spheres& spheres;
  const SphereKinds& kinds;
  StepConstants c;
  const ContactArrays& contacts;
  float* impulse;
  SphereStep& step;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    const auto awake =
        std::uint32_t(spheres.awake);  // the place of one that does not move, for those that sleep
    const std::uint32_t *first = contacts.first.data(), *second = contacts.second.data();
    const float *nx = contacts.nx.data(), *ny = contacts.ny.data(), *nz = contacts.nz.data(),
                *gap = contacts.gap.data(), *closing = contacts.closing.data();
    const float *restitution = contacts.restitution.data(), *friction = contacts.friction.data();
    float* gives = impulse;
    const Row *p = step.p.data(), *u = step.u.data();
    Row *added = step.a.data(), *turned_by = step.s.data(), *pushed = step.d.data();
    const double* inverse_mass = spheres.inverse_mass.data();
    const float *size_of = kinds.radius.data(), *radius = spheres.radius.data();
    [[maybe_unused]] const std::uint32_t* kind = spheres.kind.data();
    const float per_time = 1.0f / c.time, bounce = settings.bounce_velocity, slop = settings.contact.slop,
                push_out = settings.contact.push_out;
    [[maybe_unused]] const float parting =
        settings.contact.parting * square_root(most(1.0f, c.gravity)) * c.time;  // m over √m
    const float only_restitution = float(settings.only_law.restitution),
                only_friction = float(settings.only_law.friction);
    alignas(64) Row relative[kChunk]{}, turning[kChunk]{}, given[kChunk], torque[kChunk], out[kChunk];
    alignas(64) float size[kChunk]{}, farthest[kChunk]{};
    const std::uint8_t* eased = spheres.eased.data();
    for (std::int64_t chunk = begin; chunk < end; chunk += kChunk) {
      const std::int64_t n = std::min(kChunk, end - chunk);
      for (std::int64_t i = 0; i < n; ++i) {
        const std::uint32_t a = first[chunk + i], other = second[chunk + i], b = std::min(other, awake);
        [[maybe_unused]] const std::size_t ka = OneKind ? 0 : kind[a], kb = OneKind ? 0 : kind[other];
        // Mass splitting (Tonge, Benevolenski and Voroshilov, Mass splitting for jitter-free parallel rigid
        // body simulation, 2012): all contacts are answered at once, each by 1/n of the mass of a body that
        // has n (p.w), so that together they do not answer one approach n times. w: n_a/m_a + n_b/m_b.
        const RowLanes of_a =
            RowLanes{1.0f, 1.0f, 1.0f, float(inverse_mass[OneKind ? 0 : a])} * lanes_of(p[a]);
        const RowLanes of_b =
            RowLanes{-1.0f, -1.0f, -1.0f, float(inverse_mass[OneKind ? 0 : other])} * lanes_of(p[b]);
        relative[i] = row_of(of_a + of_b);
        if constexpr (Last)
          turning[i] = row_of(only_w(of_a) * lanes_of(u[a]) + only_w(of_b) * lanes_of(u[b]));
        if constexpr (Last && (Eased || !OneKind)) size[i] = least(size_of[ka], size_of[kb]);
        if constexpr (Last && Eased) farthest[i] = (eased[a] | eased[other]) != 0 ? parting : 1e9f;
      }
#pragma GCC ivdep
      for (std::int64_t i = 0; i < kChunk; ++i) {
        const std::int64_t at = chunk + i;
        // By components: GCC keeps these vectors in memory, and then makes no loop of vector instructions.
        const float x = nx[at], y = ny[at], z = nz[at], vx = relative[i].x, vy = relative[i].y,
                    vz = relative[i].z;
        const float speed = vx * x + vy * y + vz * z, split = 1.0f / relative[i].w, apart = gap[at],
                    nearing = closing[at], before = gives[at];
        const float e = OneKind ? only_restitution : restitution[at];
        const float shut = least(0.0f, -apart * per_time), bounced = most(-e * nearing, shut);
        const float target = choose(nearing < -bounce, bounced, shut);
        const float after = most(0.0f, before + split * (target - speed)), change = after - before;
        gives[at] = after;
        float ix = change * x, iy = change * y, iz = change * z;
        if constexpr (Last) {
          // Friction on the slip of the touching points, with the inertia under which it changes most.
          const float tx = turning[i].x, ty = turning[i].y, tz = turning[i].z;
          const float slip_x = vx - speed * x - (ty * z - tz * y),
                      slip_y = vy - speed * y - (tz * x - tx * z),
                      slip_z = vz - speed * z - (tx * y - ty * x);
          const float slipping = square_root(slip_x * slip_x + slip_y * slip_y + slip_z * slip_z) + 1e-12f;
          const float rub =
              least((OneKind ? only_friction : friction[at]) * after / slipping, 1.0f / turning[i].w);
          const float fx = -rub * slip_x, fy = -rub * slip_y, fz = -rub * slip_z;
          ix += fx, iy += fy, iz += fz;
          torque[i].x = fy * z - fz * y, torque[i].y = fz * x - fx * z, torque[i].z = fx * y - fy * x,
          torque[i].w = 0.0f;  // over the radius
          out[i].x = x, out[i].y = y, out[i].z = z;
          const float overlap = most(0.0f, -apart - slop * (OneKind ? size_of[0] : size[i])) * push_out;
          out[i].w = (Eased ? least(overlap, farthest[i] * square_root(size[i])) : overlap) * split;
        }
        given[i].x = ix, given[i].y = iy, given[i].z = iz, given[i].w = 0.0f;
      }
      for (std::int64_t i = 0; i < n; ++i) {
        const std::uint32_t a = first[chunk + i], other = second[chunk + i], b = std::min(other, awake);
        const auto wa = float(inverse_mass[OneKind ? 0 : a]), wb = float(inverse_mass[OneKind ? 0 : other]);
        const RowLanes sum = lanes_of(given[i]);
        add_to(added[a], wa * sum);
        add_to(added[b], -wb * sum);
        if constexpr (Last) {
          const RowLanes turns = lanes_of(torque[i]), pushes = lanes_of(out[i]);
          add_to(turned_by[a], (radius[a] * wa) * turns);
          add_to(turned_by[b], (radius[other] * wb) * turns);
          add_to(pushed[a], (out[i].w * wa) * pushes);
          add_to(pushed[b], (-out[i].w * wb) * pushes);
        }
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
  if (constants.one_kind)
    run_wide(simd, TouchLoop<true>{pairs, spheres, kinds, constants, touching, contacts}, 0, pairs.size());
  else
    run_wide(simd, TouchLoop<false>{pairs, spheres, kinds, constants, touching, contacts}, 0, pairs.size());
  return {&contacts, begin, contacts.count};
}

void sweep_contacts(const SweepSettings& settings, const Spheres& spheres, const SphereKinds& kinds,
                    const StepConstants& constants, Simd simd, const ContactRun& contacts, SphereStep& step) {
  const auto run = [&]<bool OneKind, bool Last, bool Eased>() {
    run_wide(simd,
             SweepContacts<OneKind, Last, Eased>{settings, spheres, kinds, constants, *contacts.arrays,
                                                 contacts.arrays->impulse.data(), step},
             std::int64_t(contacts.begin), std::int64_t(contacts.end));
  };
  const auto run_last = [&]<bool OneKind>() {
    settings.eased ? run.template operator()<OneKind, true, true>()
                   : run.template operator()<OneKind, true, false>();
  };
  if (constants.one_kind && settings.last)
    run_last.template operator()<true>();
  else if (constants.one_kind)
    run.template operator()<true, false, false>();
  else if (settings.last)
    run_last.template operator()<false>();
  else
    run.template operator()<false, false, false>();
}

}  // namespace lodestone
