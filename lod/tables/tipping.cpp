#include "lod/tables/tipping.h"

namespace lodestone {
namespace {

using namespace lane;

// Of torques over those that the impulses could have at most: what friction in the touching faces and edges
// holds, so that heaps come to rest.
constexpr float kHeldTorque = 0.15f;
constexpr float kTippingRate = 2.0f;  // √(g/R), of what is pressed at its end
// rad a step, of what is pressed at its end: in kPatchAngle its torque is gone where a face comes to lie; by
// half as much again it comes there sooner, and does not go to and fro.
constexpr float kFlush = 1.5f * kPatchAngle;
// Tipping does work: its torque, over its weight, times its angle, m. That must come from its fall, so that a
// heap does not work for ever against what holds it, but for a credit, which a fall through the air gives
// anew (SphereKinds::tipping_work). What sinks more slowly than kCreep √(gR) creeps, and has nothing of it.
constexpr float kCreep = 0.03f;
// Over √(gR), of a fall through the air: slower sinks what was lifted out of another, and gains no more than
// that.
constexpr float kFalls = 0.2f;
// Variance over the squared radius: of where two corners touch.
constexpr float kSharpest = 1e-5f;

Turn turn_of(const Spheres& spheres, std::size_t i) {
  return {spheres.qw[i], {spheres.qx[i], spheres.qy[i], spheres.qz[i]}};
}

// The farthest points of a body in a direction: their mean, from its centre, and their spread in the plane of
// two directions beside that one.
struct TurnedPatch {
  F3 mean;
  float uu, vv, uv;
};

// Two directions at right angles to a normal and to each other.
struct BesideNormal {
  explicit BesideNormal(F3 n) {
    const F3 aside = absolute(n.x) < 0.6f ? F3{1.0f, 0.0f, 0.0f} : F3{0.0f, 1.0f, 0.0f},
             along = cross(n, aside);
    u = (1.0f / length(along)) * along, v = cross(n, u);
  }
  F3 u, v;
};

SupportPatch patch_of(const SphereKinds& kinds, int kind, const Turn& turn, F3 direction) {
  return read_patch(kinds.patch.data() + std::size_t(kind) * std::size_t(kHullHeights),
                    place_in_map(turned(back(turn), direction)));
}

TurnedPatch find_patch(const SphereKinds& kinds, int kind, const Turn& turn, F3 direction,
                       const BesideNormal& beside) {
  const SupportPatch patch = patch_of(kinds, kind, turn, direction);
  const F3 own_u = turned(back(turn), beside.u), own_v = turned(back(turn), beside.v);
  return {turned(turn, patch.mean), patch.spread(own_u, own_u), patch.spread(own_v, own_v),
          patch.spread(own_u, own_v)};
}

// Of a point, (x, y) from a patch's mean in the two directions beside its normal, how far that is, in
// standard deviations of the patch, squared.
float squared_distance(const TurnedPatch& patch, float x, float y, float sharpest) {
  const float uu = patch.uu + sharpest, vv = patch.vv + sharpest;
  return (vv * x * x - 2.0f * patch.uv * x * y + uu * y * y) / (uu * vv - patch.uv * patch.uv);
}

// Of the lever of what presses on a body, what is left of it where pressure goes within the patch towards the
// centre of mass, at most `reach` standard deviations; the centre is `squared` from the patch's mean.
float share_of_lever(float squared, float reach) {
  return squared > reach * reach ? 1.0f - reach / square_root(squared) : 0.0f;
}

float variance_of_corners(float radius) { return kSharpest * radius * radius; }

// Where two hulls touch, from the centre of the first: the means of both, `between` apart from first to
// second, each weighted by the inverse of its spread, beside the normal.
F3 join_patches(const TurnedPatch& first, const TurnedPatch& second, F3 between, const BesideNormal& beside,
                float sharpest) {
  const auto [u, v] = beside;
  const float x = dot(between, u), y = dot(between, v);
  const float uu = first.uu + second.uu + sharpest, vv = first.vv + second.vv + sharpest,
              uv = first.uv + second.uv, scale = 1.0f / (uu * vv - uv * uv);
  const float by_u = scale * (vv * x - uv * y), by_v = scale * (uu * y - uv * x), half = 0.5f * sharpest;
  return first.mean + ((first.uu + half) * by_u + first.uv * by_v) * u +
         (first.uv * by_u + (first.vv + half) * by_v) * v;
}

Tensors ends_of(const SphereKinds& k) {
  return {k.gxx.data(), k.gyy.data(), k.gzz.data(), k.gxy.data(), k.gxz.data(), k.gyz.data()};
}

// m, in this step.
float fall_of(const Spheres& spheres, const SphereStep& step, const StepConstants& c, std::size_t i) {
  const Row& out = step.d[i];
  const F3 way{float(spheres.vx[i]) * c.time + out.x, float(spheres.vy[i]) * c.time + out.y,
               float(spheres.vz[i]) * c.time + out.z};
  return dot(way, {c.gx, c.gy, c.gz}) / most(c.gravity, 1e-9f);
}

float creep_of(const SphereKinds& kinds, const StepConstants& c, std::size_t kind) {
  return kCreep * square_root(c.gravity * kinds.radius[kind]) * c.time;
}

// Over the mass: of all that presses on a body.
struct PressingLoad {
  F3 torque;       // m²/s
  float impulses;  // m/s
};
PressingLoad load_of(const Spheres& spheres, const SphereKinds& kinds, const SphereGround& ground,
                     const SphereStep& step, const TippingStep& tipping, std::size_t i, const Turn& turn) {
  const Row& others = tipping.torque[i];
  PressingLoad load{{others.x, others.y, others.z}, others.w};
  const std::uint8_t state = step.on_ground[i];
  const bool lies = state == std::uint8_t(GroundState::lies) || state == std::uint8_t(GroundState::settles);
  if (!lies || spheres.held[i] <= 0.0f) return load;
  const auto plane = std::size_t(step.plane[i]);
  const F3 n{ground.nx[plane], ground.ny[plane], ground.nz[plane]};
  const auto kind = std::size_t(spheres.kind[i]);
  const BesideNormal beside(n);
  const TurnedPatch patch = find_patch(kinds, int(kind), turn, -1.0f * n, beside);
  const float squared = squared_distance(patch, dot(patch.mean, beside.u), dot(patch.mean, beside.v),
                                         variance_of_corners(kinds.radius[kind]));
  load.torque =
      load.torque + spheres.held[i] * share_of_lever(squared, kinds.patch_reach[kind]) * cross(patch.mean, n);
  load.impulses += spheres.held[i];
  return load;
}

// 0 to 1.
float credit_of(const Spheres& spheres, std::size_t i) {
  return float(spheres.tipping_credit[i]) / float(kWholeCredit);
}

void set_credit(Spheres& spheres, std::size_t i, float credit) {
  const float within = most(0.0f, least(1.0f, credit));
  spheres.tipping_credit[i] = std::uint16_t(within * float(kWholeCredit) + 0.5f);
}

// Its spin turns with it: so its energy stays, where its inertia differs from axis to axis.
void turn_body(Spheres& spheres, std::size_t i, const Turn& by) {
  const Turn to = product(by, turn_of(spheres, i));
  const float scale = 1.5f - 0.5f * (to.w * to.w + dot(to.v, to.v));  // as in EndLoop
  spheres.qw[i] = scale * to.w, spheres.qx[i] = scale * to.v.x, spheres.qy[i] = scale * to.v.y,
  spheres.qz[i] = scale * to.v.z;
  const F3 spin = turned(by, {float(spheres.lx[i]), float(spheres.ly[i]), float(spheres.lz[i])});
  spheres.lx[i] = double(spin.x), spheres.ly[i] = double(spin.y), spheres.lz[i] = double(spin.z);
}

}  // namespace

void TippingStep::clear(std::size_t awake) {
  torque.assign(awake + 1, {});
  turned.assign(awake, 0.0f);
}

void add_torques(const ContactRun& contacts, const Spheres& spheres, const SphereKinds& kinds,
                 float bounce_velocity, TippingStep& tipping) {
  const ContactArrays& c = *contacts.arrays;
  const auto awake = std::uint32_t(spheres.awake);
  for (std::size_t i = contacts.begin; i < contacts.end; ++i) {
    const std::uint32_t a = c.first[i], b = c.second[i];
    const bool on_plane = b >= kGroundPlace;
    const int first_kind = int(spheres.kind[a]), second_kind = on_plane ? first_kind : int(spheres.kind[b]);
    if (c.impulse[i] <= 0.0f || c.closing[i] < -bounce_velocity) continue;
    if (kinds.tips[std::size_t(first_kind)] + kinds.tips[std::size_t(second_kind)] <= 0.0f) continue;
    const F3 n{c.nx[i], c.ny[i], c.nz[i]};
    const BesideNormal beside(n);
    const TurnedPatch first = find_patch(kinds, first_kind, turn_of(spheres, a), -1.0f * n, beside);
    const auto squared_from = [&](const TurnedPatch& patch, F3 arm, float sharpest) {
      return squared_distance(patch, dot(arm, beside.u), dot(arm, beside.v), sharpest);
    };
    const auto add = [&](std::uint32_t place, int kind, F3 arm, float squared, F3 normal) {
      const float lever = share_of_lever(squared, kinds.patch_reach[std::size_t(kind)]);
      const F3 torque = lever * cross(arm, normal);
      const float weight = c.impulse[i] * float(spheres.inverse_mass[place]);
      add_to(tipping.torque[place], weight * RowLanes{torque.x, torque.y, torque.z, 1.0f});
    };
    const float radius = kinds.radius[std::size_t(first_kind)];
    if (on_plane) {
      add(a, first_kind, first.mean, squared_from(first, first.mean, variance_of_corners(radius)), n);
      continue;
    }
    const TurnedPatch second = find_patch(kinds, second_kind, turn_of(spheres, b), n, beside);
    const F3 centres{float(spheres.x[b] - spheres.x[a]), float(spheres.y[b] - spheres.y[a]),
                     float(spheres.z[b] - spheres.z[a])};
    const float sharpest = variance_of_corners(least(radius, kinds.radius[std::size_t(second_kind)]));
    const F3 point = join_patches(first, second, centres + second.mean - first.mean, beside, sharpest);
    // Of what two patches have in common, as of independent measurements.
    const auto squared_from_both = [&](F3 arm) {
      return squared_from(first, arm, sharpest) + squared_from(second, arm, sharpest);
    };
    add(a, first_kind, point, squared_from_both(point), n);
    if (b < awake) add(b, second_kind, point - centres, squared_from_both(point - centres), -1.0f * n);
  }
}

void tip(Spheres& spheres, const SphereKinds& kinds, const SphereGround& ground,
         const StepConstants& constants, const SphereStep& step, std::int64_t begin, std::int64_t end,
         TippingStep& tipping) {
  if (constants.gravity <= 0.0f) return;  // nothing falls
  for (std::int64_t at = begin; at < end; ++at) {
    const auto i = std::size_t(at);
    const auto kind = std::size_t(spheres.kind[i]);
    if (kinds.tips[kind] <= 0.0f) continue;
    if (!step.touches(at)) {
      const float sinks = most(0.0f, fall_of(spheres, step, constants, i)),
                  falls = kFalls * square_root(constants.gravity * kinds.radius[kind]) * constants.time;
      set_credit(spheres, i, sinks > falls ? 1.0f : credit_of(spheres, i) + sinks / kinds.tipping_work[kind]);
      continue;
    }
    if (step.on_ground[i] == std::uint8_t(GroundState::moved)) continue;
    const float whole = kinds.tipping_work[kind];
    const float fallen = fall_of(spheres, step, constants, i) - creep_of(kinds, constants, kind);
    set_credit(spheres, i, credit_of(spheres, i) + fallen / whole);
    const float credit = credit_of(spheres, i);
    const Turn turn = turn_of(spheres, i);
    const PressingLoad load = load_of(spheres, kinds, ground, step, tipping, i, turn);
    // Over what the impulses would do at the ends of the body: at most about 1.
    const float pressed = most(load.impulses, constants.gravity * constants.time);
    const F3 given = in_world(ends_of(kinds), int(kind), turn, (1.0f / pressed) * load.torque);
    const float size = length(given), beyond = least(1.0f, size - kHeldTorque);
    if (beyond <= 0.0f || credit <= 0.0f) continue;
    // No end goes farther in a step than the hull is thick: it would be through what it strikes.
    const float rate = kTippingRate * square_root(constants.gravity / kinds.radius[kind]) * constants.time,
                willing = kinds.tips[kind] * least(beyond * least(rate, kFlush), kinds.thickness[kind]),
                work = length(load.torque) / pressed;  // m a rad
    const float angle = least(willing, credit * whole / work);
    set_credit(spheres, i, credit - angle * work / whole);
    turn_body(spheres, i, turn_by((angle / size) * given, 1.0f));
    tipping.turned[i] = angle;
  }
}

}  // namespace lodestone
