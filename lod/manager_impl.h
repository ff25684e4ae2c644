// What a Manager is made of. manager.cpp is its public face, manager_step.cpp the stages of a step.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lod/cross_level.h"
#include "lod/manager.h"

namespace lodestone {

struct Manager::Impl {
  explicit Impl(const ManagerSettings& settings);
  Impl(dxWorld* world, dxSpace* space, const ManagerSettings& settings);

  Levels levels;
  PolicySettings policy;
  dxSpace* callers_space = nullptr;
  std::size_t own_planes = 0;  // those of the caller's space follow in levels.ground
  std::vector<Vec3> viewpoints;
  std::vector<Eigen::AlignedBox3d> static_bounds;  // of the static boxes and meshes
  std::vector<LevelReason> reasons;             // of the last step's decisions
  std::vector<std::uint32_t> newcomers;         // at no level yet
  std::vector<std::uint32_t> put_off;           // waiting to be tried again
  std::vector<std::uint32_t> pushed;            // with a force for the next step
  std::vector<std::int32_t> moved;              // slots that may have moved in the last step
  // Where nothing changed that the policy looks at, it is not asked.
  bool settled = false, positions_matter = true;  // its last answer
  bool all_still = false;                         // no body moved in the last step
  int frames_unasked = 0;
  bool positions_old = false;                     // those of statistical bodies that the policy looks at
  Neighborhood neighborhood;
  StepReport report;
  // Smoothed measurements; the first is a guess until a body was full.
  double full_body_step_ms = 0.1, statistical_ms = 0.0;

  const StepReport& step(double dt);
  void begin_report();
  std::optional<LevelDecision> choose();  ///< nothing: all bodies stay as they are
  bool may_leave_unasked() const;
  void move_bodies(std::optional<LevelDecision> decision);
  void step_statistical(double dt);
  void step_full(double dt);
  void finish_report();

  void read_callers_planes();
  void see(std::uint32_t body, const RigidState& state);  ///< what the policy is to know of where a body is
  bool near_static_ground(const RigidState& state, double radius) const;
  void add_static_bounds(const Eigen::AlignedBox3d& bounds);
  void follow_moved();
  void see_statistical();  ///< where they are now, if the policy was not told
  void note_waiting(std::uint32_t body);  ///< whether its signature is there yet
  void promote(std::uint32_t body);
  void put_promotion_off(std::uint32_t body);
  void count_down_retries();
  void give_forces();
};

}  // namespace lodestone
