// Bodies that change rung together: what a caller gives Manager::make_group besides the bodies.
#pragma once

#include <functional>

#include "lod/body.h"

namespace lodestone {

/// For a group whose members the caller has joined with ODE joints (Manager::ode_body). Joints pin a body at
/// the full level. With these two functions a joined group may leave it while all of its bodies sleep. When
/// something wakes one of them, all come back before ODE's next step, to exactly the poses that they had.
/// Both functions or neither: make_group throws InputError for one alone. They are called within a step,
/// after_promotion also within dissolve_group and restore(), and may read the manager but not change it.
struct GroupJoints {
  /// Must destroy or detach the joints: the ODE bodies are destroyed after it returns. If it leaves a joint,
  /// the group stays full.
  std::function<void(GroupId)> before_demotion = {};
  std::function<void(GroupId)> after_promotion = {};  ///< must join the new ODE bodies
};

}  // namespace lodestone
