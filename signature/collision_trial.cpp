#include "signature/collision_trial.h"

#include <cmath>
#include <numbers>

#include "reference/free_rotation.h"
#include "reference/random.h"

namespace lodestone {
namespace {

constexpr double kTouch = 1e-6;           // over R: a gap this small is contact
constexpr double kImpactStep = 1e-4;      // s, of the ODE step that answers the impact
constexpr double kFollowStep = 5e-4;      // s, of those until the body has left the plane: the ground truth's
constexpr int kMaxFollowSteps = 400;
constexpr double kSinking = 1e-4;         // of the speed unit s: slower motion of the lowest point into the plane is rounding

OdeSettings trial_settings() {
  OdeSettings settings;
  settings.gravity.setZero();
  settings.bounce_velocity = 1e-6;  // the tables are the scale-invariant limits above and (with e = 0) below ODE's bounce_vel
  return settings;
}

std::unique_ptr<MaterialTable> materials_with(const ContactLaw& law) {
  auto materials = std::make_unique<MaterialTable>();
  materials->set_law(0, 0, law);
  return materials;
}

struct Lowest {
  double gap;
  Vec3 arm;
};

Lowest find_lowest(const Shape& shape, const RigidState& state, int& hint) {
  if (shape.sphere_radius) return {state.position.z() - *shape.sphere_radius, {0, 0, -*shape.sphere_radius}};
  hint = find_support(shape.hull, state.orientation.conjugate() * Vec3(0, 0, -1), hint);
  const Vec3 arm = state.orientation * shape.hull.vertices[hint];
  return {state.position.z() + arm.z(), arm};
}

// Ω⁻ at angle φ from V⁻, turned by ψ about it.
Vec3 direction_at(const Vec3& axis, double phi, double psi) {
  const Vec3 a = axis.unitOrthogonal(), b = axis.cross(a);
  return std::cos(phi) * axis + std::sin(phi) * (std::cos(psi) * a + std::sin(psi) * b);
}

double kinetic_energy(const Shape& shape, const RigidState& s) {
  return 0.5 * (s.velocity.squaredNorm() + s.angular_velocity.dot(spin_of(s.orientation, s.angular_velocity, shape)));
}

}  // namespace

bool advance_to_contact(const Shape& shape, RigidState& state) {
  const Vec3 spin = spin_of(state.orientation, state.angular_velocity, shape);
  int hint = 0;
  constexpr double kMaxTurn = 0.1;  // rad a step, for the rotation's accuracy
  for (int i = 0; i < 100'000; ++i) {
    const double gap = find_lowest(shape, state, hint).gap;
    state.angular_velocity = angular_velocity(state.orientation, spin, shape);
    if (gap < kTouch * shape.radius) return true;
    const double turning = state.angular_velocity.norm(), fastest = -state.velocity.z() + shape.radius * turning;
    if (fastest <= 0.0 || (state.position.z() > shape.radius && state.velocity.z() >= 0.0)) return false;
    // Above the bounding sphere's reach only the fall counts.
    const double above = (state.position.z() - shape.radius) / -state.velocity.z();
    double time = std::max(gap / fastest, state.velocity.z() < 0.0 ? above : 0.0);
    if (turning > 0.0) time = std::min(time, kMaxTurn / turning);
    state.position += state.velocity * time;
    state.orientation = advance_orientation(state.orientation, spin, shape, time).normalized();
  }
  return false;
}

CollisionTrial::CollisionTrial(std::shared_ptr<const Shape> shape, const ContactLaw& law, TrialEnd end)
    : shape_(std::move(shape)), law_(law), end_(end), materials_(materials_with(law)), world_(trial_settings(), *materials_) {
  world_.add_plane(Vec3::UnitZ(), 0.0, 0);
  RigidState above;
  above.position.z() = 2.0 * shape_->radius;
  body_ = world_.add_body({.shape = shape_, .mass = 1.0, .material = 0, .state = above, .geometry = OdeGeometry::trimesh, .spheres = {}});
}

std::optional<CollisionOutcome> CollisionTrial::run(const CollisionConfiguration& c, std::uint64_t seed, std::uint64_t cell, std::uint32_t trial) {
  RandomStream random(seed, cell, trial);
  const double radius = shape_->radius;
  RigidState state;
  state.orientation = random.orientation();
  state.position.z() = radius * (1.0 + random.uniform());
  state.velocity = std::cos(c.alpha) * Vec3(std::sin(c.theta), 0.0, -std::cos(c.theta));
  state.angular_velocity = std::sin(c.alpha) / radius * direction_at(state.velocity.normalized(), c.phi, random.uniform(0.0, 2.0 * std::numbers::pi));
  if (!advance_to_contact(*shape_, state)) return {};
  const double energy_before = kinetic_energy(*shape_, state);
  const Vec3 particle = state.velocity - (1.0 + law_.restitution) * state.velocity.z() * Vec3::UnitZ();

  int hint = 0;
  state.position.z() -= find_lowest(*shape_, state, hint).gap + 1e-9 * radius;  // just inside, so that ODE sees the contact
  world_.set_state(body_, state);
  world_.step(kImpactStep);
  RigidState after = world_.state(body_);
  Lowest lowest = find_lowest(*shape_, after, hint);
  const auto sinking = [&] { return (after.velocity + after.angular_velocity.cross(lowest.arm)).z() < -kSinking; };
  if (end_ == TrialEnd::leaves_plane)
    for (int i = 0; i < kMaxFollowSteps && (sinking() || (law_.restitution > 0.0 && lowest.gap <= 0.0)); ++i) {
      world_.step(kFollowStep);
      after = world_.state(body_);
      lowest = find_lowest(*shape_, after, hint);
    }

  // Frame: e1 = z, e2 = x (the slip), e3 = y.
  CollisionOutcome outcome;
  const Vec3 dv = after.velocity - particle, w = radius * after.angular_velocity;
  outcome.response << float(dv.z()), float(dv.x()), float(dv.y()), float(w.z()), float(w.x()), float(w.y());
  outcome.moves_into_plane = sinking();
  outcome.energy_ratio = kinetic_energy(*shape_, after) / energy_before;
  return outcome;
}

}  // namespace lodestone
