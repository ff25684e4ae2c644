// Stages 2 to 4, in substeps for bodies that are near others. A pile needs them: contacts found once in 1/60 s miss what a body that falls into
// it at several m/s meets on its way, and ten sweeps over a pile of many layers leave it sinking into itself (a bin of 100 boxes: time to sleep
// three times ODE's, a third too low). After Macklin et al., Small steps in physics simulation, 2019.
#include <algorithm>
#include <cmath>

#include "lod/statistical/statistical_level_internal.h"
#include "lod/statistical/stopwatch.h"

namespace lodestone {
namespace {

constexpr int kLeastSubsteps = 3, kMostSubsteps = 12;
constexpr double kStride = 0.07;  // over R: how far two bodies may close in in a substep, while kMostSubsteps lasts

// Where a full neighbour is after a substep that it began with velocity `before`: what took part in the crowd has its velocity from there, gravity included.
void advance(FullNeighbor& body, const Vec3& before, const Vec3& gravity, double time) {
  if (body.asleep) return;
  if (body.state.velocity == before) body.state.velocity += (gravity + body.force / body.mass) * time;
  body.state.position += body.state.velocity * time;
  body.state.orientation = (rotation_from_vector(body.state.angular_velocity * time) * body.state.orientation).normalized();
}

}  // namespace

void StatisticalLevel::Impl::mark_near(const FoundPair& pair) {
  for (const Participant p : {pair.first, pair.second})
    if (p >= 0) near_another[std::size_t(p)] = 1;
}

bool StatisticalLevel::Impl::may_strike_ground(std::int32_t slot, double dt) const {
  const StatisticalBody& body = bodies[std::size_t(slot)];
  const double fall = 0.5 * settings.gravity.norm() * dt * dt;
  return std::ranges::any_of(ground.planes, [&](const HalfSpace& plane) {
    return plane.height_of(body.position) - kind_of(body).shape->radius <= fall - std::min(0.0, body.velocity.dot(plane.normal)) * dt;
  });
}

// What strikes another or the ground may stop within the step: then who follows close behind meets it, though neither gains on the other now. Returns the farthest way
// of a follower, over R.
double StatisticalLevel::Impl::mark_followers(double dt) {
  const auto stops = [&](Participant p) { return p < 0 || near_another[std::size_t(p)] || may_strike_ground(p, dt); };
  double farthest = 0.0;
  for (bool any = true; any;) {
    any = false;
    std::erase_if(following, [&](const FoundPair* pair) {
      if (!stops(pair->first) && !stops(pair->second)) return false;
      mark_near(*pair);
      const double speed = std::max(center_velocity(pair->first, full).norm(), center_velocity(pair->second, full).norm());
      farthest = std::max(farthest, speed * dt / least_radius(*pair, full));
      return any = true;
    });
  }
  return farthest;
}

// Returns how many substeps those take that may touch another.
int StatisticalLevel::Impl::plan_substeps(double dt) {
  for (const std::int32_t slot : awake) near_another[std::size_t(slot)] = 0;
  bool any = false;
  double longest = 0.0;  // way over R
  following.clear();
  for (const FoundPair& pair : found) {
    const double gap = gap_left(pair, full), approach = find_approach(pair, dt, full);
    if (gap <= 2.0 * approach) {  // twice, since others may strike them meanwhile
      any = true;
      mark_near(pair);
      longest = std::max(longest, (center_velocity(pair.first, full) - center_velocity(pair.second, full)).norm() * dt / least_radius(pair, full));
    } else if (gap <= approach + (center_velocity(pair.first, full).norm() + center_velocity(pair.second, full).norm()) * dt) {
      following.push_back(&pair);
    }
  }
  const double farthest = mark_followers(dt);
  any |= farthest > 0.0;
  longest = std::max(longest, farthest);
  for (const SolidContact& contact : solid_contacts) near_another[std::size_t(contact.slot)] = 1;
  if (!any) return solid_contacts.empty() ? 0 : 1;
  return int(std::ceil(std::clamp(longest / kStride, double(kLeastSubsteps), double(kMostSubsteps))));
}

template <class Select>
ContactTally StatisticalLevel::Impl::move_those(double time, Select select) {
  const auto count = std::int64_t(awake.size());
  tallies.assign(std::size_t(count), {});
  run_in_pieces(jobs, count, 256, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      if (bodies[awake[i]].motion != Motion::asleep && select(awake[i])) move_alone(std::size_t(i), time, tallies[i]);
  });
  ContactTally sum;
  for (const ContactTally& tally : tallies) sum += tally;
  return sum;
}

void StatisticalLevel::Impl::move_crowded(double dt, double time, std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts, ContactTally& tally) {
  if (contacts.empty() && solid_contacts.empty()) return;
  for (const std::int32_t slot : awake)
    if (bodies[slot].crowded && bodies[slot].motion == Motion::settling) bodies[slot].motion = Motion::dynamic;
  StepWorld crowd_world = world();
  // A full neighbour is given what holds it up once a step: what gravity adds meanwhile is no impact.
  if (!neighbors.empty()) crowd_world.bounce_velocity += settings.gravity.norm() * (dt - time);
  tally += crowd.step({bodies, kinds, neighbors, full_contacts, faces_below, crowd_world, StatisticalModel::support, time}, contacts, solid_contacts);
  for (const std::int32_t slot : awake)
    if (bodies[slot].crowded && bodies[slot].motion != Motion::asleep) update_quiet(bodies[slot], time, tally);
}

void StatisticalLevel::Impl::move(double dt, std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts, StageTimes& times,
                                  ContactTally& tally) {
  Stopwatch watch;
  for (const std::int32_t slot : awake) bodies[slot].crowded = false;
  find_ground_solids(dt, false);
  full.assign(neighbors.begin(), neighbors.end());
  if (!found.empty()) find_turning();
  const int substeps = plan_substeps(dt);
  remember_places();
  tally += move_those(dt, [&](std::int32_t slot) { return !near_another[slot]; });
  times.flight_ms += watch.lap_ms();

  for (int i = 0; i < substeps; ++i) {
    const double time = dt / substeps;
    if (woken) find_near_pairs(dt, full);  // it may touch other sleepers
    if (i > 0) find_turning();
    find_contacts(time, full);  // who is crowded is decided anew
    wake_touched(full);
    if (substeps > 1) find_ground_solids(time, true);
    for (const SolidContact& contact : solid_contacts) bodies[contact.slot].crowded = true;
    times.pairs_ms += watch.lap_ms();

    tally += move_those(time, [&](std::int32_t slot) { return near_another[slot] && !bodies[slot].crowded; });
    times.flight_ms += watch.lap_ms();

    full_before.assign(full.begin(), full.end());
    move_crowded(dt, time, full, full_contacts, tally);
    for (std::size_t k = 0; k < full.size(); ++k) {
      advance(full[k], full_before[k].state.velocity, settings.gravity, time);
      // The full level takes every hit at the step's beginning: too early by i substeps, in which it must not carry the body along.
      full[k].shift -= (i * time / full[k].mass) * (full[k].hit.linear - full_before[k].hit.linear);
    }
    times.crowd_ms += watch.lap_ms();
  }
  for (std::size_t i = 0; i < neighbors.size(); ++i) {
    neighbors[i].asleep = full[i].asleep;
    neighbors[i].hit = full[i].hit;
    neighbors[i].push = full[i].push;
    neighbors[i].shift = full[i].shift;
  }
}

}  // namespace lodestone
