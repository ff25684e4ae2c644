// Of NearBodies: which sleepers wake within a step, and whom they meet then.
#include <algorithm>

#include "lod/rungs/near_bodies.h"
#include "lod/statistical/parting.h"

namespace lodestone {
namespace {

// Whether two hulls lie in each other by more than `depth`, over the lesser R. (Those that came from another
// rung may, for a while.)
bool overlap_by(const ContactScene& scene, const CrowdContact& contact, double depth) {
  const auto is_hull = [&](Participant p) {
    return !p.is_statistical() || (!scene.body(p).is_sphere() && scene.body(p).eased == 0.0f);
  };
  const double radius = std::min(scene.shape(contact.first).radius, scene.shape(contact.second).radius);
  return contact.contact.gap < -depth * radius && is_hull(contact.first) && is_hull(contact.second);
}

// Whether its caller put it where it may overlap others.
bool is_placed(const ContactScene& scene, Participant p) {
  return p.is_statistical() && scene.body(p).placed > 0.0f;
}
bool is_placed(const ContactScene& scene, const CrowdContact& c) {
  return is_placed(scene, c.first) || is_placed(scene, c.second);
}

// Whether it came from another rung with overlaps, which it would keep for good where all around it sleep.
bool is_parting(const ContactScene& scene, Participant p) {
  return p.is_statistical() && !scene.asleep(p) && !scene.body(p).is_sphere() &&
         scene.body(p).eased == kEasedTime && scene.body(p).quiet_time == 0.0f;
}

}  // namespace

void NearBodies::keep_awake(const Step& step, Participant p) {
  if (p.is_full()) {
    step.scene.neighbor(p).carried = true;
    return;
  }
  step.scene.body(p).quiet_time = 0.0f;
  if (step.support.is_guest(std::int32_t(p.index())))
    step.guests[p.index() - std::size_t(step.support.size())].carried = true;
}

void NearBodies::wake(const Step& step, Participant p, Pace pace) {
  woken_.push_back(p);
  if (p.is_full()) {
    step.scene.neighbor(p).asleep = false;
    return;
  }
  step.support.wake(int(p.index()));
  pairs_.clear_turning(p);
  near_.set_pace(p, pace);
}

// Who sleeps wakes where what carries it moves, where something that is fast enough touches it or strikes it
// through others, and where it and another have to part.
void NearBodies::wake_touched(const Step& step, Pace pace) {
  const ContactScene& scene = step.scene;
  woken_.clear();
  carried_.find(scene, pairs_.contacts(), solids_.contacts(), step.full_contacts);
  find_inside(scene);
  for (const CrowdContact& c : pairs_.contacts())
    for (const auto& [touched, other] : {std::pair{c.first, c.second}, std::pair{c.second, c.first}}) {
      const bool is_carried = carried_.contains(touched),
                 stays_awake = is_carried || is_parting(scene, other);
      if (stays_awake) keep_awake(step, touched);
      if (is_carried && touched.is_statistical()) scene.body(touched).carried = true;
      if (!scene.asleep(touched)) continue;
      Vec3 velocity = pairs_.point_velocity(scene, other, c.contact.manifold.points[0].point);
      if (other.is_statistical()) velocity += step.dt * scene.pushed(other);  // as it will be
      const double speed = velocity.norm();
      if (stays_awake || speed > rest_law_.wake_speed(scene.shape(touched).radius) || are_to_part(scene, c))
        wake(step, touched, pace);
    }
  blows_.find(scene, pairs_, rest_law_, struck_);
  for (const Participant p : struck_) wake(step, p, pace);
  if (!carried_.none()) keep_awake_on_moving_ground(step);
}

// Notes hulls of which one was put where the other is: they are to part, and no sleeper is to hold them
// together.
void NearBodies::find_inside(const ContactScene& scene) {
  const auto is_pinned = [&](Participant p) { return p.is_statistical() && scene.body(p).pinned; };
  inside_.clear();
  for (const CrowdContact& c : pairs_.contacts())
    if (overlap_by(scene, c, is_placed(scene, c) ? kBroughtOverlap : kWakingOverlap) &&
        !(is_pinned(c.first) && is_pinned(c.second)))
      inside_.insert(inside_.end(), {c.first, c.second});
}

// Whether one of the two is in inside_, and the other lies in its way.
bool NearBodies::are_to_part(const ContactScene& scene, const CrowdContact& c) const {
  constexpr double kPressed = 0.25;  // over kBroughtOverlap: in the way of one that its caller placed
  const double least = is_placed(scene, c) ? kPressed * kBroughtOverlap : kBroughtOverlap;
  return !inside_.empty() && overlap_by(scene, c, least) &&
         (std::ranges::find(inside_, c.first) != inside_.end() ||
          std::ranges::find(inside_, c.second) != inside_.end());
}

void NearBodies::keep_awake_on_moving_ground(const Step& step) {
  for (const SolidContact& c : solids_.contacts()) {
    if (!c.part->moves()) continue;
    const Participant p = Participant::statistical(std::size_t(c.slot));
    keep_awake(step, p);
    step.scene.body(p).carried = true;
  }
}

// Finds whom the woken are near, with those that were driven out of their balls.
void NearBodies::look_up_woken(const Step& step, double elapsed) {
  pairs_.add(step.scene, step.search.find_woken(elapsed, step.support, full_, woken_));
  for (const Participant p : woken_) note_ball(step, p, elapsed);
}

// Finds the contacts of the woken; whom they touch may wake, too, and so on.
void NearBodies::meet_woken(const Step& step, Pace pace, int substep) {
  const double time = step.dt / pace;
  for (; !woken_.empty(); wake_touched(step, pace)) {
    known_movers_ = movers_;
    choose_movers(step.support, pace);
    look_up_woken(step, substep * time);
    pairs_.find_more_contacts(step.scene, time, near_, pace);
    solids_.find_more(step.scene, movers_, known_movers_, substep * time, time);
  }
}

}  // namespace lodestone
