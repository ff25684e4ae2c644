#include "lod/rungs/carried_bodies.h"

#include <algorithm>

namespace lodestone {
namespace {

bool is_kinematic(const ContactScene& scene, Participant p) { return scene.properties(p).kinematic; }

bool drives(const ContactScene& scene, Participant p) {
  if (scene.asleep(p)) return false;
  if (p.is_full() && scene.neighbor(p).driven) return true;
  if (!is_kinematic(scene, p)) return false;
  const bool turns = p.is_statistical() ? !scene.body(p).spin.isZero(0.0)
                                        : !scene.neighbor(p).state.angular_velocity.isZero(0.0);
  return turns || !scene.velocity(p).isZero(0.0);
}

}  // namespace

void CarriedBodies::find(const ContactScene& scene, std::span<const CrowdContact> contacts,
                         std::span<const SolidContact> solid_contacts,
                         std::span<const FullContact> full_contacts) {
  const auto is_on_mover = [](const SolidContact& c) { return c.part->moves(); };
  const auto full = [](std::int32_t index) { return Participant::full(std::size_t(index)); };
  const auto is_moved = [](const FullContact& c) { return c.second < 0 && !c.velocity.isZero(0.0); };
  any_ = std::ranges::any_of(solid_contacts, is_on_mover) ||
         std::ranges::any_of(full_contacts,
                             [&](const FullContact& c) {
                               return is_moved(c) || drives(scene, full(c.first)) ||
                                      (c.second >= 0 && drives(scene, full(c.second)));
                             }) ||
         std::ranges::any_of(contacts, [&](const CrowdContact& c) {
           return drives(scene, c.first) || drives(scene, c.second);
         });
  if (!any_) return;
  bodies_ = scene.bodies.size();
  sets_.set_all_apart(1 + bodies_ + scene.neighbors.size());
  const auto join = [&](Participant p, Participant q) {
    const std::int32_t first = drives(scene, p) ? 0 : node_of(p), second = drives(scene, q) ? 0 : node_of(q);
    const bool through_resting =
        (first != 0 && is_kinematic(scene, p)) || (second != 0 && is_kinematic(scene, q));
    if (!through_resting) sets_.join(first, second);
  };
  for (const CrowdContact& c : contacts) join(c.first, c.second);
  for (const SolidContact& c : solid_contacts)
    if (c.part->moves()) sets_.join(0, node_of(Participant::statistical(std::size_t(c.slot))));
  for (const FullContact& c : full_contacts) {
    if (c.second >= 0)
      join(full(c.first), full(c.second));
    else if (is_moved(c))
      sets_.join(0, node_of(full(c.first)));
  }
}

}  // namespace lodestone
