#include "signature/measure/collision_trial.h"

#include <cmath>

#include "reference/free_rotation.h"

namespace lodestone {
namespace {

constexpr double kImpactTime =
    1e-6;  // over R/s: the ODE step that answers an impact, in which nothing moves to speak of
constexpr double kDepth = 1e-13;   // over R: just inside the plane, so that ODE sees the one contact
constexpr double kStill = 1e-9;    // of s
constexpr int kMostImpulses = 16;  // a body that rattles between two vertices is cut short

OdeSettings trial_settings(double bounce_velocity) {
  OdeSettings settings;
  settings.gravity.setZero();
  settings.bounce_velocity = bounce_velocity;
  settings.cfm = 1e-14;  // at the usual 1e-10 so short a step would soften the contact
  return settings;
}

// e1 = z, e2 = x, e3 = y: V⁻ falls towards +x.
RigidState start_of(const CollisionConfiguration& c, const Quat& orientation, double radius) {
  const Vec3 along(std::sin(c.theta), 0.0, -std::cos(c.theta)), across = Vec3::UnitY();
  const Vec3 in_plane = across.cross(along);
  const Vec3 axis =
      std::cos(c.phi) * along + std::sin(c.phi) * (std::cos(c.psi) * in_plane + std::sin(c.psi) * across);
  return {{0.0, 0.0, radius}, orientation, c.speed * along, c.spin / radius * axis};
}

}  // namespace

CollisionTrial::CollisionTrial(std::shared_ptr<const Shape> shape, const ContactLaw& law, TrialEnd end,
                               double bounce_velocity)
    : shape_(std::move(shape)),
      law_(law),
      end_(end),
      materials_(std::make_unique<MaterialTable>(law)),
      contact_time_(*shape_),
      world_(trial_settings(bounce_velocity), *materials_) {
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

std::optional<CollisionOutcome> CollisionTrial::run(const CollisionConfiguration& c,
                                                    const Quat& orientation) {
  RigidState state = start_of(c, orientation, shape_->radius);
  return collide(state);
}

std::optional<CollisionOutcome> CollisionTrial::collide(RigidState& state) {
  if (!contact_time_.advance(state)) return {};
  const Before before{std::hypot(state.velocity.norm(), shape_->radius * state.angular_velocity.norm()),
                      kinetic_energy(*shape_, state),
                      state.velocity - (1.0 + law_.restitution) * state.velocity.z() * Vec3::UnitZ()};
  CollisionOutcome outcome;
  outcome.approach = -contact_time_.find_lowest(state).velocity / before.speed_unit;
  answer_contact(state, before.speed_unit);
  outcome.first = outcome.end = describe(state, before);
  if (end_ == TrialEnd::first_impulse) return outcome;
  for (; outcome.impulses < kMostImpulses && contact_time_.advance(state); ++outcome.impulses)
    answer_contact(state, before.speed_unit);
  if (outcome.impulses > 1) outcome.end = describe(state, before);
  return outcome;
}

void CollisionTrial::answer_contact(RigidState& state, double speed_unit) {
  state.position.z() -= contact_time_.find_lowest(state).gap + kDepth * shape_->radius;
  world_.set_state(body_, state);
  world_.step(kImpactTime * shape_->radius / speed_unit);
  state = world_.state(body_);
}

CollisionEnd CollisionTrial::describe(const RigidState& state, const Before& before) const {
  CollisionEnd end;
  const Vec3 v = (state.velocity - before.particle) / before.speed_unit,
             w = shape_->radius / before.speed_unit * state.angular_velocity;
  end.response = Eigen::Matrix<double, 6, 1>(v.z(), v.x(), v.y(), w.z(), w.x(), w.y()).cast<float>();
  end.energy_ratio = kinetic_energy(*shape_, state) / before.energy;
  end.moves_into_plane = state.velocity.z() < -kStill * before.speed_unit;
  return end;
}

}  // namespace lodestone
