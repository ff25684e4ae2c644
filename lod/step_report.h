// What one step did and cost: a timing per stage, in the order of the stages, and counts.
#pragma once

#include <array>
#include <cstdint>

#include "lod/body.h"

namespace lodestone {

/// Wall time of each stage of the last step, ms; of one that was divided the sum over its parts. The stages'
/// numbers are those of lod/manager.h and lod/rungs/statistical_level.h.
struct StageTimes {
  double choose_ms = 0, transfer_ms = 0;  ///< 1, 2
  double flight_ms = 0;       ///< 3a, 3d, 3e: flight, contacts with the ground and their responses
  double broad_phase_ms = 0;  ///< 3b, 3d: which bodies are near each other
  double pairs_ms = 0;        ///< 3b, 3d: finding the contacts between bodies
  double crowd_ms = 0;        ///< 3c, 3d: the response of bodies that touch others
  double rest_ms = 0;         ///< 3f: coming to rest, sleeping and waking
  /// Around 3: full bodies handed to the statistical level, and the impulses that come back.
  double cross_level_ms = 0;
  double full_ms = 0;  ///< 4
  double total_ms = 0;

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
  /// materials needed, wherever they came from; steps in which near pairs of statistical bodies with others
  /// were looked for.
  std::int64_t ode_bodies_created = 0, trimeshes_built = 0, signatures_loaded = 0, pair_phases = 0;
  std::int64_t ode_messages = 0;  ///< what ODE complained of while it stepped
  /// Points at which two full bodies touch beyond eight of a pair: the deepest and those farthest apart stay,
  /// so that the pair is held.
  std::int64_t contacts_dropped = 0;
  std::int64_t states_recovered = 0;  ///< bodies that were no longer finite or sound: put back
  /// Substeps of the full level by dWorldQuickStep: the largest island had more than 60 contacts
  /// (150 where bodies that touch differ twelvefold in mass), or dWorldStep had given up on it.
  std::int64_t full_quick_steps = 0;
  std::int64_t full_swallowed = 0;  ///< times that a full body was wholly inside another in a substep
  /// Times that a full body, faster than it is thick in a substep, was stopped at what it would have gone
  /// through.
  std::int64_t full_passes_prevented = 0;
  /// Contacts, in substeps by QuickStep, of bodies 100 times as heavy as each other: the heavy one sinks in.
  std::int64_t full_uneven_contacts = 0;
  std::int64_t energy_clamps = 0;         ///< responses scaled so as not to add energy
  std::int64_t table_extrapolations = 0;  ///< look-ups outside the measured range
  /// Bodies whose level was thought about, step by step: most that sleep are in no step.
  std::int64_t levels_considered = 0;
  std::int64_t promotions_put_off = 0;  ///< for overlap with another body
  std::int64_t divided_steps = 0;       ///< steps longer than .1 s, which were done in equal parts of no more
  /// Times that a new body waited for a step, as it was given, where too many others were added at the same
  /// place.
  std::int64_t bodies_held_back = 0;
};

/// What the bodies of a rung cost in a step: predicted before it, measured in it. Milliseconds of the calling
/// thread's processor time.
struct RungCost {
  double predicted_ms = 0, measured_ms = 0;
  /// Predicted, in work units: a microsecond of the machine that they were counted on; the same in every run.
  double work = 0;
};

/// One number of bodies that went down from the full level, beside the same bodies simulated on in full.
struct AuditFigure {
  double full = 0, demoted = 0;        ///< means
  double deviation = 0;                ///< among the full ones
  std::array<double, 2> difference{};  ///< 95 % interval of the mean difference, demoted − full, body by body
};

/// What the audit has found since the manager was made (ManagerSettings::audit_ms).
struct AuditReport {
  int bodies = 0;    ///< compared so far: they met nothing but planes until they rested
  int watched = 0;   ///< on their way
  int left_out = 0;  ///< that met something else, went up again, or were pushed or removed by the caller
  /// After the demotion; the last of the centre of mass along gravity, over the size: which pose it rests in.
  AuditFigure rest_time_s, distance_m, rest_height;
  /// Mean distance between the two a second after the demotion, over the size (as RungError::drift).
  double drift = 0;
  std::array<double, 2> drift_interval{};  ///< 95 %
  double spent_ms = 0;  ///< in this step, of the calling thread's processor time; no part of the budget
};

struct StepReport {
  std::int64_t step = 0;  ///< so many were done; one that was divided counts as its parts
  double dt_s = 0;        ///< that it lasted; 0: a pause
  StageTimes times;
  int full = 0, statistical = 0, asleep = 0;  ///< bodies at the end of the step; asleep counts within both
  int support = 0, tables = 0;                ///< of the statistical ones
  int promotions = 0, demotions = 0;          ///< changes to a higher rung and to a lower one, in this step
  /// By Rung, in its order; of a step that was divided, of its last part. Filled under a budget only, since
  /// clocks and counts cost time themselves.
  std::array<RungCost, kRungs> cost{};
  double predicted_ms = 0,
         measured_ms = 0;  ///< of the whole step, with what is no rung's; under a budget only
  /// Of the scene: the sum of what explain() says of each awake body, times its importance; under an error
  /// budget only.
  double predicted_error_pixels = 0;
  double bytes_moved = 0;  ///< by the tables model, counted from its arrays; 0 where it is not counted
  AuditReport audit = {};
  int contacts = 0;  ///< of statistical bodies, with ground and each other, in this step
  Counters counters;
};

}  // namespace lodestone
