// What joints give the bodies that they are on, in the directions that body_joints.h leaves to them: limits,
// springs, motors that it does not know, and joints of other kinds.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "reference/geometry.h"

struct dxBody;

namespace lodestone {

/// Of all joints of a body together.
struct JointForce {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  ///< N at the centre of mass, N m
};

/// By ODE's feedback of joints (dJointSetFeedback), for as long as a step takes. A caller's own stays in
/// place.
class JointListener {
 public:
  JointListener();
  ~JointListener();  ///< stops
  JointListener(JointListener&&) noexcept;
  JointListener& operator=(JointListener&&) noexcept;

  /// Before ODE's step: to the joints of `bodies`, which stay where they are until stop().
  void listen(std::span<dxBody* const> bodies);
  /// After it. Of each of them, in the last substep; of one that sleeps, and where nothing listened, nothing.
  std::span<const JointForce> stop();

 private:
  struct Feedback;
  std::vector<dxBody*> bodies_;
  std::unique_ptr<Feedback> feedback_;
  std::vector<JointForce> forces_;
};

}  // namespace lodestone
