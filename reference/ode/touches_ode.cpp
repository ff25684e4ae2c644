#include "reference/ode/touches_ode.h"

#include <algorithm>
#include <cmath>

#include "reference/ode/geometry_ode.h"

namespace lodestone::ode {

void Touches::begin_step() { touches_.clear(), hardest_.clear(), index_.clear(), watched_.clear(); }

std::size_t Touches::touch_of(const ContactSide& ours, const ContactSide& other) {
  const auto [entry, is_new] = index_.try_emplace(
      {ours.id.value, other.id.value, other.ground.value, other.callers_geom}, touches_.size());
  if (is_new) {
    touches_.push_back({.first = ours.id,
                        .second = other.id,
                        .ground = other.ground,
                        .callers_geom = other.callers_geom,
                        .first_material = ours.material,
                        .second_material = other.material});
    hardest_.push_back(-1.0);
  }
  return entry->second;
}

void Touches::watch(dJointID joint, const ContactSide& first, const ContactSide& second,
                    const ContactPoint& point, double approach) {
  const bool in_order = bool(first.id);  // a touch names this world's body first
  Watched& watched = watched_.emplace_back();
  watched.touch = in_order ? touch_of(first, second) : touch_of(second, first);
  watched.point = point.point, watched.normal = in_order ? point.normal : Vec3(-point.normal);
  OdeTouch& touch = touches_[watched.touch];
  touch.approach = std::max(touch.approach, approach);
  dJointSetFeedback(joint, &watched.feedback);
}

void Touches::end_substep(double h) {
  for (OdeTouch& touch : touches_) touch.at_end = false;
  for (const Watched& watched : watched_) {
    OdeTouch& touch = touches_[watched.touch];
    const double impulse = h * std::abs(watched.normal.dot(to_vec3(watched.feedback.f1)));
    touch.at_end = true;
    touch.impulse += impulse;
    if (impulse <= hardest_[watched.touch]) continue;
    hardest_[watched.touch] = impulse;
    touch.point = watched.point, touch.normal = watched.normal;
  }
  watched_.clear();
}

}  // namespace lodestone::ode
