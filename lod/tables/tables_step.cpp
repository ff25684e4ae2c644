// Of TablesLevel: its step but for rest, in loops over blocks of the dense arrays.
#include <algorithm>
#include <cmath>
#include <utility>

#include "lod/contact/hull_contacts.h"
#include "lod/statistical/flight.h"
#include "lod/tables/tables_level.h"

namespace lodestone {
namespace {

constexpr int kOrderInterval = 16;  // steps between looks at how far bodies have moved from their places

}  // namespace

void TablesLevel::begin_step(double dt, std::span<const std::uint32_t> order, ContactTally& tally) {
  forget_all_given();
  fell_asleep_.clear();
  apply_pushes(dt, tally);
  start(dt, order);
}

void TablesLevel::apply_pushes(double dt, ContactTally& tally) {
  acting_.clear();
  for (const Push& push : pushes_) {
    const std::int64_t place = spheres_.place_of_slot[std::size_t(push.slot)];
    end_clip(place);  // it knows no force but gravity
    StatisticalBody body = spheres_.body(place);
    const double impulse = dt * spheres_.inverse_mass[std::size_t(place)];
    body.velocity += impulse * push.force;
    body.spin += impulse * push.torque;
    body.motion = Motion::dynamic;
    spheres_.put(place, body);
    if (body.velocity.dot(push.force) > impulse * push.force.squaredNorm())  // it gives way: at no rest
      spheres_.crowded_for[std::size_t(place)] = 0, spheres_.quiet[std::size_t(place)] = 0.0f;
    if (!is_within_limit(body.velocity) || !is_within_limit(body.spin))
      recover(place, tally);
    else
      acting_.add({push.slot, (impulse / dt) * push.force, (impulse / dt) * push.torque});
  }
  pushes_.clear();
  acting_.put_in_order();
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
  const StepLengths::Shares known = lengths_.begin(dt);
  const float remembered = settings_.tables.as_published() ? contacts_.settings().remembered
                                                           : contacts_.settings().hull_remembered;
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
                .remembered = remembered * float(known.of_forces),
                .held = remembered * float(known.of_impulses),
                .remembers = known.remembers,
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
  carried_guests_.clear(), leaning_.clear();
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
    const std::size_t first = faces_.size();
    const bool alone = is_alone(i), only_planes = alone && find_planes_of(i);
    const PairBody hull{kind_of(i).shape.get(), center, spheres_.orientation(i)};
    if (!only_planes)
      find_ground_near(ground_, center, 1.01 * size + way, 0.0, near, constants_.hulls ? &hull : nullptr);
    for (const GroundNear& n : near) faces_.push_back(n.plane(center));
    if (faces_.size() == first) continue;
    for (std::size_t face = first; face < faces_.size(); ++face) {
      const GroundPart* part = only_planes ? nullptr : near[face - first].part;  // which moves, perhaps
      planes_.add(faces_[face], materials_, kinds_, settings_.gravity,
                  part ? part->carrying_velocity(center, time) : Vec3(Vec3::Zero()),
                  part ? part->pose.angular_velocity : Vec3(Vec3::Zero()));
    }
    const double margin = 0.01 * size + way;
    const bool cornered = (alone && !only_planes) || is_cornered(i, near, margin);
    const bool above = std::ranges::none_of(near, [](const GroundNear& n) { return n.part->moves(); }) &&
                       std::all_of(faces_.begin() + std::ptrdiff_t(first), faces_.end(),
                                   [&](const HalfSpace& face) { return face.height_of(center) >= 0.0; });
    near_faces_.push_back(
        {i, std::int32_t(first), std::int32_t(faces_.size()), only_planes, cornered, above});
    const auto mover = std::ranges::find_if(near, [&](const GroundNear& n) {
      return n.part->moves() && n.height < double(spheres_.radius[i]) + margin;
    });
    if (mover != near.end())
      carried_.push_back(
          {i, mover->part->carrying_velocity(center, time), mover->part->pose.angular_velocity});
    if (cornered) cornered_.push_back(spheres_.slot[i]);
  }
}

// Among others, of what is nearer than it reaches, `margin` m around. A published sphere meets one plane; one
// that knows its hull meets as many as there are, but over edges its hull tips as long as it moves, and what
// moves holds it.
bool TablesLevel::is_cornered(std::int64_t place, std::span<const GroundNear> near, double margin) const {
  const auto is_held = [&] {
    return is_held_several_ways(near, ground_.planes(), spheres_.position(place),
                                double(spheres_.radius[std::size_t(place)]) + margin);
  };
  if (!constants_.hulls) return is_held();
  const auto is_over_edge = [&](const GroundNear& n) {
    return n.at_edge && n.height <= double(ground_height(place, -n.normal)) + margin;
  };
  if (std::ranges::any_of(near, is_over_edge) && !is_nearly_still(spheres_.body(place), kind_of(place), true))
    return true;
  return std::ranges::any_of(near, [](const GroundNear& n) { return n.part->moves(); }) && is_held();
}

// Of one that may stand on its hull. Who stands does until an edge is near, who does not waits until it is
// farther away: else one at rest there would go on to change.
bool TablesLevel::find_planes_of(std::int64_t place) {
  constexpr double kSlack = 0.1;  // over R
  const BodyKind& kind = kind_of(place);
  const double slack =
      spheres_.on_hull[std::size_t(place)] == HullStand::none ? kSlack * kind.shape->radius : 0.0;
  return find_planes_below(spheres_.body(place), kind, ground_, slack, constants_.wide_time, faces_);
}

const TablesLevel::NearFaces* TablesLevel::near_faces_at(std::int64_t place) const {
  const auto near = std::ranges::lower_bound(near_faces_, place, {}, &NearFaces::place);
  return near == near_faces_.end() || near->place != place ? nullptr : &*near;
}

std::span<const HalfSpace> TablesLevel::faces_of(std::int64_t place) const {
  const NearFaces* near = near_faces_at(place);
  if (!near) return {};
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
  note_pushes();
  contacts_.set_pushes(pushes_by_place_);
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

// Who has contacts with others.
void TablesLevel::note_paired() {
  paired_.assign(std::size_t(spheres_.awake), 0);
  contacts_.each([&](const SphereContact& c) {
    paired_[c.first] = 1;
    if (c.second < paired_.size()) paired_[c.second] = 1;
  });
}

// A body meets the plane that carries it as ground; in a corner it touches more, and is held by each.
void TablesLevel::find_further_planes() {
  const std::span<const HalfSpace> everywhere = ground_.planes();
  plane_touches_.clear();
  if (everywhere.size() + faces_.size() < 2) return;
  if (constants_.hulls) note_paired();
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
  step_.each(GroundState::near, 0, spheres_.awake, [&](std::int64_t i) {
    if (constants_.hulls && !paired_[std::size_t(i)] && is_alone(i)) return;  // its hull, on all of them
    for (std::uint32_t number = 0; number < everywhere.size(); ++number) look(i, number);
    while (near != near_faces_.end() && near->place < i) ++near;
    if (near == near_faces_.end() || near->place != i) return;
    for (std::int32_t face = near->begin; face < near->end; ++face)
      look(i, std::uint32_t(everywhere.size()) + std::uint32_t(face));
  });
  if (!plane_touches_.empty()) contacts_.add_ground(spheres_, plane_touches_, bounce_velocity(), constants_);
}

// Block by block, while it is in the cache: the last round of the ground's contacts, friction on it, impacts,
// motion.
void TablesLevel::finish(ContactTally& tally) {
  const bool ground = has_planes();
  take_back_pressing();
  tallies_.assign(std::size_t((spheres_.awake + kBlock - 1) / kBlock), {});
  joined_.resize(std::max(joined_.size(), tallies_.size()));
  tips_ = constants_.hulls && kinds_.any_tips() && contacts_.count() > 0;
  if (tips_) {
    tipping_.clear(std::size_t(spheres_.awake));
    contacts_.each_run(jobs_, [&](const ContactRun& run) {
      add_torques(run, spheres_, kinds_, bounce_velocity(), tipping_);
    });
  }
  each_block([&](std::int64_t begin, std::int64_t end) {
    ContactTally& own = tallies_[std::size_t(begin / kBlock)];
    std::vector<PlayingClip>& joined = joined_[std::size_t(begin / kBlock)];
    if (ground) {
      sweep_ground(planes_, constants_, simd_, begin, end, step_);
      lie_on_ground(spheres_, kinds_, planes_, constants_, simd_, begin, end, step_);
      step_.each(GroundState::near, begin, end, [&](std::int64_t i) { move_alone(i, own, joined); });
      if (constants_.hulls)
        step_.each(GroundState::stands, begin, end, [&](std::int64_t i) { move_alone(i, own, joined); });
    }
    end_block(begin, end);
    if (tips_) tip(spheres_, kinds_, planes_, constants_, step_, begin, end, tipping_);
    step_.each(GroundState::unsound, begin, end, [&](std::int64_t i) { recover(i, own); });
  });
  for (const ContactTally& t : tallies_) tally += t;
  take_back_excess();
  keep_above_ground();
  update_clips();
  if (log_ && ground) write_ground();
}

// Of bodies that flew through the whole step: a force acted through it, not at its beginning.
void TablesLevel::take_back_excess() {
  for (const ActingForce& force : acting_.all()) {
    const std::size_t i = place_of(force.slot);
    if (step_.on_ground[i] != std::uint8_t(GroundState::free) || step_.touches(std::int64_t(i))) continue;
    const Vec3 too_far = 0.5 * constants_.wide_time * constants_.wide_time * force.acceleration;
    spheres_.x[i] -= too_far.x(), spheres_.y[i] -= too_far.y(), spheres_.z[i] -= too_far.z();
  }
}

// Who follows one that strikes the ground learns of it a step later, and presses it in by up to a step's way.
// Out of ground without an underside it comes back; beyond the middle of a slab it would leave by the other
// side.
void TablesLevel::keep_above_ground() {
  constexpr double kLeast = 0.02;  // over R
  for (const NearFaces& near : near_faces_) {
    const auto i = std::size_t(near.place);
    if (!near.above || near.place >= spheres_.awake || !step_.touches(near.place)) continue;
    for (std::int32_t face = near.begin; face < near.end; ++face) {
      const HalfSpace& plane = faces_[std::size_t(face)];
      const double lift =
          kLeast * double(kinds_.radius[spheres_.kind[i]]) - plane.height_of(spheres_.position(near.place));
      if (lift <= 0.0) continue;
      const Vec3 out = lift * plane.normal,
                 stop = std::max(0.0, -spheres_.velocity(near.place).dot(plane.normal)) * plane.normal;
      spheres_.x[i] += out.x(), spheres_.y[i] += out.y(), spheres_.z[i] += out.z();
      spheres_.vx[i] += stop.x(), spheres_.vy[i] += stop.y(), spheres_.vz[i] += stop.z();
    }
  }
}

// For contacts(): what presses together does not strike.
void TablesLevel::note_pushes() {
  pushes_by_place_.clear();
  if (acting_.empty()) return;
  pushes_by_place_.assign(std::size_t(spheres_.awake), Eigen::Vector3f::Zero());
  for (const ActingForce& force : acting_.all()) {
    pushes_by_place_[place_of(force.slot)] = (constants_.wide_time * force.acceleration).cast<float>();
  }
}

// m/s, times `share`.
void TablesLevel::give_pushes(double share) {
  for (const ActingForce& force : acting_.all()) {
    const std::size_t i = place_of(force.slot);
    const Vec3 push = share * constants_.wide_time * force.acceleration;
    spheres_.vx[i] += push.x(), spheres_.vy[i] += push.y(), spheres_.vz[i] += push.z();
  }
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
  if (!step_.touches(i) && constants_.hulls) {
    const ActingForce& force = acting_.of(std::int32_t(spheres_.slot[i]));
    body.velocity -= constants_.wide_time * force.acceleration;
    body.spin -= constants_.wide_time * force.turning;
    around.gravity += force.acceleration;  // for what moves alone, as good as a gravity of its own
    around.turning = force.turning;
  }
  if (step_.on_ground[i] == std::uint8_t(GroundState::stands)) {
    tally += move_over_ground(i, body, around, rides, joined);
  } else {
    become_sphere(i, body);
    if (constants_.hulls && (step_.touches(i) || spheres_.since_crowded[i] < kLeaningTicks)) {
      // As high as its hull is over that plane; the others that it meets are among its contacts.
      around.planes = {&plane(step_.plane[i]), 1};
      body.sphere_radius = ground_height(i, -around.planes[0].normal);
    }
    const BodyKind& kind = kind_of(i);
    const bool is_ball = constants_.hulls && kind.shape->sphere_radius;  // for which no table need stand
    tally += is_ball ? step_support_body(body, kind, around, constants_.wide_time, SupportSettings{})
                     : step_tables_body(body, resting, kind, around, constants_.wide_time, tables_);
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

}  // namespace lodestone
