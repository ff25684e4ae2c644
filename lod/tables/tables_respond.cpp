// Stage 3c, of TablesLevel: what touches answers, in rounds over all contacts, and what lies on the
// ground is told from what strikes it.
#include <algorithm>
#include <cmath>

#include "lod/tables/sphere_log.h"
#include "lod/tables/tables_level.h"

namespace lodestone {
namespace {

constexpr double kMostUneven = 12.0;  // times the rounds of contacts of like bodies

}  // namespace

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

void TablesLevel::respond(std::span<const Guest> guests, ContactTally& tally) {
  tally.contacts += contacts_.count();
  if (contacts_.count() > 0 && settings_.tables.paper_pair_rule) respond_as_paper(tally);
  const bool crowd = contacts_.count() > 0;
  if (crowd) contacts_.begin(spheres_, kinds_, materials_, constants_, step_, jobs_);
  if (crowd) loads_.press();
  forces_.give(-1.0);  // what presses a body to the ground does not throw it there
  sort_ground();
  forces_.give(1.0);
  rubbing_.give();
  rounds_ = 0;
  strikers_.clear();
  if (!crowd) return;
  blows_.pass_on();
  let_strikers_strike(guests, tally);
  sweep_contacts();
  if (log_) write_contacts(scene_, near_ground_, blows_.passed(), *log_);
}

void TablesLevel::let_strikers_strike(std::span<const Guest> guests, ContactTally& tally) {
  thread_local std::vector<SphereClips::Playing> joined;  // none: they touch others
  joined.clear();
  for (const std::uint32_t place : strikers_.find(guests)) {
    move_alone(place, tally, joined);
    strikers_.add(place);
  }
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
    outcome = contacts_.sweep(spheres_, kinds_, materials_, scene_.bounce_velocity(), constants_, last,
                              eased_ > 0, simd_, step_, jobs_);
    if (!last)
      each_block([&](std::int64_t begin, std::int64_t end) {
        if (near_ground_.any()) sweep_ground(near_ground_.planes(), constants_, simd_, begin, end, step_);
        take_impulses(simd_, begin, end, step_);
      });
    if (!last) strikers_.hold();
  }
  if (!constants_.hulls || outcome.deepest <= settings.deep) return;
  for (int round = 0; round < settings.deep_rounds; ++round) {
    if (near_ground_.any())
      each_block([&](std::int64_t begin, std::int64_t end) {
        keep_on_ground(near_ground_.planes(), begin, end, step_);
      });
    contacts_.move_apart(spheres_, kinds_, step_, jobs_);
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
  constexpr float kNoPlane = 1e9f;  // m: to what comes near none of them, whatever was there before it
  clips_.end_of_touched();
  each_block([&](std::int64_t begin, std::int64_t end) {
    if (constants_.hulls) hulls_.choose(begin, end);
    if (!near_ground_.any()) return clear_added(begin, end, step_);
    sort_near_ground(spheres_, kinds_, near_ground_.planes(), constants_, scene_.bounce_velocity(), simd_,
                     begin, end, step_);
    step_.each(GroundState::settles, begin, end, [&](std::int64_t i) { choose_rest_pose(i); });
    const auto all_carried = near_ground_.carried();
    for (auto carried = std::ranges::lower_bound(all_carried, begin, {}, &NearGround::Carried::place);
         carried != all_carried.end() && carried->place < end; ++carried) {
      std::uint8_t& state = step_.on_ground[std::size_t(carried->place)];
      const bool among_others = state >= std::uint8_t(GroundState::lies) && step_.touches(carried->place);
      if (state == std::uint8_t(GroundState::free)) {
        step_.gap[std::size_t(carried->place)] = kNoPlane;
        step_.plane[std::size_t(carried->place)] = near_ground_.nearest_face(carried->place);
      }
      if (state != std::uint8_t(GroundState::stands) && !among_others)
        state = std::uint8_t(GroundState::near);  // by itself, in the frame of what carries it
    }
  });
}

// The rest pose that needs the smallest rotation (3.4), unless it has one that holds it. What knows its hull
// lies in a wedge as it came.
void TablesLevel::choose_rest_pose(std::int64_t i) {
  if (constants_.hulls && further_planes_.touches(i)) {
    spheres_.motion[i] = Motion::dynamic;
    step_.on_ground[i] = std::uint8_t(GroundState::lies);
    return;
  }
  const Quat orientation = spheres_.orientation(i);
  const BodyKind& kind = kind_of(i);
  const HalfSpace& under = near_ground_.plane(step_.plane[i]);
  if (spheres_.motion[i] == Motion::settling &&
      holds_pose(orientation, kind, spheres_.pose[i], under, world()))
    return;
  // What it has towards the plane ends there.
  const double falling = spheres_.velocity(i).dot(under.normal),
               energy = double(step_.s[std::size_t(i)].w) - 0.5 * falling * falling;
  const RestingRecord resting = find_resting(orientation, kind, under, world(), energy, settings_.tables);
  spheres_.motion[i] = resting.pose < 0 ? Motion::dynamic : Motion::settling;
  if (resting.pose >= 0) spheres_.pose[i] = std::int16_t(resting.pose);
}

}  // namespace lodestone
