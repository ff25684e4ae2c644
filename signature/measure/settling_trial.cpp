#include "signature/measure/settling_trial.h"

#include <algorithm>
#include <cmath>

#include "reference/free_rotation.h"
#include "reference/random.h"
#include "reference/trial.h"
#include "signature/measure/rest_poses.h"

namespace lodestone {
namespace {

constexpr int kSubsteps = 33;               // ODE steps of .505 ms in 1/60 s: the ground truth's
constexpr double kHorizon = 30.0;           // s: a rounded body rocks for long
constexpr double kRestEnergy = 2.5e-4;      // J/kg over g R: below it for kRestTime the body rests
constexpr double kRestTime = 0.75;          // s

RigidState settling_start(const Shape& shape, std::uint64_t seed, std::uint32_t trial) {
  RandomStream random(seed, trial, 3);
  const double radius = shape.radius, speed = std::sqrt(kSettlingGravity * radius);
  RigidState state;
  state.orientation = random.orientation();
  state.velocity = speed * Vec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 0.0));
  state.angular_velocity = 1.5 * speed / radius * random.uniform() * random.direction();
  state.position.z() = 0.0;
  state.position.z() = radius * random.uniform(0.1, 3.0) - gap_over_ground(shape, state);
  return state;
}

std::unique_ptr<MaterialTable> materials_with(const ContactLaw& law) {
  auto materials = std::make_unique<MaterialTable>();
  materials->set_law(0, 0, law);
  return materials;
}

}  // namespace

double gap_over_ground(const Shape& shape, const RigidState& s) {
  if (shape.sphere_radius) return s.position.z() - *shape.sphere_radius;
  const Vec3 down = s.orientation.conjugate() * Vec3(0, 0, -1);
  return s.position.z() - shape.hull.vertices[find_support(shape.hull, down)].dot(down);
}

SettlingTrial::SettlingTrial(std::shared_ptr<const Shape> shape, const ContactLaw& law)
    : shape_(std::move(shape)), materials_(materials_with(law)), world_(OdeSettings{}, *materials_) {
  if (!shape_->sphere_radius) faces_.emplace(shape_->hull);
  world_.add_plane(Vec3::UnitZ(), 0.0, 0);
  RigidState above;
  above.position.z() = 2.0 * shape_->radius;
  body_ = world_.add_body({.shape = shape_, .mass = 1.0, .material = 0, .state = above, .geometry = OdeGeometry::hull, .spheres = {}});
}

SettlingRecord SettlingTrial::run(std::uint64_t seed, std::uint32_t trial, bool whole) {
  world_.set_state(body_, settling_start(*shape_, seed, trial));
  SettlingRecord record;
  const double energy_unit = kSettlingGravity * shape_->radius;
  double quiet_since = 0.0;
  bool started = false;
  simulate_drop(world_, body_, kHorizon, kSubsteps, [&](double time, const RigidState& state) {
    const double energy = kinetic_energy(*shape_, state), gap = gap_over_ground(*shape_, state);
    if (!whole && note_certain_pose(state, gap, energy, record)) return false;
    started = started || (energy < kClipEnergy * energy_unit && gap < kEntryGap * shape_->radius);
    if (whole && started) record.states.push_back(state);
    if (energy > kRestEnergy * energy_unit) quiet_since = time;
    record.rests = started && time - quiet_since >= kRestTime;
    if (record.rests) record.normal = state.orientation.conjugate() * Vec3::UnitZ(), record.height = state.position.z();
    return !record.rests;
  });
  const auto still = std::ptrdiff_t(kRestTime / kObservationStep) - 3;  // a few frames of stillness are enough to end on
  if (record.rests && std::ptrdiff_t(record.states.size()) > still) record.states.resize(record.states.size() - std::size_t(still));
  return record;
}

// Contacts under ODE push a little, too: the energy is taken to be that much greater.
bool SettlingTrial::note_certain_pose(const RigidState& state, double gap, double energy, SettlingRecord& record) const {
  if (!faces_) return false;
  constexpr double kPush = 1e-3;  // over R
  const double energy_height = state.position.z() - std::min(0.0, gap) + energy / kSettlingGravity + kPush * shape_->radius;
  const int face = faces_->find_certain(state.orientation.conjugate() * Vec3::UnitZ(), energy_height, kSamePose);
  if (face < 0) return false;
  record.rests = true;
  record.normal = faces_->faces()[face].normal;
  record.height = faces_->faces()[face].height;
  return true;
}

}  // namespace lodestone
