#include "lod/rungs/statistical_level.h"

#include <algorithm>

#include "lod/rungs/drift.h"
#include "lod/rungs/near_bodies.h"
#include "lod/rungs/near_search.h"
#include "lod/timing/stage_timer.h"
#include "lod/timing/thread_clock.h"

namespace lodestone {
namespace {

constexpr double kTouchFactor = 1.02;  // of the radii: what rests on a removed body

}  // namespace

struct StatisticalLevel::Impl {
  Impl(const StatisticalSettings& s, const Ground& g, const MaterialTable& m)
      : settings(s),
        jobs(s.jobs ? s.jobs : make_job_runner(s.threads)),
        kinds(!s.tables.as_published()),
        support(s, g, m, kinds, sleepers),
        tables(s, g, m, kinds, sleepers, jobs),
        search(s, sleepers, jobs),
        near_bodies(s, g, m, kinds, jobs) {}

  StatisticalSettings settings;
  JobRunner jobs;
  Kinds kinds;
  Sleepers sleepers;
  SupportLevel support;
  TablesLevel tables;
  NearSearch search;
  NearBodies near_bodies;
  std::vector<StatisticalBody> guest_bodies;
  std::vector<std::uint32_t> fell_asleep;
  double reach = 0.0;  // m, greatest bounding radius
  StatisticalCost cost;
  bool clocked = false;

  template <class Do>
  auto at(StatisticalPlace place, const Do& act) {
    return place.model == StatisticalModel::tables ? act(tables) : act(support);
  }
  Vec3 position(StatisticalPlace place) const {
    return place.model == StatisticalModel::tables ? tables.position(place.slot)
                                                   : support.body(place.slot).position;
  }
  double radius(StatisticalPlace place) const {
    return place.model == StatisticalModel::tables ? tables.radius(place.slot)
                                                   : support.kind_of(support.body(place.slot)).shape->radius;
  }
  std::uint32_t owner(StatisticalPlace place) const {
    return place.model == StatisticalModel::tables ? tables.owner(place.slot)
                                                   : support.body(place.slot).owner;
  }
  double share_of_support() const;
  double clock() const { return clocked ? thread_time_ms() : 0.0; }
  void let_fall(StatisticalPlace place);
  void wake_touching(StatisticalPlace place);
  bool any_pairs(std::span<const FullNeighbor> neighbors) const;
  void find_near(double dt, const Vec3& drift, std::span<const FullNeighbor> neighbors, StageTimes& times);
  void forget_near();
  void move_hulls(double dt, std::span<FullNeighbor> neighbors, std::span<const FullContact> full_contacts,
                  StageTimes& times, ContactTally& tally);
  void count_bodies();
};

// Wakes it, though what bore it may be gone.
void StatisticalLevel::Impl::let_fall(StatisticalPlace place) {
  if (place.model == StatisticalModel::tables && tables.asleep(place.slot)) tables.let_tip(place.slot);
  at(place, [&](auto& level) { level.wake(place.slot); });
}

// What rests on a body, or it on, must find new support once it is gone, or was put elsewhere.
void StatisticalLevel::Impl::wake_touching(StatisticalPlace gone) {
  const Vec3 center = position(gone);
  const double own_radius = radius(gone);
  std::vector<StatisticalPlace> touching;
  sleepers.find_near(center, kTouchFactor * own_radius, [&](StatisticalModel model, std::int32_t slot) {
    const StatisticalPlace other{model, slot};
    if (other != gone && (position(other) - center).norm() < kTouchFactor * (own_radius + radius(other)))
      touching.push_back(other);
  });
  std::ranges::sort(touching, {}, [](StatisticalPlace p) { return std::pair(p.model, p.slot); });
  for (const StatisticalPlace other : touching) let_fall(other);
}

bool StatisticalLevel::Impl::any_pairs(std::span<const FullNeighbor> neighbors) const {
  const bool any_moves = tables.awake().size() + support.awake().size() > 0 ||
                         std::ranges::any_of(neighbors, [](const FullNeighbor& n) { return !n.asleep; });
  return any_moves && std::size_t(tables.size() + support.size()) + neighbors.size() > 1;
}

// Of the time of hulls: the rest is that of bodies of `tables` which are at edges of the ground.
double StatisticalLevel::Impl::share_of_support() const {
  const auto hulls_of_tables = double(std::ranges::count_if(search.guests(), &Guest::on_hull));
  if (hulls_of_tables == 0.0) return 1.0;
  const double others = double(support.awake().size() + search.guests().size()) - hulls_of_tables;
  return others / (others + hulls_of_tables);
}

void StatisticalLevel::Impl::count_bodies() {
  cost.tables = cost.support = {};
  const auto count = [](auto& counts, Activity activity) { ++counts[std::size_t(activity)]; };
  for (const std::int32_t slot : tables.awake())
    count(cost.tables, tables.crowded(slot) ? Activity::crowded : Activity::alone);
  for (const std::int32_t slot : support.awake())
    count(cost.support, support.crowded(slot) ? Activity::crowded : Activity::alone);
  cost.tables[std::size_t(Activity::asleep)] = tables.asleep_count();
  cost.support[std::size_t(Activity::asleep)] = support.asleep_count();
}

StatisticalLevel::StatisticalLevel(const StatisticalSettings& settings, const Ground& ground,
                                   const MaterialTable& materials)
    : impl_(std::make_unique<Impl>(settings, ground, materials)) {}
StatisticalLevel::~StatisticalLevel() = default;

StatisticalPlace StatisticalLevel::add(StatisticalModel model, std::uint32_t owner,
                                       std::shared_ptr<const Shape> shape, double mass, MaterialId material,
                                       const RigidState& state, bool asleep,
                                       std::shared_ptr<const Signature> signature, bool arrives) {
  impl_->reach = std::max(impl_->reach, shape->radius);
  const std::uint32_t kind = impl_->kinds.take(model, std::move(shape), material, std::move(signature));
  const StatisticalPlace place{model, impl_->at({model, 0}, [&](auto& level) {
                                 return level.add(owner, kind, mass, state, asleep, arrives);
                               })};
  impl_->near_bodies.make_room(std::size_t(impl_->support.size()));
  return place;
}

std::optional<std::uint32_t> StatisticalLevel::remove(StatisticalPlace place, bool stays) {
  if (!stays) impl_->wake_touching(place);
  const std::uint32_t kind = impl_->at(place, [&](const auto& level) { return level.kind(place.slot); });
  const auto moved = impl_->at(place, [&](auto& level) { return level.remove(place.slot); });
  impl_->kinds.give_back(kind);
  return moved;
}

// 3b
void StatisticalLevel::Impl::find_near(double dt, const Vec3& drift, std::span<const FullNeighbor> neighbors,
                                       StageTimes& times) {
  {
    const StageTimer timer(times.broad_phase_ms);
    search.fill(dt, drift, tables, support, neighbors);
  }
  const StageTimer timer(times.pairs_ms);
  search.find(tables, support, neighbors);
}

void StatisticalLevel::Impl::forget_near() {
  search.clear();
  tables.forget_contacts();
}

// 3d
void StatisticalLevel::Impl::move_hulls(double dt, std::span<FullNeighbor> neighbors,
                                        std::span<const FullContact> full_contacts, StageTimes& times,
                                        ContactTally& tally) {
  guest_bodies.clear();
  for (Guest& guest : search.guests()) {
    tables.describe(guest);
    guest_bodies.push_back(tables.guest_body(guest));
  }
  support.admit_guests(guest_bodies);
  near_bodies.step(dt, support, search.guests(), search, neighbors, full_contacts, times, tally);
  tables.take_guests(search.guests(), guest_bodies, support.bodies().subspan(std::size_t(support.size())));
  support.dismiss_guests();
}

void StatisticalLevel::step(double dt, std::span<FullNeighbor> neighbors, StepReport& report,
                            std::span<const FullContact> full_contacts) {
  Impl& s = *impl_;
  SupportLevel& support = s.support;
  TablesLevel& tables = s.tables;
  NearSearch& search = s.search;
  StageTimes& times = report.times;
  ContactTally tally;
  const double started = s.clock();
  // 3a start
  const Vec3 drift = find_drift(dt, tables, support, neighbors);
  {
    const StageTimer timer(times.flight_ms);
    tables.begin_step(dt, drift, search.order_of_spheres(), tally);
    support.begin_step(dt, tally);
  }
  // 3b near pairs, and the contacts of spheres
  const bool pair_phase = s.any_pairs(neighbors);
  report.counters.pair_phases += pair_phase;
  if (pair_phase)
    s.find_near(dt, drift, neighbors, times);
  else
    s.forget_near();
  search.invite_cornered(tables, support);
  // 3c spheres answer
  {
    const StageTimer timer(times.crowd_ms);
    tables.respond(search.guests(), tally);
  }
  // 3d hulls and their guests
  const double hulls_from = s.clock();
  if (!support.awake().empty() || !search.pairs().empty() || !search.guests().empty())
    s.move_hulls(dt, neighbors, full_contacts, times, tally);
  else
    s.near_bodies.forget_pairs();
  const double hulls_until = s.clock();
  // 3e spheres move
  {
    const StageTimer timer(times.flight_ms);
    tables.finish(tally);
  }
  // 3f rest
  {
    const StageTimer timer(times.rest_ms);
    tables.rest();
    support.end_step();
  }
  s.fell_asleep.assign(tables.fell_asleep().begin(), tables.fell_asleep().end());
  s.fell_asleep.insert(s.fell_asleep.end(), support.fell_asleep().begin(), support.fell_asleep().end());
  if (s.clocked) {
    s.cost.support_ms = (hulls_until - hulls_from) * s.share_of_support();
    s.cost.tables_ms = s.clock() - started - s.cost.support_ms;
    s.count_bodies();
  }
  if (tables.size() > 0) report.bytes_moved += tables.count_traffic(pair_phase);
  report.contacts += int(tally.contacts);
  report.counters.energy_clamps += tally.energy_clamps;
  report.counters.table_extrapolations += tally.table_extrapolations;
  report.counters.states_recovered += tally.states_recovered;
}

void StatisticalLevel::forget_contacts() {
  impl_->tables.forget_contacts();
  impl_->near_bodies.forget_pairs();
  impl_->fell_asleep.clear();
}

std::size_t StatisticalLevel::bytes() const {
  return impl_->tables.size() == 0 ? 0
                                   : impl_->tables.bytes() + impl_->search.bytes() + impl_->sleepers.bytes();
}
int StatisticalLevel::size(StatisticalModel model) const {
  return model == StatisticalModel::tables ? impl_->tables.size() : impl_->support.size();
}
int StatisticalLevel::asleep_count() const {
  return impl_->support.asleep_count() + impl_->tables.asleep_count();
}
std::span<const std::uint32_t> StatisticalLevel::fell_asleep() const { return impl_->fell_asleep; }

void StatisticalLevel::take_woke(std::vector<std::uint32_t>& owners) {
  impl_->tables.take_woke(owners);
  impl_->support.take_woke(owners);
}

void StatisticalLevel::set_gravity(const Vec3& gravity) {
  impl_->settings.gravity = gravity;
  impl_->support.set_gravity(gravity);
  impl_->tables.set_gravity(gravity);
  impl_->search.set_gravity(gravity);
  impl_->near_bodies.set_gravity(gravity);
}

void StatisticalLevel::set_log(ContactLog* log) {
  impl_->support.set_log(log);
  impl_->tables.set_log(log);
  impl_->near_bodies.set_log(log);
}

void StatisticalLevel::set_threads(int threads) { impl_->search.set_threads(threads); }

void StatisticalLevel::find_awake(std::vector<std::uint32_t>& owners) const {
  for (const std::int32_t slot : impl_->tables.awake()) owners.push_back(impl_->tables.owner(slot));
  for (const std::int32_t slot : impl_->support.awake()) owners.push_back(impl_->support.body(slot).owner);
}

RigidState StatisticalLevel::state(StatisticalPlace place) const {
  return impl_->at(place, [&](const auto& level) { return level.state(place.slot); });
}
Vec3 StatisticalLevel::position(StatisticalPlace place) const { return impl_->position(place); }
void StatisticalLevel::set_state(StatisticalPlace place, const RigidState& state) {
  impl_->at(place, [&](auto& level) { level.set_state(place.slot, state); });
}
bool StatisticalLevel::asleep(StatisticalPlace place) const {
  return impl_->at(place, [&](const auto& level) { return level.asleep(place.slot); });
}
double StatisticalLevel::sphere_radius(StatisticalPlace place) const {
  return place.model == StatisticalModel::tables ? impl_->tables.sphere_radius(place.slot) : 0.0;
}
void StatisticalLevel::wake(StatisticalPlace place) {
  impl_->at(place, [&](auto& level) { level.wake(place.slot); });
}
void StatisticalLevel::note_placed(StatisticalPlace place) {
  if (place.model == StatisticalModel::support) impl_->support.note_placed(place.slot);
}
void StatisticalLevel::let_fall_near(StatisticalPlace place) { impl_->wake_touching(place); }
void StatisticalLevel::put_to_sleep(StatisticalPlace place) {
  impl_->at(place, [&](auto& level) { level.put_to_sleep(place.slot); });
}
void StatisticalLevel::add_force(StatisticalPlace place, const Vec3& force, const Vec3& torque) {
  impl_->at(place, [&](auto& level) { level.add_force(place.slot, force, torque); });
}
double StatisticalLevel::reach() const { return impl_->reach; }

void StatisticalLevel::find_sleepers(const Vec3& center, double reach,
                                     std::vector<std::uint32_t>& owners) const {
  impl_->sleepers.find_near(center, reach, [&](StatisticalModel model, std::int32_t slot) {
    owners.push_back(impl_->owner({model, slot}));
  });
}

const std::shared_ptr<const Signature>& StatisticalLevel::signature(StatisticalPlace place) const {
  const std::uint32_t kind = impl_->at(place, [&](const auto& level) { return level.kind(place.slot); });
  return impl_->kinds[kind].signature;
}

std::vector<KindSignature> StatisticalLevel::signatures() const { return impl_->kinds.signatures(); }

void StatisticalLevel::archive(StateArchive& a,
                               std::span<const std::shared_ptr<const Signature>> signatures) {
  Impl& s = *impl_;
  s.kinds.archive(a, signatures);
  a(s.sleepers, s.support, s.tables, s.search, s.near_bodies, s.fell_asleep, s.reach, s.cost, s.clocked);
  s.near_bodies.make_room(std::size_t(s.support.size()));
}

std::span<const CarriedFull> StatisticalLevel::carriers() const { return impl_->near_bodies.carriers(); }

void StatisticalLevel::find_contacts(std::vector<PairContact>& contacts) const {
  for (const CrowdContact& contact : impl_->near_bodies.contacts()) contacts.push_back(contact.contact);
}

Activity StatisticalLevel::activity(StatisticalPlace place) const {
  return impl_->at(place, [&](const auto& level) {
    return level.asleep(place.slot)    ? Activity::asleep
           : level.crowded(place.slot) ? Activity::crowded
                                       : Activity::alone;
  });
}

bool StatisticalLevel::is_carried(StatisticalPlace place) const {
  return place.model == StatisticalModel::support && impl_->support.body(place.slot).carried;
}

const StatisticalCost& StatisticalLevel::cost() const { return impl_->cost; }
void StatisticalLevel::set_clocked(bool clocked) { impl_->clocked = clocked; }

}  // namespace lodestone
