#include "tools/bench/transitions_bench.h"

#include <algorithm>
#include <cmath>

#include "reference/error.h"
#include "reference/hull/hull_overlap.h"
#include "scenes/ground_heights.h"
#include "scenes/run_measures.h"
#include "tools/bench/rungs_bench.h"
#include "tools/median.h"

namespace lodestone {
namespace {

constexpr double kNearestDistance = 0.1;  // m from the camera, below which a pixel gets no smaller
constexpr double kReach =
    1.2;  // × the radii of two bodies' bounding spheres: within a step they may have met

MovesBeyondMotion moves_of(std::vector<double> px) {
  if (px.empty()) return {};
  std::ranges::sort(px);
  const auto within = std::ranges::upper_bound(px, 1.0) - px.begin();
  return {.moves = std::int64_t(px.size()),
          .p50_px = percentile_of(px, 0.5),
          .p99_px = percentile_of(px, 0.99),
          .max_px = px.back(),
          .within_pixel = double(within) / double(px.size())};
}

OverlapsAtPromotion overlaps_of(std::vector<double> overlaps) {
  std::ranges::sort(overlaps);
  return {.promotions = std::int64_t(overlaps.size()),
          .p50 = percentile_of(overlaps, 0.5),
          .p99 = percentile_of(overlaps, 0.99),
          .max = percentile_of(overlaps, 1.0)};
}

Vec3 rotation_between(const Quat& from, const Quat& to) {
  const Eigen::AngleAxisd turn((to * from.conjugate()).normalized());
  return turn.angle() * turn.axis();  // angles of Eigen's are 0 … π
}

class SceneGroundOverlap {
 public:
  explicit SceneGroundOverlap(std::span<const SceneGround> ground) : meshes_(meshes_among(ground)) {
    for (const SceneGround& part : ground) {
      if (const auto* plane = std::get_if<GroundPlane>(&part))
        planes_.push_back(*plane);
      else if (const auto* box = std::get_if<GroundBox>(&part))
        boxes_.push_back({make_shape("ground", make_box(box->sides_m)),
                          {.position = box->position_m, .orientation = box->orientation}});
    }
  }

  /// m; 0 where the body is clear of all.
  double deepest(const Shape& shape, const RigidState& state) const {
    double deepest = 0.0;
    for (const GroundPlane& plane : planes_)
      deepest = std::max(deepest, measure_plane_overlap(shape, state, plane.normal, plane.offset_m));
    for (const auto& [box, at] : boxes_)
      if ((at.position - state.position).norm() < box.radius + shape.radius)
        deepest = std::max(deepest, measure_pair_overlap(shape, state, box, at));
    for (const Vec3& vertex : shape.hull.vertices) {
      const Vec3 at = state.position + state.orientation * vertex;
      if (const auto height = meshes_.highest_under(at, 0.0)) deepest = std::max(deepest, *height - at.z());
    }
    return deepest;
  }

 private:
  static std::vector<SceneGround> meshes_among(std::span<const SceneGround> ground) {
    std::vector<SceneGround> meshes;
    std::ranges::copy_if(ground, std::back_inserter(meshes),
                         [](const SceneGround& part) { return std::holds_alternative<GroundMesh>(part); });
    return meshes;
  }

  std::vector<GroundPlane> planes_;
  std::vector<std::pair<Shape, RigidState>> boxes_;
  GroundHeights meshes_;
};

class TransitionsWatch {
 public:
  TransitionsWatch(const Scene& scene, double from_s)
      : scene_(scene), from_s_(from_s), ground_(scene.ground) {}

  void look(const WatchedStep& step) {
    if (places_.empty()) note_places(step);
    if (step.start_s < from_s_) return;
    changed_.assign(step.bodies.size(), false);
    const SceneViewpoint& viewpoint = scene_.viewpoints.front();
    const Vec3 eye = viewpoint.position_at(step.start_s);
    const Camera camera(eye, viewpoint.look_at_m);
    for (const RungChange& change : step.manager.rung_changes()) {
      const std::size_t body = places_[change.body.index];
      ++figures_.changes;
      changed_[body] = true;
      if (change.to == Rung::full) add_overlaps(step, body);
      if (camera.sees(step.after.states[body].position)) changed_px_.push_back(move_px(step, body, eye));
    }
    if (!step.manager.rung_changes().empty()) add_energies(step);
    for (std::size_t body = 0; body < step.bodies.size(); ++body)
      if (!changed_[body] && step.after.rungs[body] != Rung::tables &&
          !step.manager.asleep(step.bodies[body]) && camera.sees(step.after.states[body].position))
        others_px_.push_back(move_px(step, body, eye));
  }

  TransitionFigures finish(double scene_j) {
    figures_.changed = moves_of(std::move(changed_px_)), figures_.others = moves_of(std::move(others_px_));
    figures_.with_bodies = overlaps_of(std::move(with_bodies_)),
    figures_.with_ground = overlaps_of(std::move(with_ground_));
    figures_.scene_j = scene_j;
    return figures_;
  }

 private:
  void note_places(const WatchedStep& step) {
    for (std::size_t body = 0; body < step.bodies.size(); ++body) {
      const std::size_t index = step.bodies[body].index;
      if (index >= places_.size()) places_.resize(index + 1);
      places_[index] = body;
    }
  }

  const Shape& shape(std::size_t body) const { return *scene_.bodies[body].definition.shape; }

  double move_px(const WatchedStep& step, std::size_t body, const Vec3& eye) const {
    const RigidState &before = step.before.states[body], &after = step.after.states[body];
    const double moved = distance_beyond(after.position - before.position, step.dt_s * before.velocity,
                                         step.dt_s * after.velocity);
    const double turned =
        distance_beyond(rotation_between(before.orientation, after.orientation),
                        step.dt_s * before.angular_velocity, step.dt_s * after.angular_velocity);
    const double pixels_at_1_m = 0.5 * scene_.viewpoints.front().height_px / std::tan(0.5 * kFieldOfView);
    return (moved + shape(body).radius * turned) * pixels_at_1_m /
           std::max(kNearestDistance, (after.position - eye).norm());
  }

  bool near(const WatchedStep& step, std::size_t first, std::size_t second) const {
    const std::vector<RigidState>& states = step.before.states;
    return (states[first].position - states[second].position).norm() <
           kReach * (shape(first).radius + shape(second).radius);
  }

  double gain_of(const WatchedStep& step, std::size_t body) const {
    const double mass = step.manager.mass(step.bodies[body]);
    const auto energy = [&](const RigidState& state) {
      return kinetic_energy(shape(body), mass, state) -
             mass * scene_.step.gravity_m_per_s2.dot(state.position);
    };
    return energy(step.after.states[body]) - energy(step.before.states[body]);
  }

  /// Clusters of changed bodies and what is near them, each body in one.
  void add_energies(const WatchedStep& step) {
    constexpr std::size_t kNone = std::size_t(-1);
    cluster_.assign(step.bodies.size(), kNone);
    for (std::size_t first = 0; first < step.bodies.size(); ++first) {
      if (!changed_[first] || cluster_[first] != kNone) continue;
      double gained = 0.0;
      std::vector<std::size_t> open = {first};
      cluster_[first] = first;
      while (!open.empty()) {
        const std::size_t body = open.back();
        open.pop_back();
        gained += gain_of(step, body);
        if (!changed_[body]) continue;
        for (std::size_t other = 0; other < step.bodies.size(); ++other)
          if (cluster_[other] == kNone && near(step, body, other))
            cluster_[other] = first, open.push_back(other);
      }
      figures_.gained_j += std::max(0.0, gained);
      figures_.net_j += gained;
    }
  }

  void add_overlaps(const WatchedStep& step, std::size_t body) {
    const std::vector<RigidState>& states = step.before.states;
    double deepest = 0.0;
    for (std::size_t other = 0; other < states.size(); ++other)
      if (other != body &&
          (states[other].position - states[body].position).norm() < shape(body).radius + shape(other).radius)
        deepest =
            std::max(deepest, measure_pair_overlap(shape(body), states[body], shape(other), states[other]));
    with_bodies_.push_back(deepest / shape(body).size);
    with_ground_.push_back(ground_.deepest(shape(body), states[body]) / shape(body).size);
  }

  const Scene& scene_;
  double from_s_;
  SceneGroundOverlap ground_;
  std::vector<std::size_t> places_;   // in the scene, by a body's index
  std::vector<bool> changed_;         // in this step
  std::vector<std::size_t> cluster_;  // in this step: the first changed body that it is near
  std::vector<double> changed_px_, others_px_, with_bodies_, with_ground_;
  TransitionFigures figures_;
};

}  // namespace

bool is_unseen(const TransitionFigures& figures) {
  return figures.changed.p99_px <= 1.0 &&
         std::max(figures.with_bodies.max, figures.with_ground.max) <= kMostOverlap &&
         figures.gained_j <= kMostGain * std::max(0.0, figures.scene_j);
}

TransitionFigures bench_transitions(const Scene& scene, RunSettings settings, double from_s) {
  if (scene.viewpoints.empty())
    throw InputError(scene.file.string() +
                     ": viewpoints: found none, expected one whose picture is looked at");
  TransitionsWatch watch(scene, from_s);
  double end_j = 0.0;
  settings.watch = [&](const WatchedStep& step) {
    watch.look(step);
    end_j = step.after.energy_j;
  };
  const RunResult result = run_scene(scene, settings);
  return watch.finish(result.energy_start_j - end_j);
}

}  // namespace lodestone
