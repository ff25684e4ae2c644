// What a Manager is made of. manager.cpp is its public face, manager_choose.cpp the first stage of a step, manager_step.cpp the others.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lod/cross_level.h"
#include "lod/far_bodies.h"
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
  std::vector<std::uint32_t> put_off;           // waiting to be tried again
  // Whom the policy is asked about: manager_choose.cpp.
  bool look_at_all = true;
  std::vector<std::uint32_t> wishing;           // that did not get the level that is wanted for them
  std::vector<std::uint32_t> changed;           // by the caller, or by a demotion
  std::vector<std::int32_t> were_awake;         // slots, at the step's start
  std::vector<std::uint32_t> fell_asleep;       // in the last step
  FarBodies far;
  double traveled = 0.0;                        // m: how far viewpoints came, at most
  std::vector<std::uint32_t> asked;             // bodies of the candidates
  std::vector<LevelCandidate> candidates;
  Neighborhood neighborhood;
  StepReport report;
  // Smoothed measurements; the first is a guess until a body was full.
  double full_body_step_ms = 0.1, statistical_ms = 0.0;

  const StepReport& step(double dt);
  void begin_report();
  std::optional<LevelDecision> choose();  ///< with bodies for candidates; nothing: all stay as they are
  void move_bodies(std::optional<LevelDecision> decision);
  void step_statistical(double dt);
  void step_full(double dt);
  void finish_report();

  void read_callers_planes();
  bool policy_sees_places() const { return !static_bounds.empty() || (levels.bodies.automatic() > 0 && !viewpoints.empty()); }
  void look_at_those_concerned();
  void look_at(std::uint32_t body);
  void look_at_nearest(const BudgetPolicy& budget);
  LevelCandidate make_candidate(std::uint32_t body) const;
  void put_far(std::uint32_t body, const LevelCandidate& candidate);
  void put_in_order();
  void take_answers(LevelDecision& decision);
  bool near_static_ground(const RigidState& state, double radius) const;
  void add_static_bounds(const Eigen::AlignedBox3d& bounds);
  void note_waiting(std::uint32_t body);  ///< whether its signature is there yet
  void promote(std::uint32_t body);
  void put_promotion_off(std::uint32_t body);
  void count_down_retries();
};

}  // namespace lodestone
