#include "lod/manager/full_contacts.h"

namespace lodestone {

void write_full_touches(const Levels& levels, ContactLog& log) {
  if (!levels.full.world()) return;
  for (const OdeTouch& touch : levels.full.world()->touches()) {
    const std::int32_t first = levels.full.index_of(touch.first),
                       second = touch.second ? levels.full.index_of(touch.second) : -1;
    const bool gone = first < 0 || (touch.second && second < 0);
    if (gone) continue;
    const auto owner = [&](std::int32_t member) { return levels.full.members()[std::size_t(member)].owner; };
    log.add({.first = owner(first),
             .second = second >= 0 ? owner(second) : ContactRecord::kGround,
             .ground = levels.full.ground_of(touch.ground),
             .ground_material = touch.second_material,
             .callers_geom = touch.callers_geom,
             .point = touch.point,
             .normal = touch.normal,
             .impulse = touch.impulse,
             .approach = touch.approach});
  }
}

}  // namespace lodestone
