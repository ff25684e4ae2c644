#include "lod/tables/tables_level.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "lod/contact/hull_contacts.h"
#include "lod/statistical/flight.h"
#include "lod/statistical/parting.h"
#include "lod/tables/tables_traffic.h"
#include "reference/error.h"

namespace lodestone {
namespace {

constexpr std::int64_t kBlock = 1024;  // bodies of a job
constexpr int kOrderInterval = 16;     // steps between looks at how far bodies have moved from their places

constexpr auto kEasedUnits = std::uint8_t(125.0f * kEasedTime);  // of 8 ms
static_assert(125.0f * kEasedTime < 256.0f);

// Calls visit(i) for the elements of [begin, end) that hold `mark`: mostly few or none.
template <class Visit>
void each_marked(const std::vector<std::uint8_t>& marks, std::uint8_t mark, std::int64_t begin,
                 std::int64_t end, const Visit& visit) {
  const std::uint8_t *at = marks.data() + begin, *last = marks.data() + end;
  while (at < last && (at = static_cast<const std::uint8_t*>(std::memchr(at, mark, std::size_t(last - at)))))
    visit(at++ - marks.data());
}

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
  const StatisticalBody body = spheres_.body(place);
  spheres_.radius[place] =
      arrives ? arriving_radius(body, kind_of(place))
              : float(find_sphere_radius(body, kind_of(place), settings_.tables, settings_.seed));
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
  end_clip(place);
  const std::int64_t last_place = spheres_.place_of_slot[last];
  const bool renamed = gone != last, last_sleeps = renamed && last_place >= spheres_.awake;
  const Vec3 last_position = spheres_.position(last_place);
  const double last_radius = kind_of(last_place).shape->radius;
  if (last_sleeps) still().remove(last, last_position, last_radius);
  spheres_.remove(gone);
  if (last_sleeps) still().insert(gone, last_position, last_radius);
  if (renamed)
    if (const std::int32_t clip = spheres_.clip[spheres_.place_of_slot[gone]]; clip >= 0)
      clips_[std::size_t(clip)].slot = slot;
  std::erase_if(pushes_, [&](const Push& push) { return push.slot == slot; });
  for (Push& push : pushes_)
    if (push.slot == std::int32_t(last)) push.slot = slot;
  given_.erase(gone);
  if (auto moved = given_.extract(last)) {
    moved.key() = gone;
    given_.insert(std::move(moved));
  }
  searched_ = 0;
  return renamed ? std::optional(spheres_.owner[spheres_.place_of_slot[gone]]) : std::nullopt;
}

// The height that its hull has over the plane that it is nearest to, where it is near one: it neither sinks
// nor rises as it arrives. Else as it moves, but into no plane.
float TablesLevel::arriving_radius(const StatisticalBody& body, const BodyKind& kind) const {
  constexpr double kNear = 0.3, kLeast = 0.02;  // over R: a gap; a radius
  const Shape& shape = *kind.shape;
  double least_gap = kNear * shape.radius,
         radius = find_sphere_radius(body, kind, settings_.tables, settings_.seed),
         least_height = shape.radius;
  std::vector<GroundNear> near;
  std::vector<HalfSpace> faces;
  find_ground_near(ground_, body.position, shape.radius + least_gap, 0.0, near);
  for (const GroundNear& n : near) faces.push_back(n.plane(body.position));
  for (const HalfSpace& plane : join_planes(ground_.planes(), faces)) {
    const double height = plane.height_of(body.position);
    least_height = std::min(least_height, height);
    if (height > shape.radius + least_gap) continue;
    std::int32_t hint = 0;
    const HullContact lowest = find_lowest_point(shape, body.orientation, plane.normal, height, hint);
    if (lowest.gap < least_gap) least_gap = lowest.gap, radius = -lowest.arm.dot(plane.normal);
  }
  return float(std::max(std::min(radius, least_height), kLeast * shape.radius));
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
  end_clip(place);
  StatisticalBody body = spheres_.body(place);
  body.position = state.position;
  body.orientation = state.orientation;
  body.velocity = state.velocity;
  body.spin = spin_of(state.orientation, state.angular_velocity, *kind_of(place).shape);
  body.motion = Motion::dynamic;
  body.quiet_time = 0.0f;
  spheres_.put(place, body);
  spheres_.twice_energy[place] = float(body.spin.dot(state.angular_velocity));
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

void TablesLevel::put_to_sleep(int slot) {
  if (asleep(slot)) return;
  std::erase_if(pushes_, [&](const Push& push) { return push.slot == slot; });
  lay_still(std::int64_t(place_of(slot)));
}

void TablesLevel::set_gravity(const Vec3& gravity) {
  settings_.gravity = gravity;
  kinds_ = {};
  for (const std::uint32_t kind : spheres_.kind) kinds_.take(all_kinds_, kind, gravity.norm());
  for (std::int64_t i = 0; i < spheres_.awake; ++i)
    if (spheres_.motion[std::size_t(i)] == Motion::settling)
      spheres_.motion[std::size_t(i)] = Motion::dynamic;
  end_all_clips();  // they were recorded under another
}

void TablesLevel::take_woke(std::vector<std::uint32_t>& owners) {
  owners.insert(owners.end(), woke_.begin(), woke_.end());
  woke_.clear();
}

void TablesLevel::lay_still(std::int64_t place) {
  still().insert(std::uint32_t(spheres_.slot[place]), spheres_.position(place), kind_of(place).shape->radius);
  given_.erase(std::uint32_t(spheres_.slot[place]));
  end_clip(place);
  spheres_.on_hull[std::size_t(place)] = HullStand::none;
  spheres_.put_to_sleep(place);
  searched_ = 0;
}

void TablesLevel::archive(StateArchive& a) {
  a(spheres_, contacts_, elapsed_, steps_, one_mass_, eased_, searched_, fell_asleep_, woke_, cornered_,
    given_, pushes_, clips_);
  if (!a.reading()) return;
  kinds_ = {};
  for (const std::uint32_t kind : spheres_.kind) kinds_.take(all_kinds_, kind, settings_.gravity.norm());
  if (!settings_.tables.as_published()) return;
  end_all_clips();  // of a level that had them
  std::ranges::fill(spheres_.on_hull, HullStand::none);
}

// For as long as there are overlaps, and a while after.
void TablesLevel::ease() {
  constexpr double kParting = 1e-3;  // over R: moved out of overlaps in a step
  if (eased_ == 0) return;
  const int units = std::max(1, int(std::lround(constants_.wide_time / 0.008)));
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
    given_ = {};  // of a whole scene that was added
  else if (!given_.empty())
    given_.clear();
}

void TablesLevel::add_force(int slot, const Vec3& force, const Vec3& torque) {
  wake(slot);
  pushes_.push_back({slot, force, torque});
}

template <class Task>
void TablesLevel::each_block(const Task& task) const {
  const std::int64_t count = spheres_.awake;
  if (count == 0) return;
  jobs_((count + kBlock - 1) / kBlock,
        TaskRef([&](std::int64_t block) { task(block * kBlock, std::min(count, (block + 1) * kBlock)); }));
}

void TablesLevel::begin_step(double dt, std::span<const std::uint32_t> order, ContactTally& tally) {
  forget_all_given();
  fell_asleep_.clear();
  apply_pushes(dt, tally);
  start(dt, order);
}

double TablesLevel::count_traffic(bool pair_phase) const {
  return count_bytes_moved(
      {spheres_, step_, contacts_, pair_phase, has_planes(), settings_.sleeping, sweeps()});
}

std::size_t TablesLevel::bytes() const {
  const auto held = [](const auto& array) { return array.capacity() * sizeof array[0]; };
  const std::size_t given =
      given_.size() * (sizeof(std::pair<const std::uint32_t, RigidState>) + 2 * sizeof(void*)) +
      given_.bucket_count() * sizeof(void*);
  std::size_t bytes = held(spheres_.place_of_slot) + given + held(pushes_) + held(still_touches_) +
                      held(tallies_) + held(clips_) + held(plane_touches_);
  spheres_.each_array([&](const auto& array) { bytes += held(array); });
  return bytes + step_.bytes() + contacts_.bytes();
}

void TablesLevel::apply_pushes(double dt, ContactTally& tally) {
  for (const Push& push : pushes_) {
    const std::int64_t place = spheres_.place_of_slot[std::size_t(push.slot)];
    StatisticalBody body = spheres_.body(place);
    const double impulse = dt * spheres_.inverse_mass[std::size_t(place)];
    body.velocity += impulse * push.force;
    body.spin += impulse * push.torque;
    spheres_.put(place, body);
    if (!is_within_limit(body.velocity) || !is_within_limit(body.spin)) recover(place, tally);
  }
  pushes_.clear();
}

void TablesLevel::start(double dt, std::span<const std::uint32_t> order) {
  // Bodies near each other should lie near each other in memory, too.
  if (steps_ % kOrderInterval == 0 && searched_ == spheres_.awake &&
      searched_ == std::int64_t(order.size()) && !std::ranges::is_sorted(order)) {
    step_.resize(std::size_t(spheres_.awake));
    spheres_.reorder_awake(order, step_.s.data());  // the rows of the last step serve no more
  }
  searched_ = spheres_.awake;
  const auto ticks = [](double time) { return std::int64_t(1000.0 * time); };
  const int step_ticks = int(std::min<std::int64_t>(255, ticks(elapsed_ + dt) - ticks(elapsed_)));
  elapsed_ += dt;
  const bool plain_radius = settings_.tables.interpolate && !settings_.tables.draw_height &&
                            settings_.tables.radius_update_interval <= 1;
  const Vec3& g = settings_.gravity;
  constants_ = {.time = float(dt),
                .gx = float(g.x()),
                .gy = float(g.y()),
                .gz = float(g.z()),
                .wide_time = dt,
                .wide_gx = g.x(),
                .wide_gy = g.y(),
                .wide_gz = g.z(),
                .gravity = float(g.norm()),
                .resting_energy = float(tables_.resting_energy),
                .update_radius = plain_radius,
                .ticks = step_ticks,
                .one_kind = all_kinds_.size() == 1 && one_mass_,
                .hulls = !settings_.tables.as_published()};
  step_.resize(std::size_t(spheres_.awake));
  if (!plain_radius && steps_ % std::max(1, settings_.tables.radius_update_interval) == 0)
    update_radii_one_by_one();
  planes_.clear(kinds_.size());
  for (const HalfSpace& plane : ground_.planes()) planes_.add(plane, materials_, kinds_, settings_.gravity);
  faces_.clear();
  near_faces_.clear();
  cornered_.clear();
  carried_.clear();
  find_near_faces(0, spheres_.awake);
  each_block([&](std::int64_t begin, std::int64_t end) { start_block(begin, end, simd_); });
}

void TablesLevel::start_block(std::int64_t begin, std::int64_t end, Simd simd) {
  start_step(spheres_, kinds_, constants_, simd, begin, end, step_, spheres_);
  for (std::size_t p = 0; p < ground_.planes().size(); ++p)
    find_near_ground(spheres_, kinds_, planes_, ground_.planes()[p], std::int32_t(p), constants_, simd, begin,
                     end, step_);
  const auto first = std::ranges::lower_bound(near_faces_, begin, {}, &NearFaces::place);
  for (auto near = first; near != near_faces_.end() && near->place < end; ++near)
    for (std::int32_t face = near->begin; face < near->end; ++face)
      find_near_ground(spheres_, kinds_, planes_, faces_[std::size_t(face)],
                       std::int32_t(ground_.planes().size()) + face, constants_, Simd::portable, near->place,
                       near->place + 1, step_);
}

// Of the spheres at places [begin, end): what they are near of the ground's parts, as planes.
void TablesLevel::find_near_faces(std::int64_t begin, std::int64_t end) {
  if (!ground_.has_parts()) return;
  const double time = constants_.wide_time, fall = 0.5 * settings_.gravity.norm() * time * time;
  thread_local std::vector<GroundNear> near;
  for (std::int64_t i = begin; i < end; ++i) {
    const double size = double(kinds_.radius[spheres_.kind[i]]),
                 way = spheres_.velocity(i).norm() * time + fall;
    const Vec3 center = spheres_.position(i);
    near.clear();
    find_ground_near(ground_, center, 1.01 * size + way, 0.0, near);
    if (near.empty()) continue;
    const auto first = std::int32_t(faces_.size());
    for (const GroundNear& n : near) {
      faces_.push_back(n.plane(center));
      planes_.add(faces_.back(), materials_, kinds_, settings_.gravity);
    }
    near_faces_.push_back({i, first, std::int32_t(faces_.size())});
    const auto mover = std::ranges::find_if(near, [&](const GroundNear& n) {
      return n.part->moves() && n.height < double(spheres_.radius[i]) + 0.01 * size + way;
    });
    if (mover != near.end())
      carried_.push_back({i, mover->part->velocity_at(center), mover->part->pose.angular_velocity});
    if (is_held_several_ways(near, ground_.planes(), center, double(spheres_.radius[i]) + 0.01 * size + way))
      cornered_.push_back(spheres_.slot[i]);
  }
}

std::span<const HalfSpace> TablesLevel::faces_of(std::int64_t place) const {
  const auto near = std::ranges::lower_bound(near_faces_, place, {}, &NearFaces::place);
  if (near == near_faces_.end() || near->place != place) return {};
  return std::span(faces_).subspan(std::size_t(near->begin), std::size_t(near->end - near->begin));
}

void TablesLevel::update_radii_one_by_one() {
  for (std::int64_t i = 0; i < spheres_.awake; ++i)
    if (spheres_.motion[i] == Motion::dynamic && spheres_.since_crowded[i] > 0)
      spheres_.radius[i] =
          float(find_sphere_radius(spheres_.body(i), kind_of(i), settings_.tables, settings_.seed));
}

void TablesLevel::find_contacts(const CellGrid& cells, std::vector<BallPairs>* others) {
  const std::int64_t were_awake = spheres_.awake;
  contacts_.find(spheres_, kinds_, cells, bounce_velocity(), constants_, simd_, jobs_, others);
  find_still_contacts();
  if (spheres_.awake > were_awake) {  // those that were woken start their step now
    step_.resize(std::size_t(spheres_.awake));
    find_near_faces(were_awake, spheres_.awake);
    start_block(were_awake, spheres_.awake, simd_);
  }
  for (auto& touch : still_touches_) touch.second = spheres_.place_of_slot[touch.second];
  if (!still_touches_.empty())
    contacts_.add(spheres_, kinds_, still_touches_, bounce_velocity(), constants_, simd_);
  find_further_planes();
}

// A body meets the plane that carries it as ground; in a corner it touches more, and is held by each.
void TablesLevel::find_further_planes() {
  const std::span<const HalfSpace> everywhere = ground_.planes();
  plane_touches_.clear();
  if (everywhere.size() + faces_.size() < 2) return;
  const auto look = [&](std::int64_t i, std::uint32_t number) {
    if (std::int32_t(number) == step_.plane[std::size_t(i)]) return;
    const HalfSpace& other = plane(std::int32_t(number));
    const float gap = float(other.height_of(spheres_.position(i))) - ground_height(i, -other.normal),
                closing = float(spheres_.velocity(i).dot(other.normal));
    const BodyKind& kind = kind_of(i);
    if (gap + closing * constants_.time > contacts_.settings().touching * float(kind.shape->radius)) return;
    const Vec3& n = other.normal;
    plane_touches_.push_back({.place = std::uint32_t(i),
                              .plane = number,
                              .normal = {float(n.x()), float(n.y()), float(n.z())},
                              .gap = gap,
                              .closing = closing,
                              .law = materials_.law(kind.material, other.material)});
  };
  auto near = near_faces_.begin();
  each_marked(step_.on_ground, std::uint8_t(GroundState::near), 0, spheres_.awake, [&](std::int64_t i) {
    for (std::uint32_t number = 0; number < everywhere.size(); ++number) look(i, number);
    while (near != near_faces_.end() && near->place < i) ++near;
    if (near == near_faces_.end() || near->place != i) return;
    for (std::int32_t face = near->begin; face < near->end; ++face)
      look(i, std::uint32_t(everywhere.size()) + std::uint32_t(face));
  });
  if (!plane_touches_.empty()) contacts_.add_ground(spheres_, plane_touches_, bounce_velocity(), constants_);
}

/// m, from the centre of mass: what stands for the body towards the ground, and towards others.
float TablesLevel::ground_height(std::int64_t place, const Vec3& direction) const {
  return constants_.hulls ? read_heights(kinds_.hull_height, place, direction)
                          : spheres_.radius[std::size_t(place)];
}

float TablesLevel::pair_reach(std::int64_t place, const Vec3& direction) const {
  return constants_.hulls ? read_heights(kinds_.pair_reach, place, direction)
                          : spheres_.radius[std::size_t(place)];
}

float TablesLevel::read_heights(const std::vector<float>& heights, std::int64_t place,
                                const Vec3& direction) const {
  const Vec3 own = spheres_.orientation(place).conjugate() * direction;
  return read_hull_height(heights.data(), int(spheres_.kind[std::size_t(place)]) * kHullHeights,
                          {float(own.x()), float(own.y()), float(own.z())});
}

// Of awake bodies with sleepers; those that are hit hard enough wake.
void TablesLevel::find_still_contacts() {
  still_touches_.clear();
  if (still().empty()) return;
  for (std::int64_t i = 0; i < spheres_.awake; ++i) {
    const Vec3 position = spheres_.position(i);
    still().find_near(position, double(step_.reach[i]), [&](std::uint32_t other) {
      const std::int64_t at = spheres_.place_of_slot[other];
      const double limit =
          double(step_.reach[i]) +
          1.01 * double(constants_.hulls ? kinds_.farthest_reach[spheres_.kind[at]] : spheres_.radius[at]);
      if ((spheres_.position(at) - position).squaredNorm() < limit * limit)
        still_touches_.emplace_back(std::uint32_t(i), other);
    });
  }
  if (settings_.pair_filter)
    std::erase_if(still_touches_, [&](const auto& touch) {
      return !settings_.pair_filter(spheres_.owner[touch.first],
                                    spheres_.owner[spheres_.place_of_slot[touch.second]]);
    });
  std::ranges::sort(still_touches_);
  for (const auto& [place, slot] : still_touches_) {
    const std::int64_t at = spheres_.place_of_slot[slot];
    if (at < spheres_.awake) continue;
    const Vec3 between = spheres_.position(place) - spheres_.position(at);
    const double gap = between.norm() - double(pair_reach(place, -between)) - double(pair_reach(at, between));
    const Vec3 velocity = spheres_.velocity(place);
    const double closing = velocity.dot(between.normalized());
    const bool touches = gap + closing * double(constants_.time) <=
                         0.01 * std::min(kind_of(place).shape->radius, kind_of(at).shape->radius);
    if (touches && velocity.norm() > rest_law_.wake_speed(kind_of(at).shape->radius)) wake(int(slot));
  }
}

void TablesLevel::respond(ContactTally& tally) {
  tally.contacts += contacts_.count();
  if (contacts_.count() > 0 && settings_.tables.paper_pair_rule) respond_as_paper(tally);
  const bool crowd = contacts_.count() > 0;
  if (crowd) contacts_.begin(spheres_, kinds_, materials_, constants_, step_, jobs_);
  sort_ground();
  if (!crowd) return;
  for (int sweep = 1; sweep <= sweeps(); ++sweep) {
    contacts_.sweep(spheres_, kinds_, materials_, bounce_velocity(), constants_, sweep == sweeps(),
                    eased_ > 0, simd_, step_, jobs_);
    if (sweep < sweeps())
      each_block([&](std::int64_t begin, std::int64_t end) {
        if (has_planes()) sweep_ground(planes_, constants_, simd_, begin, end, step_);
        take_impulses(simd_, begin, end, step_);
      });
  }
  if (log_) write_contacts();
}

void TablesLevel::write_contacts() {
  contacts_.each([&](const SphereContact& c) {
    if (c.impulse <= 0.0f) return;
    const Vec3 normal(double(c.nx), double(c.ny), double(c.nz));
    if (c.second >= kGroundPlace) {
      const HalfSpace& under = plane(std::int32_t(c.second - kGroundPlace));
      return log_->add(
          {.first = spheres_.owner[c.first],
           .ground = under.id,
           .ground_material = under.material,
           .point = spheres_.position(c.first) - double(ground_height(c.first, -normal)) * normal,
           .normal = normal,
           .impulse = double(c.impulse),
           .approach = std::max(0.0, -double(c.closing))});
    }
    log_->add({.first = spheres_.owner[c.first],
               .second = spheres_.owner[c.second],
               .point = spheres_.position(c.first) - double(pair_reach(c.first, -normal)) * normal,
               .normal = normal,
               .impulse = double(c.impulse),
               .approach = std::max(0.0, -double(c.closing))});
  });
}

// Of those that lie on it; impacts are written where they are answered.
void TablesLevel::write_ground() {
  for (std::int64_t i = 0; i < spheres_.awake; ++i) {
    const std::uint8_t state = step_.on_ground[std::size_t(i)];
    if (state != std::uint8_t(GroundState::lies) && state != std::uint8_t(GroundState::settles)) continue;
    const HalfSpace& under = plane(step_.plane[std::size_t(i)]);
    const double pressing =
        std::max(0.0, -settings_.gravity.dot(under.normal)) * constants_.wide_time;  // m/s
    log_->add({.first = spheres_.owner[std::size_t(i)],
               .ground = under.id,
               .ground_material = under.material,
               .point = spheres_.position(i) - double(spheres_.radius[std::size_t(i)]) * under.normal,
               .normal = under.normal,
               .impulse = std::max(pressing, double(spheres_.held[std::size_t(i)])) /
                          spheres_.inverse_mass[std::size_t(i)]});
  }
}

// The paper's rule (3.3.2): each body of a pair responds by itself, as to an immovable plane, and then moves
// as if alone.
void TablesLevel::respond_as_paper(ContactTally& tally) {
  const auto take = [&](std::int64_t place, const StatisticalBody& body) {
    spheres_.put(place, body);
    start_block(place, place + 1, Simd::portable);
  };
  contacts_.each([&](const SphereContact& c) {
    if (c.second >= std::uint32_t(spheres_.awake)) return;
    StatisticalBody first = spheres_.body(c.first), second = spheres_.body(c.second);
    const BodyKind &first_kind = kind_of(c.first), &second_kind = kind_of(c.second);
    respond_pair_as_paper(first, first_kind, second, second_kind,
                          Vec3(double(c.nx), double(c.ny), double(c.nz)), world(),
                          materials_.law(first_kind.material, second_kind.material), settings_.tables, tally);
    take(c.first, first);
    take(c.second, second);
  });
  contacts_.clear();
}

void TablesLevel::sort_ground() {
  end_clips_of_touched();
  each_block([&](std::int64_t begin, std::int64_t end) {
    if (constants_.hulls) choose_hulls(begin, end);
    if (!has_planes()) return clear_added(begin, end, step_);
    sort_near_ground(spheres_, kinds_, planes_, constants_, bounce_velocity(), simd_, begin, end, step_);
    each_marked(step_.on_ground, std::uint8_t(GroundState::settles), begin, end,
                [&](std::int64_t i) { choose_rest_pose(i); });
    for (auto carried = std::ranges::lower_bound(carried_, begin, {}, &Carried::place);
         carried != carried_.end() && carried->place < end; ++carried)
      if (step_.on_ground[std::size_t(carried->place)] != std::uint8_t(GroundState::stands))
        step_.on_ground[std::size_t(carried->place)] =
            std::uint8_t(GroundState::near);  // by itself, in the frame of what carries it
  });
}

// The rest pose that needs the smallest rotation (3.4), unless it has one that holds it.
void TablesLevel::choose_rest_pose(std::int64_t i) {
  const Quat orientation = spheres_.orientation(i);
  const BodyKind& kind = kind_of(i);
  const HalfSpace& under = plane(step_.plane[i]);
  if (spheres_.motion[i] == Motion::settling &&
      holds_pose(orientation, kind, spheres_.pose[i], under, world()))
    return;
  const RestingRecord resting = find_resting(orientation, kind, under, world(), settings_.tables);
  spheres_.motion[i] = resting.pose < 0 ? Motion::dynamic : Motion::settling;
  if (resting.pose >= 0) spheres_.pose[i] = std::int16_t(resting.pose);
}

// Block by block, while it is in the cache: the last round of the ground's contacts, friction on it, impacts,
// motion.
void TablesLevel::finish(ContactTally& tally) {
  const bool ground = has_planes();
  tallies_.assign(std::size_t((spheres_.awake + kBlock - 1) / kBlock), {});
  joined_.resize(std::max(joined_.size(), tallies_.size()));
  each_block([&](std::int64_t begin, std::int64_t end) {
    ContactTally& own = tallies_[std::size_t(begin / kBlock)];
    std::vector<PlayingClip>& joined = joined_[std::size_t(begin / kBlock)];
    if (ground) {
      sweep_ground(planes_, constants_, simd_, begin, end, step_);
      lie_on_ground(spheres_, kinds_, planes_, constants_, simd_, begin, end, step_);
      each_marked(step_.on_ground, std::uint8_t(GroundState::near), begin, end,
                  [&](std::int64_t i) { move_alone(i, own, joined); });
      if (constants_.hulls)
        each_marked(step_.on_ground, std::uint8_t(GroundState::stands), begin, end,
                    [&](std::int64_t i) { move_alone(i, own, joined); });
    }
    end_block(begin, end);
    each_marked(step_.on_ground, std::uint8_t(GroundState::unsound), begin, end,
                [&](std::int64_t i) { recover(i, own); });
  });
  for (const ContactTally& t : tallies_) tally += t;
  update_clips();
  if (log_ && ground) write_ground();
}

// The orientations of slender bodies, and of those that turn far in a step, follow by splitting, one by one.
void TablesLevel::end_block(std::int64_t begin, std::int64_t end) {
  constexpr float kFar = 0.7f;  // rad: so far the loop's rule keeps the energy
  thread_local std::vector<std::pair<std::int64_t, Quat>> before;
  before.clear();
  const bool slender = kinds_.any_slender();
  const float rate = kFar / constants_.time;  // rad/s
  for (std::int64_t i = begin; i < end; ++i) {
    const lane::Row& turning = step_.u[std::size_t(i)];  // m/s, at the radius
    const float most = rate * spheres_.radius[std::size_t(i)];
    const bool far = turning.x * turning.x + turning.y * turning.y + turning.z * turning.z > most * most;
    if ((far || (slender && SphereKinds::is_slender(kind_of(i)))) &&
        step_.on_ground[std::size_t(i)] != std::uint8_t(GroundState::moved))
      before.emplace_back(i, spheres_.orientation(i));
  }
  end_step(spheres_, kinds_, constants_, simd_, begin, end, step_);
  for (const auto& [i, orientation] : before)
    spheres_.set_orientation(i, advance_orientation(orientation, spheres_.spin(i), kind_of(i),
                                                    constants_.wide_time, spheres_.twice_energy[i])
                                    .normalized());
}

// A body that meets the ground by itself, after the impulses of its contacts with others.
void TablesLevel::move_alone(std::int64_t i, ContactTally& tally, std::vector<PlayingClip>& joined) {
  if (lies_at_clips_end(i)) {
    step_.on_ground[i] = std::uint8_t(GroundState::moved);
    return;
  }
  const float t = constants_.time;
  StatisticalBody body = spheres_.body(i);
  body.velocity = step_.touches(i)
                      ? step_.velocity(i, {constants_.gx * t, constants_.gy * t, constants_.gz * t, 0.0f})
                      : spheres_.velocity(i);
  body.spin += step_.added_spin(i);
  body.position += step_.push_out(i);
  RestingRecord resting{spheres_.pose[i]};
  StepWorld around = world();
  around.planes = join_planes(ground_.planes(), faces_of(i));
  const auto carried = std::ranges::lower_bound(carried_, i, {}, &Carried::place);
  const bool rides = carried != carried_.end() && carried->place == i;
  if (rides) body.velocity -= carried->velocity;
  if (step_.on_ground[i] == std::uint8_t(GroundState::stands) && is_over_level_ground(body, around)) {
    tally += move_over_ground(i, body, around, rides, joined);
  } else {
    become_sphere(i, body);
    if (step_.touches(i) || spheres_.since_crowded[i] < kLeaningTicks)
      body.sphere_radius = ground_height(i, -plane(step_.plane[i]).normal);
    tally += step_tables_body(body, resting, kind_of(i), around, constants_.wide_time, tables_);
  }
  if (rides) {
    body.velocity += carried->velocity;
    body.position += carried->velocity * constants_.wide_time;
    body.orientation =
        (rotation_from_vector(carried->angular_velocity * constants_.wide_time) * body.orientation)
            .normalized();
  }
  spheres_.pose[i] = std::int16_t(resting.pose);
  spheres_.put(i, body);
  spheres_.held[i] = 0.0f;
  step_.on_ground[i] = std::uint8_t(GroundState::moved);
}

StatisticalBody TablesLevel::guest_body(const Guest& guest) const {
  const auto i = std::int64_t(place_of(guest.slot));
  StatisticalBody body = spheres_.body(i);
  if (i < spheres_.awake && step_.touches(i)) {
    body.velocity = step_.velocity(i) - settings_.gravity * constants_.wide_time;
    body.spin += step_.added_spin(i);
    body.position += step_.push_out(i);
  }
  if (spheres_.clip[std::size_t(i)] >= 0) body.motion = Motion::dynamic;
  return body;
}

void TablesLevel::take_guests(std::span<const Guest> guests, std::span<const StatisticalBody> bodies) {
  const std::int64_t were_awake = spheres_.awake;
  for (const Guest& guest : guests)
    if (guest.touched) wake(guest.slot);
  if (spheres_.awake > were_awake) {
    step_.resize(std::size_t(spheres_.awake));
    find_near_faces(were_awake, spheres_.awake);
    start_block(were_awake, spheres_.awake, simd_);
    clear_added(were_awake, spheres_.awake, step_);
  }
  for (std::size_t k = 0; k < guests.size(); ++k) {
    if (!guests[k].touched) continue;
    const std::size_t i = place_of(guests[k].slot);
    const StatisticalBody& body = bodies[k];
    end_clip(std::int64_t(i));
    spheres_.on_hull[i] = HullStand::none;
    spheres_.put(std::int64_t(i), body);
    spheres_.pose[i] = std::int16_t(guests[k].resting.pose);
    spheres_.held[i] = 0.0f;
    // It has moved and lies among others: nothing is left to be added to what it has now.
    step_.p[i] = {float(body.velocity.x()), float(body.velocity.y()), float(body.velocity.z()),
                  std::max(1.0f, step_.p[i].w)};
    step_.a[i] = step_.s[i] = step_.d[i] = {};
    step_.on_ground[i] = std::uint8_t(GroundState::moved);
  }
}

// What is no number must not spread.
void TablesLevel::recover(std::int64_t place, ContactTally& tally) {
  StatisticalBody body = spheres_.body(place);
  const Vec3 omega = angular_velocity(body.orientation, body.spin, *kind_of(place).shape);
  const bool turned = std::abs(body.orientation.squaredNorm() - 1.0) < 1e-6;
  if (is_within_limit(body.position) && is_within_limit(body.velocity) && is_within_limit(omega) && turned) {
    spheres_.put(place, body);
    return;
  }
  for (double& x : body.position) x = std::isfinite(x) ? std::clamp(x, -kStateLimit, kStateLimit) : 0.0;
  if (!turned) body.orientation = Quat::Identity();
  body.velocity.setZero();
  body.spin.setZero();
  spheres_.put(place, body);
  spheres_.known_count[place] = 0;
  ++tally.states_recovered;
}

}  // namespace lodestone
