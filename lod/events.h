// What touched what in a step: for sounds, damage and triggers.
#pragma once

#include <cstdint>

#include "lod/body.h"
#include "lod/ground_id.h"

struct dxGeom;
struct dxBody;

namespace lodestone {

/// Which contact events a manager makes. None as it is; what nobody asks for costs nothing.
struct EventSettings {
  bool all_bodies = false;  ///< of all bodies; else of those that ask for them, see BodyDefinition::events
  /// m/s, ≥ 0, at which two points must near each other along the normal to be a hit.
  double least_speed = 0.5;
  double least_impulse = 0.0;  ///< N s, ≥ 0, that a hit must give
};

enum class ContactPhase : std::uint8_t {
  begin,  ///< they touch, and have not done so for a tenth of a second
  hit,    ///< they strike each other: with a begin, or while they touch; at most once a step
  /// They have not touched for a tenth of a second, or one of them was removed; not said of two that sleep
  /// where they lie.
  end,
};

/// Who takes part in a contact.
struct ContactSide {
  enum class Kind : std::uint8_t { body, ground, callers };
  Kind kind = Kind::ground;
  BodyId body = {};      ///< of the manager's own; at the end of a contact perhaps removed
  GroundId ground = {};  ///< of the manager's ground; null where it is not known which piece
  /// dGeomID, of the caller's ground, and of his bodies where a query meets them; at a contact null for a
  /// body of his.
  dxGeom* geom = nullptr;
  /// dBodyID, of a dynamic body of the caller's; at the end of a contact it, as geom, is perhaps one that he
  /// has destroyed.
  dxBody* callers = nullptr;
  MaterialId material = 0;
};

/// `first` is a body of the manager's. Two bodies: the one with the lower index first.
struct ContactEvent {
  ContactPhase phase = ContactPhase::begin;
  ContactSide first, second;
  Vec3 point = Vec3::Zero();    ///< m, world, where most was given; at the end the last one
  Vec3 normal = Vec3::UnitZ();  ///< into the first
  /// N s along the normal, over the whole step and all points in which they touch; 0 at the end.
  double impulse = 0.0;
  double speed = 0.0;  ///< m/s at which they came together, along the normal; 0 at the end
};

}  // namespace lodestone
