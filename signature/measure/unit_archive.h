// The units of a measurement, and the shape that they were measured for, as bytes.
#pragma once

#include "reference/shape.h"
#include "signature/byte_archive.h"
#include "signature/measure/measurement.h"
#include "signature/measure/settling_trial.h"

namespace lodestone {

template <class Archive>
void archive(Archive& a, Archived<RigidState> auto& s) {
  a(s.position, s.orientation, s.velocity, s.angular_velocity);
}

template <class Archive>
void archive(Archive& a, Archived<HeightUnit> auto& u) {
  a(u.mean, u.deviation);
}

template <class Archive>
void archive(Archive& a, Archived<Approach> auto& u) {
  a(u.mean, u.deviation);
}

template <class Archive>
void archive(Archive& a, Archived<CellUnit> auto& u) {
  a(u.mean, u.deviation, u.factor, u.approach, u.trials, u.missed, u.into_plane_first, u.into_plane,
    u.impulses);
  a(u.energy_ratio_first, u.energy_ratio, u.responses, u.approaches);
}

template <class Archive>
void archive(Archive& a, Archived<CollisionConfiguration> auto& c) {
  a(c.theta, c.phi, c.psi, c.speed, c.spin);
}

template <class Archive>
void archive(Archive& a, Archived<HeldOutUnit> auto& u) {
  a(u.configuration, u.responses);
}

template <class Archive>
void archive(Archive& a, Archived<SettlingRecord> auto& r) {
  a(r.rests, r.normal, r.height, r.states);
}

template <class Archive>
void archive(Archive& a, Archived<Share> auto& s) {
  a(s.index, s.count);
}

/// What a measured copy is made of (make_hashed_copy); not the hull.
template <class Archive>
void archive(Archive& a, Archived<Shape> auto& s) {
  a(s.name, s.mesh.vertices, s.mesh.faces, s.convex, s.volume, s.inertia_per_mass, s.radius, s.sphere_radius,
    s.content_hash);
}

template <class Unit>
std::vector<std::byte> encode_unit(const Unit& unit) {
  ByteWriter writer;
  writer(unit);
  return std::move(writer.bytes);
}

/// False where the bytes are not those of one such unit.
template <class Unit>
bool decode_unit(std::span<const std::byte> bytes, Unit& unit) {
  ByteReader reader(bytes);
  reader(unit);
  return reader.whole();
}

/// Calls `visit(kind, units)` for every kind of unit.
template <class M, class Visit>
void visit_units(M& measurement, Visit visit) {
  visit(UnitKind::height, measurement.heights);
  visit(UnitKind::bouncing, measurement.bouncing.cells);
  visit(UnitKind::bouncing_held_out, measurement.bouncing.held_out);
  visit(UnitKind::non_bouncing, measurement.non_bouncing.cells);
  visit(UnitKind::non_bouncing_held_out, measurement.non_bouncing.held_out);
  visit(UnitKind::by_speed, measurement.by_speed.cells);
  visit(UnitKind::by_speed_held_out, measurement.by_speed.held_out);
  visit(UnitKind::settling, measurement.settlings);
}

}  // namespace lodestone
