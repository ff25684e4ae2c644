// Which stages of a step a profiler is told of, and whose: the manager's that steps on this thread.
#pragma once

#include "lod/hooks.h"
#include "lod/step_report.h"

namespace lodestone {

/// The zone of a whole step. While it lasts, every StageTimer of this thread over a field of `times` but the
/// total is a zone, too. Both must outlive it.
class StageZones {
 public:
  StageZones(const ProfileHooks& hooks, const StageTimes& times);
  ~StageZones();
  StageZones(const StageZones&) = delete;
  StageZones& operator=(const StageZones&) = delete;

  /// For a timer over `field`: nothing where nobody listens, or where it is none of those times.
  static void begin(const double& field);
  static void end(const double& field);

 private:
  std::string_view name_of(const double& field) const;

  const ProfileHooks* hooks_;
  const StageTimes* times_;
  StageZones* outer_;  // a manager stepped within another's hook
};

}  // namespace lodestone
