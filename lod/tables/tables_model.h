// The paper's model, `tables`: a sphere whose radius follows ‖ω‖/‖v‖ stands for the body (3.3.1), a collision
// replaces both velocities by draws from the response tables (3.3.2), and the resting conditions bring it
// into a rest pose (3.4). Departures from the paper: the impact is answered at its exact time within the
// step, and no response adds energy or leaves the body moving into the plane.
#pragma once

#include "lod/statistical/step_world.h"
#include "lod/tables_options.h"

namespace lodestone {

/// A body under the resting conditions: the pose it is led to.
struct RestingRecord {
  int pose = -1;  ///< index into Signature::rest_poses
};

struct TablesSettings {
  TablesOptions options;
  int max_impacts = 4;           ///< a step; then the body slides on for the rest of the step
  double resting_energy = 0.25;  ///< J/kg over g R: the first threshold of 3.4; the second is RestLaw's
  double blend_time = 1.2;       ///< over √(R/g): in which height and orientation approach the rest pose
};

/// Mean (or drawn) collision height for how `body` moves: the sphere's radius, m.
double find_sphere_radius(const StatisticalBody& body, const BodyKind& kind, const TablesOptions& options,
                          std::uint64_t seed);

/// The response of section 3.3.2 to a plane with `normal`: draws for Ω⁺ and V⁺ − V_particle, then both
/// velocities replaced.
void respond_from_tables(StatisticalBody& body, const BodyKind& kind, const Vec3& normal,
                         const StepWorld& world, const ContactLaw& law, const TablesOptions& options,
                         ContactTally& tally);

/// The paper's rule for a pair (3.3.2): each responds as against an immovable plane. `normal` from the second
/// body into the first.
void respond_pair_as_paper(StatisticalBody& first, const BodyKind& first_kind, StatisticalBody& second,
                           const BodyKind& second_kind, const Vec3& normal, const StepWorld& world,
                           const ContactLaw& law, const TablesOptions& options, ContactTally& tally);

/// Moves a body that touches no other by `time` seconds over the ground's planes.
ContactTally step_tables_body(StatisticalBody& body, RestingRecord& resting, const BodyKind& kind,
                              const StepWorld& world, double time, const TablesSettings& settings);

/// The resting condition's pose on `plane`: the one that needs the smallest rotation (3.4), on a slope of
/// those in which the body stays there; −1 where there is none, and, but for the paper's model, where the
/// body stands on a face that is no kept pose without the `energy`, J/kg, to tip off it: a book on end.
RestingRecord find_resting(const Quat& orientation, const BodyKind& kind, const HalfSpace& plane,
                           const StepWorld& world, double energy, const TablesOptions& options);

/// Whether a body led to that pose stays in it on `plane`: always on a horizontal one; on a slope where it
/// does not tip over the edge of the face that it lies on.
bool holds_pose(const Quat& orientation, const BodyKind& kind, int pose, const HalfSpace& plane,
                const StepWorld& world);

}  // namespace lodestone
