// A camera for a scene that has none.
#pragma once

#include "scenes/trajectory.h"

namespace lodestone {

/// Stands still, obliquely above, and has nearly all bodies (all but the farthest hundredth) in its picture
/// over the whole trajectory.
SceneViewpoint frame_bodies(const Trajectory& trajectory, const Scene& scene);

}  // namespace lodestone
