// What a signature's file holds, section by section: one list for writing, checking, reading and `inspect`.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "signature/settings_archive.h"

namespace lodestone {

/// How a value lies in the file: without padding, of a size that is a multiple of its alignment.
template <class T>
struct Stored {
  using Type = T;
  static const T& pack(const T& value) { return value; }
  static const T& unpack(const T& stored) { return stored; }
};
template <>
struct Stored<Response> {
  using Type = std::array<float, 6>;
  static Type pack(const Response& r) { return {r[0], r[1], r[2], r[3], r[4], r[5]}; }
  static Response unpack(const Type& s) { return Response(s.data()); }
};
template <>
struct Stored<RestPose> {
  using Type = std::array<double, 6>;
  static Type pack(const RestPose& p) {
    return {p.normal.x(), p.normal.y(), p.normal.z(), p.height, p.frequency, p.basin};
  }
  static RestPose unpack(const Type& s) { return {{s[0], s[1], s[2]}, s[3], s[4], s[5]}; }
};
static_assert(sizeof(ResponseSample) == 14 && sizeof(SettlingClip) == 12 && sizeof(ClipFrame) == 26 &&
              sizeof(ClipEntry) == 8 && sizeof(Approach) == 8);

template <class Archive>
void archive(Archive& a, Archived<TableCertificate> auto& c) {
  a(c.trials, c.missed, c.fewest_trials, c.most_trials, c.impulses, c.into_plane_first, c.into_plane,
    c.energy_ratio_first, c.energy_ratio);
  a(c.mean_over_deviation, c.standard_error, c.greatest_standard_error, c.held_out, c.held_out_ks,
    c.held_out_error, c.uniform_trials);
}

/// All that is no list.
template <class Archive>
void archive_numbers(Archive& a, Archived<Signature> auto& s) {
  a(s.shape_hash, s.mesh_vertices, s.mesh_faces, s.settings, s.trials, s.rest_poses_above_5_percent,
    s.clip_frame_interval);
  a(s.support_map_error.mean, s.support_map_error.greatest);
  for (auto* table : {&s.bouncing, &s.non_bouncing})
    a(table->n_theta, table->n_phi, table->n_alpha, table->n_psi, table->cells.sample_range);
  a(s.by_speed.n_theta, s.by_speed.n_phi, s.by_speed.cells.sample_range);
  a(s.bouncing_certificate, s.non_bouncing_certificate, s.by_speed_certificate);
}

template <class Cells, class Visit>
void visit_table_sections(std::string_view table, Cells& cells, Visit& visit) {
  visit(table, "means", cells.mean);
  visit(table, "deviations", cells.deviation);
  visit(table, "trial counts", cells.trials);
  visit(table, "approaches", cells.approach);
  visit(table, "covariances", cells.factor);
  visit(table, "sample runs", cells.first_sample);
  visit(table, "samples", cells.sample);
}

/// Calls `visit(group, name, list)` for every list, in the order of the file's sections (which the numbers
/// precede).
template <class S, class Visit>
void visit_sections(S& s, Visit visit) {
  visit("shape", "name", s.shape_name);
  visit("collision heights", "means", s.collision_heights.mean);
  visit("collision heights", "deviations", s.collision_heights.deviation);
  visit_table_sections("bouncing", s.bouncing.cells, visit);
  visit_table_sections("non_bouncing", s.non_bouncing.cells, visit);
  visit_table_sections("by_speed", s.by_speed.cells, visit);
  visit("by_speed", "speeds", s.by_speed.speeds);
  visit("by_speed", "spins", s.by_speed.spins);
  visit("rest poses", "poses", s.rest_poses);
  visit("settling clips", "clips", s.clips);
  visit("settling clips", "frames", s.clip_frames);
  visit("settling clips", "entries", s.clip_entries);
  visit("shape", "versions", s.versions);
}

}  // namespace lodestone
