#include "reference/ode/touches_ode.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "reference/ode/geometry_ode.h"

namespace lodestone::ode {

void Touches::begin_step() { touches_.clear(), hardest_.clear(), index_.clear(), watched_.clear(); }

std::size_t Touches::place_of(const OdeTouch& contact) {
  const auto [entry, is_new] = index_.try_emplace(
      {contact.first.value, contact.second.value, contact.ground.value, contact.callers_geom},
      touches_.size());
  if (is_new) touches_.push_back(contact), hardest_.push_back(-1.0);
  return entry->second;
}

void Touches::watch(dJointID joint, const ContactSide& first, const ContactSide& second,
                    const ContactPoint& point, double approach) {
  const bool in_order = bool(first.id);  // a touch names this world's body first
  const auto& [ours, other] = in_order ? std::tie(first, second) : std::tie(second, first);
  Watched& watched = watched_.emplace_back();
  watched.contact = {.first = ours.id,
                     .second = other.id,
                     .ground = other.ground,
                     .callers_geom = other.callers_geom,
                     .first_material = ours.material,
                     .second_material = other.material,
                     .point = point.point,
                     .normal = in_order ? point.normal : Vec3(-point.normal),
                     .approach = std::max(0.0, approach)};
  dJointSetFeedback(joint, &watched.feedback);
}

void Touches::end_substep(double h) {
  for (OdeTouch& touch : touches_) touch.at_end = false;
  for (const auto& [contact, feedback] : watched_) {
    const std::size_t place = place_of(contact);
    OdeTouch& touch = touches_[place];
    const double impulse = h * std::abs(contact.normal.dot(to_vec3(feedback.f1)));
    touch.at_end = true;
    touch.approach = std::max(touch.approach, contact.approach);
    touch.impulse += impulse;
    if (impulse <= hardest_[place]) continue;
    hardest_[place] = impulse;
    touch.point = contact.point, touch.normal = contact.normal;
  }
  watched_.clear();
}

}  // namespace lodestone::ode
