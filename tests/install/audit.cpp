// The audit: bodies that went down from the full level are simulated on in full beside the world, and the
// report says how far they are from themselves.
#include <memory>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

const auto kCrate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
constexpr double kFrame = 1.0 / 60.0;

struct Outcome {
  AuditReport audit;
  std::uint64_t hash = 0;
  double most_ms = 0;
};

/// Crates that fall one by one, full until the camera goes at a third of a second; `model`: what they are
/// then.
Outcome run(StatisticalModel model, double audit_ms, int crates, const TablesOptions& options = {}) {
  PolicySettings policy{
      .policy = DistancePolicy{.full_within = 1e3}, .min_dwell_frames = 0, .max_transitions_per_frame = 1000};
  Manager manager({.model = model,
                   .tables = options,
                   .policy = policy,
                   .audit_ms = audit_ms,
                   .signature_timing = SignatureTiming::in_step});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  Outcome outcome;
  std::vector<BodyId> row;
  for (int i = 0; i < crates; ++i) {
    const Quat turn = Quat(1.0, 0.3 * (i % 7) - 1, 0.2 * (i % 11) - 1, 0.25 * (i % 5) - 0.5).normalized();
    row.push_back(manager.add_body({.shape = kCrate,
                                    .state = {.position = {6.0 * i, 0, 0.9},
                                              .orientation = turn,
                                              .velocity = {0.1 * (i % 9) - 0.4, 0.5, 0},
                                              .angular_velocity = {1.0 * (i % 6), 2, -1.0 * (i % 4)}}}));
  }
  for (int frame = 0; frame < 900; ++frame) {
    const Vec3 camera(frame < 20 ? 0.0 : 1e5, 0, 0);
    manager.set_viewpoints({&camera, 1});
    manager.step(kFrame);
    outcome.most_ms = std::max(outcome.most_ms, manager.report().audit.spent_ms);
  }
  outcome.audit = manager.report().audit;
  outcome.hash = manager.state_hash();
  return outcome;
}

}  // namespace

int main() {
  const Outcome support = run(StatisticalModel::support, 5.0, 60),
                none = run(StatisticalModel::support, 0.0, 60),
                tables = run(StatisticalModel::tables, 5.0, 60),
                spheres = run(StatisticalModel::tables, 5.0, 60, {.published = true});
  check::that(support.hash == none.hash, "the world is the same to the bit with and without an audit");
  check::within(none.audit.bodies + none.audit.watched, 0, 0, "bodies audited where it is off");
  check::within(support.audit.bodies, 55, 60, "bodies compared, of 60 that fell by themselves");
  const auto& rest = support.audit.rest_time_s;
  std::printf("     time to rest: full %.3f s, demoted %.3f s, deviation %.3f\n", rest.full, rest.demoted,
              rest.deviation);
  check::within(rest.difference[0] / rest.deviation, -1.0, 0.15,
                "support: lower end of the interval of the time to rest, in deviations");
  check::within(rest.difference[1] / rest.deviation, -0.15, 1.0, "and upper end");
  check::within(support.audit.distance_m.demoted / support.audit.distance_m.full, 0.8, 1.25,
                "support: distance over that of full ones");
  check::within(support.audit.drift, 0.0, 1.0, "support: sizes apart after a second");
  check::within(tables.audit.drift / support.audit.drift, 0.5, 2.0, "tables drift so many times as far");
  check::that(spheres.audit.drift > 1.2 * support.audit.drift, "the paper's spheres drift farther");
  check::within(spheres.audit.drift, 0.2, 3.0, "the paper's spheres: sizes apart after a second");
  check::that(spheres.audit.drift_interval[0] > support.audit.drift_interval[1],
              "with intervals that do not meet");
  return check::result();
}
