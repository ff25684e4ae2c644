// Bodies that change rung together: what a caller may ask for with Manager::make_group.
#pragma once

#include <functional>

#include "lod/body.h"

namespace lodestone {

/// For a group whose members the caller has joined with ODE joints (Manager::ode_body). Joints pin a body at
/// the full level. With these two, a joined group may leave it while all of it sleeps, so that nothing moves,
/// and comes back as a whole at once, to the very same poses, when something wakes one of them: before ODE's
/// next step. They are called within Manager::step, which they may read and not change.
struct GroupJoints {
  /// Destroys the joints, or detaches them: the ODE bodies are gone when it has returned. One that leaves a
  /// joint keeps its group full.
  std::function<void(GroupId)> before_demotion = {};
  std::function<void(GroupId)> after_promotion = {};  ///< joins the new ODE bodies
};

}  // namespace lodestone
