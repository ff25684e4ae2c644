#include "lod/tables/hulls_on_ground.h"

#include <algorithm>

#include "lod/contact/hull_contacts.h"

namespace lodestone {
namespace {

constexpr double kSunk = 0.01;  // over R

// Contact steps fewer and longer than those of `support`.
SupportSettings coarse_steps(bool energy_bounded) {
  return {.coarse = true,
          .contact_step = 0.1,
          .step_at_once = 0.2,
          .solver = {.sweeps = 4, .tolerance = 1e-2},
          .energy_bounded = energy_bounded,
          .impact_tolerance = 2e-4};
}

bool is_sunk(const StatisticalBody& body, const Shape& shape, std::span<const HalfSpace> planes) {
  return std::ranges::any_of(planes, [&](const HalfSpace& p) {
    const double height = p.height_of(body.position);
    if (height > shape.radius) return false;
    std::int32_t hint = body.support_hint;
    return find_lowest_point(shape, body.orientation, p.normal, height, hint).gap < -kSunk * shape.radius;
  });
}

}  // namespace

// Where the ground's parts are planes to that, here.
bool HullsOnGround::stands_when_alone(std::int64_t place) const {
  return scene_.is_alone(place) && near_ground_.is_even(place);
}

// Where they are none, as a guest.
bool HullsOnGround::is_at_edge(std::int64_t place) const {
  return scene_.is_alone(place) && !near_ground_.is_even(place);
}

void HullsOnGround::choose(std::int64_t begin, std::int64_t end) {
  constexpr auto kFree = std::uint8_t(GroundState::free), kNear = std::uint8_t(GroundState::near);
  constexpr auto kWithin = std::uint8_t(GroundState::within);
  for (auto i = std::size_t(begin); i < std::size_t(end); ++i) {
    std::uint8_t& state = step_.on_ground[i];
    const bool hops = state == kFree && spheres_.clip[i] >= 0;  // and goes on in its clip
    if ((state == kWithin || state == kNear || hops) && !step_.touches(std::int64_t(i)) &&
        stands_when_alone(std::int64_t(i))) {
      state = std::uint8_t(GroundState::stands);
    } else {
      if (!is_at_edge(std::int64_t(i)) || step_.touches(std::int64_t(i)))
        spheres_.on_hull[i] = HullStand::none;
      if (state == kWithin) state = kFree;
    }
  }
}

bool HullsOnGround::lies_at_clips_end(std::int64_t place) const {
  const SphereClips::Playing* playing = clips_.of(place);
  if (!playing || step_.on_ground[std::size_t(place)] != std::uint8_t(GroundState::stands)) return false;
  const HalfSpace& ground = playing->playback.ground;
  return playing->state == SphereClips::Playing::over &&
         std::ranges::any_of(ground_.planes(), [&](const HalfSpace& p) {
           return p.normal == ground.normal && p.offset == ground.offset;
         });
}

void HullsOnGround::become_sphere(std::int64_t place, StatisticalBody& body) {
  spheres_.on_hull[std::size_t(place)] = HullStand::none;
  SphereClips::Playing* playing = clips_.of(place);
  if (!playing) return;
  playing->state = SphereClips::Playing::ended;
  body.motion = Motion::dynamic;
}

const HullMotionSettings& HullsOnGround::motion_settings(const StatisticalBody& body, const BodyKind& kind,
                                                         const StepWorld& around) const {
  // Bounded, in so long steps a bunny would lie down where it rocks.
  static const SupportSettings coarse = coarse_steps(false);
  // Clips are joined sooner than at `support`, by what is farther from them: they are what is cheap, single
  // drops score the same, and what the body is turned by meanwhile is not seen from where this rung is. Not
  // of lively materials: how often these bounce on hangs on all that was before.
  constexpr double kLively = 0.65;  // restitution
  static const HullMotionSettings level{
      .support = coarse,
      .clips = {.energy_limit = .8, .distance_over_energy = 1.2f, .greatest_distance = .5f}};
  static const HullMotionSettings lively{.support = coarse};
  static const HullMotionSettings fine{.support = SupportSettings::of_tables()};
  const double farthest = 1.01 * kind.shape->radius + body.velocity.norm() * constants_.wide_time;  // m
  const bool is_level = std::ranges::all_of(around.planes, [&](const HalfSpace& p) {
    return around.is_horizontal(p) || p.height_of(body.position) > farthest;
  });
  if (!is_level || scene_.is_nearly_still(body, kind, false)) return fine;
  const bool is_lively = std::ranges::any_of(
      around.planes, [&](const HalfSpace& p) { return around.law(kind, p).restitution > kLively; });
  return is_lively ? lively : level;
}

ContactTally HullsOnGround::move(std::int64_t place, StatisticalBody& body, const StepWorld& around,
                                 bool rides, std::vector<SphereClips::Playing>& joined) {
  const auto i = std::size_t(place);
  const BodyKind& kind = scene_.kind_of(place);
  const Shape& shape = *kind.shape;
  const double radius = shape.radius;
  HullStand& stand = spheres_.on_hull[i];
  if (stand != HullStand::stands)
    stand = is_sunk(body, shape, around.planes) ? HullStand::rises : HullStand::stands;
  const float eased = body.eased;
  if (stand == HullStand::rises) body.eased = std::max(eased, 1.0f);
  SphereClips::Playing* under_way = clips_.of(place);
  const bool may_settle = !rides && stand == HullStand::stands;
  if (!under_way || !may_settle)
    body.motion = Motion::dynamic;  // it may have turned into a rest pose as a sphere
  SphereClips::Playing begun{.slot = spheres_.slot[i]};
  SphereClips::Playing& playing = under_way ? *under_way : begun;
  const HullMotion moved =
      move_on_hull(body, playing.playback, kind, around, settings_.gravity, constants_.wide_time, may_settle,
                   motion_settings(body, kind, around));
  body.eased = eased;
  playing.state = !moved.plays_clip ? SphereClips::Playing::ended
                  : moved.clip_over ? SphereClips::Playing::over
                                    : SphereClips::Playing::plays;
  if (moved.plays_clip && !under_way) joined.push_back(begun);
  double height = radius;  // m
  for (const HalfSpace& p : around.planes) height = std::min(height, p.height_of(body.position));
  const bool touches = moved.plays_clip || moved.tally.touched_plane >= 0;
  if (!touches) height = std::min(height, double(body.sphere_radius));
  body.sphere_radius = float(std::max(height, least_height(shape)));
  return moved.tally;
}

ContactTally HullsOnGround::strike(std::int64_t place, StatisticalBody& body, StepWorld around) {
  static const SupportSettings coarse = coarse_steps(true);
  const auto i = std::size_t(place);
  const BodyKind& kind = scene_.kind_of(place);
  // The other planes that it meets are among its contacts.
  if (step_.touches(place) || spheres_.since_crowded[i] < kLeaningTicks)
    around.planes = {&near_ground_.plane(step_.plane[i]), 1};
  if (kind.shape->sphere_radius) {
    body.sphere_radius = scene_.ground_height(place, -around.planes[0].normal);
    return step_support_body(body, kind, around, constants_.wide_time, SupportSettings{});
  }
  body.sphere_radius = 0.0f;
  const ContactTally tally = step_support_body(body, kind, around, constants_.wide_time, coarse);
  body.sphere_radius = height_over_ground(place, body);
  return tally;
}

// From its edges a hull that was a sphere parts slowly, as from a plane.
bool HullsOnGround::overlaps_ground(const StatisticalBody& body, const BodyKind& kind) const {
  thread_local std::vector<SolidContact> contacts;
  thread_local std::vector<HalfSpace> planes;
  contacts.clear();
  planes.assign(ground_.planes().begin(), ground_.planes().end());
  find_solid_contacts(body, kind, 0, ground_, constants_.wide_time, 0.0, contacts, planes);
  const double deepest = -kSunk * kind.shape->radius;
  return is_sunk(body, *kind.shape, planes) ||
         std::ranges::any_of(contacts, [&](const SolidContact& c) { return c.contact.gap < deepest; });
}

// m, as high as it stands, for the sphere that others would meet.
float HullsOnGround::height_over_ground(std::int64_t place, const StatisticalBody& body) const {
  const double radius = scene_.kind_of(place).shape->radius;
  double height = radius;
  for (const HalfSpace& plane : near_ground_.planes_of(place))
    height = std::min(height, plane.height_of(body.position));
  return float(std::max(height, least_height(*scene_.kind_of(place).shape)));
}

void HullsOnGround::take_from_edge(std::int64_t place, const StatisticalBody& moved) {
  const auto i = std::size_t(place);
  HullStand& stand = spheres_.on_hull[i];
  if (stand != HullStand::stands)
    stand = overlaps_ground(moved, scene_.kind_of(place)) ? HullStand::rises : HullStand::stands;
  StatisticalBody body = moved;
  body.sphere_radius = height_over_ground(place, body);
  spheres_.put(place, body);
  spheres_.held[i] = 0.0f;
}

bool HullsOnGround::stands(std::int64_t place) const {
  if (spheres_.on_hull[std::size_t(place)] == HullStand::none || is_at_edge(place)) return true;
  return stands_firmly(spheres_.body(place), *scene_.kind_of(place).shape, near_ground_.planes_of(place));
}

}  // namespace lodestone
