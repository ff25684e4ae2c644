// What the full level's bodies touched among themselves, of the ground and of the caller's, for contact
// events.
#pragma once

#include "lod/manager/levels.h"
#include "lod/statistical/contact_log.h"

namespace lodestone {

/// Of the full level's last step, in which touches were recorded.
void write_full_touches(const Levels& levels, ContactLog& log);

}  // namespace lodestone
