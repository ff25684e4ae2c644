#include "lod/statistical_level.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "lod/broad_phase.h"
#include "lod/clip_player.h"
#include "lod/crowd.h"
#include "lod/flight.h"
#include "lod/pair_memory.h"
#include "lod/parallel.h"
#include "lod/support_model.h"
#include "lod/tables_model.h"
#include "reference/error.h"

namespace lodestone {
namespace {

// Sleeping (3.4's second threshold). Among other bodies: slower than .05 m/s at R = .2 m, scaled with √R, for .1 s. Alone a body may still rock
// slowly, so it must be nearly still for longer: kinetic energy over m g R below 2.5e-4 for .5 s.
constexpr double kSleepSpeed = 0.05, kSleepSpeedRadius = 0.2;
constexpr float kSleepTime = 0.1f;
constexpr double kAloneSleepEnergy = 2.5e-4;
constexpr float kAloneSleepTime = 0.5f;
constexpr int kLeaningSteps = 12;  // a body that touched another so lately still leans on it, though a hair apart
constexpr double kWakeFactor = 2.0;  // a sleeper wakes when touched faster than this times the sleeping speed

double sleep_speed(double radius) { return kSleepSpeed * std::sqrt(radius / kSleepSpeedRadius); }

class Stopwatch {
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

// Drops `gone` from a list in order, and where `last`, the greatest of all, is in it, puts `gone` there instead.
void rename_in_order(std::vector<std::int32_t>& list, std::int32_t last, std::int32_t gone) {
  const auto place = std::ranges::lower_bound(list, gone);
  if (place != list.end() && *place == gone) list.erase(place);
  if (list.empty() || list.back() != last) return;
  list.pop_back();
  list.insert(std::ranges::lower_bound(list, gone), gone);
}

struct Push { Vec3 force = Vec3::Zero(), torque = Vec3::Zero(); };

struct FoundPair {
  ContactKey key = 0;
  PairRecord record;
  std::optional<CrowdContact> contact;
};

// The way of a body's farthest point, m.
struct Travel {
  double gone = 0.0, ahead = 0.0;     // since it was added; at most in this step
  Vec3 position = Vec3::Zero();       // at the step's start
  Quat orientation = Quat::Identity();
};

}  // namespace

struct StatisticalLevel::Impl {
  StatisticalSettings settings;
  const StaticGround& ground;
  const MaterialTable& materials;
  ParallelFor parallel;
  std::vector<BodyKind> kinds;

  // One of each per body, by slot.
  std::vector<StatisticalBody> bodies;
  std::vector<ClipPlayback> clips;
  std::vector<RestingRecord> resting;
  std::vector<std::optional<Vec3>> angular_velocity_given;  // until the next step: a state that was set is read back to the bit
  std::vector<Travel> travels;
  std::vector<std::pair<int, Push>> pushes;  // of the next step

  std::vector<std::int32_t> awake, asleep;   // slots
  bool sleepers_changed = true;
  BroadPhase broad_phase;
  PairMemory pair_memory;
  double longest_travel = 0.0;               // m, of any body so far: one that is added begins beyond it, so that its pairs are looked at anew
  Crowd crowd;
  double reach = 0.0;
  std::int64_t steps = 0;

  // Work arrays of a step.
  std::vector<Bound> bounds;
  std::vector<NearPair> pairs;
  std::vector<FoundPair> found;
  std::vector<CrowdContact> contacts;
  std::vector<ContactTally> tallies;

  Impl(const StatisticalSettings& s, const StaticGround& g, const MaterialTable& m) : settings(s), ground(g), materials(m), parallel(s.threads) {}

  const BodyKind& kind_of(const StatisticalBody& body) const { return kinds[body.kind]; }
  std::uint16_t find_kind(std::shared_ptr<const Shape> shape, double mass, MaterialId material, std::shared_ptr<const Signature> signature);
  StepWorld world() const { return {settings.gravity, &ground, &materials, settings.seed}; }
  bool tables() const { return settings.model == StatisticalModel::tables; }

  void wake(int slot);
  void put_to_sleep(StatisticalBody& body);
  void sort_by_motion();

  void apply_pushes(double dt);
  void find_near_pairs(double dt, std::span<const FullNeighbor> neighbors);
  void find_contacts(double dt, std::span<const FullNeighbor> neighbors);
  void plan_travel(double dt);
  void add_travel();
  PairBody pair_body(Participant p, std::span<const FullNeighbor> neighbors) const;
  void find_contact(Participant first, Participant second, double dt, std::span<const FullNeighbor> neighbors, FoundPair& pair) const;
  Vec3 point_velocity(Participant p, const Vec3& point, std::span<const FullNeighbor> neighbors) const;
  bool is_asleep(Participant p, std::span<const FullNeighbor> neighbors) const {
    return p < 0 ? neighbors[-1 - p].asleep : bodies[p].motion == Motion::asleep;
  }
  void wake_touched(std::span<FullNeighbor> neighbors);
  ContactTally respond_pairs_as_paper();
  void move_alone(int slot, double dt, ContactTally& tally);
  void move_support(StatisticalBody& body, int slot, double dt, ContactTally& tally);
  void move_tables(StatisticalBody& body, int slot, double dt, ContactTally& tally);
  void update_quiet(StatisticalBody& body, double dt);
};

std::uint16_t StatisticalLevel::Impl::find_kind(std::shared_ptr<const Shape> shape, double mass, MaterialId material,
                                                std::shared_ptr<const Signature> signature) {
  for (std::size_t i = 0; i < kinds.size(); ++i)
    if (kinds[i].shape == shape && kinds[i].mass == mass && kinds[i].material == material && kinds[i].signature == signature) return std::uint16_t(i);
  check_that(kinds.size() < 65535, "at most 65,535 kinds of body");
  const Mat3& inertia = shape->inertia_per_mass;
  const bool isotropic = (inertia - inertia.trace() / 3.0 * Mat3::Identity()).norm() < 1e-9 * inertia.norm();
  ClipIndex index;
  if (signature && !tables()) index = ClipIndex(*signature, inertia / (shape->radius * shape->radius), ClipSettings{}.max_distance);
  kinds.push_back({std::move(shape), std::move(signature), std::move(index), mass, material, isotropic});
  return std::uint16_t(kinds.size() - 1);
}

// ---- sleeping and waking

void StatisticalLevel::Impl::wake(int slot) {
  StatisticalBody& body = bodies[slot];
  if (body.motion != Motion::asleep) return;
  body.motion = Motion::dynamic;
  body.quiet_time = 0.0f;
  asleep.erase(std::lower_bound(asleep.begin(), asleep.end(), slot));
  awake.push_back(slot);
  sleepers_changed = true;
}

void StatisticalLevel::Impl::put_to_sleep(StatisticalBody& body) {
  body.motion = Motion::asleep;
  body.velocity.setZero();
  body.spin.setZero();
}

// Awake slots stay in order, so that the result of a step does not depend on the history of sleeping.
void StatisticalLevel::Impl::sort_by_motion() {
  const auto sleeps = [&](std::int32_t slot) { return bodies[slot].motion == Motion::asleep; };
  const auto first_asleep = std::stable_partition(awake.begin(), awake.end(), std::not_fn(sleeps));
  if (first_asleep != awake.end()) {
    asleep.insert(asleep.end(), first_asleep, awake.end());
    std::sort(asleep.begin(), asleep.end());
    awake.erase(first_asleep, awake.end());
    sleepers_changed = true;
  }
  if (!std::is_sorted(awake.begin(), awake.end())) std::sort(awake.begin(), awake.end());
}

// ---- 1 near pairs

void StatisticalLevel::Impl::apply_pushes(double dt) {
  for (const auto& [slot, push] : pushes) {
    StatisticalBody& body = bodies[slot];
    const double impulse = dt / kind_of(body).mass;
    body.velocity += impulse * push.force;
    body.spin += impulse * push.torque;
  }
  pushes.clear();
}

void StatisticalLevel::Impl::find_near_pairs(double dt, std::span<const FullNeighbor> neighbors) {
  const double fall = 0.5 * settings.gravity.norm() * dt * dt;
  const auto bound = [&](const Vec3& position, const Vec3& velocity, double radius) {
    return Bound{position, 1.02 * radius + 0.5 * velocity.norm() * dt + fall};
  };
  if (sleepers_changed) {
    bounds.clear();
    for (const std::int32_t slot : asleep) bounds.push_back({bodies[slot].position, 1.02 * kind_of(bodies[slot]).shape->radius});
    broad_phase.set_still(bounds);
    sleepers_changed = false;
  }
  bounds.clear();
  for (const std::int32_t slot : awake) bounds.push_back(bound(bodies[slot].position, bodies[slot].velocity, kind_of(bodies[slot]).shape->radius));
  for (const FullNeighbor& n : neighbors) bounds.push_back(bound(n.state.position, n.state.velocity, n.shape->radius));
  pairs.clear();
  broad_phase.find_pairs(bounds, pairs);
}

// ---- 2 contacts of those pairs

PairBody StatisticalLevel::Impl::pair_body(Participant p, std::span<const FullNeighbor> neighbors) const {
  if (p < 0) {
    const FullNeighbor& n = neighbors[-1 - p];
    return {n.shape, n.signature, n.state.position, n.state.orientation, 0.8 * n.shape->radius};
  }
  const StatisticalBody& body = bodies[p];
  const BodyKind& kind = kind_of(body);
  return {kind.shape.get(), kind.signature.get(), body.position, body.orientation, body.sphere_radius};
}

Vec3 StatisticalLevel::Impl::point_velocity(Participant p, const Vec3& point, std::span<const FullNeighbor> neighbors) const {
  if (p < 0) {
    const RigidState& s = neighbors[-1 - p].state;
    return s.velocity + s.angular_velocity.cross(point - s.position);
  }
  const StatisticalBody& body = bodies[p];
  if (body.motion == Motion::asleep) return Vec3::Zero();
  return body.velocity + angular_velocity(body.orientation, body.spin, *kind_of(body).shape).cross(point - body.position);
}

void StatisticalLevel::Impl::find_contact(Participant first, Participant second, double dt, std::span<const FullNeighbor> neighbors, FoundPair& pair) const {
  const PairBody a = pair_body(first, neighbors), b = pair_body(second, neighbors);
  const double touching = 0.01 * std::min(a.shape->radius, b.shape->radius);
  const bool statistical = first >= 0 && second >= 0;
  const double gone = statistical ? travels[first].gone + travels[second].gone : 0.0;
  const PairRecord* known = pair_memory.find(pair.key);
  if (statistical && known && known->gap - (gone - known->travel) > touching + travels[first].ahead + travels[second].ahead) {
    pair.record = *known;
    return;
  }
  const Vec3 closing = point_velocity(first, a.position, neighbors) - point_velocity(second, b.position, neighbors);
  const double margin = touching + closing.norm() * dt;
  std::optional<PairContact> contact;
  if (tables()) {
    contact = find_sphere_contact(a, b, margin);
  } else {
    HullContactSearch search = find_hull_contact(a, b, known ? Vec3(known->normal.cast<double>()) : Vec3::Zero(), margin);
    pair.record = {search.normal.cast<float>(), float(search.gap), gone};
    contact = std::move(search.contact);
  }
  if (!contact) return;
  // It counts if it closes within the step.
  const auto closes = [&](const ManifoldPoint& p) {
    const Vec3 velocity = point_velocity(first, p.point, neighbors) - point_velocity(second, p.point, neighbors);
    return p.gap + velocity.dot(contact->normal) * dt <= touching;
  };
  const auto points = std::span(contact->manifold.points).first(std::size_t(contact->manifold.count));
  if (std::ranges::any_of(points, closes)) pair.contact = CrowdContact{first, second, *contact};
}

void StatisticalLevel::Impl::find_contacts(double dt, std::span<const FullNeighbor> neighbors) {
  const auto mover = [&](std::int32_t i) { return i < std::int32_t(awake.size()) ? awake[i] : -1 - (i - std::int32_t(awake.size())); };
  // The lower owner first, so that a contact is the same whichever of its bodies is full.
  const auto owner = [&](Participant p) { return p < 0 ? neighbors[-1 - p].owner : bodies[p].owner; };
  for (const std::int32_t slot : awake) bodies[slot].crowded = false;
  found.resize(pairs.size());
  parallel(std::int64_t(pairs.size()), 64, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      Participant first = mover(pairs[i].first), second = pairs[i].second >= 0 ? mover(pairs[i].second) : asleep[-1 - pairs[i].second];
      if (owner(second) < owner(first)) std::swap(first, second);
      found[i] = {contact_key(owner(first), owner(second)), {}, {}};
      if (first < 0 && second < 0) continue;  // two full bodies are the full level's matter
      if (is_asleep(first, neighbors) && is_asleep(second, neighbors)) continue;
      find_contact(first, second, dt, neighbors, found[i]);
    }
  });
  contacts.clear();
  if (!tables()) pair_memory.begin(pairs.size());
  for (const FoundPair& pair : found) {
    if (!tables()) pair_memory.put(pair.key, pair.record);
    if (!pair.contact) continue;
    contacts.push_back(*pair.contact);
    for (const Participant p : {pair.contact->first, pair.contact->second})
      if (p >= 0) bodies[p].crowded = true;
  }
  if (!tables()) pair_memory.end();
}

// No point of a body goes farther than its centre does plus R times the angle turned.
void StatisticalLevel::Impl::plan_travel(double dt) {
  const double fall = 0.5 * settings.gravity.norm() * dt * dt;
  for (const std::int32_t slot : awake) {
    const StatisticalBody& body = bodies[slot];
    const Shape& shape = *kind_of(body).shape;
    travels[slot].ahead = body.velocity.norm() * dt + fall + angular_velocity(body.orientation, body.spin, shape).norm() * shape.radius * dt;
    travels[slot].position = body.position;
    travels[slot].orientation = body.orientation;
  }
}

void StatisticalLevel::Impl::add_travel() {
  for (const std::int32_t slot : awake) {
    const StatisticalBody& body = bodies[slot];
    Travel& t = travels[slot];
    const double same = (body.orientation.coeffs() - t.orientation.coeffs()).squaredNorm();
    const double opposite = (body.orientation.coeffs() + t.orientation.coeffs()).squaredNorm();
    t.gone += (body.position - t.position).norm() + 2.2 * std::sqrt(std::min(same, opposite)) * kind_of(body).shape->radius;
    t.ahead = 0.0;
  }
}

void StatisticalLevel::Impl::wake_touched(std::span<FullNeighbor> neighbors) {
  for (const CrowdContact& c : contacts)
    for (const auto& [sleeper, other] : {std::pair{c.first, c.second}, std::pair{c.second, c.first}}) {
      if (!is_asleep(sleeper, neighbors)) continue;
      const double radius = sleeper < 0 ? neighbors[-1 - sleeper].shape->radius : kind_of(bodies[sleeper]).shape->radius;
      const double speed = point_velocity(other, c.contact.manifold.points[0].point, neighbors).norm();
      if (speed <= kWakeFactor * sleep_speed(radius)) continue;
      if (sleeper < 0) neighbors[-1 - sleeper].asleep = false;
      else wake(sleeper);
    }
}

// Both bodies of a pair respond by themselves and then move as if alone; pairs with full bodies keep the impulse that both share.
ContactTally StatisticalLevel::Impl::respond_pairs_as_paper() {
  ContactTally tally;
  std::erase_if(contacts, [&](const CrowdContact& c) {
    if (c.first < 0 || c.second < 0) return false;
    StatisticalBody &first = bodies[c.first], &second = bodies[c.second];
    const BodyKind &first_kind = kind_of(first), &second_kind = kind_of(second);
    respond_pair_as_paper(first, first_kind, second, second_kind, c.contact, world(), materials.law(first_kind.material, second_kind.material),
                          settings.tables, tally);
    first.crowded = second.crowded = false;
    return true;
  });
  return tally;
}

// ---- 3 flight and ground contact of bodies that touch no other

void StatisticalLevel::Impl::update_quiet(StatisticalBody& body, double dt) {
  const BodyKind& kind = kind_of(body);
  const double speed = sleep_speed(kind.shape->radius);
  const bool among_others = body.crowded || body.since_crowded < kLeaningSteps;
  const double limit = among_others ? 0.5 * speed * speed : kAloneSleepEnergy * settings.gravity.norm() * kind.shape->radius;
  body.since_crowded = body.crowded ? 0 : std::uint8_t(std::min(255, body.since_crowded + 1));
  body.quiet_time = kinetic_energy(body, *kind.shape) < limit ? body.quiet_time + float(dt) : 0.0f;
  if (settings.sleeping && body.quiet_time >= (among_others ? kSleepTime : kAloneSleepTime)) put_to_sleep(body);
}

void StatisticalLevel::Impl::move_support(StatisticalBody& body, int slot, double dt, ContactTally& tally) {
  const BodyKind& kind = kind_of(body);
  const double gravity = settings.gravity.norm();
  static const ClipSettings clip_settings;
  if (body.motion == Motion::settling) {
    const HalfSpace& plane = ground.planes[resting[slot].plane];
    if (advance_clip(clips[slot], body, kind, plane, gravity, dt, clip_settings)) {
      if (settings.sleeping) put_to_sleep(body);
    }
    return;
  }
  static const SupportSettings support_settings;
  tally = step_support_body(body, kind, world(), dt, support_settings);
  if (tally.touched_plane < 0) return update_quiet(body, dt);
  const HalfSpace& plane = ground.planes[tally.touched_plane];
  if (!kind.clips.empty() && world().is_horizontal(plane)) {
    if (const auto clip = find_clip(body, kind, plane, gravity, clip_settings)) {
      clips[slot] = *clip;
      resting[slot].plane = tally.touched_plane;
      body.motion = Motion::settling;
      return;
    }
  }
  update_quiet(body, dt);
}

void StatisticalLevel::Impl::move_tables(StatisticalBody& body, int slot, double dt, ContactTally& tally) {
  const BodyKind& kind = kind_of(body);
  static const TablesSettings defaults;
  TablesSettings tables_settings = defaults;
  tables_settings.options = settings.tables;
  if (body.motion == Motion::settling) {
    const double rest = kind.signature->rest_poses[resting[slot].pose].height * kind.shape->radius;
    const double blend = defaults.blend_time * std::sqrt(kind.shape->radius / std::max(1e-9, settings.gravity.norm()));
    body.sphere_radius += float((rest - body.sphere_radius) * std::min(1.0, 2.0 * dt / blend));
  } else if (steps % std::max(1, settings.tables.radius_update_interval) == 0) {
    body.sphere_radius = float(find_sphere_radius(body, kind, settings.tables, settings.seed));
  }
  tally = step_tables_body(body, resting[slot], kind, world(), dt, tables_settings);
  update_quiet(body, dt);
}

void StatisticalLevel::Impl::move_alone(int slot, double dt, ContactTally& tally) {
  if (tables()) move_tables(bodies[slot], slot, dt, tally);
  else move_support(bodies[slot], slot, dt, tally);
}

// ---- the level

StatisticalLevel::StatisticalLevel(const StatisticalSettings& settings, const StaticGround& ground, const MaterialTable& materials)
    : impl_(std::make_unique<Impl>(settings, ground, materials)) {}
StatisticalLevel::~StatisticalLevel() = default;

int StatisticalLevel::add(std::uint32_t owner, std::shared_ptr<const Shape> shape, double mass, MaterialId material, const RigidState& state,
                          bool asleep, std::shared_ptr<const Signature> signature) {
  Impl& level = *impl_;
  check_that(!level.tables() || signature != nullptr, "the tables model needs a signature");
  level.reach = std::max(level.reach, shape->radius);
  StatisticalBody body;
  body.kind = level.find_kind(std::move(shape), mass, material, std::move(signature));
  body.owner = owner;
  const int slot = size();
  level.bodies.push_back(body);
  level.clips.emplace_back();
  level.resting.emplace_back();
  level.travels.emplace_back();
  level.travels.back().gone = level.longest_travel + 10.0 * level.reach;
  level.angular_velocity_given.emplace_back();
  level.awake.push_back(slot);
  set_state(slot, state);
  if (level.tables()) level.bodies[slot].sphere_radius = float(find_sphere_radius(level.bodies[slot], level.kind_of(level.bodies[slot]), level.settings.tables, level.settings.seed));
  if (asleep) {
    level.put_to_sleep(level.bodies[slot]);
    level.angular_velocity_given[slot].reset();
    level.sort_by_motion();
  }
  return slot;
}

std::optional<std::uint32_t> StatisticalLevel::remove(int slot) {
  Impl& level = *impl_;
  check_that(slot >= 0 && slot < size(), "slot out of range");
  const StatisticalBody gone = level.bodies[slot];
  const double radius = level.kind_of(gone).shape->radius;
  // What rests on it, or it on, must find new support.
  std::vector<int> touching;
  for (const std::int32_t other : level.asleep)
    if (other != slot && (level.bodies[other].position - gone.position).norm() < 1.02 * (radius + level.kind_of(level.bodies[other]).shape->radius))
      touching.push_back(other);
  for (const int other : touching) level.wake(other);

  const int last = size() - 1;
  if (!std::ranges::is_sorted(level.awake)) std::ranges::sort(level.awake);
  for (auto* list : {&level.awake, &level.asleep}) rename_in_order(*list, last, slot);
  std::erase_if(level.pushes, [&](const auto& push) { return push.first == slot; });
  for (auto& push : level.pushes)
    if (push.first == last) push.first = slot;
  level.bodies[slot] = level.bodies[last];
  level.clips[slot] = level.clips[last];
  level.resting[slot] = level.resting[last];
  level.longest_travel = std::max(level.longest_travel, level.travels[slot].gone);
  level.travels[slot] = level.travels[last];
  level.travels.pop_back();
  level.bodies.pop_back();
  level.clips.pop_back();
  level.resting.pop_back();
  level.angular_velocity_given[slot] = level.angular_velocity_given[last];
  level.angular_velocity_given.pop_back();
  level.sleepers_changed = true;
  return slot == last ? std::nullopt : std::optional(level.bodies[slot].owner);
}

void StatisticalLevel::step(double dt, std::span<FullNeighbor> neighbors, StepReport& report, std::span<const FullContact> full_contacts) {
  Impl& level = *impl_;
  Stopwatch watch;
  level.angular_velocity_given.assign(level.bodies.size(), std::nullopt);
  level.apply_pushes(dt);

  ContactTally paper_tally;
  // 1 Near pairs: none to look for with a single body.
  level.contacts.clear();
  const bool pair_phase = level.bodies.size() + neighbors.size() > 1 && !level.awake.empty() + !neighbors.empty() > 0;
  if (pair_phase) {
    level.find_near_pairs(dt, neighbors);
    ++report.counters.pair_phases;
    report.times.broad_phase_ms += watch.lap_ms();
    // 2 Contacts of those pairs.
    level.plan_travel(dt);
    level.find_contacts(dt, neighbors);
    level.wake_touched(neighbors);
    if (level.tables() && level.settings.tables.paper_pair_rule) paper_tally = level.respond_pairs_as_paper();
    report.times.pairs_ms += watch.lap_ms();
  } else {
    for (const std::int32_t slot : level.awake) level.bodies[slot].crowded = false;
  }

  // 3 Bodies that touch no other.
  const std::int64_t awake = std::int64_t(level.awake.size());
  level.tallies.assign(std::size_t(awake), {});
  level.parallel(awake, 256, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      if (!level.bodies[level.awake[i]].crowded) level.move_alone(level.awake[i], dt, level.tallies[i]);
  });
  ContactTally tally = paper_tally;
  for (const ContactTally& t : level.tallies) tally += t;
  report.times.flight_ms += watch.lap_ms();

  // 4 Bodies that do.
  if (!level.contacts.empty()) {
    for (const std::int32_t slot : level.awake)
      if (level.bodies[slot].crowded && level.bodies[slot].motion == Motion::settling) level.bodies[slot].motion = Motion::dynamic;
    tally += level.crowd.step(level.bodies, level.kinds, neighbors, full_contacts, level.contacts, level.world(), level.settings.model, dt);
    for (const std::int32_t slot : level.awake)
      if (level.bodies[slot].crowded) level.update_quiet(level.bodies[slot], dt);
    report.times.pairs_ms += watch.lap_ms();
  }

  if (pair_phase) level.add_travel();

  ++level.steps;

  // 5 Rest.
  level.sort_by_motion();
  report.times.rest_ms += watch.lap_ms();
  report.contacts += int(tally.contacts);
  report.counters.energy_clamps += tally.energy_clamps;
  report.counters.table_extrapolations += tally.table_extrapolations;
}

int StatisticalLevel::size() const { return int(impl_->bodies.size()); }
std::span<const std::int32_t> StatisticalLevel::awake() const { return impl_->awake; }
int StatisticalLevel::asleep_count() const { return int(impl_->asleep.size()); }

RigidState StatisticalLevel::state(int slot) const {
  const StatisticalBody& body = impl_->bodies[slot];
  const std::optional<Vec3>& given = impl_->angular_velocity_given[slot];
  return {body.position, body.orientation, body.velocity,
          given ? *given : angular_velocity(body.orientation, body.spin, *impl_->kind_of(body).shape)};
}

const Vec3& StatisticalLevel::position(int slot) const { return impl_->bodies[slot].position; }

void StatisticalLevel::set_state(int slot, const RigidState& state) {
  wake(slot);
  StatisticalBody& body = impl_->bodies[slot];
  impl_->travels[slot].gone += (state.position - body.position).norm() + 4.0 * impl_->kind_of(body).shape->radius;
  body.position = state.position;
  body.orientation = state.orientation;
  body.velocity = state.velocity;
  body.spin = spin_of(state.orientation, state.angular_velocity, *impl_->kind_of(body).shape);
  impl_->angular_velocity_given[slot] = state.angular_velocity;
  body.motion = Motion::dynamic;
  body.quiet_time = 0.0f;
}

bool StatisticalLevel::asleep(int slot) const { return impl_->bodies[slot].motion == Motion::asleep; }
void StatisticalLevel::wake(int slot) { impl_->wake(slot); }

void StatisticalLevel::add_force(int slot, const Vec3& force, const Vec3& torque) {
  wake(slot);
  impl_->pushes.push_back({slot, {force, torque}});
}

double StatisticalLevel::reach() const { return impl_->reach; }

}  // namespace lodestone
