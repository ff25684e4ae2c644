// From the units of a measurement to the signature. Declared in measure.h.
#include <algorithm>
#include <cmath>

#include "reference/drop_trial.h"
#include "reference/free_rotation.h"
#include "signature/measure/certify.h"
#include "signature/measure/choose_clips.h"
#include "signature/measure/measure.h"
#include "signature/measure/measurement_shape.h"
#include "signature/measure/response_grid.h"
#include "signature/measure/rest_poses.h"
#include "signature/measure/settling_trial.h"
#include "signature/settling_clips.h"

namespace lodestone {
namespace {

float range_of(std::span<const CellUnit> units) {
  float range = 1e-6f;
  for (const CellUnit& unit : units)
    for (const Response& response : unit.responses) range = std::max(range, response.cwiseAbs().maxCoeff());
  return range;
}

ResponseSample pack(const Response& response, float approach, float range) {
  ResponseSample sample;
  for (int i = 0; i < 6; ++i) sample.response[i] = std::int16_t(std::lround(response[i] / range * 32767.0f));
  sample.approach = std::uint16_t(std::lround(std::clamp(approach / 2.0f, 0.0f, 1.0f) * 65535.0f));
  return sample;
}

ResponseCells make_cells(std::span<const CellUnit> units, ResponseDraw draw) {
  ResponseCells cells;
  for (const CellUnit& unit : units) {
    cells.mean.push_back(unit.mean);
    cells.deviation.push_back(unit.deviation);
    cells.trials.push_back(unit.trials);
    cells.approach.push_back(unit.approach);
    if (draw == ResponseDraw::correlated) cells.factor.push_back(unit.factor);
  }
  if (draw != ResponseDraw::empirical) return cells;
  cells.sample_range = range_of(units);
  cells.first_sample.push_back(0);
  for (const CellUnit& unit : units) {
    for (std::size_t i = 0; i < unit.responses.size(); ++i)
      cells.sample.push_back(pack(unit.responses[i], unit.approaches[i], cells.sample_range));
    cells.first_sample.push_back(std::uint32_t(cells.sample.size()));
  }
  return cells;
}

void add_responses(const SignatureSettings& settings, const Measurement& m, Signature& signature) {
  if (settings.paper_grid) {
    signature.by_speed = make_speed_grid(settings);
    signature.by_speed.cells = make_cells(m.by_speed.cells, settings.draw);
    signature.by_speed_certificate = certify_table(m.by_speed, TableKind::by_speed, signature);
    return;
  }
  signature.bouncing = signature.non_bouncing = make_response_grid(settings);
  signature.bouncing.cells = make_cells(m.bouncing.cells, settings.draw);
  signature.non_bouncing.cells = make_cells(m.non_bouncing.cells, settings.draw);
  signature.bouncing_certificate = certify_table(m.bouncing, TableKind::bouncing, signature);
  signature.non_bouncing_certificate = certify_table(m.non_bouncing, TableKind::non_bouncing, signature);
}

std::uint64_t count_trials(const TableUnits& units) {
  std::uint64_t count = kHeldOutTrials * units.held_out.size();
  for (const CellUnit& unit : units.cells) count += unit.trials + unit.missed;
  return count;
}

constexpr std::uint32_t kEntriesPerClip = 24;

double energy_over_gr(const Shape& shape, const RigidState& s) {
  return kinetic_energy(shape, s) / (kSettlingGravity * shape.radius);
}

SettlingClip add_frames(std::span<const RigidState> states, double radius, Signature& signature) {
  const double speed_unit = std::sqrt(kSettlingGravity * radius);
  const Vec3 start(states.front().position.x(), states.front().position.y(), 0.0);
  double extent = 1e-3;
  for (const RigidState& s : states)
    extent = std::max(extent, (s.position - start).head<2>().cwiseAbs().maxCoeff() / radius);
  const SettlingClip clip{.first_frame = std::uint32_t(signature.clip_frames.size()),
                          .frames = std::uint32_t(states.size()),
                          .extent = float(extent)};
  for (const RigidState& s : states)
    signature.clip_frames.push_back(
        encode_frame({(s.position - start) / radius, s.orientation, s.velocity / speed_unit,
                      s.angular_velocity * (radius / speed_unit)},
                     clip.extent));
  return clip;
}

// At contacts, more closely at the start, where states differ most from clip to clip.
void add_entries(const Shape& shape, std::span<const RigidState> states, std::uint32_t clip,
                 Signature& signature) {
  std::vector<std::uint32_t> touching;
  for (std::uint32_t i = 0; i < states.size(); ++i)
    if (energy_over_gr(shape, states[i]) < kClipEnergy &&
        gap_over_ground(shape, states[i]) < kEntryGap * shape.radius)
      touching.push_back(i);
  const auto n = std::uint32_t(touching.size());
  for (std::uint32_t i = 0; i < std::min(kEntriesPerClip, n); ++i) {
    const double part = double(i) / kEntriesPerClip;
    signature.clip_entries.push_back({clip, touching[std::max(i, std::uint32_t(n * part * part))]});
  }
}

/// Makes `count` clips of the records that choose_clips picks, with their entries. The signature's rest poses
/// must be there.
void add_clips(std::span<const SettlingRecord> records, const Shape& shape, int count, Signature& signature) {
  signature.clip_frame_interval = float(kObservationStep / std::sqrt(shape.radius / kSettlingGravity));
  for (const std::size_t chosen : choose_clips(records, signature.rest_poses, count)) {
    const std::vector<RigidState>& states = records[chosen].states;
    add_entries(shape, states, std::uint32_t(signature.clips.size()), signature);
    signature.clips.push_back(add_frames(states, shape.radius, signature));
  }
}

}  // namespace

Signature make_signature(const Shape& shape, const SignatureSettings& settings, const Measurement& m) {
  const auto measured = make_measurement_shape(shape);
  Signature signature;
  signature.shape_hash = measured->content_hash;
  signature.shape_name = shape.name;
  signature.mesh_vertices = std::uint32_t(shape.mesh.vertices.size()),
  signature.mesh_faces = std::uint32_t(shape.mesh.faces.size());
  signature.versions = measurement_versions();
  signature.settings = settings;
  for (const HeightUnit& unit : m.heights) {
    signature.collision_heights.mean.push_back(unit.mean);
    signature.collision_heights.deviation.push_back(unit.deviation);
  }
  add_responses(settings, m, signature);
  signature.rest_poses = find_rest_poses(m.settlings, *measured, settings.rest_pose_frequency_min);
  signature.rest_poses_above_5_percent =
      int(std::ranges::count_if(signature.rest_poses, [](const RestPose& p) { return p.frequency > 0.05; }));
  if (!measured->sphere_radius) {
    signature.support_map_error = find_lookup_error(measured->hull, SupportMap(measured->hull));
    signature.support_map_error.mean /= measured->radius,
        signature.support_map_error.greatest /= measured->radius;
  }
  add_clips(m.settlings, *measured, settings.clips, signature);
  signature.trials = std::uint64_t(settings.height_samples) * std::uint64_t(settings.height_trials) +
                     count_trials(m.bouncing) + count_trials(m.non_bouncing) + count_trials(m.by_speed) +
                     m.settlings.size();
  return signature;
}

}  // namespace lodestone
