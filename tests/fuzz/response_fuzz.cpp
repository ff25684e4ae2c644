// Responses: what is drawn from a signature is finite and leaves the plane, whatever the configuration; and a
// single hit in closed form turns the approach as restitution says and gains no energy where the law has none
// to give (see kGainless).
#include "lod/contact/contact_impulse.h"
#include "reference/free_rotation.h"
#include "reference/random.h"
#include "signature/measure/measure.h"
#include "signature/response_lookup.h"
#include "tests/fuzz/fuzz_input.h"

namespace lodestone {
namespace {

/// Up to here, as restitution and as friction, Newton's restitution with the friction bound of ODE's
/// approximate pyramid adds no energy in single hits.
constexpr double kGainless = 0.5;

const Shape& shape() {
  static const Shape box = make_shape("box", make_box({0.2, 0.3, 0.4}));
  return box;
}

const Signature& signature() {
  static const Signature measured = [] {
    SignatureSettings coarse;
    coarse.n_theta = 3, coarse.n_phi = 3, coarse.n_alpha = 4, coarse.trials_per_cell = 6,
    coarse.held_out_conditions = 1, coarse.height_trials = 20, coarse.settling_trials = 5, coarse.clips = 1;
    return measure_signature(shape(), coarse, 1);
  }();
  return measured;
}

void draw(fuzz::FuzzInput& input) {
  CollisionConfiguration c{.speed = input.any_real(), .spin = input.any_real()};
  c.theta = input.any_real(), c.phi = input.any_real(), c.psi = input.any_real();
  if (input.choice(2) == 0)
    c = {.theta = input.real(0, 1.5),
         .phi = input.real(0, 3.1),
         .psi = input.real(0, 6.2),
         .speed = input.real(0, 100),
         .spin = input.real(0, 100)};
  const FoundResponse found = find_response(signature(), c, 0.05);
  RandomStream random(input.byte(), input.byte(), 0);
  fuzz::require(found.mean.allFinite() && found.deviation.allFinite(), "a response that is not finite");
  const bool sane = std::isfinite(c.speed) && std::isfinite(c.spin) && std::isfinite(c.theta) &&
                    c.speed >= 0.0 && c.spin >= 0.0 && c.speed + c.spin > 1e-100 &&
                    c.speed + c.spin < 1e100 && c.theta >= 0.0 && c.theta < 1.57;
  if (!sane) return;
  const DrawnVelocities drawn = draw_response(found, c, 0.4, ResponseDraw(input.choice(3)), random);
  fuzz::require(drawn.linear.allFinite() && drawn.angular.allFinite(), "a draw that is not finite");
  fuzz::require(drawn.linear.x() >= 0.0, "a draw that moves into the plane");
}

void hit(fuzz::FuzzInput& input) {
  RigidState s;
  s.orientation = rotation_from_vector({input.real(-3, 3), input.real(-3, 3), input.real(-3, 3)});
  s.velocity = {input.real(-20, 20), input.real(-20, 20), input.real(-20, 20)};
  s.angular_velocity = {input.real(-100, 100), input.real(-100, 100), input.real(-100, 100)};
  const ContactLaw law{input.real(0, kGainless), input.real(0, kGainless)};
  const Vec3 arm =
      s.orientation *
      shape()
          .hull.vertices[std::size_t(find_support(shape().hull, s.orientation.conjugate() * Vec3(0, 0, -1)))];
  const Vec3 approach = s.velocity + s.angular_velocity.cross(arm);
  const Mat3 inverse_inertia = inverse_inertia_world(s.orientation, shape());
  const Vec3 impulse =
      respond_contact(contact_response_matrix(1.0, inverse_inertia, arm), Vec3::UnitZ(), approach, law);
  RigidState after = s;
  after.velocity += impulse;
  after.angular_velocity += inverse_inertia * arm.cross(impulse);
  const Vec3 leaving = after.velocity + after.angular_velocity.cross(arm);
  const double scale = 1.0 + s.velocity.norm() + s.angular_velocity.norm();
  fuzz::require(impulse.allFinite() && impulse.z() >= -1e-9 * scale, "an impulse that pulls");
  fuzz::require(std::abs(leaving.z() - (approach.z() < 0.0 ? -law.restitution * approach.z()
                                                           : approach.z())) < 1e-9 * scale,
                "another rebound than restitution says");
  fuzz::require(kinetic_energy(shape(), after) <= kinetic_energy(shape(), s) * (1.0 + 1e-9) + 1e-12,
                "energy out of nothing");
}

}  // namespace
}  // namespace lodestone

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lodestone::fuzz::FuzzInput input(data, size);
  for (int i = 0; i < 40 && !input.ended(); ++i)
    input.choice(2) == 0 ? lodestone::draw(input) : lodestone::hit(input);
  return 0;
}
