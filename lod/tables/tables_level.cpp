#include "lod/tables/tables_level.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lod/contact/hull_contacts.h"
#include "lod/statistical/parting.h"
#include "lod/tables/tables_traffic.h"
#include "reference/error.h"

namespace lodestone {
namespace {

constexpr auto kEasedUnits = std::uint8_t(125.0f * kEasedTime);  // of 8 ms
static_assert(125.0f * kEasedTime < 256.0f);

}  // namespace

TablesLevel::TablesLevel(const StatisticalSettings& settings, const Ground& ground,
                         const MaterialTable& materials, const Kinds& kinds, Sleepers& sleepers,
                         const JobRunner& jobs)
    : settings_(settings),
      ground_(ground),
      materials_(materials),
      all_kinds_(kinds),
      sleepers_(sleepers),
      jobs_(jobs),
      simd_(settings.simd),
      rest_law_(settings.sleep) {
  tables_.options = settings.tables;
  contacts_.set_pair_filter(settings.pair_filter);
}

int TablesLevel::add(std::uint32_t owner, std::uint32_t kind, double mass, const RigidState& state,
                     bool asleep, bool arrives) {
  kinds_.take(all_kinds_, kind, settings_.gravity.norm());
  const std::int64_t place = spheres_.add(owner);
  const auto slot = int(spheres_.slot[place]);
  spheres_.kind[place] = kind;
  spheres_.inverse_mass[place] = 1.0 / mass;
  one_mass_ =
      size() == 1 || (one_mass_ && spheres_.inverse_mass[place] == spheres_.inverse_mass[place > 0 ? 0 : 1]);
  set_state(slot, state);
  if (settings_.tables.as_published()) {
    const StatisticalBody body = spheres_.body(place);
    spheres_.radius[place] =
        arrives ? radius_at_ground(body, kind_of(place))
                : float(find_sphere_radius(body, kind_of(place), settings_.tables, settings_.seed));
  }
  if (arrives) spheres_.eased[std::size_t(place)] = kEasedUnits, ++eased_;
  if (asleep) lay_still(place);
  return slot;
}

std::optional<std::uint32_t> TablesLevel::remove(int slot) {
  check_that(slot >= 0 && slot < size(), "slot out of range");
  const auto gone = std::uint32_t(slot), last = std::uint32_t(size()) - 1;
  const std::int64_t place = spheres_.place_of_slot[gone];
  const Vec3 position = spheres_.position(place);
  eased_ -= spheres_.eased[std::size_t(place)] > 0;
  if (asleep(slot)) still().remove(gone, position, kind_of(place).shape->radius);
  clips_.end(place);
  const std::int64_t last_place = spheres_.place_of_slot[last];
  const bool renamed = gone != last, last_sleeps = renamed && last_place >= spheres_.awake;
  const Vec3 last_position = spheres_.position(last_place);
  const double last_radius = kind_of(last_place).shape->radius;
  if (last_sleeps) still().remove(last, last_position, last_radius);
  spheres_.remove(gone);
  if (last_sleeps) still().insert(gone, last_position, last_radius);
  if (renamed)
    if (SphereClips::Playing* clip = clips_.of(std::int64_t(place_of(slot)))) clip->slot = slot;
  forces_.forget(slot);
  forces_.rename(int(last), slot);
  given_.erase(gone);
  if (auto moved = given_.extract(last)) {
    moved.key() = gone;
    given_.insert(std::move(moved));
  }
  searched_ = 0;
  return renamed ? std::optional(spheres_.owner[spheres_.place_of_slot[gone]]) : std::nullopt;
}

// The height that its hull has over the plane that it is nearest to, where it is near one: it neither sinks
// nor rises as it arrives, or while it is a guest. Else as it moves, but into no plane.
float TablesLevel::radius_at_ground(const StatisticalBody& body, const BodyKind& kind) const {
  constexpr double kNear = 0.3;  // over R: a gap
  const Shape& shape = *kind.shape;
  double least_gap = kNear * shape.radius,
         radius = find_sphere_radius(body, kind, settings_.tables, settings_.seed),
         lowest_height = shape.radius;
  thread_local std::vector<GroundNear> near;
  thread_local std::vector<HalfSpace> faces;
  near.clear(), faces.clear();
  const PairBody hull{&shape, body.position, body.orientation};
  find_ground_near(ground_, body.position, shape.radius + least_gap, 0.0, near, &hull);
  for (const GroundNear& n : near) faces.push_back(n.plane(body.position));
  for (const HalfSpace& plane : join_planes(ground_.planes(), faces)) {
    const double height = plane.height_of(body.position);
    lowest_height = std::min(lowest_height, height);
    if (height > shape.radius + least_gap) continue;
    std::int32_t hint = 0;
    const HullContact lowest = find_lowest_point(shape, body.orientation, plane.normal, height, hint);
    if (lowest.gap < least_gap)
      least_gap = lowest.gap, radius = -lowest.arm.dot(plane.normal);
    else if (lowest.gap > kNear * shape.radius)  // not to be touched by what lies on something else
      lowest_height = std::min(lowest_height, height - 0.5 * lowest.gap);
  }
  return float(std::max(std::min(radius, lowest_height), least_height(shape)));
}

RigidState TablesLevel::state(int slot) const {
  if (!given_.empty())
    if (const auto given = given_.find(std::uint32_t(slot)); given != given_.end()) return given->second;
  const std::int64_t place = spheres_.place_of_slot[std::size_t(slot)];
  const Quat orientation = spheres_.orientation(place);
  return {spheres_.position(place), orientation, spheres_.velocity(place),
          angular_velocity(orientation, spheres_.spin(place), *kind_of(place).shape)};
}

void TablesLevel::set_state(int slot, const RigidState& state) {
  wake(slot);
  const std::int64_t place = spheres_.place_of_slot[std::size_t(slot)];
  clips_.end(place);
  StatisticalBody body = spheres_.body(place);
  body.position = state.position;
  body.orientation = state.orientation;
  body.velocity = state.velocity;
  body.spin = spin_of(state.orientation, state.angular_velocity, *kind_of(place).shape);
  body.motion = Motion::dynamic;
  body.quiet_time = 0.0f;
  spheres_.put(place, body);
  spheres_.twice_energy[place] = float(body.spin.dot(state.angular_velocity));
  if (!settings_.tables.as_published() && is_sound(body, *kind_of(place).shape))
    spheres_.radius[std::size_t(place)] = radius_at_ground(spheres_.body(place), kind_of(place));
  given_[std::uint32_t(slot)] = state;
}

void TablesLevel::wake(int slot) {
  if (!asleep(slot)) return;
  const std::int64_t place = spheres_.place_of_slot[std::size_t(slot)];
  still().remove(std::uint32_t(slot), spheres_.position(place), kind_of(place).shape->radius);
  spheres_.wake(std::uint32_t(slot));
  searched_ = 0;
  woke_.push_back(spheres_.owner[place_of(slot)]);
}

void TablesLevel::let_tip(int slot) { spheres_.tipping_credit[place_of(slot)] = kWholeCredit; }

void TablesLevel::put_to_sleep(int slot) {
  if (asleep(slot)) return;
  forces_.forget(slot);
  lay_still(std::int64_t(place_of(slot)));
}

void TablesLevel::set_gravity(const Vec3& gravity) {
  settings_.gravity = gravity;
  kinds_.set_gravity(all_kinds_, gravity.norm());
  for (std::int64_t i = 0; i < spheres_.awake; ++i)
    if (spheres_.motion[std::size_t(i)] == Motion::settling)
      spheres_.motion[std::size_t(i)] = Motion::dynamic;
  clips_.end_all();  // they were recorded under another
}

void TablesLevel::take_woke(std::vector<std::uint32_t>& owners) {
  owners.insert(owners.end(), woke_.begin(), woke_.end());
  woke_.clear();
}

void TablesLevel::lay_still(std::int64_t place) {
  still().insert(std::uint32_t(spheres_.slot[place]), spheres_.position(place), kind_of(place).shape->radius);
  given_.erase(std::uint32_t(spheres_.slot[place]));
  clips_.end(place);
  spheres_.on_hull[std::size_t(place)] = HullStand::none;
  spheres_.put_to_sleep(place);
  searched_ = 0;
}

void TablesLevel::archive(StateArchive& a) {
  a(spheres_, contacts_, elapsed_, lengths_, steps_, one_mass_, eased_, searched_, fell_asleep_, woke_,
    near_ground_, given_, forces_, clips_, loads_, rubbing_);
  if (!a.reading()) return;
  kinds_.forget();
  for (const std::uint32_t kind : spheres_.kind) kinds_.take(all_kinds_, kind, settings_.gravity.norm());
  if (!settings_.tables.as_published()) return;
  clips_.end_all();  // of a level that had them
  std::ranges::fill(spheres_.on_hull, HullStand::none);
}

// For as long as there are overlaps, and a while after.
void TablesLevel::ease() {
  constexpr double kParting = 1e-3;  // over R: moved out of overlaps in a step
  if (eased_ == 0) return;
  const auto units_until = [](double time) { return std::int64_t(time / 0.008); };
  const int units = int(units_until(elapsed_) - units_until(elapsed_ - constants_.wide_time));
  for (std::int64_t i = 0; i < spheres_.awake; ++i) {
    std::uint8_t& left = spheres_.eased[std::size_t(i)];
    const bool parts = step_.push_out(i).norm() > kParting * kind_of(i).shape->radius;
    if (left == 0 || parts) continue;
    left = std::uint8_t(std::max(0, int(left) - units));
    eased_ -= left == 0;
  }
}

void TablesLevel::forget_all_given() {
  if (given_.size() > 64)
    given_ = decltype(given_)();  // of a whole scene that was added: its buckets, too, are given back
  else if (!given_.empty())
    given_.clear();
}

void TablesLevel::add_force(int slot, const Vec3& force, const Vec3& torque) {
  wake(slot);
  forces_.push(slot, force, torque);
}

double TablesLevel::count_traffic(bool pair_phase) const {
  return count_bytes_moved(
      {spheres_, step_, contacts_, pair_phase, near_ground_.any(), settings_.sleeping, rounds_});
}

std::size_t TablesLevel::bytes() const {
  const auto held = [](const auto& array) { return array.capacity() * sizeof array[0]; };
  const std::size_t given =
      given_.size() * (sizeof(std::pair<const std::uint32_t, RigidState>) + 2 * sizeof(void*)) +
      given_.bucket_count() * sizeof(void*);
  std::size_t bytes = held(spheres_.place_of_slot) + given + held(tallies_);
  spheres_.each_array([&](const auto& array) { bytes += held(array); });
  return bytes + step_.bytes() + tipping_.bytes() + contacts_.bytes() + forces_.bytes() +
         further_planes_.bytes() + rubbing_.bytes() + clips_.bytes() + touched_sleepers_.bytes() +
         strikers_.bytes();
}

}  // namespace lodestone
