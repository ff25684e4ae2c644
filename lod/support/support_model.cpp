#include "lod/support/support_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lod/contact/contact_impulse.h"
#include "lod/contact/contact_solver.h"
#include "lod/contact/hull_contacts.h"
#include "lod/statistical/flight.h"

namespace lodestone {
namespace {

constexpr double kTouching = 1e-4;  // over R: a gap that is none

struct LowestPoint {
  int plane = -1;  // −1: no plane within reach
  HullContact contact;
};

// The lowest point over the plane it is nearest to (or deepest in); planes out of reach are not looked at.
LowestPoint find_lowest(StatisticalBody& body, const BodyKind& kind, std::span<const HalfSpace> planes) {
  LowestPoint lowest;
  lowest.contact.gap = 1e300;
  for (int i = 0; i < int(planes.size()); ++i) {
    const HalfSpace& plane = planes[std::size_t(i)];
    const double height = plane.height_of(body.position);
    if (height > kind.shape->radius || height - kind.shape->radius > lowest.contact.gap) continue;
    const HullContact contact =
        find_lowest_point(*kind.shape, body.orientation, plane.normal, height, body.support_hint);
    if (contact.gap < lowest.contact.gap) lowest = {i, contact};
  }
  return lowest;
}

Vec3 velocity_at(const StatisticalBody& body, const BodyKind& kind, const Vec3& arm) {
  return body.velocity + angular_velocity(body.orientation, body.spin, *kind.shape).cross(arm);
}

struct Impact {
  double time = 0.0;
  StatisticalBody body;  // at that time
  LowestPoint lowest;
};

// When, between a body clear of the ground and the same body inside it after `time` seconds, the gap closes:
// bisection first, for the gap may rise before it falls (another vertex has just left), then false position.
Impact find_impact(const StatisticalBody& start, const StatisticalBody& end, const LowestPoint& end_lowest,
                   const BodyKind& kind, const StepWorld& world, double time) {
  const double tolerance = kTouching * kind.shape->radius;
  Impact before{0.0, start, {}}, after{time, end, end_lowest};
  double gap_before = 0.0, gap_after = end_lowest.contact.gap;
  for (int i = 0; i < 12 && gap_after < -tolerance; ++i) {
    const double fraction =
        i < 2 || gap_before <= 0.0 ? 0.5 : std::clamp(gap_before / (gap_before - gap_after), 0.1, 0.9);
    Impact middle{before.time + fraction * (after.time - before.time), start, {}};
    advance_flight(middle.body, kind, world.gravity, middle.time);
    middle.lowest = find_lowest(middle.body, kind, world.planes);
    if (middle.lowest.contact.gap < 0.0) {
      gap_after = middle.lowest.contact.gap;
      after = middle;
    } else {
      gap_before = middle.lowest.contact.gap;
      before = middle;
    }
  }
  return after;
}

// Whether the vertex that is lowest at the step's end touches already: then nothing strikes, the body only
// leans on.
bool touches_already(const StatisticalBody& body, const BodyKind& kind, const HalfSpace& plane,
                     std::int32_t vertex, double bounce_velocity) {
  if (kind.shape->sphere_radius)
    return plane.height_of(body.position) - *kind.shape->sphere_radius < kTouching * kind.shape->radius;
  const Vec3 arm = body.orientation * kind.shape->hull.vertices[vertex];
  return plane.height_of(body.position) + arm.dot(plane.normal) < kTouching * kind.shape->radius &&
         velocity_at(body, kind, arm).dot(plane.normal) > -bounce_velocity;
}

// The impulses of several vertices that strike at once, an edge's or a face's.
void respond_together(StatisticalBody& body, const BodyKind& kind, const HullContacts& found,
                      const Vec3& normal, const ContactLaw& law, const SupportSettings& settings) {
  std::array<SolverBody, 1> bodies{SolverBody{body.velocity,
                                              angular_velocity(body.orientation, body.spin, *kind.shape), 1.0,
                                              inverse_inertia_world(body.orientation, *kind.shape)}};
  std::array<SolverContact, kMaxGroundContacts> contacts;
  for (int i = 0; i < found.count; ++i) {
    contacts[i].normal = normal;
    contacts[i].arm_first = found.contact[i].arm;
    contacts[i].law = law;
  }
  constexpr double kInstant = 1e-9;  // s: no gap is closed meanwhile
  solve_contacts(bodies, std::span(contacts).first(std::size_t(found.count)), kInstant,
                 settings.impact_solver);
  body.velocity = bodies[0].velocity;
  for (int i = 0; i < found.count; ++i) body.spin += contacts[i].arm_first.cross(impulse_of(contacts[i]));
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

void respond(StatisticalBody& body, const BodyKind& kind, const HullContact& contact, const HalfSpace& plane,
             const ContactLaw& law, double gravity, const SupportSettings& settings) {
  const double height = plane.height_of(body.position), radius = kind.shape->radius;
  const double approach = std::max(0.0, -velocity_at(body, kind, contact.arm).dot(plane.normal));
  const double sunk = settings.impact_lag * std::sqrt(radius / std::max(1e-9, gravity)) * approach;
  const double margin =
      std::clamp(sunk, settings.impact_margin * radius, settings.greatest_impact_margin * radius);
  const HullContacts together = find_hull_contacts(*kind.shape, body.orientation, plane.normal, height,
                                                   contact.gap + margin, body.support_hint);
  ++body.events;
  if (together.count > 1) return respond_together(body, kind, together, plane.normal, law, settings);
  const Mat3 response =
      contact_response_matrix(1.0, inverse_inertia_world(body.orientation, *kind.shape), contact.arm);
  const Vec3 impulse =
      respond_contact(response, plane.normal, velocity_at(body, kind, contact.arm), law).impulse;
  body.velocity += impulse;
  body.spin += contact.arm.cross(impulse);
}

// What held a vertex in the contact step before: where the solver begins in the next.
struct HeldVertices {
  std::array<std::pair<std::int32_t, Vec3>, 3 * kMaxGroundContacts> impulse;  // by vertex, N s over mass
  int count = 0;
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

// One step of sliding, rolling or rocking: gravity, every vertex near the ground held or bounced at once,
// then motion.
void contact_step(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                  const SupportSettings& settings, HeldVertices& held, ContactTally& tally) {
  const Shape& shape = *kind.shape;
  const Vec3 velocity_at_first = body.velocity;
  body.velocity += world.gravity * time;
  std::array<SolverBody, 1> bodies{SolverBody{body.velocity,
                                              angular_velocity(body.orientation, body.spin, shape), 1.0,
                                              inverse_inertia_world(body.orientation, shape)}};
  // Kept from step to step, since to make all of them takes longer than to solve a few.
  thread_local std::array<SolverContact, 3 * kMaxGroundContacts> contacts;
  std::array<std::int32_t, 3 * kMaxGroundContacts> vertices;
  std::array<int, 3 * kMaxGroundContacts> planes;
  int count = 0;
  double deepest = 0.0;
  for (int i = 0; i < int(world.planes.size()) && count + kMaxGroundContacts <= int(contacts.size()); ++i) {
    const HalfSpace& plane = world.planes[i];
    const double height = plane.height_of(body.position);
    const double margin = settings.contact_margin * shape.radius +
                          (body.velocity.norm() + bodies[0].angular_velocity.norm() * shape.radius) * time;
    if (height > shape.radius + margin) continue;
    const HullContacts found =
        find_hull_contacts(shape, body.orientation, plane.normal, height, margin, body.support_hint);
    for (int k = 0; k < found.count; ++k) {
      if (found.contact[k].gap > margin) continue;
      SolverContact& c = contacts[count++] = SolverContact{};
      c.normal = plane.normal;
      c.arm_first = found.contact[k].arm;
      c.gap = found.contact[k].gap;
      c.law = world.law(kind, plane);
      c.guess = held.find(found.contact[k].vertex);
      vertices[count - 1] = found.contact[k].vertex;
      planes[count - 1] = i;
      deepest = std::min(deepest, c.gap);
      tally.touched_plane = i;
    }
  }
  if (count > 0) {
    ContactSolverSettings solver = settings.solver;
    solver.bounce_velocity =
        world.bounce_velocity + world.gravity_strength() * time;  // what gravity adds in a step is no impact
    solve_contacts(bodies, std::span(contacts).first(count), time, solver);
    const bool bounces = std::ranges::any_of(std::span(contacts).first(count), &SolverContact::bounces);
    const Vec3 velocity_before = body.velocity, spin_before = body.spin;
    body.velocity = bodies[0].velocity;
    for (int k = 0; k < count; ++k) {
      const Vec3 impulse = impulse_of(contacts[k]);
      body.spin += contacts[k].arm_first.cross(impulse);
      held.impulse[k] = {vertices[k], contacts[k].bounces ? Vec3::Zero() : impulse};
      if (world.log && contacts[k].impulse[0] > 0.0) {
        const Vec3 &arm = contacts[k].arm_first,
                   omega = angular_velocity(body.orientation, spin_before, shape);
        const double approach = -Vec3(velocity_at_first + omega.cross(arm)).dot(contacts[k].normal);
        write_touch(body, world, planes[k], arm, approach, contacts[k].impulse[0]);
      }
    }
    if (bounces) clamp_energy(velocity_before, spin_before, body, shape, tally);
    tally.contacts += count;
  }
  held.count = count;
  body.position += body.velocity * time;
  if (deepest < 0.0 && body.eased <= 0.0f)
    body.position += push_out_overlap(deepest, shape.radius) * world.planes[tally.touched_plane].normal;
  body.orientation = advance_orientation(body.orientation, body.spin, kind, time).normalized();
}

}  // namespace

ContactTally step_support_body(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                               double time, const SupportSettings& settings) {
  ContactTally tally;
  double left = time;
  for (int hit = 0; hit < settings.max_impacts && left > 0.0; ++hit) {
    StatisticalBody end = body;
    advance_flight(end, kind, world.gravity, left);
    const LowestPoint lowest = find_lowest(end, kind, world.planes);
    if (lowest.plane < 0 || lowest.contact.gap >= 0.0) {
      body = end;
      return tally;
    }
    if (touches_already(body, kind, world.planes[lowest.plane], end.support_hint, world.bounce_velocity)) {
      body.support_hint = end.support_hint;
      break;
    }
    const Impact impact = find_impact(body, end, lowest, kind, world, left);
    const HalfSpace& plane = world.planes[impact.lowest.plane];
    const double approach = velocity_at(impact.body, kind, impact.lowest.contact.arm).dot(plane.normal);
    if (approach > -world.bounce_velocity) break;  // not a bounce: it stays in contact
    body = impact.body;
    left -= impact.time;
    respond(body, kind, impact.lowest.contact, plane, world.law(kind, plane), world.gravity_strength(),
            settings);
    clamp_energy(impact.body.velocity, impact.body.spin, body, *kind.shape, tally);
    if (world.log)
      write_touch(body, world, impact.lowest.plane, impact.lowest.contact.arm, -approach,
                  (body.velocity - impact.body.velocity).dot(plane.normal));
    tally.touched_plane = impact.lowest.plane;
    ++tally.contacts;
  }
  if (left > 0.0) {
    const double longest =
        settings.contact_step * std::sqrt(kind.shape->radius / std::max(1e-9, world.gravity_strength()));
    const int steps = std::clamp(int(std::ceil(left / longest)), 1, 32);
    HeldVertices held;
    for (int i = 0; i < steps; ++i) contact_step(body, kind, world, left / steps, settings, held, tally);
    if (tally.touched_plane >= 0)
      lift_out(body, *kind.shape, world.planes[tally.touched_plane],
               lift_of(body, *kind.shape, world.gravity_strength(), left));
  }
  return tally;
}

}  // namespace lodestone
