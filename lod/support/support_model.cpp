#include "lod/support/support_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "lod/contact/contact_impulse.h"
#include "lod/contact/ground_solver.h"
#include "lod/contact/hull_contacts.h"
#include "lod/support/hull_flight.h"

namespace lodestone {
namespace {

// Whether the vertex that is lowest at the step's end touches already: then nothing strikes, the body only
// leans on. The flight of `body` is that before a torque has given it anything.
bool touches_already(const HullFlight& flight, const StatisticalBody& body, const Shape& shape,
                     const HalfSpace& plane, LowestPoint lowest, double bounce_velocity) {
  const HullPose now{body.position, body.orientation};
  lowest.normal = now.orientation.conjugate() * plane.normal;
  if (shape.sphere_radius) lowest.arm = -*shape.sphere_radius * lowest.normal;
  const bool touches =
      plane.height_of(now.position) + lowest.arm.dot(lowest.normal) < kTouching * shape.radius;
  return touches && (shape.sphere_radius || flight.gap_motion(now, lowest, 0.0).velocity > -bounce_velocity);
}

// A body that moves against the ground, in its own axes.
struct OnGround {
  Mat3 rotation;  // body axes to the world's
  GroundMotion motion;
  OnGround(const StatisticalBody& body, const Shape& shape) : rotation(body.orientation.toRotationMatrix()) {
    motion.velocity = rotation.transpose() * body.velocity;
    motion.angular_velocity = shape.inverse_inertia_per_mass * (rotation.transpose() * body.spin);
  }
};

Vec3 arm_of(const HullContact& contact, const Shape& shape, const Vec3& normal_in_body) {
  if (shape.sphere_radius) return -*shape.sphere_radius * normal_in_body;
  return shape.hull.vertices[std::size_t(contact.vertex)];
}

// What the contacts gave it.
void take_impulses(StatisticalBody& body, const OnGround& on, std::span<const GroundContact> contacts) {
  Vec3 impulse = Vec3::Zero(), turning = Vec3::Zero();
  for (const GroundContact& c : contacts) {
    impulse += c.impulse();
    turning += c.arm.cross(c.impulse());
  }
  body.velocity += on.rotation * impulse;
  body.spin += on.rotation * turning;
}

// The impulses of several vertices that strike at once, an edge's or a face's.
void respond_together(StatisticalBody& body, const BodyKind& kind, const HullContacts& found,
                      const Vec3& normal, const ContactLaw& law, const SupportSettings& settings) {
  OnGround on(body, *kind.shape);
  const Vec3 normal_in_body = on.rotation.transpose() * normal;
  std::array<GroundContact, kMaxGroundContacts> all;
  const auto contacts = std::span(all).first(std::size_t(found.count));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts[i].normal = normal_in_body;
    contacts[i].arm = arm_of(found.contact[i], *kind.shape, normal_in_body);
    contacts[i].law = law;
  }
  constexpr double kInstant = 1e-9;  // s: no gap is closed meanwhile
  solve_ground_contacts(on.motion, kind.shape->inverse_inertia_per_mass, contacts, kInstant,
                        settings.impact_solver);
  take_impulses(body, on, contacts);
}

// ODE's law itself adds energy in some hits of high restitution: there the impulse, which gave `body` its
// motion, is scaled down until it adds none. With s of the impulse the energy is E₀ + s (ΔE − C) + s² C, C
// being that of the change alone.
void clamp_energy(const Vec3& velocity_before, const Vec3& spin_before, StatisticalBody& body,
                  const Shape& shape, ContactTally& tally) {
  const Vec3 omega_before = angular_velocity(body.orientation, spin_before, shape);
  const double energy = 0.5 * (velocity_before.squaredNorm() + spin_before.dot(omega_before));
  const double gain = kinetic_energy(body, shape) - energy;
  if (gain <= 1e-12 * energy) return;
  const Vec3 velocity = body.velocity - velocity_before, spin = body.spin - spin_before;
  const double of_change =
      0.5 * (velocity.squaredNorm() + spin.dot(angular_velocity(body.orientation, spin, shape)));
  const double share = std::clamp(1.0 - gain / of_change, 0.0, 1.0);
  body.velocity = velocity_before + share * velocity;
  body.spin = spin_before + share * spin;
  ++tally.energy_clamps;
}

// What moves a body up that rolls onto vertices that did not carry it slows it down, if by no more than half
// of its kinetic energy. (On an edge or a face it turns about what carries it: there ODE's law has all of it,
// and what is taken for nothing but rounding keeps a pillar next to balance from falling.) One that parts
// from what it overlapped when it came is moved by no motion of its own.
class EnergyBound {
 public:
  EnergyBound(StatisticalBody& body, const Shape& shape, const Vec3& gravity, bool bounded)
      : body_(body), shape_(shape), gravity_(gravity), bounded_(bounded && body.eased <= 0.0f) {
    if (bounded_) kinetic_ = kinetic_energy(body, shape), position_ = body.position;
  }
  /// Takes from the motion by what kinetic and potential energy exceed what they were. Where the ground has
  /// no friction, its `normal` given, not from what nothing there can change: the motion along it, the spin
  /// about the normal.
  void keep(const std::optional<Vec3>& normal = {}) {
    if (!bounded_) return;
    const double now = kinetic_energy(body_, shape_),
                 gain = now - kinetic_ - gravity_.dot(body_.position - position_);
    if (!(gain > 0.0 && now > 0.0)) return;
    if (!normal) {
      const double share = share_left(gain, now);
      body_.velocity *= share;
      body_.spin *= share;
      return;
    }
    const Vec3 rising = body_.velocity.dot(*normal) * *normal,
               rocking = body_.spin - body_.spin.dot(*normal) * *normal;
    const double taken =
        1.0 - share_left(gain, 0.5 * (rising.squaredNorm() +
                                      rocking.dot(angular_velocity(body_.orientation, rocking, shape_))));
    body_.velocity -= taken * rising;
    body_.spin -= taken * rocking;
  }

 private:
  /// Of a motion of the energy `kinetic`, both over mass.
  static double share_left(double gain, double kinetic) {
    return kinetic > 0.0 ? std::sqrt(1.0 - std::min(0.5, gain / kinetic)) : 1.0;
  }

  StatisticalBody& body_;
  const Shape& shape_;
  const Vec3& gravity_;
  bool bounded_;
  double kinetic_ = 0.0;          // J/kg, before
  Vec3 position_ = Vec3::Zero();  // m, before
};

// One vertex strikes, all in body axes: respond_contact's impulse, less of it where that would add energy. Of
// the share s the energy is that of a parabola, s J·u + s² J·K J / 2.
void respond_alone(StatisticalBody& body, const Shape& shape, const LowestPoint& lowest,
                   const ContactLaw& law, ContactTally& tally) {
  const Quat to_body = body.orientation.conjugate();
  const Vec3 spin = to_body * body.spin;
  const Vec3 velocity = to_body * body.velocity + (shape.inverse_inertia_per_mass * spin).cross(lowest.arm);
  const Mat3 response = contact_response_matrix(1.0, shape.inverse_inertia_per_mass, lowest.arm);
  Vec3 impulse = respond_contact(response, lowest.normal, velocity, law).impulse;
  const double linear = impulse.dot(velocity), square = impulse.dot(response * impulse);
  if (linear + 0.5 * square > 1e-12 * square) {
    impulse *= std::clamp(-2.0 * linear / square, 0.0, 1.0);
    ++tally.energy_clamps;
  }
  body.velocity += body.orientation * impulse;
  body.spin += body.orientation * lowest.arm.cross(impulse);
}

// `lowest` strikes, and with it what is about to.
void respond(StatisticalBody& body, const BodyKind& kind, const LowestPoint& lowest, double approach,
             const StepWorld& world, const SupportSettings& settings, ContactTally& tally) {
  const HalfSpace& plane = world.planes[std::size_t(lowest.plane)];
  const double height = plane.height_of(body.position), radius = kind.shape->radius;
  const double sunk =
      settings.impact_lag * std::sqrt(radius / std::max(1e-9, world.gravity_strength())) * approach;
  const double margin =
      std::clamp(sunk, settings.impact_margin * radius, settings.greatest_impact_margin * radius);
  const HullContacts together = find_hull_contacts(*kind.shape, body.orientation, plane.normal, height,
                                                   lowest.gap + margin, body.support_hint);
  ++body.events;
  const ContactLaw law = world.law(kind, plane);
  if (together.count == 1) return respond_alone(body, *kind.shape, lowest, law, tally);
  const Vec3 velocity = body.velocity, spin = body.spin;
  respond_together(body, kind, together, plane.normal, law, settings);
  clamp_energy(velocity, spin, body, *kind.shape, tally);
}

// What held a vertex in the contact step before: where the solver begins in the next.
struct HeldVertices {
  std::array<std::pair<std::int32_t, Vec3>, 3 * kMaxGroundContacts> impulse;  // by vertex, N s over mass
  int count = 0;
  bool rolls = false;   // onto a vertex that was none of these
  bool wedged = false;  // between planes that look against each other
  Vec3 find(std::int32_t vertex) const {
    for (int i = 0; i < count; ++i)
      if (impulse[i].first == vertex) return impulse[i].second;
    return Vec3::Zero();
  }
};

// Of impulses over mass.
void write_touch(const StatisticalBody& body, const StepWorld& world, int plane, const Vec3& arm,
                 double approach, double impulse) {
  const HalfSpace& ground = world.planes[std::size_t(plane)];
  world.log->add({.first = body.owner,
                  .ground = ground.id,
                  .ground_material = ground.material,
                  .point = body.position + arm,
                  .normal = ground.normal,
                  .impulse = body.mass * impulse,
                  .approach = std::max(0.0, approach)});
}

// The contacts of a step: of each plane in reach the vertices that may meet it.
struct StepContacts {
  static constexpr std::size_t kCapacity = 3 * kMaxGroundContacts;
  std::array<GroundContact, kCapacity> contact;
  std::array<std::int32_t, kCapacity> vertex;
  std::array<int, kCapacity> plane;
  std::size_t count = 0;
  double deepest = 0.0;  // m, 0 or less
  int deepest_plane = -1;
  std::span<GroundContact> contacts() { return std::span(contact).first(count); }
};

// For a body that gravity has been given to.
void find_step_contacts(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                        const OnGround& on, double time, double least_margin, const HeldVertices& held,
                        StepContacts& found) {
  const Shape& shape = *kind.shape;
  for (std::size_t i = 0; i < world.planes.size(); ++i) {
    if (found.count + kMaxGroundContacts > StepContacts::kCapacity) return;
    const HalfSpace& plane = world.planes[i];
    const double height = plane.height_of(body.position), drop = body.velocity.dot(plane.normal) * time;
    // What the ground gives one point may turn another down as fast as the body fell.
    const double fall = std::max(0.0, -drop), margin = least_margin + fall;
    const Vec3 normal = on.rotation.transpose() * plane.normal;
    const GapChange change{drop, normal.cross(on.motion.angular_velocity) * time};
    const double reach = margin + fall + change.of_arm.norm() * shape.radius;
    if (height > shape.radius + reach) continue;
    const HullContacts low =
        find_hull_contacts(shape, body.orientation, plane.normal, height, margin, body.support_hint, change);
    for (int k = 0; k < low.count; ++k) {
      const HullContact& point = low.contact[std::size_t(k)];
      if (point.gap > reach) continue;
      found.contact[found.count] = {.normal = normal,
                                    .arm = arm_of(point, shape, normal),
                                    .gap = point.gap,
                                    .law = world.law(kind, plane),
                                    .guess = on.rotation.transpose() * held.find(point.vertex)};
      found.vertex[found.count] = point.vertex;
      found.plane[found.count++] = int(i);
      if (point.gap < found.deepest) found.deepest = point.gap, found.deepest_plane = int(i);
    }
  }
}

// With what the contacts gave, `on` being the motion then: the vertex that has sunk in deepest by the step's
// end, if it is none of those found. A round surface rolls onto it: held as they are, it raises the body by
// its motion, where a lift out of the ground would add energy. False: there is none.
bool add_sinking(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                 const OnGround& on, double time, StepContacts& found) {
  const Shape& shape = *kind.shape;
  if (shape.sphere_radius || found.count == StepContacts::kCapacity) return false;
  const int plane_index = found.plane[found.count - 1];
  const HalfSpace& plane = world.planes[std::size_t(plane_index)];
  const Vec3 position = body.position + on.rotation * on.motion.velocity * time;
  const Quat orientation =
      rotation_from_vector(on.rotation * on.motion.angular_velocity * time) * body.orientation;
  std::int32_t vertex = body.support_hint;
  const HullContact lowest =
      find_lowest_point(shape, orientation, plane.normal, plane.height_of(position), vertex);
  const auto known = std::span(found.vertex).first(found.count);
  if (lowest.gap > -kTouching * shape.radius || std::ranges::find(known, lowest.vertex) != known.end())
    return false;
  for (GroundContact& c : found.contacts()) c.guess = c.impulse();
  const Vec3 normal = on.rotation.transpose() * plane.normal,
             &arm = shape.hull.vertices[std::size_t(lowest.vertex)];
  found.contact[found.count] = {.normal = normal,
                                .arm = arm,
                                .gap = plane.height_of(body.position) + arm.dot(normal),
                                .law = world.law(kind, plane)};
  found.vertex[found.count] = lowest.vertex;
  found.plane[found.count++] = plane_index;
  return true;
}

// One step of sliding, rolling or rocking: gravity, every vertex near the ground held or bounced at once,
// then motion.
void contact_step(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                  const SupportSettings& settings, HeldVertices& held, ContactTally& tally) {
  const Shape& shape = *kind.shape;
  EnergyBound energy(body, shape, world.gravity, settings.energy_bounded);
  const Vec3 fallen = world.gravity * time;
  body.velocity += fallen;
  body.spin += world.turning * time;
  OnGround on(body, shape);
  // Kept from step to step, since to make all of them takes longer than to solve a few.
  thread_local StepContacts found;
  found.count = 0;
  found.deepest = 0.0;
  find_step_contacts(body, kind, world, on, time, settings.contact_margin * shape.radius, held, found);
  if (found.count > 0) {
    tally.touched_plane = found.plane[found.count - 1];
    ContactSolverSettings solver = settings.solver;
    solver.bounce_velocity =
        world.bounce_velocity + world.gravity_strength() * time;  // what gravity adds in a step is no impact
    if (settings.timed_bounces) solver.fall = on.rotation.transpose() * fallen;
    const GroundMotion before = on.motion;
    solve_ground_contacts(on.motion, shape.inverse_inertia_per_mass, found.contacts(), time, solver);
    const bool sinks = add_sinking(body, kind, world, on, time, found);
    held.rolls |= sinks;
    if (sinks) {
      on.motion = before;
      solve_ground_contacts(on.motion, shape.inverse_inertia_per_mass, found.contacts(), time, solver);
    }
    const Vec3 velocity_before = body.velocity, spin_before = body.spin;
    take_impulses(body, on, found.contacts());
    for (std::size_t k = 0; k < found.count; ++k) {
      const GroundContact& c = found.contact[k];
      held.impulse[k] = {found.vertex[k], c.bounces ? Vec3(Vec3::Zero()) : Vec3(on.rotation * c.impulse())};
      if (!world.log || c.rows[0].impulse <= 0.0) continue;
      const Vec3 velocity =
          before.velocity - on.rotation.transpose() * fallen + before.angular_velocity.cross(c.arm);
      write_touch(body, world, found.plane[k], on.rotation * c.arm, -velocity.dot(c.normal),
                  c.rows[0].impulse);
    }
    if (std::ranges::any_of(found.contacts(), &GroundContact::bounces))
      clamp_energy(velocity_before, spin_before, body, shape, tally);
    tally.contacts += std::int64_t(found.count);
  }
  held.count = int(found.count);
  held.wedged = false;
  for (std::size_t k = 1; k < found.count; ++k)
    held.wedged |= found.contact[k].normal.dot(found.contact[0].normal) < 0.0;
  body.position += body.velocity * time;
  if (held.rolls)
    energy.keep(found.count > 0 && found.contact[0].law.friction == 0.0
                    ? std::optional(world.planes[std::size_t(tally.touched_plane)].normal)
                    : std::nullopt);
  if (found.deepest < 0.0 && body.eased <= 0.0f)
    body.position +=
        push_out_overlap(found.deepest, shape.radius) * world.planes[std::size_t(found.deepest_plane)].normal;
  body.orientation = advance_orientation(body.orientation, body.spin, kind, time).normalized();
}

// The ground has the last word.
void lift_off(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, const HalfSpace& plane,
              double time, bool rolls, const SupportSettings& settings) {
  const Shape& shape = *kind.shape;
  EnergyBound energy(body, shape, world.gravity, settings.energy_bounded && rolls);
  lift_out(body, shape, plane, world.gravity, lift_of(body, shape, world.gravity_strength(), time));
  energy.keep(world.law(kind, plane).friction == 0.0 ? std::optional(plane.normal) : std::nullopt);
}

}  // namespace

[[gnu::flatten]] ContactTally step_support_body(StatisticalBody& body, const BodyKind& kind,
                                                const StepWorld& world, double time,
                                                const SupportSettings& settings, const Quat* turned) {
  ContactTally tally;
  double left = time;
  // A torque acts at once on what flies, step by step on what touches the ground.
  const bool is_turned = !world.turning.isZero(0.0);
  const StatisticalBody before = is_turned ? body : StatisticalBody();
  body.spin += world.turning * time;
  for (int hit = 0; hit < settings.max_impacts && left > 0.0; ++hit) {
    const HullFlight flight(body, kind, world);
    std::int32_t hint = body.support_hint;
    Impact end{
        left, hit == 0 && turned ? HullPose{flight.position_at(left), *turned} : flight.pose_at(left), {}};
    end.lowest = flight.find_lowest(end.pose, hint);
    if (end.lowest.plane < 0 || end.lowest.gap >= 0.0) {
      body.position = end.pose.position;
      body.velocity = flight.velocity_at(left);
      body.orientation = end.pose.orientation;
      body.support_hint = hint;
      return tally;
    }
    if (touches_already(is_turned && hit == 0 ? HullFlight(before, kind, world) : flight, body, *kind.shape,
                        world.planes[std::size_t(end.lowest.plane)], end.lowest, world.bounce_velocity)) {
      body.support_hint = hint;
      break;
    }
    const Impact impact = flight.find_impact(end, settings.impact_tolerance * kind.shape->radius, hint);
    if (impact.lowest.plane < 0) break;
    const double approach = -flight.gap_motion(impact.pose, impact.lowest, impact.time).velocity;
    if (approach < world.bounce_velocity) break;  // not a bounce: it stays in contact
    const Vec3 velocity = flight.velocity_at(impact.time);
    body.position = impact.pose.position;
    body.velocity = velocity;
    body.orientation = impact.pose.orientation;
    body.support_hint = hint;
    left -= impact.time;
    respond(body, kind, impact.lowest, approach, world, settings, tally);
    const HalfSpace& plane = world.planes[std::size_t(impact.lowest.plane)];
    if (world.log)
      write_touch(body, world, impact.lowest.plane, body.orientation * impact.lowest.arm, approach,
                  (body.velocity - velocity).dot(plane.normal));
    tally.touched_plane = impact.lowest.plane;
    ++tally.contacts;
  }
  if (left > 0.0) {
    const double longest =
        settings.contact_step * std::sqrt(kind.shape->radius / std::max(1e-9, world.gravity_strength()));
    const int steps = std::clamp(int(std::ceil(left / longest)), 1, 32);
    HeldVertices held;
    body.spin -= world.turning * left;
    for (int i = 0; i < steps; ++i) contact_step(body, kind, world, left / steps, settings, held, tally);
    // Off one of two walls that lean against each other it would be lifted into the other.
    if (tally.touched_plane >= 0 && !held.wedged)
      lift_off(body, kind, world, world.planes[tally.touched_plane], left, held.rolls, settings);
  }
  return tally;
}

}  // namespace lodestone
