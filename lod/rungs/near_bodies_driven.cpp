// Of NearBodies: those that others drive so fast that they would pass bodies or ground unseen.
#include "lod/contact/free_way.h"
#include "lod/rungs/near_bodies.h"

namespace lodestone {
namespace {

// Over the inner radius: what goes less far than that passes nothing.
constexpr double kFarUnseen = 0.25;

}  // namespace

void NearBodies::note_ball(const Step& step, Participant p, double elapsed) {
  if (!p.is_statistical()) return;
  const StatisticalBody& body = step.scene.body(p);
  balls_[p.index()] =
      step.search.ball_of(body.position, body.velocity, kinds_[body.kind].shape->radius, elapsed);
}

// Finds those that others struck so hard that they may leave their balls, or their long ways, in the `left`
// seconds of the step, and pass bodies that were out of reach when near pairs were looked for.
void NearBodies::find_driven(const Step& step, double left) {
  if (pairs_.contacts().empty() || left < 1e-6 * step.dt) return;
  const Vec3 drift = step.dt * step.search.drift();  // m: how far ahead its frame is at the end
  for (const std::int32_t index : movers_) {
    const StatisticalBody& body = step.scene.bodies[std::size_t(index)];
    if (!body.crowded || body.motion == Motion::asleep) continue;
    const Shape& shape = *kinds_[body.kind].shape;
    const NearSearch::Ball& ball = balls_[std::size_t(index)];
    const BallWay way = ball.way();
    const double unseen = kFarUnseen * shape.inner_radius - shape.radius;
    const bool bound = step.search.any_passed() && way.is_long();
    const double most = unseen + (bound ? way.radius : double(ball.reach));
    const Vec3 middle = bound ? Vec3(way.middle + way.half_way) : ball.center;
    if ((body.position + left * body.velocity - drift - middle).squaredNorm() > most * most)
      driven_.push_back(Participant::statistical(std::size_t(index)));
  }
}

// Of those that touch others, before they are moved.
void NearBodies::note_places(const Step& step) {
  places_.clear();
  if (!ground_.has_parts()) return;
  for (const std::int32_t index : movers_) {
    const StatisticalBody& body = step.scene.bodies[std::size_t(index)];
    if (body.crowded && body.motion != Motion::asleep &&
        meets_solids(step.scene.world.properties_of(body.owner)))
      places_.emplace_back(index, body.position);
  }
}

// A body that others drive may not have been closing in on the ground when contacts were found, and may be
// behind it when they are found next. It stops at the ground, and strikes it in the next substep.
void NearBodies::stop_before_unseen_ground(const Step& step) {
  for (const auto& [index, from] : places_) {
    StatisticalBody& body = step.scene.bodies[std::size_t(index)];
    const Shape& shape = *kinds_[body.kind].shape;
    const Vec3 way = body.position - from;
    if (way.norm() > kFarUnseen * shape.inner_radius)
      body.position =
          from +
          find_free_way({ground_, step.scene.world.properties_of(body.owner)}, body, shape, from, way) * way;
  }
}

}  // namespace lodestone
