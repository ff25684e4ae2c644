// Contacts of one body with a plane, answered at their own time within a step.
// ODE answers a contact at the start of the step after it happened. At game rates a body is then up to v·h
// inside the plane, so an impact of one vertex looks like one of a whole patch; and a rocking body, lifted
// off by next to nothing, falls freely for a step and loses the g·h that it lands with: a bunny that rocks
// for five seconds lies still after three. So here
// - vertices that strike within the step bounce at the time of the first of them, later ones not yet;
// - a body that strikes meets ODE's solver turned as it is then. A vertex where it strikes, of a body turned
// as at the start, is off a thin rod: blows there spin it about its own axis, and a turn back by the change
// of its spin made that one across the rod (at restitution .9 energy × 7e6 in ten seconds);
// - a vertex that gravity alone would bring back within the step is held: it may come down to the plane, and
// no farther. All others are ODE's: a slow landing sinks in and is lifted out, at small steps as at large
// ones.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "reference/contact_point.h"
#include "reference/hull/hull.h"

namespace lodestone {

/// What of a body, a plane and a step to come its contacts depend on.
struct TimedStep {
  RigidState body;
  Vec3 normal = Vec3::UnitZ();            ///< of the plane
  Vec3 acceleration = Vec3(0, 0, -9.81);  ///< m/s², by gravity and by what else acts on the body
  double duration = 0.0;                  ///< s
  double restitution = 0.0;
  double bounce_velocity = 0.05;  ///< m/s, slower contacts do not bounce
  bool turns = true;              ///< its points go round with it; a ball's lowest one does not
};

/// A point of a body near a plane.
struct NearPoint {
  Vec3 arm;      ///< m from the centre of mass, world axes
  double depth;  ///< m below the plane; negative above it
};

/// When in a step a body strikes, and what is not contacts' doing of that step's change of its velocity.
struct TimedImpact {
  double time = 0.0;         ///< s after its start; negative for one noticed late
  Vec3 fall = Vec3::Zero();  ///< m/s
};

/// Appends the contacts among `near` to `contacts`; nothing where none of them strikes within the step.
std::optional<TimedImpact> append_timed_contacts(std::span<const NearPoint> near, const TimedStep& step,
                                                 std::vector<ContactPoint>& contacts);

/// How a body that nothing acts on is turned `time` after `start`.
Quat turned_on(const RigidState& start, double time);

/// A step takes its impulses at its start. Where it ends if they came at the `impact` instead, of a body that
/// was turned on by its time for them. It is turned back about the axis that it turns about at the end, which
/// leaves it the energy that the solver gave it.
RigidState end_of_step(const RigidState& start, const RigidState& end, const TimedImpact& impact);

}  // namespace lodestone
