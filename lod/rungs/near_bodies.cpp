#include "lod/rungs/near_bodies.h"

#include <algorithm>
#include <chrono>

namespace lodestone {
namespace {

/// Wall time between laps, for the step report.
class Laps {
 public:
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Where a full neighbour is after a substep that it began with velocity `before`: what took part in the crowd
// has its velocity from there, gravity included.
void advance(FullNeighbor& body, const BodyProperties& own, const Vec3& before, const Vec3& gravity,
             double time) {
  if (body.asleep) return;
  if (body.state.velocity == before && !own.kinematic)
    body.state.velocity +=
        (own.gravity ? Vec3(gravity + body.force / body.mass) : Vec3(body.force / body.mass)) * time;
  body.state.position += body.state.velocity * time;
  body.state.orientation =
      (rotation_from_vector(body.state.angular_velocity * time) * body.state.orientation).normalized();
}

bool meets_solids(const BodyProperties& own) { return !own.kinematic && meets_ground(own); }

}  // namespace

void NearBodies::step(double dt, SupportLevel& support, std::span<Guest> guests, NearSearch& search,
                      std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts,
                      StageTimes& times, ContactTally& tally) {
  Laps watch;
  full_.assign(neighbors.begin(), neighbors.end());
  step_s_ = dt;
  const StepWorld step_world = world();
  const ContactScene scene{support.bodies(), full_, kinds_, step_world};
  near_.begin(scene.bodies.size());
  pairs_.take(scene, search.pairs());
  times.broad_phase_ms += watch.lap_ms();

  for (const std::int32_t index : support.awake_with_guests())
    scene.bodies[std::size_t(index)].crowded = false;
  find_ground_solids(scene, support, 0.0, dt, false);
  if (pairs_.size() > 0) pairs_.find_turning(scene, support.awake_with_guests());
  const int substeps = plan_.make(scene, pairs_, solid_contacts_, dt, near_);
  move_those(support, guests, dt, tally,
             [&](std::int32_t index) { return !near_[std::size_t(index)] && !support.is_guest(index); });
  times.flight_ms += watch.lap_ms();

  for (int i = 0; i < substeps; ++i) {
    const double time = dt / substeps;
    if (support.take_woken()) {  // it may touch other sleepers
      search.find_again(dt, support, full_);
      pairs_.take(scene, search.pairs());
    }
    if (i > 0) pairs_.find_turning(scene, near_.marked());
    pairs_.find_contacts(scene, time, support.awake_with_guests(), near_);  // who is crowded is decided anew
    wake_touched(scene, support);
    if (substeps > 1) find_ground_solids(scene, support, i * time, time, true);
    for (const SolidContact& contact : solid_contacts_)
      scene.bodies[std::size_t(contact.slot)].crowded = true;
    times.pairs_ms += watch.lap_ms();

    move_those(support, guests, time, tally, [&](std::int32_t index) {
      return near_[std::size_t(index)] && !scene.bodies[std::size_t(index)].crowded;
    });
    times.flight_ms += watch.lap_ms();

    full_before_.assign(full_.begin(), full_.end());
    move_crowded(scene, support, guests, full_contacts, time, tally);
    move_on(time, i);
    times.crowd_ms += watch.lap_ms();
  }
  for (std::size_t i = 0; i < neighbors.size(); ++i) {
    neighbors[i].asleep = full_[i].asleep;
    neighbors[i].hit = full_[i].hit;
    neighbors[i].push = full_[i].push;
    neighbors[i].shift = full_[i].shift;
  }
}

// Parts of the ground: what nears one is solved with all that it touches.
void NearBodies::find_ground_solids(const ContactScene& scene, const SupportLevel& support, double after,
                                    double time, bool of_near_only) {
  solid_contacts_.clear();
  faces_.faces.clear();
  if (!ground_.has_parts()) return faces_.run.clear();
  faces_.run.resize(scene.bodies.size());  // of those awake; nobody asks about others
  for (const std::int32_t index : support.awake_with_guests()) {
    StatisticalBody& body = scene.bodies[std::size_t(index)];
    const std::size_t before = solid_contacts_.size(), faces = faces_.faces.size();
    if (meets_solids(scene.world.properties_of(body.owner))) {
      if (support.is_guest(index))
        find_sphere_contacts(body, scene.kind_of(body), index, ground_, after, time, solid_contacts_,
                             faces_.faces);
      else if (!of_near_only || near_[std::size_t(index)])
        find_solid_contacts(body, scene.kind_of(body), index, ground_, after, time, solid_contacts_,
                            faces_.faces);
    }
    faces_.run[std::size_t(index)] = {std::int32_t(faces), std::int32_t(faces_.faces.size())};
    if (solid_contacts_.size() > before) body.crowded = true;
  }
}

template <class Select>
void NearBodies::move_those(SupportLevel& support, std::span<Guest> guests, double time, ContactTally& tally,
                            const Select& select) {
  const std::span<const std::int32_t> awake = support.awake_with_guests();
  const auto count = std::int64_t(awake.size());
  tallies_.assign(std::size_t(count), {});
  run_in_pieces(jobs_, count, 256, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const std::int32_t index = awake[std::size_t(i)];
      if (support.bodies()[std::size_t(index)].motion != Motion::asleep && select(index))
        move_alone(support, guests, index, time, tallies_[std::size_t(i)]);
    }
  });
  for (const ContactTally& own : tallies_) tally += own;
}

void NearBodies::move_alone(SupportLevel& support, std::span<Guest> guests, std::int32_t index, double time,
                            ContactTally& tally) const {
  if (!support.is_guest(index)) return support.move_alone(index, faces_.of(index), time, tally);
  StatisticalBody& body = support.bodies()[std::size_t(index)];
  StepWorld around = world();
  around.planes = join_planes(ground_.planes(), faces_.of(index));
  around.log = nullptr;  // where it touches nobody in the end, the tables level moves it once more
  tally = step_tables_body(body, guests[std::size_t(index - support.size())].resting, kinds_[body.kind],
                           around, time, tables_);
}

void NearBodies::wake_touched(const ContactScene& scene, SupportLevel& support) {
  for (const CrowdContact& c : pairs_.contacts())
    for (const auto& [sleeper, other] : {std::pair{c.first, c.second}, std::pair{c.second, c.first}}) {
      const bool carried =
          scene.properties(other).kinematic && !scene.velocity(other).isZero(0.0);  // however slowly
      if (carried && sleeper.is_statistical()) scene.body(sleeper).quiet_time = 0.0f;
      if (!scene.asleep(sleeper)) continue;
      const double speed = pairs_.point_velocity(scene, other, c.contact.manifold.points[0].point).norm();
      if (speed <= rest_law_.wake_speed(scene.shape(sleeper).radius) && !carried) continue;
      if (sleeper.is_full()) {
        scene.neighbor(sleeper).asleep = false;
      } else {
        support.wake(int(sleeper.index()));
        pairs_.clear_turning(sleeper);
      }
    }
}

void NearBodies::move_crowded(const ContactScene& scene, SupportLevel& support, std::span<Guest> guests,
                              std::span<const FullContact> full_contacts, double time, ContactTally& tally) {
  if (pairs_.contacts().empty() && solid_contacts_.empty()) return;
  for (const std::int32_t index : support.awake_with_guests()) {
    StatisticalBody& body = scene.bodies[std::size_t(index)];
    if (!body.crowded) continue;
    if (body.motion == Motion::settling) body.motion = Motion::dynamic;
    if (support.is_guest(index)) guests[std::size_t(index - support.size())].touched = true;
  }
  StepWorld crowd_world = world();
  // A full neighbour is given what holds it up once a step: what gravity adds meanwhile is no impact.
  if (!full_.empty()) crowd_world.bounce_velocity += settings_.gravity.norm() * (step_s_ - time);
  tally += crowd_.step({scene.bodies, scene.neighbors, kinds_, crowd_world},
                       {pairs_.contacts(), solid_contacts_, full_contacts, faces_, time});
  for (const std::int32_t index : support.awake_with_guests())
    if (const StatisticalBody& body = scene.bodies[std::size_t(index)];
        body.crowded && body.motion != Motion::asleep && !support.is_guest(index))
      support.update_quiet(index, faces_.of(index), time, tally);
}

void NearBodies::move_on(double time, int substep) {
  for (std::size_t k = 0; k < full_.size(); ++k) {
    advance(full_[k], world().properties_of(full_[k].owner), full_before_[k].state.velocity,
            settings_.gravity, time);
    // The full level takes every hit at the step's beginning: too early by some substeps, in which it must
    // not carry the body along.
    full_[k].shift -= (substep * time / full_[k].mass) * (full_[k].hit.linear - full_before_[k].hit.linear);
  }
}

}  // namespace lodestone
