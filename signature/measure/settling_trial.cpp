#include "signature/measure/settling_trial.h"

#include <algorithm>
#include <cmath>

#include "reference/drop_trial.h"
#include "reference/free_rotation.h"
#include "reference/random.h"
#include "signature/measure/rest_poses.h"

namespace lodestone {
namespace {

// ODE steps of .505 ms in 1/60 s. The ground truth has kTruthSubsteps; one less here, so that signatures are
// the same, to the bit, as those that people keep.
constexpr int kSubsteps = 33;
constexpr double kHorizon = 30.0;       // s: a rounded body rocks for long
constexpr double kRestEnergy = 2.5e-4;  // J/kg over g R: below it for kRestTime the body rests
constexpr double kRestTime = 0.75;      // s

RigidState settling_start(const Shape& shape, std::uint64_t seed, std::uint32_t trial) {
  RandomStream random(seed, trial, 3);
  const double radius = shape.radius, speed = std::sqrt(kSettlingGravity * radius);
  RigidState state;
  state.orientation = random.orientation();
  // One by one: a compiler is free to draw the arguments of a call in any order.
  const double z = random.uniform(-1.0, 0.0), y = random.uniform(-1.0, 1.0), x = random.uniform(-1.0, 1.0);
  state.velocity = speed * Vec3(x, y, z);
  const Vec3 axis = random.direction();
  state.angular_velocity = 1.5 * speed / radius * random.uniform() * axis;
  state.position.z() = 0.0;
  state.position.z() = radius * random.uniform(0.1, 3.0) - gap_over_ground(shape, state);
  return state;
}

/// Of the kinetic energy (J/kg), what sliding and steady spin about the vertical do not hold: the least that
/// a body with its horizontal velocity and its spin L_z about the vertical can have is v_xy²/2 + L_z²/(2
/// I_zz), from ½ ω·Iω at its least for a given (Iω)_z.
double unsteady_energy(const Shape& shape, const RigidState& s) {
  const Vec3 up = s.orientation.conjugate() * Vec3::UnitZ();
  const double spin = spin_of(s.orientation, s.angular_velocity, shape).z(),
               inertia = up.dot(shape.inertia_per_mass * up);
  return std::max(
      0.0, kinetic_energy(shape, s) - 0.5 * (s.velocity.head<2>().squaredNorm() + spin * spin / inertia));
}

/// Of the kinetic energy (J/kg), what may lift the centre of mass where nothing rubs: the plane then only
/// pushes upwards, so that the horizontal velocity and the spin about the vertical stay as they are, and in
/// no orientation does that spin take less than L_z²/(2 I_max).
double liftable_energy(const Shape& shape, const RigidState& s) {
  const double spin = spin_of(s.orientation, s.angular_velocity, shape).z();
  const double greatest = find_principal_moments(shape.inertia_per_mass).z();
  return std::max(
      0.0, kinetic_energy(shape, s) - 0.5 * (s.velocity.head<2>().squaredNorm() + spin * spin / greatest));
}

}  // namespace

double gap_over_ground(const Shape& shape, const RigidState& s) {
  if (shape.sphere_radius) return s.position.z() - *shape.sphere_radius;
  const Vec3 down = s.orientation.conjugate() * Vec3(0, 0, -1);
  return s.position.z() - shape.hull.vertices[find_support(shape.hull, down)].dot(down);
}

SettlingTrial::SettlingTrial(std::shared_ptr<const Shape> shape, const ContactLaw& law)
    : shape_(std::move(shape)),
      friction_(law.friction),
      materials_(std::make_unique<MaterialTable>(law)),
      world_(OdeSettings{}, *materials_) {
  if (!shape_->sphere_radius) faces_.emplace(shape_->hull);
  world_.add_plane(Vec3::UnitZ(), 0.0, 0);
  RigidState above;
  above.position.z() = 2.0 * shape_->radius;
  body_ = world_.add_body({.shape = shape_,
                           .mass = 1.0,
                           .material = 0,
                           .state = above,
                           .geometry = OdeGeometry::hull,
                           .spheres = {}});
}

SettlingRecord SettlingTrial::run(std::uint64_t seed, std::uint32_t trial, bool whole) {
  SettlingRecord record;
  if (shape_->sphere_radius) return record;
  world_.set_state(body_, settling_start(*shape_, seed, trial));
  const double energy_unit = kSettlingGravity * shape_->radius;
  const bool slippery = friction_ < kSlipperyFriction;
  double quiet_since = 0.0;
  bool started = false, landed = false;
  simulate_drop(world_, body_, kHorizon, kSubsteps, [&](double time, const RigidState& state) {
    const double energy = kinetic_energy(*shape_, state), gap = gap_over_ground(*shape_, state);
    const double unsteady = slippery ? unsteady_energy(*shape_, state) : energy;
    if (!whole &&
        note_certain_pose(state, gap, friction_ > 0.0 ? energy : liftable_energy(*shape_, state), record))
      return false;
    const bool touches = gap < kEntryGap * shape_->radius;
    started = started || (energy < kClipEnergy * energy_unit && touches);
    landed = landed || (unsteady < kClipEnergy * energy_unit && touches);
    if (whole && started) record.states.push_back(state);
    if (unsteady > kRestEnergy * energy_unit) quiet_since = time;
    record.rests = landed && time - quiet_since >= kRestTime;
    if (record.rests)
      record.normal = state.orientation.conjugate() * Vec3::UnitZ(), record.height = state.position.z();
    if (record.rests && energy > kRestEnergy * energy_unit) record.states.clear();  // it slides on
    return !record.rests;
  });
  const auto still =
      std::ptrdiff_t(kRestTime / kObservationStep) - 3;  // a few frames of stillness are enough to end on
  if (record.rests && std::ptrdiff_t(record.states.size()) > still)
    record.states.resize(record.states.size() - std::size_t(still));
  return record;
}

// Contacts under ODE push a little, too: the energy is taken to be that much greater.
bool SettlingTrial::note_certain_pose(const RigidState& state, double gap, double energy,
                                      SettlingRecord& record) const {
  if (!faces_) return false;
  constexpr double kPush = 1e-3;  // over R
  const double energy_height =
      state.position.z() - std::min(0.0, gap) + energy / kSettlingGravity + kPush * shape_->radius;
  const int face =
      faces_->find_certain(state.orientation.conjugate() * Vec3::UnitZ(), energy_height, kSamePose);
  if (face < 0) return false;
  record.rests = true;
  record.normal = faces_->faces()[face].normal;
  record.height = faces_->faces()[face].height;
  return true;
}

}  // namespace lodestone
