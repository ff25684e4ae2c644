#include "tools/compare/return_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference/error.h"
#include "signature/measure/certify.h"
#include "tools/compare/fidelity.h"
#include "tools/compare/rest_classes.h"
#include "tools/compare/trials.h"
#include "tools/compare/wasserstein.h"
#include "tools/median.h"

namespace lodestone {
namespace {

struct Visit {
  DropObservation drop;
  int changes = 0;
  bool full_at_end = false;
};

class Returning {
 public:
  Returning(const DropJob& job, const ReturnSettings& settings)
      : job_(job),
        settings_(settings),
        signature_(find_signature(job, settings.measuring, settings.threads, settings.progress)) {}

  std::vector<Visit> run(bool leaves, std::uint64_t seed) const {
    std::vector<Visit> visits(std::size_t(settings_.runs));
    run_trials(settings_.runs, settings_.threads,
               [&](int i) { visits[std::size_t(i)] = observe(leaves, seed, std::uint32_t(i)); });
    return visits;
  }

 private:
  Visit observe(bool leaves, std::uint64_t seed, std::uint32_t trial) const {
    ManagerSettings settings =
        manager_settings_of({.signature = signature_, .published = settings_.published}, seed + 7919 * trial);
    settings.model = {};
    const double support_within =
        settings_.away == StatisticalModel::support ? std::numeric_limits<double>::infinity() : 1e3;
    settings.policy = {.policy = DistancePolicy{.full_within = 1e3, .support_within = support_within},
                       .min_dwell_frames = 0};
    Manager manager(settings);
    manager.materials().replace(0, job_.material);
    manager.add_plane(drop_plane_normal(job_.conditions), 0.0);
    const BodyId body = manager.add_body(
        {.shape = job_.shape, .state = drop_state(*job_.shape, job_.conditions, seed, trial)});
    DropObserver observer(*job_.shape, drop_plane_normal(job_.conditions));
    observer.sample(0.0, manager.state(body));
    Visit visit;
    const double back_s = settings_.leave_s + settings_.away_s;
    for (int k = 1; k * kObservationStep <= observer.horizon_s() + 1e-9 &&
                    (!observer.settled() || (k - 1) * kObservationStep < back_s + 0.1);
         ++k) {
      const double now = (k - 1) * kObservationStep;
      const bool away = leaves && now >= settings_.leave_s && now < back_s;
      const Vec3 viewpoint(away ? 1e5 : 0.0, 0.0, 0.0);
      manager.set_viewpoints({&viewpoint, 1});
      manager.step(kObservationStep);
      visit.changes += manager.report().promotions + manager.report().demotions;
      observer.sample(k * kObservationStep, manager.state(body));
    }
    visit.full_at_end = manager.rung(body) == Rung::full;
    visit.drop = observer.result();
    return visit;
  }

  const DropJob& job_;
  const ReturnSettings& settings_;
  std::shared_ptr<const Signature> signature_;
};

double deviation_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / double(values.size()));
}

template <class Number>
ReturnMeasure measure(const char* name, const std::vector<DropObservation>& full,
                      const std::vector<DropObservation>& other, const std::vector<DropObservation>& returned,
                      Number number) {
  const auto values = [&](const std::vector<DropObservation>& drops) {
    std::vector<double> list;
    for (const DropObservation& drop : drops) list.push_back(double(number(drop)));
    return list;
  };
  const std::vector<double> a = values(full), b = values(other), r = values(returned);
  const double deviation = std::max(1e-12, deviation_of(a)), n = double(a.size());
  return {.name = name,
          .mean_full = mean_of(a),
          .mean_returned = mean_of(r),
          .distance = kolmogorov_smirnov(a, r),
          .floor = kolmogorov_smirnov(a, b),
          .critical = 1.358 * std::sqrt(2.0 / n),
          .w1_over_deviation = wasserstein_distance(a, r) / deviation,
          .w1_floor = wasserstein_distance(a, b) / deviation};
}

double part_at_rest(const std::vector<DropObservation>& drops) {
  return double(std::ranges::count_if(drops, &DropObservation::at_rest)) / double(drops.size());
}

ReturnMeasure measure_poses(const std::vector<DropObservation>& full, const DropScore& returned,
                            const DropScore& floor, const std::vector<DropObservation>& of_returned) {
  return {.name = "rest pose",
          .mean_full = part_at_rest(full),
          .mean_returned = part_at_rest(of_returned),
          .distance = returned.tv.value_or(0.0),
          .floor = floor.tv.value_or(0.0)};
}

}  // namespace

ReturnComparison compare_return(const DropJob& job, const ReturnSettings& settings) {
  check_that(settings.runs >= 2, "there are runs to compare");
  const Returning returning(job, settings);
  const auto report = [&](const char* stage, double done) {
    if (settings.progress) settings.progress(stage, done);
  };
  const auto drops_of = [](const std::vector<Visit>& visits) {
    std::vector<DropObservation> drops;
    for (const Visit& visit : visits) drops.push_back(visit.drop);
    return drops;
  };
  report("full all the time", 0.0);
  const std::vector<DropObservation> full = drops_of(returning.run(false, 2 * settings.seed)),
                                     other = drops_of(returning.run(false, 2 * settings.seed + 1));
  report("leaving and returning", 0.7);
  const std::vector<Visit> visits = returning.run(true, 2 * settings.seed + 1);
  const std::vector<DropObservation> returned = drops_of(visits);
  const DropScore score = score_drops(full, returned, settings.seed).value,
                  floor = score_drops(full, other, settings.seed).value;
  ReturnComparison comparison{
      .runs = settings.runs, .score = score.score, .score_floor = floor.score, .measures = {}};
  for (const Visit& visit : visits)
    comparison.mean_rung_changes += double(visit.changes) / settings.runs,
        comparison.all_full_again += double(visit.full_at_end) / settings.runs;
  comparison.measures = {
      measure("distance m", full, other, returned, [](const DropObservation& d) { return d.distance_m; }),
      measure("time to rest s", full, other, returned,
              [](const DropObservation& d) { return d.rest_time_s; }),
      measure("bounces", full, other, returned, [](const DropObservation& d) { return d.bounces; }),
      measure_poses(full, score, floor, returned)};
  return comparison;
}

}  // namespace lodestone
