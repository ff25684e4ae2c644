#include "lod/manager/audit.h"

#include <algorithm>
#include <cmath>

#include "lod/timing/thread_clock.h"
#include "reference/drop_trial.h"
#include "reference/free_rotation.h"

namespace lodestone {
namespace {

constexpr double kRestDuration = 1.0;  // s below it until a body counts as at rest
constexpr double kHorizon = 10.0;      // s
constexpr std::size_t kMostWatched = 64;

/// Parts of the ground that the body may touch.
bool near_solids(const Levels& levels, const Vec3& position, double radius) {
  std::vector<const GroundPart*> found;
  if (levels.ground.has_parts()) levels.ground.find_parts(position, 1.5 * radius, found);
  return !found.empty();
}

bool same(const RigidState& a, const RigidState& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs() &&
         a.velocity == b.velocity && a.angular_velocity == b.angular_velocity;
}

}  // namespace

void RunningMean::add(double value) {
  const double before = value - mean_;
  mean_ += before / double(++count_);
  squares_ += before * (value - mean_);
}

double RunningMean::deviation() const { return count_ > 1 ? std::sqrt(squares_ / double(count_ - 1)) : 0.0; }
double RunningMean::standard_error() const {
  return count_ > 1 ? deviation() / std::sqrt(double(count_)) : 0.0;
}

void WayToRest::sample(double time_s, const RigidState& state, double energy, bool asleep) {
  if (done_) return;
  if (energy > kRestEnergyPerMass) rest_time_ = time_s;
  if (time_s <= 1.0 + 1e-9) a_second_on_ = state.position;
  last_ = state.position;
  done_ = asleep || time_s - rest_time_ >= kRestDuration || time_s >= kHorizon;
}

double WayToRest::distance_m(const Vec3& up) const {
  const Vec3 way = last_ - start_;
  return (way - up.dot(way) * up).norm();
}

void Audit::watch(std::uint32_t body, const RigidState& state) {
  const bool as_others = levels_.bodies.properties(body) == BodyProperties{};
  if (!on() || watched_.size() >= kMostWatched || !as_others) return;
  const BodyRecord& record = levels_.bodies[body];
  const std::shared_ptr<const Shape>& shape = levels_.bodies.shape(body);
  watched_.push_back({.body = body,
                      .birth = record.birth,
                      .number = ++numbers_,
                      .start = state,
                      .seen = state,
                      .shape = shape,
                      .mass = record.mass,
                      .material = record.material,
                      .demoted = WayToRest(state, shape->size)});
}

// One whose own way is over is kept for its comparison, whatever becomes of it.
bool Audit::still_watched(const Watched& w) const {
  if (w.demoted.done()) return true;
  if (levels_.bodies[w.body].birth != w.birth || !levels_.bodies[w.body].statistical) return false;
  return levels_.statistical->activity(levels_.bodies[w.body].statistical) != Activity::crowded;
}

void Audit::forget_watched() {
  left_out_ += int(watched_.size());
  watched_.clear();
  way_.reset();
}

void Audit::begin_step() {
  if (!on()) return;
  const auto disturbed = [this](const Watched& w) {
    if (w.demoted.done()) return false;
    const bool there = levels_.bodies[w.body].birth == w.birth;
    if (!there || levels_.bodies.properties(w.body) != BodyProperties{}) return true;
    const auto& given = levels_.bodies.force(w.body);
    return !given.force.isZero(0.0) || !given.torque.isZero(0.0) || !same(levels_.state(w.body), w.seen);
  };
  left_out_ += int(std::erase_if(watched_, disturbed));
}

void Audit::look_at(Watched& w, double dt) {
  if (w.demoted.done()) return;
  w.time_s += dt;
  w.seen = levels_.state(w.body);
  w.demoted.sample(w.time_s, w.seen, kinetic_energy(*w.shape, w.seen), levels_.asleep(w.body));
}

void Audit::end_step(double dt, StepReport& report) {
  if (!on()) return;
  const double started = thread_time_ms();
  left_out_ += int(std::erase_if(watched_, [this](const Watched& w) {
    return !still_watched(w) || near_solids(levels_, w.seen.position, w.shape->radius);
  }));
  for (Watched& w : watched_) look_at(w, dt);
  while (!watched_.empty() && thread_time_ms() - started < audit_ms_) {
    const auto next = std::ranges::find_if(watched_, [](const Watched& w) { return !w.full; });
    if (next == watched_.end()) break;
    if (simulated_number_ != next->number || !way_) begin(*next);
    simulate(*next, dt);
    if (way_->done()) next->full = std::exchange(way_, std::nullopt);
  }
  std::erase_if(watched_, [this](const Watched& w) {
    if (!w.full || !w.demoted.done()) return false;
    compare(w);
    return true;
  });
  spent_ms_ = thread_time_ms() - started;
  fill(report.audit);
}

bool Audit::world_is_current() const {
  const auto alike = [](const HalfSpace& a, const HalfSpace& b) {
    return a.normal == b.normal && a.offset == b.offset && a.material == b.material;
  };
  return world_ && full_.gravity == levels_.statistical_settings.gravity &&
         std::ranges::equal(levels_.ground.planes(), planes_, alike);
}

void Audit::begin(const Watched& w) {
  full_.substeps = levels_.full.substeps();
  if (!world_is_current()) {
    const std::span<const HalfSpace> planes = levels_.ground.planes();
    world_.reset();
    full_.gravity = levels_.statistical_settings.gravity;
    world_.emplace(ode_settings_of(full_), levels_.materials);
    planes_.assign(planes.begin(), planes.end());
    for (const HalfSpace& plane : planes_) world_->add_plane(plane.normal, plane.offset, plane.material);
    simulated_ = {};
  }
  if (simulated_) world_->remove_body(simulated_);
  simulated_ = world_->add_body({.shape = w.shape, .mass = w.mass, .material = w.material, .state = w.start});
  simulated_number_ = w.number;
  simulated_s_ = 0.0;
  way_.emplace(w.start, w.shape->size);
}

void Audit::simulate(const Watched& w, double dt) {
  world_->step(dt, full_.substeps);
  simulated_s_ += dt;
  const RigidState state = world_->state(simulated_);
  way_->sample(simulated_s_, state, kinetic_energy(*w.shape, state), world_->asleep(simulated_));
}

void Audit::compare(const Watched& w) {
  const Vec3 up = -levels_.statistical_settings.gravity.normalized();
  const auto add = [](double full, double demoted, RunningMean& of_full, RunningMean& of_demoted,
                      RunningMean& difference) {
    of_full.add(full), of_demoted.add(demoted), difference.add(demoted - full);
  };
  add(w.full->rest_time_s(), w.demoted.rest_time_s(), rest_time_full_, rest_time_, rest_time_difference_);
  add(w.full->distance_m(up), w.demoted.distance_m(up), distance_full_, distance_, distance_difference_);
  add(w.full->rest_height(up), w.demoted.rest_height(up), height_full_, height_, height_difference_);
  drift_.add((w.full->a_second_on() - w.demoted.a_second_on()).norm() / w.shape->size);
}

void Audit::fill(AuditReport& report) const {
  const auto figure = [](const RunningMean& full, const RunningMean& demoted, const RunningMean& difference) {
    const double margin = 1.96 * difference.standard_error();
    return AuditFigure{full.mean(),
                       demoted.mean(),
                       full.deviation(),
                       {difference.mean() - margin, difference.mean() + margin}};
  };
  report.bodies = int(drift_.count());
  report.watched = int(watched_.size());
  report.left_out = left_out_;
  report.rest_time_s = figure(rest_time_full_, rest_time_, rest_time_difference_);
  report.distance_m = figure(distance_full_, distance_, distance_difference_);
  report.rest_height = figure(height_full_, height_, height_difference_);
  report.drift = drift_.mean();
  report.drift_interval = {drift_.mean() - 1.96 * drift_.standard_error(),
                           drift_.mean() + 1.96 * drift_.standard_error()};
  report.spent_ms = spent_ms_;
}

}  // namespace lodestone
