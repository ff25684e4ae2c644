// Contact events: what touched what in a step, for sounds, damage and triggers.
#pragma once

#include <cstdint>

#include "lod/body.h"
#include "lod/ground_id.h"

struct dxGeom;
struct dxBody;

namespace lodestone {

/// Which contact events a manager makes. By default none; events that nobody asks for cost nothing.
struct EventSettings {
  /// Events of all bodies; false: only of those with BodyDefinition::events, and of whatever touches these.
  bool all_bodies = false;
  /// m/s, ≥ 0: how fast two bodies must approach each other, along the normal at a point of contact, to make
  /// a hit.
  double least_speed = 0.5;
  double least_impulse = 0.0;  ///< N s, ≥ 0: and the least impulse of the contact (ContactEvent::impulse)
};

/// What happened between the two sides of a contact.
enum class ContactPhase : std::uint8_t {
  begin,  ///< they touch, and had not touched for .1 s before
  hit,    ///< they strike each other, as they begin to touch or later; at most one hit per pair and step
  /// They have not touched for .1 s, or one of them was removed. Two that sleep in contact do not end it.
  end,
};

/// One of the two sides of a contact, or what a query meets. `body`: a body of the manager's. `ground`:
/// ground that was added to the manager. `callers`: a geom or a dynamic body of the caller's, in his world.
struct ContactSide {
  enum class Kind : std::uint8_t { body, ground, callers };
  Kind kind = Kind::ground;
  BodyId body = {};      ///< of kind `body`, else null; at the end of a contact it may have been removed
  GroundId ground = {};  ///< of kind `ground`, else null; also null where it is not known which piece it was
  /// dGeomID, of kind `callers`: of a geom that is ground, and in a query of a dynamic body's geom. Null in a
  /// contact event with a dynamic body. At the end of a contact the caller may have destroyed it.
  dxGeom* geom = nullptr;
  /// dBodyID, of kind `callers`: the caller's dynamic body, else null. At the end of a contact the caller may
  /// have destroyed it.
  dxBody* callers = nullptr;
  MaterialId material = 0;
};

/// One event of a pair in one step. `first` is always a body of the manager's; of two such bodies it is the
/// one with the lower index.
struct ContactEvent {
  ContactPhase phase = ContactPhase::begin;
  ContactSide first, second;
  /// m, world: the point of contact with the greatest impulse; at the end that of the last step in contact.
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit, at that point, towards `first`
  /// N s along the normal, summed over the step and all points of contact; 0 at the end.
  double impulse = 0.0;
  double speed = 0.0;  ///< m/s, the greatest at which they approached along a normal; 0 at the end
};

}  // namespace lodestone
