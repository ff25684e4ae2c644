// What stands behind a Manager: the bodies and the stages of a step, in their order.
#pragma once

#include <exception>
#include <memory>
#include <span>

#include "lod/manager.h"
#include "lod/manager/audit.h"
#include "lod/manager/callers_jobs.h"
#include "lod/manager/checks.h"
#include "lod/manager/choose.h"
#include "lod/manager/contact_events.h"
#include "lod/manager/cost_model.h"
#include "lod/manager/left_places.h"
#include "lod/manager/levels.h"
#include "lod/manager/move_bodies.h"
#include "lod/manager/query_scene.h"
#include "lod/manager/recorder.h"
#include "lod/manager/step_changes.h"
#include "lod/manager/step_levels.h"
#include "lod/manager/step_log.h"
#include "lod/timing/thread_clock.h"
#include "reference/state_archive.h"

namespace lodestone {

struct Manager::Impl {
  explicit Impl(const ManagerSettings& settings);
  Impl(dxWorld* world, dxSpace* space, const ManagerSettings& settings);

  std::shared_ptr<JobRunner> jobs;  // the levels' JobRunner calls this one, so that it can be replaced
  std::shared_ptr<CallersJobs> callers_jobs;  // around a caller's jobs in a step; null: they are oneTBB's
  Levels levels;
  CostModel costs;
  Choose choose;
  Audit audit;
  MoveBodies move_bodies{levels, choose, audit};
  StepLevels step_levels{levels};
  StepChanges changes{levels};
  LeftPlaces left_places;
  std::size_t last_snapshot = 0;  // bytes of its state
  ContactEvents events;
  QueryScene queries{levels};
  StepReport report;
  StepLog step_log;
  Recorder recorder;
  ProfileHooks profile;
  /// A step that has begun.
  struct Underway {
    double dt = 0.0;
    ThreadLaps laps;
    StepMeasurement measured = {};
  };
  std::optional<Underway> underway;
  bool waits_for_world_step = false;  // between before_world_step and after_world_step
  dxWorld* callers_world = nullptr;

  void set_up(const ManagerSettings& settings);
  /// All that the next steps depend on, but for the `signatures` of its statistical bodies, which are
  /// archived before it.
  void archive(StateArchive& a, std::span<const std::shared_ptr<const Signature>> signatures);
  /// Repeats the call that a chunk of a recording tells of, but for steps.
  void do_call(Manager& manager, Call call, StateArchive& chunk,
               std::span<const std::shared_ptr<const Shape>> shapes);
  std::uint32_t index_of(BodyId body) const { return levels.bodies.index_of(body); }
  /// In a caller's world, takes over its gravity where he has changed it.
  void follow_gravity();
  void step_divided(double dt, int parts);
  /// Stages 1 to 5, for at most .1 s; `since`: see begin_stages.
  void step_part(double dt, double since);
  /// If a stage throws while it lasts, makes the step none: the report is that of the step before, ground is
  /// where it was, and every body is asked about anew. (Stages throw only before they have moved a body.)
  class UndoOnThrow {
   public:
    explicit UndoOnThrow(Impl& impl) : impl_(impl), before_(impl.report) {}
    ~UndoOnThrow();
    UndoOnThrow(const UndoOnThrow&) = delete;
    UndoOnThrow& operator=(const UndoOnThrow&) = delete;

   private:
    Impl& impl_;
    const StepReport before_;
    const int exceptions_ = std::uncaught_exceptions();
  };
  /// Stages 1 to 3, before the world's step. `since`: s, the time in which the caller has moved geoms and
  /// ground to where they are; 0: this is a later part of a divided step, and he has not.
  void begin_stages(double dt, double since, WorldStepBy by);
  /// Takes over what stage 4 came to, and does stage 5.
  void end_stages();
  void begin_report(double dt);
  void follow_caller(double dt, double since);
  std::optional<RungChanges> choose_rungs();
  void step_statistical(double dt, WorldStepBy by);
  void take_over_full();
  void finish_report();
  void begin_lists();
  const StepReport& finish_lists(double dt, WorldStepBy by);
  void find_signatures(const RungChanges& changes);
};

}  // namespace lodestone
