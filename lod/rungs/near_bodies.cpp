#include "lod/rungs/near_bodies.h"

#include <algorithm>
#include <array>
#include <optional>

#include "lod/statistical/turn_lanes.h"
#include "lod/timing/stage_timer.h"

namespace lodestone {
namespace {

// Where a full neighbour is after a substep that it began with velocity `before`: what took part in the crowd
// has its velocity from there, gravity included.
void advance(FullNeighbor& body, const BodyProperties& own, const Vec3& before, const Vec3& gravity,
             double time) {
  if (body.asleep) return;
  if (body.state.velocity == before && !own.kinematic) {
    body.state.velocity +=
        (own.gravity ? Vec3(gravity + body.force / body.mass) : Vec3(body.force / body.mass)) * time;
    body.state.angular_velocity +=
        inverse_inertia_world(body.state.orientation, *body.shape) * (body.torque * (time / body.mass));
  }
  body.state.position += body.state.velocity * time;
  body.state.orientation =
      (rotation_from_vector(body.state.angular_velocity * time) * body.state.orientation).normalized();
}

// From the first contact of the body in `slot` on, which has one.
std::span<const SolidContact> from_slot(std::span<const SolidContact> contacts, std::int32_t slot) {
  const auto first = std::ranges::find(contacts, slot, &SolidContact::slot);
  return contacts.subspan(std::size_t(first - contacts.begin()));
}

}  // namespace

void NearBodies::step(double dt, SupportLevel& support, std::span<Guest> guests, NearSearch& search,
                      std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts,
                      StageTimes& times, ContactTally& tally) {
  full_.assign(neighbors.begin(), neighbors.end());
  StepWorld step_world = world();
  step_world.forces = &support.forces();
  const Step step{
      .dt = dt,
      .scene = {support.bodies(), full_, kinds_, step_world},
      .support = support,
      .guests = guests,
      .search = search,
      .full_contacts = full_contacts,
      .times = times,
      .tally = tally,
  };
  near_.begin(step.scene.bodies.size());
  {
    const StageTimer timer(times.broad_phase_ms);
    pairs_.forget_contacts();
    pairs_.take(step.scene, search.pairs());
  }
  {
    const StageTimer timer(times.flight_ms);
    plan_substeps(step);
    move_lone(step);
  }
  balls_.resize(step.scene.bodies.size());
  for (const std::int32_t index : near_.marked())
    note_ball(step, Participant::statistical(std::size_t(index)), 0.0);
  crowd_.begin_step(dt);
  for (const Pace pace : plan_.paces()) move_islands(step, pace);
  crowd_.end_step();
  give_back(neighbors);
  answer_hits(neighbors, crowd_.exchanges());
  find_carriers(step.scene);
}

// Who may meet whom, and in how many substeps.
void NearBodies::plan_substeps(const Step& step) {
  const std::span<const std::int32_t> awake = step.support.awake_with_guests();
  for (const std::int32_t index : awake) {
    StatisticalBody& body = step.scene.bodies[std::size_t(index)];
    body.crowded = body.on_solid = body.alone_on_solid = body.in_great_heap = body.on_edge = false;
  }
  solids_.find(step.scene, awake, 0.0, step.dt, SolidSearch::one_of_a_part);
  if (pairs_.size() > 0) pairs_.find_turning(step.scene, awake);
  plan_.make(step.scene, pairs_, solids_.contacts(), solids_.faces(), step.dt, near_);
  step.support.end_search();
}

// Hulls that may meet nobody in the step: at once.
void NearBodies::move_lone(const Step& step) {
  choose_movers(step.support, 0);
  for (const std::int32_t index : movers_) {
    StatisticalBody& body = step.scene.bodies[std::size_t(index)];
    body.alone_on_solid = body.on_solid && !body.is_sphere();
  }
  std::erase_if(movers_,
                [&](std::int32_t index) { return step.scene.bodies[std::size_t(index)].is_sphere(); });
  move_alone(step, step.dt);
}

// What the step did to them.
void NearBodies::give_back(std::span<FullNeighbor> neighbors) const {
  for (std::size_t i = 0; i < neighbors.size(); ++i) {
    neighbors[i].asleep = full_[i].asleep;
    neighbors[i].hit = full_[i].hit;
    neighbors[i].push = full_[i].push;
    neighbors[i].backed_hit = full_[i].backed_hit;
    neighbors[i].fastest_hit = full_[i].fastest_hit;
    neighbors[i].backing = full_[i].backing;
    neighbors[i].shift = full_[i].shift;
    neighbors[i].carried = full_[i].carried, neighbors[i].moved = full_[i].moved;
    neighbors[i].end = full_[i].state;
  }
}

void NearBodies::find_carriers(const ContactScene& scene) {
  carriers_.clear();
  if (full_.empty() || !settings_.properties || settings_.properties->empty()) return;
  const auto is_awake = [&](Participant p) {
    return p.is_full() && !scene.asleep(p) && !scene.properties(p).kinematic;
  };
  for (const CrowdContact& c : contacts())
    for (const auto& [body, other] : {std::pair{c.first, c.second}, std::pair{c.second, c.first}})
      if (body.is_statistical() && scene.properties(body).kinematic && is_awake(other))
        carriers_.push_back({scene.owner(body), scene.owner(other)});
}

// All islands of one pace, from the step's beginning to its end.
void NearBodies::move_islands(const Step& step, Pace pace) {
  choose_movers(step.support, pace);
  pairs_.choose(near_, pace);
  const bool with_full = near_.full_pace() == pace;
  const double time = step.dt / pace;
  woken_.clear();
  crowd_.begin_islands();
  for (int i = 0; i < pace; ++i) {
    {
      const StageTimer timer(step.times.pairs_ms);
      find_touching(step, pace, i);
    }
    {
      const StageTimer timer(step.times.flight_ms);
      move_alone(step, time);
    }
    const StageTimer timer(step.times.crowd_ms);
    if (with_full) full_before_.assign(full_.begin(), full_.end());
    move_crowded(step, pace, i);
    find_driven(step, step.dt - (i + 1) * time);
    if (with_full) move_full_on(time, i);
  }
  crowd_.end_islands();
  pairs_.keep_contacts();
}

// Who is crowded is decided anew.
void NearBodies::find_touching(const Step& step, Pace pace, int substep) {
  const double time = step.dt / pace;
  if (!woken_.empty()) choose_movers(step.support, pace);  // at the end of the substep before
  woken_.insert(woken_.end(), driven_.begin(), driven_.end());
  driven_.clear();
  if (!woken_.empty()) look_up_woken(step, substep * time);
  if (substep > 0) pairs_.find_turning(step.scene, movers_);
  pairs_.find_contacts(step.scene, time, movers_, near_, pace);
  solids_.find(step.scene, movers_, substep * time, time, SolidSearch::all);
  wake_touched(step, pace);
  meet_woken(step, pace, substep);
}

void NearBodies::choose_movers(const SupportLevel& support, Pace pace) {
  movers_.clear();
  for (const std::int32_t index : support.awake_with_guests())
    if (near_.pace(Participant::statistical(std::size_t(index))) == pace) movers_.push_back(index);
}

// The movers that touch nobody.
void NearBodies::move_alone(const Step& step, double time) {
  const auto count = std::int64_t(movers_.size());
  tallies_.assign(std::size_t(count), {});
  constexpr std::int64_t kBlock = TurnLanes::kBodies;
  const auto moves = [](const StatisticalBody& body) {
    return body.motion != Motion::asleep && !body.is_solved_in_crowd() && !body.alone_on_solid;
  };
  run_in_pieces(jobs_, count, 8 * kBlock, [&](std::int64_t begin, std::int64_t end) {
    TurnLanes turns(settings_.simd);
    std::array<int, kBlock> lane;  // −1: none
    for (; begin < end; begin += kBlock) {
      const auto block =
          std::span(movers_).subspan(std::size_t(begin), std::size_t(std::min(kBlock, end - begin)));
      int turning = 0;
      for (std::size_t i = 0; i < block.size(); ++i) {
        const StatisticalBody& body = step.scene.bodies[std::size_t(block[i])];
        // Of one with a torque the spin is not yet what it turns by (step_support_body).
        const bool flies = moves(body) && body.motion == Motion::dynamic &&
                           !step.support.is_guest(block[i]) && !kinds_[body.kind].isotropic &&
                           step.support.forces().of(block[i]).turning.isZero(0.0);
        lane[i] = flies ? turning++ : -1;
        if (flies) turns.put(lane[i], body, kinds_[body.kind]);
      }
      turns.turn(time, turning);
      for (std::size_t i = 0; i < block.size(); ++i) {
        if (!moves(step.scene.bodies[std::size_t(block[i])])) continue;
        const std::optional<Quat> turned = lane[i] < 0 ? std::nullopt : turns.orientation(lane[i]);
        move_alone(step.support, step.guests, block[i], time, tallies_[std::size_t(begin) + i],
                   FacesUnder{solids_.faces().of(block[i])}, turned ? &*turned : nullptr);
      }
    }
  });
  for (const ContactTally& own : tallies_) step.tally += own;
  move_on_solids(step, time);
}

// Those that touch the ground's parts alone. Where these go on, in the frame that goes with them, in which
// they stand still; nobody sleeps there.
void NearBodies::move_on_solids(const Step& step, double time) {
  constexpr std::int64_t kFew = 4;  // bodies, that take long each
  on_solids_.clear();
  std::span<const SolidContact> contacts = solids_.contacts();
  for (const std::int32_t index : movers_) {
    const StatisticalBody& body = step.scene.bodies[std::size_t(index)];
    if (!body.alone_on_solid || body.motion == Motion::asleep) continue;
    contacts = from_slot(contacts, index);
    const Vec3 along = find_velocity_of_ground(first_run_of(contacts), time).value_or(Vec3(Vec3::Zero()));
    on_solids_.emplace_back(index, along);
  }
  const auto count = std::int64_t(on_solids_.size());
  tallies_.assign(std::size_t(count), {});
  solids_.run_among(count, kFew, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i) {
      const auto& [index, along] = on_solids_[i];
      StatisticalBody& body = step.scene.bodies[std::size_t(index)];
      const bool goes_on = !along.isZero(0.0);
      if (goes_on) body.velocity -= along;
      move_alone(step.support, step.guests, index, time, tallies_[i],
                 faces_under(step.scene, index, along, time), nullptr);
      if (goes_on) body.velocity += along, body.position += time * along;
    }
  });
  for (std::size_t i = 0; i < on_solids_.size(); ++i) {
    const auto& [index, along] = on_solids_[i];
    step.tally += tallies_[i];
    if (along.isZero(0.0)) continue;
    if (step.scene.bodies[std::size_t(index)].motion == Motion::asleep) step.support.wake(index);
    keep_awake(step, Participant::statistical(std::size_t(index)));
  }
}

// Those that were found of it; where it is seen from ground that goes on with `along`, those of that, if
// there are no edges. A thread has them of one body at a time.
FacesUnder NearBodies::faces_under(const ContactScene& scene, std::int32_t index, const Vec3& along,
                                   double time) const {
  if (along.isZero(0.0)) return {solids_.faces().of(index)};
  thread_local std::vector<HalfSpace> faces;
  faces.clear();
  StatisticalBody seeker = scene.bodies[std::size_t(index)];
  const MetGround ground(ground_, scene.world.properties_of(seeker.owner));
  seeker.velocity += time * scene.gravity(Participant::statistical(std::size_t(index)));
  if (find_faces_going_along(seeker, scene.kind_of(seeker), ground, along, time, faces)) return {faces, true};
  return {solids_.faces().of(index)};
}

void NearBodies::move_alone(SupportLevel& support, std::span<Guest> guests, std::int32_t index, double time,
                            ContactTally& tally, const FacesUnder& under, const Quat* turned) const {
  if (!support.is_guest(index)) return support.move_alone(index, under, time, tally, turned);
  StatisticalBody& body = support.bodies()[std::size_t(index)];
  StepWorld around = world();
  around.planes = join_planes(ground_.planes(), under.faces);
  around.gravity += body.borne;
  if (!body.is_sphere()) {
    if (body.alone_on_solid && !under.go_along) around.solids = &ground_;
    tally = step_support_body(body, kinds_[body.kind], around, time, SupportSettings::of_tables());
    return;
  }
  around.log = nullptr;  // where it touches nobody in the end, the tables level moves it once more
  tally = step_tables_body(body, guests[std::size_t(index - support.size())].resting, kinds_[body.kind],
                           around, time, tables_);
  resist_rolling(body, time);
}

// Who sleeps holds still; where it would not, it wakes, and what touches it is solved once more.
void NearBodies::move_crowded(const Step& step, Pace pace, int substep) {
  constexpr int kMostRounds = 8;
  constexpr std::size_t kFew = 256;  // contacts: of more a round costs too much
  const ContactScene& scene = step.scene;
  const double time = step.dt / pace;
  if (pairs_.contacts().empty() && solids_.contacts().empty()) return;
  StepWorld crowd_world = scene.world;
  // A full neighbour is given what holds it up once a step: what gravity adds meanwhile is no impact.
  if (!full_.empty()) crowd_world.bounce_velocity += settings_.gravity.norm() * (step.dt - time);
  const float still_time = settings_.sleeping ? rest_law_.least_still_time() : 1e30f;  // s
  const ContactScene crowd_scene{scene.bodies, scene.neighbors, kinds_, crowd_world};
  const auto touch = [&] {
    return CrowdTouch{.contacts = pairs_.contacts(),
                      .solid_contacts = solids_.contacts(),
                      .full_contacts = step.full_contacts,
                      .faces = solids_.faces(),
                      .time = time,
                      .still_time = still_time,
                      .still_speed = rest_law_.full_sleep_speed(settings_.gravity.norm()),
                      .sweeps = sweeps_of(pace),
                      .parting = parting_of(pace)};
  };
  for (int round = 0;; ++round) {
    take_crowded(step);
    crowd_.solve(crowd_scene, touch());
    for (const Participant p : crowd_.pressed())
      if (scene.asleep(p)) wake(step, p, pace);
    if (woken_.empty() || round == kMostRounds || pairs_.contacts().size() > kFew) break;
    crowd_.drop(crowd_scene);
    meet_woken(step, pace, substep);
  }
  note_places(step);
  step.tally += crowd_.move(crowd_scene, touch());
  stop_before_unseen_ground(step);
  for (const std::int32_t index : movers_)
    if (const StatisticalBody& body = scene.bodies[std::size_t(index)];
        body.is_solved_in_crowd() && body.motion != Motion::asleep && !step.support.is_guest(index))
      step.support.update_quiet(index, solids_.faces().of(index), time, step.tally);
}

// Of the movers those that are solved with others.
void NearBodies::take_crowded(const Step& step) {
  const ContactScene& scene = step.scene;
  const SupportLevel& support = step.support;
  for (const std::int32_t index : movers_) {
    StatisticalBody& body = scene.bodies[std::size_t(index)];
    if (!body.is_solved_in_crowd()) continue;
    if (body.motion == Motion::settling) body.motion = Motion::dynamic;
    if (!support.is_guest(index)) continue;
    Guest& guest = step.guests[std::size_t(index - support.size())];
    guest.moved = true;
    guest.touched |= body.crowded || body.is_sphere();
  }
}

void NearBodies::move_full_on(double time, int substep) {
  for (std::size_t k = 0; k < full_.size(); ++k) {
    advance(full_[k], world().properties_of(full_[k].owner), full_before_[k].state.velocity,
            settings_.gravity, time);
    // The full level takes every hit at the step's beginning: too early by some substeps, in which it must
    // not carry the body along.
    full_[k].shift -= (substep * time / full_[k].mass) * (full_[k].hit.linear - full_before_[k].hit.linear);
  }
}

}  // namespace lodestone
