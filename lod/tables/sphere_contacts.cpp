#include "lod/tables/sphere_contacts.h"

#include <cmath>

namespace lodestone {
namespace {

struct V3 { float x, y, z; };
float dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
V3 cross(V3 a, V3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

}  // namespace

void SphereContacts::clear() {
  for (Part& part : parts_) part.contacts.clear();
}

std::int64_t SphereContacts::count() const {
  std::int64_t count = 0;
  for (const Part& part : parts_) count += std::int64_t(part.contacts.size());
  return count;
}

float SphereContacts::known_impulse(const Spheres& spheres, std::uint32_t first, std::uint32_t second, float time) const {
  const auto look = [&](std::uint32_t at, std::uint32_t other) {
    const std::uint32_t begin = spheres.known_begin[at], end = begin + spheres.known_count[at];
    for (std::uint32_t i = begin; i < end; ++i)
      if (known_[i].owner == spheres.owner[other]) return known_[i].force * time;
    return 0.0f;
  };
  const float impulse = look(first, second);
  return impulse != 0.0f || std::int64_t(second) >= spheres.awake ? impulse : look(second, first);
}

void SphereContacts::add_to(Part& part, const Spheres& s, const SphereKinds& kinds, std::uint32_t first, std::uint32_t second,
                            const StepConstants& constants) const {
  const V3 between{float(s.x[first] - s.x[second]), float(s.y[first] - s.y[second]), float(s.z[first] - s.z[second])};
  const V3 velocity{float(s.vx[first] - s.vx[second]), float(s.vy[first] - s.vy[second]), float(s.vz[first] - s.vz[second])};
  const float square = dot(between, between), sum = s.radius[first] + s.radius[second];
  const float touching = settings_.touching * std::min(kinds.radius[s.kind[first]], kinds.radius[s.kind[second]]);
  const float distance = std::sqrt(square), gap = distance - sum;
  const float inverse = 1.0f / std::max(distance, 1e-12f);
  const V3 normal = distance > 1e-12f ? V3{between.x * inverse, between.y * inverse, between.z * inverse} : V3{0.0f, 0.0f, 1.0f};
  const float closing = dot(velocity, normal);
  if (gap + closing * constants.time > touching) return;
  part.contacts.push_back({first, second, normal.x, normal.y, normal.z, gap, closing, known_.empty() ? 0.0f : known_impulse(s, first, second, constants.time)});
}

void SphereContacts::find(const Spheres& spheres, const SphereKinds& kinds, const CellGrid& grid, const StepConstants& constants, const JobRunner& jobs) {
  used_parts_ = std::size_t(grid.parts()) + 1;
  if (parts_.size() < used_parts_) parts_.resize(used_parts_);
  clear();
  for (auto& colour : of_colour_) colour.clear();
  for (std::size_t i = 0; i < used_parts_; ++i) {
    parts_[i].colour = i + 1 < used_parts_ ? grid.colour_of(std::int64_t(i)) : CellGrid::kColours;
    of_colour_[std::size_t(parts_[i].colour)].push_back(std::uint32_t(i));
  }
  jobs(grid.parts(), TaskRef([&](std::int64_t i) {
    Part& part = parts_[std::size_t(i)];
    grid.find_pairs(i, [&](std::uint32_t first, std::uint32_t second) { add_to(part, spheres, kinds, first, second, constants); });
  }));
}

void SphereContacts::add(const Spheres& spheres, const SphereKinds& kinds, std::uint32_t first, std::uint32_t second, const StepConstants& constants) {
  add_to(parts_[used_parts_ - 1], spheres, kinds, first, second, constants);
}

template <class Task>
void SphereContacts::run_by_colour(const JobRunner& jobs, const Task& task) {
  for (const auto& colour : of_colour_)
    if (!colour.empty()) jobs(std::int64_t(colour.size()), TaskRef([&](std::int64_t i) { task(parts_[colour[std::size_t(i)]]); }));
}

void SphereContacts::begin(const Spheres& spheres, const SphereKinds& kinds, float bounce_velocity, SphereStep& step, const JobRunner& jobs) {
  const auto awake = std::uint32_t(spheres.awake);
  const auto give = [&](std::uint32_t body, const SphereContact& c, float impulse) {
    if (body >= awake) return;
    if (step.contacts[body] < 200) ++step.contacts[body];
    const float change = impulse * kinds.inverse_mass[spheres.kind[body]];
    step.px[body] += change * c.nx, step.py[body] += change * c.ny, step.pz[body] += change * c.nz;
  };
  run_by_colour(jobs, [&](Part& part) {
    for (SphereContact& c : part.contacts) {
      if (c.closing < -bounce_velocity) c.impulse = 0.0f;  // an impact is no support
      give(c.first, c, c.impulse);
      give(c.second, c, -c.impulse);
    }
  });
}

template <bool OneKind, bool Last>
void SphereContacts::sweep_part(Part& part, const Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials, float bounce_velocity,
                                const StepConstants& constants, SphereStep& step) const {
  const auto awake = std::uint32_t(spheres.awake);
  const ContactLaw only = materials.law(kinds.kinds[0].material, kinds.kinds[0].material);
  const float per_time = 1.0f / constants.time, only_w = kinds.inverse_mass[0], only_soft = kinds.softest[0];
  const float *px = step.px.data(), *py = step.py.data(), *pz = step.pz.data(), *wx = step.wx.data(), *wy = step.wy.data(), *wz = step.wz.data();
  const float* radius = spheres.radius.data();
  float *ax = step.ax.data(), *ay = step.ay.data(), *az = step.az.data(), *sx = step.sx.data(), *sy = step.sy.data(), *sz = step.sz.data();
  float *dx = step.dx.data(), *dy = step.dy.data(), *dz = step.dz.data();
  const std::uint8_t* contacts = step.contacts.data();
  for (SphereContact& c : part.contacts) {
    const std::uint32_t a = c.first, b = c.second;
    const std::size_t ka = OneKind ? 0 : spheres.kind[a], kb = OneKind ? 0 : spheres.kind[b];
    const bool moves = b < awake;
    const V3 n{c.nx, c.ny, c.nz};
    const float wa = OneKind ? only_w : kinds.inverse_mass[ka], wb = moves ? OneKind ? only_w : kinds.inverse_mass[kb] : 0.0f;
    const float share_a = float(contacts[a]) * wa, share_b = moves ? float(contacts[b]) * wb : 0.0f;
    V3 relative{px[a], py[a], pz[a]};
    if (moves) relative = {relative.x - px[b], relative.y - py[b], relative.z - pz[b]};
    const float speed = dot(relative, n), split = 1.0f / (share_a + share_b);
    const ContactLaw law = OneKind ? only : materials.law(kinds.kinds[ka].material, kinds.kinds[kb].material);
    const float shut = std::min(0.0f, -c.gap * per_time);
    const float target = c.closing < -bounce_velocity ? std::max(-float(law.restitution) * c.closing, shut) : shut;
    const float before = c.impulse, after = std::max(0.0f, before + split * (target - speed)), change = after - before;
    c.impulse = after;
    V3 impulse{change * n.x, change * n.y, change * n.z};
    if constexpr (Last) {
      // Friction on the slip of the touching points, with the inertia under which it changes most.
      const float ra = radius[a], rb = moves ? radius[b] : 0.0f, soft_a = OneKind ? only_soft : kinds.softest[ka], soft_b = OneKind ? only_soft : kinds.softest[kb];
      V3 turning{ra * wx[a], ra * wy[a], ra * wz[a]};
      if (moves) turning = {turning.x + rb * wx[b], turning.y + rb * wy[b], turning.z + rb * wz[b]};
      const V3 rolling = cross(turning, n);
      const V3 slip{relative.x - speed * n.x - rolling.x, relative.y - speed * n.y - rolling.y, relative.z - speed * n.z - rolling.z};
      const float slipping = std::sqrt(dot(slip, slip)) + 1e-12f;
      const float ease = share_a * (1.0f + ra * ra * soft_a) + share_b * (1.0f + rb * rb * soft_b);
      const float rub = std::min(float(law.friction) * after / slipping, 1.0f / ease);
      const V3 friction{-rub * slip.x, -rub * slip.y, -rub * slip.z};
      impulse = {impulse.x + friction.x, impulse.y + friction.y, impulse.z + friction.z};
      const V3 torque = cross(friction, n);  // over the radius
      const float size = OneKind ? kinds.radius[0] : std::min(kinds.radius[ka], kinds.radius[kb]);
      const float out = std::max(0.0f, -c.gap - settings_.slop * size) * settings_.push_out * split;
      dx[a] += out * wa * n.x, dy[a] += out * wa * n.y, dz[a] += out * wa * n.z;
      sx[a] += ra * wa * torque.x, sy[a] += ra * wa * torque.y, sz[a] += ra * wa * torque.z;
      if (moves) {
        dx[b] -= out * wb * n.x, dy[b] -= out * wb * n.y, dz[b] -= out * wb * n.z;
        sx[b] += rb * wb * torque.x, sy[b] += rb * wb * torque.y, sz[b] += rb * wb * torque.z;
      }
    }
    ax[a] += wa * impulse.x, ay[a] += wa * impulse.y, az[a] += wa * impulse.z;
    if (moves) ax[b] -= wb * impulse.x, ay[b] -= wb * impulse.y, az[b] -= wb * impulse.z;
  }
}

void SphereContacts::sweep(const Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials, float bounce_velocity,
                           const StepConstants& constants, bool last, SphereStep& step, const JobRunner& jobs) {
  run_by_colour(jobs, [&](Part& part) {
    if (constants.one_kind && last) sweep_part<true, true>(part, spheres, kinds, materials, bounce_velocity, constants, step);
    else if (constants.one_kind) sweep_part<true, false>(part, spheres, kinds, materials, bounce_velocity, constants, step);
    else if (last) sweep_part<false, true>(part, spheres, kinds, materials, bounce_velocity, constants, step);
    else sweep_part<false, false>(part, spheres, kinds, materials, bounce_velocity, constants, step);
  });
}

// A counting sort by the first body: its contacts may come from several parts.
void SphereContacts::remember(Spheres& spheres, float bounce_velocity, const StepConstants& constants) {
  std::fill(spheres.known_count.begin(), spheres.known_count.begin() + spheres.awake, std::uint8_t(0));
  const auto each_kept = [&](const auto& visit) {
    for (std::size_t p = 0; p < used_parts_; ++p)
      for (const SphereContact& c : parts_[p].contacts)
        if (c.impulse > 0.0f && c.closing >= -bounce_velocity) visit(c);  // a blow is no support
  };
  each_kept([&](const SphereContact& c) { spheres.known_count[c.first] += spheres.known_count[c.first] < 255; });
  std::uint32_t begin = 0;
  for (std::int64_t i = 0; i < spheres.awake; ++i) {
    spheres.known_begin[i] = begin;
    begin += spheres.known_count[i];
    spheres.known_count[i] = 0;
  }
  known_.resize(begin);
  const float per_time = 1.0f / constants.time;
  each_kept([&](const SphereContact& c) {
    if (spheres.known_count[c.first] == 255) return;
    known_[spheres.known_begin[c.first] + spheres.known_count[c.first]++] = {spheres.owner[c.second], c.impulse * per_time};
  });
}

}  // namespace lodestone
