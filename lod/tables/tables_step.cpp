// Stages 3a and 3e, of TablesLevel: its step but for response and rest, in loops over blocks of the dense
// arrays.
#include <algorithm>
#include <cmath>
#include <utility>

#include "lod/contact/hull_contacts.h"
#include "lod/statistical/flight.h"
#include "lod/tables/sphere_log.h"
#include "lod/tables/tables_level.h"

namespace lodestone {
namespace {

constexpr int kOrderInterval = 16;  // steps between looks at how far bodies have moved from their places

}  // namespace

void TablesLevel::begin_step(double dt, const Vec3& drift, std::span<const std::uint32_t> order,
                             ContactTally& tally) {
  forget_all_given();
  fell_asleep_.clear();
  forces_.apply(dt, clips_, tally);
  put_near_together(order);
  constants_ = next_constants(dt, drift);
  kinds_.take_friction(all_kinds_, materials_);
  step_.resize(std::size_t(spheres_.awake));
  if (!has_plain_radius() && steps_ % std::max(1, settings_.tables.radius_update_interval) == 0)
    update_radii_one_by_one();
  near_ground_.begin_step();
  carried_.begin_step();
  leaning_.clear(), set_out_.clear();
  near_ground_.find_faces(0, spheres_.awake, jobs_);
  each_block([&](std::int64_t begin, std::int64_t end) { start_block(begin, end, simd_); });
}

// Bodies near each other should lie near each other in memory, too.
void TablesLevel::put_near_together(std::span<const std::uint32_t> order) {
  if (steps_ % kOrderInterval == 0 && searched_ == spheres_.awake &&
      searched_ == std::int64_t(order.size()) && !std::ranges::is_sorted(order)) {
    step_.resize(std::size_t(spheres_.awake));
    spheres_.reorder_awake(order, step_.s.data());  // the rows of the last step serve no more
  }
  searched_ = spheres_.awake;
}

StepConstants TablesLevel::next_constants(double dt, const Vec3& drift) {
  const auto ticks = [](double time) { return std::int64_t(1000.0 * time); };
  const int step_ticks = int(std::min<std::int64_t>(255, ticks(elapsed_ + dt) - ticks(elapsed_)));
  elapsed_ += dt;
  const Vec3& g = settings_.gravity;
  const StepLengths::Shares known = lengths_.begin(dt);
  const float remembered = settings_.tables.as_published() ? contacts_.settings().remembered
                                                           : contacts_.settings().hull_remembered;
  return {.time = float(dt),
          .gx = float(g.x()),
          .gy = float(g.y()),
          .gz = float(g.z()),
          .wide_time = dt,
          .wide_gx = g.x(),
          .wide_gy = g.y(),
          .wide_gz = g.z(),
          .gravity = float(g.norm()),
          .drift = drift,
          .resting_energy = float(tables_.resting_energy),
          .remembered = remembered * float(known.of_forces),
          .held = remembered * float(known.of_impulses),
          .rubbed = float(known.of_forces),
          .remembers = known.remembers,
          .update_radius = has_plain_radius(),
          .pressing = std::max(1.0f, float(g.norm())),
          .heaviest = heaviest(),
          .ticks = step_ticks,
          .one_kind = all_kinds_.size() == 1 && one_mass_,
          .hulls = !settings_.tables.as_published()};
}

// kg, of those awake.
float TablesLevel::heaviest() const {
  if (spheres_.awake == 0) return 1.0f;
  const auto inverse_masses = std::span(spheres_.inverse_mass).first(std::size_t(spheres_.awake));
  return float(1.0 / (one_mass_ ? inverse_masses[0] : std::ranges::min(inverse_masses)));
}

void TablesLevel::start_block(std::int64_t begin, std::int64_t end, Simd simd) {
  start_step(spheres_, kinds_, constants_, simd, begin, end, step_, spheres_);
  near_ground_.find_near(begin, end, simd);
}

void TablesLevel::update_radii_one_by_one() {
  for (std::int64_t i = 0; i < spheres_.awake; ++i)
    if (spheres_.motion[i] == Motion::dynamic && spheres_.since_crowded[i] > 0)
      spheres_.radius[i] =
          float(find_sphere_radius(spheres_.body(i), kind_of(i), settings_.tables, settings_.seed));
}

// Those from that place on start their step now.
void TablesLevel::start_woken(std::int64_t begin) {
  step_.resize(std::size_t(spheres_.awake));
  near_ground_.find_faces(begin, spheres_.awake, jobs_);
  start_block(begin, spheres_.awake, simd_);
}

bool TablesLevel::find_contacts(const CellGrid& cells, std::vector<BallPairs>* others) {
  const std::int64_t were_awake = spheres_.awake;
  contacts_.set_pushes(forces_.by_place());
  const auto way_of = [&](std::uint32_t i) {
    return scene_.way(i, spheres_.position(i), spheres_.velocity(i));
  };
  const auto passes = [&](std::uint32_t first, std::uint32_t second) {
    return pass(way_of(first), way_of(second));
  };
  touched_sleepers_.find_pairs(cells);
  contacts_.find(spheres_, kinds_, cells, scene_.bounce_velocity(), constants_, simd_, jobs_, others, passes);
  touched_sleepers_.find(TaskRef([&](std::int64_t slot) { wake(int(slot)); }));
  if (spheres_.awake > were_awake) start_woken(were_awake);
  if (!touched_sleepers_.pairs().empty())
    contacts_.add(spheres_, kinds_, touched_sleepers_.pairs(), scene_.bounce_velocity(), constants_, simd_);
  further_planes_.find();
  return contacts_.any_near();
}

void TablesLevel::find_ground_contacts() {
  forget_contacts();
  contacts_.set_pushes(forces_.by_place());
  contacts_.find(spheres_, kinds_, no_cells_, scene_.bounce_velocity(), constants_, simd_, jobs_, nullptr);
  further_planes_.find();
}

void TablesLevel::finish(ContactTally& tally) {
  const bool ground = near_ground_.any();
  loads_.take_back();
  rubbing_.take_back();
  tallies_.assign(scene_.blocks(), {});
  clips_.begin_blocks(tallies_.size());
  driven_.begin_blocks(tallies_.size());
  rubbing_.begin_blocks(ground ? tallies_.size() : 0);
  carried_.let_go();
  tips_ = constants_.hulls && kinds_.any_tips() && contacts_.count() > 0;
  if (tips_) {
    tipping_.clear(std::size_t(spheres_.awake));
    contacts_.each_run(jobs_, [&](const ContactRun& run) {
      add_torques(run, spheres_, kinds_, scene_.bounce_velocity(), tipping_);
    });
  }
  each_block([&](std::int64_t begin, std::int64_t end) { finish_block(begin, end); });
  for (const ContactTally& t : tallies_) tally += t;
  rubbing_.remember();
  strikers_.finish(tally);
  forces_.take_back_excess();
  near_ground_.keep_above_faces();
  driven_.stop_before_unseen();
  clips_.update();
  if (log_ && ground) write_lying(scene_, near_ground_, *log_);
}

// While it is in the cache: the last round of the ground's contacts, friction on it, impacts, motion.
void TablesLevel::finish_block(std::int64_t begin, std::int64_t end) {
  const std::size_t block = SphereScene::block_of(begin);
  ContactTally& own = tallies_[block];
  std::vector<SphereClips::Playing>& joined = clips_.joined(block);
  driven_.note(block, begin, end);
  if (near_ground_.any()) {
    sweep_ground(near_ground_.planes(), constants_, simd_, begin, end, step_);
    rubbing_.begin_round(block, begin, end);
    lie_on_ground(spheres_, kinds_, near_ground_.planes(), constants_, simd_, begin, end, step_);
    rubbing_.end_round(block);
    step_.each(GroundState::near, begin, end, [&](std::int64_t i) { move_alone(i, own, joined); });
    if (constants_.hulls)
      step_.each(GroundState::stands, begin, end, [&](std::int64_t i) { move_alone(i, own, joined); });
  }
  end_block(begin, end);
  if (tips_) tip(spheres_, kinds_, near_ground_.planes(), constants_, step_, begin, end, tipping_);
  near_ground_.keep_above_planes(begin, end);
  step_.each(GroundState::unsound, begin, end, [&](std::int64_t i) { scene_.recover(i, own); });
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
void TablesLevel::move_alone(std::int64_t i, ContactTally& tally, std::vector<SphereClips::Playing>& joined) {
  if (!log_ && hulls_.lies_at_clips_end(i)) {  // where touches are written down, it goes on to touch
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
  around.planes = near_ground_.planes_of(i);
  const NearGround::Carried* carried = near_ground_.carrying(i);
  const bool rides = carried != nullptr;
  if (rides) body.velocity -= carried->velocity;
  if (!step_.touches(i) && constants_.hulls) {
    const ActingForce& force = forces_.acting().of(std::int32_t(spheres_.slot[i]));
    body.velocity -= constants_.wide_time * force.acceleration;
    body.spin -= constants_.wide_time * force.turning;
    around.gravity += force.acceleration;  // for what moves alone, as good as a gravity of its own
    around.turning = force.turning;
  }
  if (step_.on_ground[i] == std::uint8_t(GroundState::stands)) {
    tally += hulls_.move(i, body, around, rides, joined);
  } else {
    hulls_.become_sphere(i, body);
    tally += constants_.hulls
                 ? hulls_.strike(i, body, around)
                 : step_tables_body(body, resting, kind_of(i), around, constants_.wide_time, tables_);
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
