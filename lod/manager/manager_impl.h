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

  std::shared_ptr<JobRunner> jobs;  // behind the one that the levels have, so that it can be changed
  std::shared_ptr<CallersJobs> callers_jobs;  // around these in a step, where they are the caller's
  Levels levels;
  CostModel costs;
  Choose choose;
  Audit audit;
  MoveBodies move_bodies{levels, choose, audit};
  StepLevels step_levels{levels};
  StepChanges changes{levels};
  LeftPlaces left_places;
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
  /// All that the next steps depend on, but for what its statistical bodies move by: `signatures`, which
  /// stand before it.
  void archive(StateArchive& a, std::span<const std::shared_ptr<const Signature>> signatures);
  /// Does what a chunk of a recording tells, but for steps.
  void do_call(Manager& manager, Call call, StateArchive& chunk,
               std::span<const std::shared_ptr<const Shape>> shapes);
  std::uint32_t index_of(BodyId body) const { return levels.bodies.index_of(body); }
  /// The caller may have changed it in a world of his.
  void follow_gravity();
  void step_divided(double dt, int parts);
  /// Stages 1 to 5, for at most .1 s.
  void step_part(double dt, double since);
  /// Where stages throw while it lasts, nothing has moved, and the report is that of the step before.
  class Undo {
   public:
    explicit Undo(Impl& impl) : impl_(impl), before_(impl.report) {}
    ~Undo();
    Undo(const Undo&) = delete;
    Undo& operator=(const Undo&) = delete;

   private:
    Impl& impl_;
    const StepReport before_;
    const int exceptions_ = std::uncaught_exceptions();
  };
  /// Stages 1 to 3, before the world's step. `since`: s, in which the caller put geoms and ground where they
  /// are; 0: in a later part of a divided step.
  void begin_stages(double dt, double since, WorldStepBy by);
  /// What stage 4 leaves to be taken over, and stage 5.
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
