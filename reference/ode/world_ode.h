// What stands behind an OdeWorld, and how it steps.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "reference/ode/collision_ode.h"
#include "reference/ode/energy_bound_ode.h"
#include "reference/ode/held_forces_ode.h"
#include "reference/ode/ode_world.h"
#include "reference/ode/sleep_ode.h"
#include "reference/ode/sweep_ode.h"
#include "reference/ode/touches_ode.h"

namespace lodestone {

struct OdeWorld::Impl {
  /// `callers_world` and `callers_space` are null in a world of its own.
  Impl(dWorldID callers_world, dSpaceID callers_space, const OdeSettings& s, const MaterialTable& materials);
  ~Impl();

  void set_up_own_world();
  bool has_work();

  // A step: what comes before its substeps, each substep, and what comes after them.
  void begin_step(double h);
  void substep(double h);
  void end_step();

  // A substep: contacts, ODE's own step (or the caller's), and putting right what came of it.
  bool try_substep(double h);
  bool retry_substep(double h, int attempt, bool by_quick_step);
  void begin_substep(double h, int attempt = 0);
  void find_contacts(double h, int attempt);
  void turn_to_impacts();
  void begin_callers_substep(double h);
  void end_callers_substep(double h);
  bool advance(double h, bool by_quick_step);
  [[noreturn]] void fail(const std::string& message);
  void end_substep(double h);

  void look_at_callers_space();
  void push_bodies();
  void take_back_bodies();
  void put_back(ode::Body& body);
  void put_back_unsound();
  void wake_whose_joints_changed();
  void recover_bodies();
  void count_uneven_contacts();
  void wake_neighbors(const ode::Body& body);
  void wake(dBodyID body);

  OdeSettings settings;
  std::unique_ptr<SpaceMirror> mirror;  // of the caller's space; else null
  dWorldID own_world, world;
  std::unique_ptr<ode::StepThreading> threading;
  ode::ContactJoints joints;
  ode::TrimeshCache trimeshes;
  ode::Collision collision;
  ode::Touches touches;
  bool records_touches = false;
  ode::EnergyBound energy_bound;
  ode::Sweep sweep;
  ode::Sleep sleep;
  ode::Bodies bodies;
  ode::HeldForces held_forces;
  OdeCounters counters;
  OdeTimes times;
  std::uint64_t quick_steps = 0;
  bool was_quick_step = false;  // the last substep, of those that are the world's own
  // Of a caller's steps: what contacts their solver is given, since one of the last kCalm was given up on,
  // and how many were not since.
  static constexpr std::int32_t kCalm = 600;
  std::int32_t callers_attempt = 0, callers_calm = 0;
  std::int64_t callers_messages = 0;              // a caller's step
  bool has_looked = false;                        // for the step to come
  std::string failure = {};                       // why ODE gave up; empty: it has not
  std::optional<std::uint32_t> failed_over = {};  // the body that it is most likely about
  double callers_step_s = 0.0;                    // between begin_callers_step and end_callers_step; else 0
  std::vector<Eigen::AlignedBox3d> vacated;  // m, by bodies that were removed between steps: the caller's
                                             // near there wake once they are known again
};

}  // namespace lodestone
