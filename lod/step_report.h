// What one step did and cost: the time of each stage, in the order of the stages, and counts.
#pragma once

#include <array>
#include <cstdint>

#include "lod/body.h"

namespace lodestone {

/// Wall time of each stage of the last step, ms; of a divided step the sum over its parts. The numbers of the
/// stages are those of lod/manager.h and lod/rungs/statistical_level.h.
struct StageTimes {
  double choose_ms = 0, transfer_ms = 0;  ///< 1, 2
  double flight_ms = 0;       ///< 3a, 3d, 3e: flight, contacts with the ground and their responses
  double broad_phase_ms = 0;  ///< 3b, 3d: which bodies are near each other
  double pairs_ms = 0;        ///< 3b, 3d: finding the contacts between bodies
  double crowd_ms = 0;        ///< 3c, 3d: the response of bodies that touch others
  double rest_ms = 0;         ///< 3f: coming to rest, sleeping and waking
  /// Before and after 3: full bodies are shown to the statistical level, and get their impulses from it.
  double cross_level_ms = 0;
  double full_ms = 0;   ///< 4; 0 for before_world_step: the caller's own world step is not timed
  double total_ms = 0;  ///< 1 to 4, and what the manager does between them; without 5

  StageTimes& operator+=(const StageTimes& o) {
    choose_ms += o.choose_ms, transfer_ms += o.transfer_ms, flight_ms += o.flight_ms,
        broad_phase_ms += o.broad_phase_ms, pairs_ms += o.pairs_ms;
    crowd_ms += o.crowd_ms, rest_ms += o.rest_ms, cross_level_ms += o.cross_level_ms, full_ms += o.full_ms,
        total_ms += o.total_ms;
    return *this;
  }
};

/// Counts since the manager was made: what the scene needed, and trouble that was met and mended.
struct Counters {
  /// Bodies and triangle meshes (of shapes and of ground) made in ODE; signatures that shapes and their
  /// materials needed, wherever they came from; steps in which statistical bodies were searched for what is
  /// near them.
  std::int64_t ode_bodies_created = 0, trimeshes_built = 0, signatures_loaded = 0, pair_phases = 0;
  std::int64_t ode_messages = 0;  ///< warnings and errors that ODE reported while it stepped
  /// Contact points of a full body with another body or with ground that were left out, as a pair has eight
  /// at most. The deepest and those farthest apart are kept, so that the body does not rock.
  std::int64_t contacts_dropped = 0;
  /// Times that a body's state was not finite, or beyond what a level can hold: it was put back where it was,
  /// or at the nearest place that can be held, without velocities.
  std::int64_t states_recovered = 0;
  /// Substeps of the full level that dWorldQuickStep did, because the largest island had more than 60
  /// contacts (150 where bodies that touch differ twelvefold in mass) or because dWorldStep gave up.
  std::int64_t full_quick_steps = 0;
  /// Times that a full body was wholly inside another, one of them concave, at the beginning of a substep.
  std::int64_t full_swallowed = 0;
  /// Times that a full body that moved farther in a substep than it is thick was stopped at what it would
  /// have gone through.
  std::int64_t full_passes_prevented = 0;
  /// Contacts, in substeps by dWorldQuickStep, of two full bodies of which one is at least 100 times as
  /// heavy: it sinks into the other.
  std::int64_t full_uneven_contacts = 0;
  std::int64_t energy_clamps = 0;         ///< responses scaled down so as not to add energy
  std::int64_t table_extrapolations = 0;  ///< look-ups in response tables outside the measured range
  /// Bodies that the policy was asked about, summed over the steps; about most sleepers it is not asked.
  std::int64_t levels_considered = 0;
  std::int64_t promotions_put_off = 0;  ///< because the body overlapped another body or the ground
  std::int64_t divided_steps = 0;       ///< steps of more than .1 s, done in equal parts of at most .1 s
  /// Times that a new body waited for another step, as it was given, because too many others were added at
  /// the same place.
  std::int64_t bodies_held_back = 0;
};

/// What the bodies of a rung cost in a step, in processor time of the calling thread.
struct RungCost {
  /// ms: predicted before the step; measured in it, 0 under a budget of work.
  double predicted_ms = 0, measured_ms = 0;
  /// Predicted, in work units, the same in every run. A unit is a microsecond on the machine on which the
  /// costs were measured.
  double work = 0;
};

/// A figure of bodies that were demoted from the full level, beside that of the same bodies simulated on in
/// full.
struct AuditFigure {
  double full = 0, demoted = 0;  ///< means
  double deviation = 0;          ///< standard deviation among the full ones; 0 for fewer than two bodies
  std::array<double, 2> difference{};  ///< 95 % interval of the mean difference, demoted − full, body by body
};

/// What the audit has found since the manager was made (ManagerSettings::audit_ms); all 0 without an audit.
struct AuditReport {
  int bodies = 0;   ///< compared so far: they met nothing but planes until they rested, or for 10 s
  int watched = 0;  ///< demoted, and not yet compared
  /// Bodies that met something else before that, were promoted again, or were moved, pushed or removed by the
  /// caller.
  int left_out = 0;
  /// From the demotion to rest, s, and how far across gravity the body went meanwhile, m. The height against
  /// gravity at which its centre of mass rests, over the shape's size, tells its pose.
  AuditFigure rest_time_s, distance_m, rest_height;
  /// Mean distance between the demoted and the full body 1 s after the demotion, over the shape's size (as
  /// RungError::drift).
  double drift = 0;
  std::array<double, 2> drift_interval{};  ///< the mean's 95 % interval
  double spent_ms = 0;  ///< in this step, in processor time of the calling thread; it counts for no budget
};

/// The report of one step.
struct StepReport {
  std::int64_t step = 0;  ///< steps done so far; a divided step counts as its parts
  double dt_s = 0;        ///< s that the step advanced the world by; 0: a pause
  StageTimes times;
  int full = 0, statistical = 0, asleep = 0;  ///< bodies at the end of the step; `asleep` of both levels
  int support = 0, tables = 0;                ///< of the statistical ones
  int promotions = 0, demotions = 0;          ///< changes to a higher rung and to a lower one, in this step
  /// By Rung, in its order; for a divided step that of its last part. Only under a budget, since clocks and
  /// counts take time themselves.
  std::array<RungCost, kRungs> cost{};
  double predicted_ms = 0,
         measured_ms = 0;  ///< of the whole step, with what belongs to no rung; only under a budget
  /// Sum of Why::predicted_error_pixels over the awake bodies, each times its importance and the policy's
  /// `significance`; only under an error budget.
  double predicted_error_pixels = 0;
  double bytes_moved = 0;  ///< by the loops of `tables` in this step, reckoned from its arrays
  AuditReport audit = {};
  int contacts = 0;  ///< contact points that the statistical level answered in this step, in all substeps
  Counters counters;
};

}  // namespace lodestone
