#include "signature/measure/signature_from_trials.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/allowed_threads.h"
#include "reference/random.h"
#include "signature/measure/cell_trials.h"
#include "signature/measure/collision_vectors.h"
#include "signature/measure/measurement_shape.h"
#include "signature/measure/response_grid.h"
#include "signature/measure/rest_poses.h"

namespace lodestone {
namespace {

// Over the speed unit. A body that strikes ground at rest leaves with 1 or 2 at most; whoever measures slow
// ones badly finds tens.
constexpr float kGreatestResponse = 1e3f;

// Rows of one table, by cell.
struct CellRows {
  std::vector<Response> responses;
  std::uint32_t into_plane = 0;
};

class RowTables {
 public:
  RowTables(double radius, const SignatureSettings& settings) : radius_(radius), settings_(settings) {}

  // False where the tables have no place for it.
  bool add(const MeasuredCollision& collision) {
    const CollisionConfiguration c = configuration_of(collision, radius_);
    if (!(c.theta < std::numbers::pi / 2) || !(c.speed > 0.0) || !std::isfinite(c.speed_unit())) return false;
    const bool slow = !settings_.paper_grid && c.speed_unit() < kFastestWithoutBounce;
    const Response response = response_of(collision, radius_, slow ? 0.0 : settings_.law.restitution);
    if (!(response.array().abs() <= kGreatestResponse).all()) return false;  // nor where it is no number
    std::vector<CellRows>& table = settings_.paper_grid ? by_speed_ : slow ? non_bouncing_ : bouncing_;
    const std::int64_t cell = settings_.paper_grid ? speeds_.find_cell(c) : grid_.find_cell(c);
    CellRows& rows = table[std::size_t(cell)];
    rows.responses.push_back(response);
    rows.into_plane += collision.velocity_after.dot(collision.normal) < 0.0;
    return true;
  }

  void replace_cells(Measurement& m, TrialCoverage& coverage) const {
    if (settings_.paper_grid) return replace_cells(m.by_speed.cells, by_speed_, coverage);
    replace_cells(m.bouncing.cells, bouncing_, coverage);
    replace_cells(m.non_bouncing.cells, non_bouncing_, coverage);
  }

 private:
  void replace_cells(std::vector<CellUnit>& units, const std::vector<CellRows>& table,
                     TrialCoverage& coverage) const {
    for (std::size_t i = 0; i < units.size(); ++i) {
      ++coverage.cells;
      if (table[i].responses.empty()) continue;
      ++coverage.measured_cells;
      const Approach approach = units[i].approach;
      units[i] = make_cell_unit(table[i].responses);
      units[i].approach = approach;
      units[i].into_plane = units[i].into_plane_first = table[i].into_plane;
      if (settings_.draw != ResponseDraw::empirical) continue;
      units[i].responses = table[i].responses;
      units[i].approaches.assign(table[i].responses.size(), approach.mean);
    }
  }

  double radius_;
  const SignatureSettings& settings_;
  ResponseTable grid_ = make_response_grid(settings_);
  SpeedTable speeds_ = make_speed_grid(settings_);
  std::vector<CellRows> bouncing_ = std::vector<CellRows>(std::size_t(grid_.size())),
                        non_bouncing_ = bouncing_;
  std::vector<CellRows> by_speed_ = std::vector<CellRows>(std::size_t(speeds_.size()));
};

void set_rest_poses(std::span<const Vec3> normals, const Shape& shape, Signature& signature) {
  std::vector<SettlingRecord> records;
  for (const Vec3& normal : normals) {
    RigidState state;
    state.orientation = rotation_between(normal, Vec3::UnitZ());
    records.push_back(
        {.rests = true, .normal = normal, .height = -gap_over_ground(shape, state), .states = {}});
  }
  signature.rest_poses = find_rest_poses(records, shape, signature.settings.rest_pose_frequency_min);
  signature.rest_poses_above_5_percent =
      int(std::ranges::count_if(signature.rest_poses, [](const RestPose& p) { return p.frequency > 0.05; }));
}

// Runs a table's trials again.
template <class Grid>
void append_table(const Shape& shape, const SignatureSettings& settings, const Grid& grid,
                  std::span<const CellUnit> units, bool bounces, double speed_factor,
                  std::vector<MeasuredCollision>& into) {
  const auto measured = make_measurement_shape(shape);
  const CellSampling sampling = make_cell_sampling(settings);
  const ContactLaw law = {bounces ? settings.law.restitution : 0.0, settings.law.friction};
  const double bounce_velocity = settings.paper_grid ? OdeSettings{}.bounce_velocity : kAlwaysBounces;
  tbb::enumerable_thread_specific<CollisionTrial> trials(
      [&] { return CollisionTrial(measured, law, settings.trial_end, bounce_velocity); });
  std::vector<std::vector<MeasuredCollision>> of_cell(units.size());
  tbb::parallel_for(std::size_t(0), units.size(), [&](std::size_t cell) {
    for (std::uint32_t k = 0; k < units[cell].trials + units[cell].missed; ++k) {
      const CellTrial start = cell_trial(grid.center(std::int64_t(cell)), std::int64_t(cell), k, sampling);
      const auto outcome = trials.local().run(start.configuration, start.orientation);
      if (!outcome) continue;
      CollisionConfiguration c = start.configuration;
      c.speed *= speed_factor, c.spin *= speed_factor;
      of_cell[cell].push_back(collision_with(c, outcome->end.response, shape.radius, law.restitution));
    }
  });
  for (const auto& rows : of_cell) into.insert(into.end(), rows.begin(), rows.end());
}

}  // namespace

Signature make_signature_from_trials(const Shape& shape, const SignatureSettings& settings,
                                     const MeasuredTrials& trials, const MeasureOptions& options,
                                     TrialCoverage* coverage) {
  TrialCoverage counted;
  RowTables tables(shape.radius, settings);
  for (const MeasuredCollision& collision : trials.collisions)
    ++(tables.add(collision) ? counted.collisions : counted.left_out);
  Measurement m = measure_units(shape, settings, {}, options);
  tables.replace_cells(m, counted);
  Signature signature = make_signature(shape, settings, m);
  counted.rests = std::int64_t(trials.rest_normals.size());
  if (counted.rests > 0) set_rest_poses(trials.rest_normals, *make_measurement_shape(shape), signature);
  if (coverage) *coverage = counted;
  return signature;
}

MeasuredTrials list_trials(const Shape& shape, const SignatureSettings& settings, const Measurement& m,
                           int threads) {
  MeasuredTrials trials;
  tbb::task_arena arena(allowed_threads(threads));
  arena.execute([&] {
    if (settings.paper_grid) {
      append_table(shape, settings, make_speed_grid(settings), m.by_speed.cells, true, 1.0,
                   trials.collisions);
      return;
    }
    append_table(shape, settings, make_response_grid(settings), m.bouncing.cells, true, 1.0,
                 trials.collisions);
    append_table(shape, settings, make_response_grid(settings), m.non_bouncing.cells, false,
                 0.5 * kFastestWithoutBounce, trials.collisions);
  });
  for (const SettlingRecord& record : m.settlings)
    if (record.rests) trials.rest_normals.push_back(record.normal);
  return trials;
}

}  // namespace lodestone
