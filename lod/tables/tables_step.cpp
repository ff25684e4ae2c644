// Of TablesLevel: its step but for rest, in loops over blocks of the dense arrays.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "lod/contact/hull_contacts.h"
#include "lod/statistical/flight.h"
#include "lod/tables/hull_separation.h"
#include "lod/tables/tables_level.h"

namespace lodestone {
namespace {

constexpr std::int64_t kBlock = 1024;  // bodies of a job
constexpr double kMostUneven = 12.0;   // times the rounds of contacts of like bodies
constexpr int kOrderInterval = 16;     // steps between looks at how far bodies have moved from their places

// Calls visit(i) for the elements of [begin, end) that hold `mark`: mostly few or none.
template <class Visit>
void each_marked(const std::vector<std::uint8_t>& marks, std::uint8_t mark, std::int64_t begin,
                 std::int64_t end, const Visit& visit) {
  const std::uint8_t *at = marks.data() + begin, *last = marks.data() + end;
  while (at < last && (at = static_cast<const std::uint8_t*>(std::memchr(at, mark, std::size_t(last - at)))))
    visit(at++ - marks.data());
}

}  // namespace

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
                  part ? part->velocity_at(center) : Vec3(Vec3::Zero()),
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
      carried_.push_back({i, mover->part->velocity_at(center), mover->part->pose.angular_velocity});
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
  each_marked(step_.on_ground, std::uint8_t(GroundState::near), 0, spheres_.awake, [&](std::int64_t i) {
    if (constants_.hulls && !paired_[std::size_t(i)] && is_alone(i)) return;  // its hull, on all of them
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

/// m: where a line in that direction (unit) from its centre leaves it.
double TablesLevel::exit_distance(std::int64_t place, const Vec3& direction) const {
  const auto i = std::size_t(place);
  if (!constants_.hulls) return double(spheres_.radius[i]);
  const Vec3 own = spheres_.orientation(place).conjugate() * direction;
  const lane::MapPlace at = lane::place_in_map({float(own.x()), float(own.y()), float(own.z())});
  const lane::Row& face = kinds_.pair_face[std::size_t(int(spheres_.kind[i]) * kHullHeights + at.nearest)];
  const double cosine = Vec3(double(face.x), double(face.y), double(face.z)).dot(own);
  return cosine > 0.0 ? double(face.w) / cosine : double(face.w);
}

/// On the line of their centres, midway between where it leaves the one and the other: on or in both.
Vec3 TablesLevel::meeting_point(std::int64_t first, std::int64_t second) const {
  const Vec3 from = spheres_.position(second), between = spheres_.position(first) - from;
  const double distance = between.norm();
  if (distance < 1e-12) return from;
  const Vec3 line = between / distance;
  return from + 0.5 * (exit_distance(second, line) + distance - exit_distance(first, -line)) * line;
}

float TablesLevel::read_heights(const std::vector<float>& heights, std::int64_t place,
                                const Vec3& direction) const {
  const Vec3 own = spheres_.orientation(place).conjugate() * direction;
  return read_hull_height(heights.data(), int(spheres_.kind[std::size_t(place)]) * kHullHeights,
                          {float(own.x()), float(own.y()), float(own.z())});
}

/// The way from the second to the first along which they are apart the most, and how far, m.
std::pair<Vec3, double> TablesLevel::separate(std::int64_t first, std::int64_t second) const {
  const Vec3 between = spheres_.position(first) - spheres_.position(second);
  const double distance = between.norm();
  const Vec3 along = distance > 1e-12 ? Vec3(between / distance) : Vec3(Vec3::UnitZ());
  if (!constants_.hulls)
    return {along, distance - double(spheres_.radius[std::size_t(first)]) -
                       double(spheres_.radius[std::size_t(second)])};
  const auto placed = [&](std::int64_t place) {
    const std::size_t i = std::size_t(place);
    return lane::MappedHull{int(spheres_.kind[i]) * kHullHeights,
                            {spheres_.qw[i], {spheres_.qx[i], spheres_.qy[i], spheres_.qz[i]}}};
  };
  const float* heights = kinds_.pair_height.data();
  const lane::MappedHull one = placed(first), other = placed(second);
  const lane::F3 line{float(along.x()), float(along.y()), float(along.z())};
  const lane::HullSeparation found =
      lane::separate_hulls(heights, kinds_.pair_face.data(), one, other, line, float(distance),
                           lane::separate_along_line(heights, one, other, line, float(distance)));
  return {Vec3(double(found.normal.x), double(found.normal.y), double(found.normal.z)), double(found.gap)};
}

const TablesLevel::Load* TablesLevel::load_of(std::int64_t place) const {
  const auto slot = std::uint32_t(spheres_.slot[std::size_t(place)]);
  const auto load = std::ranges::lower_bound(loads_, slot, {}, &Load::slot);
  const bool known =
      load != loads_.end() && load->slot == slot && load->owner == spheres_.owner[std::size_t(place)];
  return known ? &*load : nullptr;
}

template <class Visit>
void TablesLevel::each_pressed(const Visit& visit) {
  for (const Load& load : loads_) {
    if (load.slot >= spheres_.place_of_slot.size()) continue;
    const std::size_t i = spheres_.place_of_slot[load.slot];
    if (std::int64_t(i) < spheres_.awake && step_.touches(std::int64_t(i)) &&
        load_of(std::int64_t(i)) == &load)
      visit(i, Vec3(load.steady * constants_.wide_time));
  }
}

// Contacts with hulls are answered after those of spheres: what hulls pressed with in the last step these are
// to bear now, else what lies on a heap sinks into it at the speed that gravity gives it in a step.
void TablesLevel::press() {
  each_pressed([&](std::size_t i, const Vec3& by) { step_.add_velocity(std::int64_t(i), by); });
}

// From whom no hull has moved after all, so that momentum is kept. What goes up or down stays: the ground
// bore it, and who bore it last must not be flung.
void TablesLevel::take_back_pressing() {
  const Vec3 up = -settings_.gravity.normalized();
  each_pressed([&](std::size_t i, const Vec3& by) {
    if (step_.on_ground[i] != std::uint8_t(GroundState::moved))
      step_.add_velocity(std::int64_t(i), by.dot(up) * up - by);
  });
}

// A round passes on to a light body a share of what a heavy one on top of it weighs: the more unlike they
// are, the more rounds, as UnevenIslands.
int TablesLevel::sweeps() const {
  if (!constants_.hulls) return contacts_.settings().sweeps;
  const int usual = contacts_.settings().hull_sweeps;
  if (one_mass_) return usual;
  double ratio = 1.0;
  contacts_.each([&](const SphereContact& c) {
    if (c.second >= std::uint32_t(spheres_.awake)) return;
    const double up = -(double(c.nx) * constants_.wide_gx + double(c.ny) * constants_.wide_gy +
                        double(c.nz) * constants_.wide_gz);
    const double first = spheres_.inverse_mass[c.first], second = spheres_.inverse_mass[c.second];
    ratio = std::max(ratio, up > 0.0 ? second / first : first / second);
  });
  return int(usual * std::min(kMostUneven, 1.0 + std::sqrt(0.5 * (ratio - 1.0))));
}

void TablesLevel::respond(ContactTally& tally) {
  tally.contacts += contacts_.count();
  if (contacts_.count() > 0 && settings_.tables.paper_pair_rule) respond_as_paper(tally);
  const bool crowd = contacts_.count() > 0;
  if (crowd) contacts_.begin(spheres_, kinds_, materials_, constants_, step_, jobs_);
  if (crowd) press();
  give_pushes(-1.0);  // what presses a body to the ground does not throw it there
  sort_ground();
  give_pushes(1.0);
  rounds_ = 0;
  if (!crowd) return;
  pass_blows_on();
  sweep_contacts();
  if (log_) write_contacts();
}

// Those of hulls as long as a round changes what bodies close in at; what is deep in each other is then taken
// out faster than the last round alone would.
void TablesLevel::sweep_contacts() {
  const SphereContactSettings& settings = contacts_.settings();
  const int usual = sweeps(), most = constants_.hulls ? std::max(usual, settings.most_hull_sweeps) : usual;
  float least = kinds_.radius[spheres_.kind[0]];  // m, of those that are awake now: kinds stay when these go
  if (!constants_.one_kind)
    for (std::int64_t i = 1; i < spheres_.awake; ++i)
      least = std::min(least, kinds_.radius[spheres_.kind[std::size_t(i)]]);
  const float solved = settings.solved * std::sqrt(std::max(1.0f, constants_.gravity) * least);  // m/s
  SweepOutcome outcome;
  bool last = false;
  for (rounds_ = 0; !last;) {
    ++rounds_;
    last = rounds_ >= most || (rounds_ >= usual && outcome.changed <= solved);
    outcome = contacts_.sweep(spheres_, kinds_, materials_, bounce_velocity(), constants_, last, eased_ > 0,
                              simd_, step_, jobs_);
    if (!last)
      each_block([&](std::int64_t begin, std::int64_t end) {
        if (has_planes()) sweep_ground(planes_, constants_, simd_, begin, end, step_);
        take_impulses(simd_, begin, end, step_);
      });
  }
  if (!constants_.hulls || outcome.deepest <= settings.deep) return;
  for (int round = 0; round < settings.deep_rounds; ++round) {
    if (has_planes())
      each_block([&](std::int64_t begin, std::int64_t end) { keep_on_ground(planes_, begin, end, step_); });
    contacts_.move_apart(spheres_, kinds_, step_, jobs_);
  }
}

void TablesLevel::write_contacts() {
  contacts_.each([&](const SphereContact& c) { write_contact(c); });
  for (const SphereContact& c : passed_) write_contact(c);
}

void TablesLevel::write_contact(const SphereContact& c) {
  if (c.impulse <= 0.0f) return;
  const Vec3 normal(double(c.nx), double(c.ny), double(c.nz));
  if (c.second >= kGroundPlace) {
    const HalfSpace& under = plane(std::int32_t(c.second - kGroundPlace));
    return log_->add({.first = spheres_.owner[c.first],
                      .ground = under.id,
                      .ground_material = under.material,
                      .point = spheres_.position(c.first) - double(ground_height(c.first, -normal)) * normal,
                      .normal = normal,
                      .impulse = double(c.impulse),
                      .approach = std::max(0.0, -double(c.closing))});
  }
  log_->add({.first = spheres_.owner[c.first],
             .second = spheres_.owner[c.second],
             .point = meeting_point(c.first, c.second),
             .normal = normal,
             .impulse = double(c.impulse),
             .approach = std::max(0.0, -double(c.closing))});
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
         carried != carried_.end() && carried->place < end; ++carried) {
      std::uint8_t& state = step_.on_ground[std::size_t(carried->place)];
      const bool among_others = state >= std::uint8_t(GroundState::lies) && step_.touches(carried->place);
      if (state != std::uint8_t(GroundState::stands) && !among_others)
        state = std::uint8_t(GroundState::near);  // by itself, in the frame of what carries it
    }
  });
}

bool TablesLevel::touches_further_planes(std::int64_t place) const {
  return std::ranges::binary_search(plane_touches_, std::uint32_t(place), {}, &PlaneTouch::place);
}

// The rest pose that needs the smallest rotation (3.4), unless it has one that holds it. What knows its hull
// lies in a wedge as it came.
void TablesLevel::choose_rest_pose(std::int64_t i) {
  if (constants_.hulls && touches_further_planes(i)) {
    spheres_.motion[i] = Motion::dynamic;
    step_.on_ground[i] = std::uint8_t(GroundState::lies);
    return;
  }
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
      each_marked(step_.on_ground, std::uint8_t(GroundState::near), begin, end,
                  [&](std::int64_t i) { move_alone(i, own, joined); });
      if (constants_.hulls)
        each_marked(step_.on_ground, std::uint8_t(GroundState::stands), begin, end,
                    [&](std::int64_t i) { move_alone(i, own, joined); });
    }
    end_block(begin, end);
    if (tips_) tip(spheres_, kinds_, planes_, constants_, step_, begin, end, tipping_);
    each_marked(step_.on_ground, std::uint8_t(GroundState::unsound), begin, end,
                [&](std::int64_t i) { recover(i, own); });
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
