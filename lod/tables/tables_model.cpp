// Symbols as in signature/response.h.
#include "lod/tables/tables_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lod/contact/contact_impulse.h"
#include "lod/statistical/flight.h"
#include "lod/statistical/parting.h"
#include "reference/random.h"
#include "signature/response_lookup.h"

namespace lodestone {
namespace {

constexpr double kSameFace = 0.998;                          // cosine between the normals of one face
constexpr std::uint32_t kHeightDraw = 1, kResponseDraw = 2;  // what a draw is for: the last part of its key

// The key of a body's draws: which body, and which of its collisions.
std::uint64_t draw_key(const StatisticalBody& body) {
  return (std::uint64_t(body.owner) << 32) | body.events;
}

double angle_between(const Vec3& a, const Vec3& b) {
  const double lengths = a.norm() * b.norm();
  return lengths > 0.0 ? std::acos(std::clamp(a.dot(b) / lengths, -1.0, 1.0)) : std::numbers::pi / 2;
}

struct Velocities {
  Vec3 linear, angular;
};

// Step 4 of 3.3.2, in the working frame (columns e1, e2, e3).
CollisionConfiguration configuration_of(const Vec3& v, const Vec3& omega, double radius, const Mat3& frame) {
  const Vec3 across = frame.col(2);
  const Vec3 in_plane = across.cross(v);
  return {.theta = angle_between(v, -frame.col(0)),
          .phi = angle_between(v, omega),
          .psi = std::atan2(omega.dot(across) * v.norm(), omega.dot(in_plane)),
          .speed = v.norm(),
          .spin = radius * omega.norm()};
}

double kinetic_energy(const Velocities& v, const StatisticalBody& body, const Shape& shape) {
  return 0.5 * (v.linear.squaredNorm() + v.angular.dot(spin_of(body.orientation, v.angular, shape)));
}

// Of a sphere within the plane, at height `gap` ≤ 0, that leaves it at `speed` and is pulled back: when it
// comes down on the plane, or to where it began. None that sinks by less than a tenth of its radius until the
// end: under a great acceleration each step would else take it deeper.
std::optional<double> find_return(double gap, double speed, double acceleration, double radius, double left) {
  if (speed * left + 0.5 * acceleration * left * left > -0.1 * radius) return {};
  const double root = speed * speed - 2.0 * acceleration * gap;  // m²/s²: of its speed at the plane
  const double time = (speed + std::sqrt(root > 0.0 ? root : speed * speed)) / -acceleration;
  return time <= left ? std::optional(time) : std::nullopt;
}

// Earliest time in [0, left] at which the sphere, falling towards the plane, touches it; none if it does not.
std::optional<double> find_touch(const StatisticalBody& body, const HalfSpace& plane, const Vec3& gravity,
                                 double left) {
  constexpr double kRounding = 1e-9;  // m/s: what slides on a slope leaves it no faster
  const double gap = plane.height_of(body.position) - body.sphere_radius;
  const double speed = body.velocity.dot(plane.normal), acceleration = gravity.dot(plane.normal);
  if (gap <= 0.0 && (speed < 0.0 || (speed < kRounding && acceleration < 0.0))) return 0.0;
  if (gap <= 0.0) return find_return(gap, speed, acceleration, body.sphere_radius, left);
  if (gap + speed * left + 0.5 * acceleration * left * left > 0.0 && (acceleration <= 0.0 || speed >= 0.0))
    return {};
  const double root = speed * speed - 2.0 * acceleration * gap;
  if (root < 0.0) return {};
  const double time = 2.0 * gap / (std::sqrt(root) - speed);  // the form without cancellation
  return time >= 0.0 && time <= left ? std::optional(time) : std::nullopt;
}

struct FirstTouch {
  int plane = -1;     // none: −1
  double time = 0.0;  // s; else all that is left
};

FirstTouch find_first_touch(const StatisticalBody& body, const StepWorld& world, double left) {
  FirstTouch first{.time = left};
  for (int i = 0; i < int(world.planes.size()); ++i)
    if (const auto t = find_touch(body, world.planes[i], world.gravity, first.time);
        t && (first.plane < 0 || *t < first.time))
      first = {i, *t};
  return first;
}

// After its answer; `approach` before it, m/s.
void write_touch(const StatisticalBody& body, const HalfSpace& plane, double approach, ContactLog& log) {
  log.add({.first = body.owner,
           .ground = plane.id,
           .ground_material = plane.material,
           .point = body.position - body.sphere_radius * plane.normal,
           .normal = plane.normal,
           .impulse = body.mass * std::max(0.0, approach + body.velocity.dot(plane.normal)),
           .approach = std::max(0.0, approach)});
}

// The resting condition's pose: the one that needs the smallest rotation (3.4).
int find_nearest_rest_pose(const Signature& signature, const Vec3& normal_in_body) {
  int best = -1;
  double best_cosine = -2.0;
  for (int i = 0; i < int(signature.rest_poses.size()); ++i) {
    const double cosine = signature.rest_poses[i].normal.dot(normal_in_body);
    if (cosine > best_cosine) best_cosine = cosine, best = i;
  }
  return best;
}

// Along which a body that lies on `plane` presses on it: gravity's way, where that leaves the friction cone
// the nearest one in it. Zero where nothing presses.
Vec3 pressing_direction(const HalfSpace& plane, const Vec3& gravity, double friction) {
  const double pressure = -gravity.dot(plane.normal);
  if (pressure <= 0.0) return Vec3::Zero();
  const Vec3 along = gravity + pressure * plane.normal;
  const double slope = along.norm() / pressure;
  return (slope > friction ? friction / slope : 1.0) * along - pressure * plane.normal;
}

// On a slope: of the poses in which the body stays there, the one that needs the smallest rotation.
int find_pose_on_slope(const Quat& orientation, const BodyKind& kind, const HalfSpace& plane,
                       const StepWorld& world) {
  const Vec3 up = orientation.conjugate() * plane.normal;
  const std::vector<RestPose>& poses = kind.signature->rest_poses;
  int best = -1;
  double best_cosine = -2.0;
  for (int i = 0; i < int(poses.size()); ++i)
    if (const double cosine = poses[std::size_t(i)].normal.dot(up);
        cosine > best_cosine && holds_pose(orientation, kind, i, plane, world))
      best_cosine = cosine, best = i;
  return best;
}

// Flush on a face that it has not the energy to leave. `up`: the plane's normal, body axes; J/kg.
bool stands_securely(const RestingFaces& faces, const Shape& shape, const Vec3& up, double energy,
                     double gravity) {
  constexpr double kSlack = 1e-4;  // over R
  if (gravity <= 0.0) return false;
  const double height = -up.dot(shape.hull.vertices[std::size_t(find_support(shape.hull, -up))]);
  const int face =
      faces.find_certain(up, height + std::max(0.0, energy) / gravity + kSlack * shape.radius, 0.0);
  return face >= 0 && faces.faces()[std::size_t(face)].normal.dot(up) > kSameFace;
}

// The rotation, as a vector in world axes, that takes the body into rest pose `pose` on `plane`.
Vec3 rotation_to_rest(const StatisticalBody& body, const BodyKind& kind, int pose, const HalfSpace& plane) {
  const Eigen::AngleAxisd turn(
      rotation_between(body.orientation * kind.signature->rest_poses[pose].normal, plane.normal));
  return turn.angle() * turn.axis();
}

// A small rotational impulse towards the rest pose, in place of Ω⁺ (3.4). Its energy comes from what the body
// still moves with.
void turn_to_rest(StatisticalBody& body, const BodyKind& kind, int pose, const HalfSpace& plane,
                  double energy_before, double time_left, double time) {
  const Vec3 turn = rotation_to_rest(body, kind, pose, plane);
  Vec3 omega = turn / std::max(time_left, time);
  const double rotational = 0.5 * omega.dot(spin_of(body.orientation, omega, *kind.shape));
  const double budget = std::max(0.0, energy_before - 0.5 * body.velocity.squaredNorm());
  const double slowest = 0.25 / time_left;  // rad/s: always enough to finish the turn
  if (rotational > budget)
    omega *= std::max(std::sqrt(budget / rotational), std::min(1.0, slowest / omega.norm()));
  body.spin = spin_of(body.orientation, omega, *kind.shape);
}

// Coulomb friction of the face that it lies on, for `time` seconds under `pressure` (m/s²): a face does not
// roll.
void drag(StatisticalBody& body, const Vec3& normal, double friction, double pressure, double time) {
  const Vec3 slip = body.velocity - body.velocity.dot(normal) * normal;
  if (const double speed = slip.norm(); speed > 0.0)
    body.velocity -= std::min(1.0, friction * pressure * time / speed) * slip;
}

// Coulomb friction of the sphere's lowest point for `time` seconds under `pressure` (m/s²), and of its
// footprint against pivoting.
void rub(StatisticalBody& body, const Shape& shape, const Vec3& normal, double friction, double pressure,
         double time) {
  const Vec3 arm = -double(body.sphere_radius) * normal;
  const Mat3 inverse_inertia = inverse_inertia_world(body.orientation, shape);
  const Vec3 omega = inverse_inertia * body.spin;
  const double available = friction * pressure * time;
  const Vec3 contact = body.velocity + omega.cross(arm), slip = contact - contact.dot(normal) * normal;
  if (const double speed = slip.norm(); speed > 1e-12) {
    const Vec3 direction = slip / speed, lever = arm.cross(direction);
    const double needed = speed / (1.0 + lever.dot(inverse_inertia * lever));
    const Vec3 impulse = -std::min(available, needed) * direction;
    body.velocity += impulse;
    body.spin += arm.cross(impulse);
  }
  constexpr double kFootprint = 0.3;  // lever of pivoting friction over R
  // A torque about the normal turns a leaning body about other axes, too: τ changes ω·n by τ n·I⁻¹n.
  const Vec3 per_torque = inverse_inertia * normal;
  const double pivot =
      body.spin.dot(per_torque) / normal.dot(per_torque);  // m²/s: what ends the turn about the normal
  body.spin -=
      std::copysign(std::min(std::abs(pivot), kFootprint * shape.radius * available), pivot) * normal;
}

// A sphere that has sunk or grown into the ground comes out of it gradually, by `farthest` m at most.
void rise(StatisticalBody& body, std::span<const HalfSpace> planes, double farthest) {
  for (const HalfSpace& plane : planes)
    if (const double gap = plane.height_of(body.position) - double(body.sphere_radius); gap < 0.0)
      body.position += std::min(-0.25 * gap, farthest) * plane.normal;
}

// The rest of a step on the ground: no normal motion, friction on the slip. `on_face`: lying on a face rather
// than rolling.
void slide(StatisticalBody& body, const BodyKind& kind, const HalfSpace& plane, const StepWorld& world,
           double friction, double time, bool on_face) {
  const double pressure = std::max(0.0, -world.gravity.dot(plane.normal));
  const Vec3 along = world.gravity - world.gravity.dot(plane.normal) * plane.normal;
  body.velocity -= body.velocity.dot(plane.normal) * plane.normal;
  body.velocity += along * time;
  if (on_face)
    drag(body, plane.normal, friction, pressure, time);
  else
    rub(body, *kind.shape, plane.normal, friction, pressure, time);
  body.position += body.velocity * time;
  rise(body, {&plane, 1}, std::numeric_limits<double>::infinity());
  body.orientation = advance_orientation(body.orientation, body.spin, kind, time).normalized();
}

}  // namespace

double find_sphere_radius(const StatisticalBody& body, const BodyKind& kind, const TablesOptions& options,
                          std::uint64_t seed) {
  const double radius = kind.shape->radius;
  const double omega = angular_velocity(body.orientation, body.spin, *kind.shape).norm();
  const HeightStatistics height =
      find_collision_height(kind.signature->collision_heights,
                            std::atan2(radius * omega, body.velocity.norm()), options.interpolate);
  if (!options.draw_height) return height.mean * radius;
  RandomStream random(seed, draw_key(body), kHeightDraw);
  return std::clamp(height.mean + height.deviation * random.normal(), 0.05, 1.0) * radius;
}

void respond_from_tables(StatisticalBody& body, const BodyKind& kind, const Vec3& normal,
                         const StepWorld& world, const ContactLaw& law, const TablesOptions& options,
                         ContactTally& tally) {
  const Shape& shape = *kind.shape;
  const Vec3 v = body.velocity, omega = angular_velocity(body.orientation, body.spin, shape);
  if (!(v.dot(normal) < 0.0)) return;
  const Mat3 frame =
      contact_frame(normal, v);  // n, slip, n × slip: its last column is e3, and e2 = e3 × e1 is the slip
  const CollisionConfiguration configuration = configuration_of(v, omega, shape.radius, frame);
  const FoundResponse found =
      find_response(*kind.signature, configuration, world.bounce_velocity, options.interpolate);
  tally.table_extrapolations += found.extrapolated;

  const double energy_before = kinetic_energy(Velocities{v, omega}, body, shape),
               s = configuration.speed_unit();
  RandomStream random(world.seed, draw_key(body), kResponseDraw);
  const DrawnVelocities drawn =
      draw_response(found, configuration, law.restitution, kind.signature->settings.draw, random);
  Velocities after{frame * (s * drawn.linear), frame * (s / shape.radius * drawn.angular)};
  const double energy_after = kinetic_energy(after, body, shape);
  if (energy_after > energy_before) {
    const double scale = std::sqrt(energy_before / energy_after);
    after.linear *= scale;
    after.angular *= scale;
    ++tally.energy_clamps;
  }
  body.velocity = after.linear;
  body.spin = spin_of(body.orientation, after.angular, shape);
  ++body.events;
  ++tally.contacts;
}

void respond_pair_as_paper(StatisticalBody& first, const BodyKind& first_kind, StatisticalBody& second,
                           const BodyKind& second_kind, const Vec3& normal, const StepWorld& world,
                           const ContactLaw& law, const TablesOptions& options, ContactTally& tally) {
  const Vec3 first_velocity = first.velocity, second_velocity = second.velocity;
  first.velocity -= second_velocity;
  respond_from_tables(first, first_kind, normal, world, law, options, tally);
  first.velocity += second_velocity;
  second.velocity -= first_velocity;
  respond_from_tables(second, second_kind, -normal, world, law, options, tally);
  second.velocity += first_velocity;
}

bool holds_pose(const Quat& orientation, const BodyKind& kind, int pose, const HalfSpace& plane,
                const StepWorld& world) {
  if (pose < 0 || world.is_horizontal(plane)) return pose >= 0;
  if (!kind.faces) return false;  // a sphere
  const Vec3 &lying = kind.signature->rest_poses[std::size_t(pose)].normal,
             up = orientation.conjugate() * plane.normal;
  const Vec3 down =
      orientation.conjugate() * pressing_direction(plane, world.gravity, world.law(kind, plane).friction);
  return kind.faces->holds(lying, rotation_between(up, lying) * down);
}

RestingRecord find_resting(const Quat& orientation, const BodyKind& kind, const HalfSpace& plane,
                           const StepWorld& world, double energy, const TablesOptions& options) {
  if (!options.rest_poses) return {};
  if (!world.is_horizontal(plane)) return {find_pose_on_slope(orientation, kind, plane, world)};
  Vec3 up = orientation.conjugate() * plane.normal;
  if (kind.faces && !options.nearest_rest_pose)
    up = kind.faces->faces()[std::size_t(kind.faces->find_quasistatic(up))].normal;
  const int pose = find_nearest_rest_pose(*kind.signature, up);
  if (pose < 0 || options.as_published() || !kind.faces) return {pose};  // what is finely round has none
  const Vec3& lying = kind.signature->rest_poses[std::size_t(pose)].normal;
  const bool is_kept = up.dot(lying) > kSameFace;
  return {is_kept || !stands_securely(*kind.faces, *kind.shape, orientation.conjugate() * plane.normal,
                                      energy, world.gravity_strength())
              ? pose
              : -1};
}

ContactTally step_tables_body(StatisticalBody& body, RestingRecord& resting, const BodyKind& kind,
                              const StepWorld& world, double time, const TablesSettings& settings) {
  ContactTally tally;
  const Shape& shape = *kind.shape;
  const double energy_unit = world.gravity_strength() * shape.radius;
  const double blend =
      settings.blend_time * std::sqrt(shape.radius / std::max(1e-9, world.gravity_strength()));
  double left = time;
  for (int hit = 0; left > 0.0; ++hit) {
    const auto [touched, touch] = find_first_touch(body, world, left);
    advance_flight(body, kind, world.gravity, touch);
    left -= touch;
    if (touched < 0) {
      if (hit > 0)
        rise(body, world.planes, 2.0 * parting_speed(shape.radius, world.gravity_strength()) * time);
      return tally;
    }

    const HalfSpace& plane = world.planes[touched];
    const ContactLaw law = world.law(kind, plane);
    tally.touched_plane = touched;
    const double energy_before = kinetic_energy(body, shape);
    const double approach = -body.velocity.dot(plane.normal);
    const bool presses =
        approach <
        world.bounce_velocity + world.gravity_strength() * time;  // no impact: what gravity adds in a step
    const bool sloped = !world.is_horizontal(plane);
    if (sloped && body.motion == Motion::settling &&
        !holds_pose(body.orientation, kind, resting.pose, plane, world))
      body.motion = Motion::dynamic;
    const bool rolls = sloped && kind.round && presses && body.motion == Motion::dynamic;
    if (!rolls && (body.motion != Motion::settling || !presses))
      respond_from_tables(body, kind, plane.normal, world, law, settings.options, tally);
    if (world.log) write_touch(body, plane, approach, *world.log);
    if (body.motion == Motion::dynamic && energy_before < settings.resting_energy * energy_unit) {
      resting = find_resting(body.orientation, kind, plane, world, energy_before - 0.5 * approach * approach,
                             settings.options);
      if (resting.pose >= 0) body.motion = Motion::settling;
    }
    if (body.motion == Motion::settling && energy_before > 2.0 * settings.resting_energy * energy_unit)
      body.motion = Motion::dynamic;
    if (body.motion == Motion::settling)
      turn_to_rest(body, kind, resting.pose, plane, energy_before, blend, std::max(left, 1e-3));
    if (approach < world.bounce_velocity || (presses && (rolls || body.motion == Motion::settling)) ||
        hit + 1 >= settings.max_impacts) {
      slide(body, kind, plane, world, law.friction, left, sloped && body.motion == Motion::settling);
      return tally;
    }
  }
  return tally;
}

}  // namespace lodestone
