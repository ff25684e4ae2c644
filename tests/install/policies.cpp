// The policies that a game may choose from: size in the picture, frusta, ranges of rungs, significance,
// look-ahead; and what explain() says of a body.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "check.h"
#include "lod/manager.h"

using namespace lodestone;

namespace {

const auto kCrate = std::make_shared<const Shape>(make_shape("crate", make_box({0.2, 0.3, 0.4})));
constexpr double kFrame = 1.0 / 60.0;

Manager on_floor(const PolicySettings& policy) {
  Manager manager({.policy = policy, .signature_timing = SignatureTiming::in_step});
  manager.add_plane(Vec3::UnitZ(), 0.0);
  return manager;
}

BodyId add(Manager& manager, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  return manager.add_body({.shape = kCrate, .state = {.position = position, .velocity = velocity}});
}

void run(Manager& manager, int frames) {
  for (int i = 0; i < frames; ++i) manager.step(kFrame);
}

void sizes_in_the_picture() {
  Manager manager = on_floor({.policy = ProjectedSizePolicy{.full_above_px = 100, .support_above_px = 20},
                              .max_transitions_per_frame = 100});
  const Viewpoint camera{.position = {0, 0, 1}, .vertical_fov_rad = 1.0, .height_px = 1080};
  manager.set_viewpoints({camera});
  std::vector<BodyId> row;
  for (int i = 1; i <= 60; ++i) row.push_back(add(manager, {double(i), 0, 0.3}));
  run(manager, 2);
  int wrong = 0;
  for (const BodyId body : row) {
    const Why why = manager.explain(body);
    const double distance = (manager.state(body).position - camera.position).norm();
    const double pixels = 2 * kCrate->radius / distance * 1080 / (2 * std::tan(0.5));
    const Rung expected = pixels > 100 ? Rung::full : pixels > 20 ? Rung::support : Rung::tables;
    const bool near_limit = std::abs(pixels - 100) < 5 || std::abs(pixels - 20) < 1;
    wrong += std::abs(why.pixels - pixels) > 1e-6 * pixels || (why.rung != expected && !near_limit);
  }
  check::within(wrong, 0, 0, "bodies not on the rung of their size in the picture, of 60");
  manager.set_viewpoints({Viewpoint{.position = {0, 0, 1}, .vertical_fov_rad = 0.1, .height_px = 1080}});
  run(manager, 90);
  check::that(manager.rung(row[20]) == Rung::full, "through a longer lens what was support is full");
}

void frusta() {
  PolicySettings policy{.policy = DistancePolicy{.full_within = 5, .support_within = 50},
                        .min_dwell_frames = 0,
                        .max_transitions_per_frame = 100,
                        .out_of_view_factor = 1e3};
  Manager manager = on_floor(policy);
  const auto look = [&](const Vec3& direction) {
    manager.set_viewpoints({Viewpoint{.position = {0, 0, 1}, .direction = direction}});
  };
  look({1, 0, 0});
  const BodyId before = add(manager, {3, 0, 0.2}), behind = add(manager, {-3, 0, 0.2}),
               far_behind = add(manager, {-20, 0, 0.2});
  run(manager, 2);
  check::that(manager.rung(before) == Rung::full && manager.rung(behind) == Rung::tables,
              "in view full, behind the camera at tables");
  check::that(manager.explain(behind).rule == Rule::out_of_view && !manager.explain(behind).in_view,
              "explain() says that it is out of view");
  run(manager, 300);
  check::that(manager.asleep(behind) && manager.asleep(far_behind), "what is behind the camera is asleep");
  look({-1, 0, 0});
  run(manager, 2);
  check::that(manager.rung(behind) == Rung::full && manager.rung(far_behind) == Rung::support &&
                  manager.rung(before) == Rung::tables,
              "the camera turns round, and sleepers follow at once");
  bool curtain = true;
  policy.visible = [&](const Vec3&, double) { return !curtain; };
  manager.set_policy(policy);
  run(manager, 2);
  check::that(manager.rung(behind) == Rung::tables, "a function of the caller's hides it");
  curtain = false;
  run(manager, 2);
  check::that(manager.rung(behind) == Rung::full, "and shows it, sleeper or not");
  // A million sleepers would not be asked about: those alone are for whom it makes a difference.
  policy.visible = {};
  manager.set_policy(policy);
  std::vector<BodyId> away;
  for (int i = 0; i < 200; ++i)
    away.push_back(manager.add_body({.shape = kCrate, .state = {.position = {500.0 + i, 0, 0.1}}}));
  run(manager, 400);
  const auto before_turning = manager.report().counters.levels_considered;
  for (int i = 0; i < 100; ++i) look({std::cos(0.1 * i), std::sin(0.1 * i), 0}), run(manager, 1);
  check::within(double(manager.report().counters.levels_considered - before_turning) / 100, 0, 8,
                "bodies looked at in a step of a turning camera, 203 in the world");
}

void ranges() {
  Manager manager = on_floor(
      {.policy = DistancePolicy{.full_within = 5, .support_within = 10}, .max_transitions_per_frame = 100});
  manager.set_viewpoints({Viewpoint{.position = {0, 0, 1}}});
  const auto at = [&](double x, Rung least, Rung greatest) {
    return manager.add_body({.shape = kCrate,
                             .state = {.position = {x, 0, 0.3}},
                             .least_rung = least,
                             .greatest_rung = greatest});
  };
  const BodyId extra = at(2, Rung::tables, Rung::support), hero = at(100, Rung::full, Rung::full),
               prop = at(101, Rung::support, Rung::full);
  run(manager, 2);
  check::that(manager.rung(extra) == Rung::support && manager.rung(hero) == Rung::full &&
                  manager.rung(prop) == Rung::support,
              "a body stays between its least and its greatest rung");
  check::that(manager.explain(hero).rule == Rule::rung_range, "explain() says that one rung was left");
  manager.set_rung_range(prop, Rung::tables, Rung::full);
  run(manager, 40);
  check::that(manager.rung(prop) == Rung::tables, "a range may change");
}

void significance() {
  int asked = 0;
  BodyId dull;
  PolicySettings policy{.policy = DistancePolicy{.full_within = 5}, .max_transitions_per_frame = 100};
  policy.significance = [&](BodyId body) { return ++asked, body == dull ? 0.1 : 1.0; };
  Manager manager = on_floor(policy);
  manager.set_viewpoints({Viewpoint{.position = {0, 0, 1}}});
  dull = add(manager, {2, 0, 0.3});
  const BodyId other = add(manager, {0, 2, 0.3});
  run(manager, 2);
  check::that(manager.rung(dull) == Rung::support && manager.rung(other) == Rung::full,
              "significance scales the distance");
  run(manager, 300);
  asked = 0;
  run(manager, 100);
  check::within(asked, 0, 200, "calls in 100 steps, one body full and one asleep far enough");
}

/// m: how far from the full target a fast ball is when it becomes full; negative: it did not before it hit.
double distance_at_promotion(double look_ahead_s) {
  Manager manager = on_floor({.policy = DistancePolicy{.full_within = 1, .support_within = 100},
                              .max_transitions_per_frame = 100,
                              .look_ahead_s = look_ahead_s});
  manager.set_viewpoints({Viewpoint{.position = {0, 0, 1}}});
  const BodyId target =
      manager.add_body({.shape = kCrate, .state = {.position = {0, 0, 0.21}}, .level = LevelChoice::full});
  const BodyId shot =
      manager.add_body({.shape = kCrate, .state = {.position = {-12, 0, 1.0}, .velocity = {20, 0, 1}}});
  for (int i = 0; i < 60; ++i) {
    manager.step(kFrame);
    const double apart =
        (manager.state(shot).position - manager.state(target).position).norm() - 2 * kCrate->radius;
    if (manager.rung(shot) == Rung::full) return apart;
    if (apart < 0) break;
  }
  return -1.0;
}

void budgets() {
  Manager manager =
      on_floor({.policy = ErrorBudgetPolicy{.budget_work = 20000}, .max_transitions_per_frame = 100});
  manager.set_viewpoints({Viewpoint{.position = {0, 0, 1}}});
  std::vector<BodyId> row;
  for (int i = 0; i < 100; ++i) row.push_back(add(manager, {1.0 + 0.7 * i, 0, 2.0}));
  run(manager, 10);
  const Why why = manager.explain(row[0]);
  check::that(why.predicted_error > 0 && why.predicted_error_pixels > 0 && why.cost_work > 0,
              "explain() has error and cost");
  check::within(why.predicted_error_pixels / why.pixels, 0.05, 1.0,
                "predicted error of a body, over its size");
  check::that(manager.why(row[0]) == std::string(name_of(why.rung)) + ": " + std::string(text_of(why.rule)),
              "the sentence stays");
}

void wrong_values() {
  Manager manager = on_floor({});
  int refused = 0;
  const auto refuses = [&](const auto& act) {
    try {
      act();
    } catch (const std::exception&) {
      ++refused;
    }
  };
  refuses([&] { manager.set_viewpoints({Viewpoint{.vertical_fov_rad = 0}}); });
  refuses([&] { manager.set_viewpoints({Viewpoint{.direction = Vec3(0, 0, 0)}}); });
  refuses([&] { manager.set_viewpoints({Viewpoint{.position = {NAN, 0, 0}}}); });
  refuses([&] { manager.set_policy({.policy = DistancePolicy{}, .out_of_view_factor = 0.5}); });
  refuses([&] { manager.set_policy({.policy = DistancePolicy{.full_within = NAN}}); });
  refuses([&] { manager.set_rung_range(add(manager, {0, 0, 1}), Rung::full, Rung::tables); });
  check::within(refused, 6, 6, "values out of range are refused");
}

}  // namespace

int main() {
  sizes_in_the_picture();
  frusta();
  ranges();
  significance();
  check::within(distance_at_promotion(0.3), 0.5, 8.0, "m to go when a crate at 20 m/s goes up, .3 s ahead");
  check::within(distance_at_promotion(0.0), -1.0, 0.8, "the same without look-ahead (the distance is 1 m)");
  budgets();
  wrong_values();
  return check::result();
}
