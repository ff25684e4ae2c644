#include "lod/manager/cross_level.h"

#include <algorithm>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>

#include "lod/contact/reckoned_contacts.h"
#include "lod/manager/joint_contacts.h"
#include "reference/ode/body_joints.h"
#include "reference/ode/callers_bodies.h"

namespace lodestone {
namespace {

FullNeighbor neighbor_of(const Levels& levels, const FullLevel::Member& member) {
  const BodyRecord& record = levels.bodies[member.owner];
  FullNeighbor neighbor;
  neighbor.owner = member.owner;
  neighbor.shape = levels.bodies.shape(member.owner).get();
  neighbor.mass = record.mass;
  neighbor.material = record.material;
  neighbor.state = levels.full.world()->state(member.id);
  dxBody* const body = levels.full.world()->ode_body(member.id);  // which its caller may push by himself
  neighbor.force = levels.bodies.force(member.owner).force + callers::force(body);
  neighbor.torque = levels.bodies.force(member.owner).torque + callers::torque(body);
  neighbor.asleep = levels.full.world()->asleep(member.id);
  return neighbor;
}

double friction_between(const Levels& levels, const Neighborhood& neighborhood, const FullContact& contact) {
  const MaterialId first = neighborhood.bodies[contact.first].material;
  const MaterialId second =
      contact.second < 0 ? contact.ground_material : neighborhood.bodies[contact.second].material;
  return levels.materials.law(first, second).friction;
}

// ODE's contacts of the last substep, and those of the last steps whose pair it did not find again.
void update_seen(std::span<const OdeContact> found, std::vector<Neighborhood::Seen>& seen) {
  constexpr int kStepsSeen = 3;  // for which a contact is kept, without depth, that ODE does not find again
  const auto pair_of = [](const Neighborhood::Seen& s) {
    return std::tuple(s.contact.first.value, s.contact.second.value, s.contact.callers_slot);
  };
  std::vector<Neighborhood::Seen> now;
  for (const OdeContact& contact : found) now.push_back({contact});
  std::ranges::stable_sort(now, {}, pair_of);
  const std::size_t fresh = now.size();
  for (Neighborhood::Seen& old : seen) {
    if (++old.age > kStepsSeen || std::ranges::binary_search(now.begin(), now.begin() + std::ptrdiff_t(fresh),
                                                             pair_of(old), {}, pair_of))
      continue;
    old.contact.depth = 0.0;
    now.push_back(old);
  }
  std::ranges::stable_sort(now, {}, pair_of);
  seen = std::move(now);
}

using NumberOfBody = std::unordered_map<dxBody*, std::int32_t>;

/// Of the neighbours that are the caller's, where any of these contacts is with one of them.
NumberOfBody number_callers(const Levels& levels, const Neighborhood& neighborhood) {
  NumberOfBody number;
  if (std::ranges::none_of(neighborhood.seen,
                           [](const auto& seen) { return seen.contact.callers_slot >= 0; }))
    return number;
  for (std::size_t i = levels.full.members().size(); i < neighborhood.ode_bodies.size(); ++i)
    number.emplace(neighborhood.ode_bodies[i], std::int32_t(i));
  return number;
}

/// Of the neighbour that is the contact's second; −1: the ground. None where it is gone.
std::optional<std::int32_t> second_of(const Levels& levels, const NumberOfBody& callers,
                                      const OdeContact& contact) {
  if (contact.second) {
    const std::int32_t member = levels.full.index_of(contact.second);
    return member >= 0 ? std::optional(member) : std::nullopt;
  }
  if (contact.callers_slot < 0) return -1;
  dxBody* const body = levels.callers.bodies.body_of_slot(std::size_t(contact.callers_slot));
  if (!body) return {};
  const auto found = callers.find(body);  // none, if it has no shape
  return found == callers.end() ? -1 : found->second;
}

// m/s, in the step to come, where ODE's contact knows that of the last one: of the part that is there, if no
// other is. What turns takes a body along the chord of its arc, in so far as that goes round with it, as in
// ODE: what lies on the body would else go along the tangent, and walk outward on it.
Vec3 velocity_of_ground(const Levels& levels, const FullNeighbor& body, const OdeContact& contact,
                        double dt) {
  constexpr double kThere = 1e-3;  // m
  if (contact.callers_slot >= 0 || (!contact.moves && !levels.ground.any_moves())) return contact.velocity;
  thread_local std::vector<const GroundPart*> parts;
  parts.clear();
  MetGround(levels.ground, levels.bodies.properties(body.owner)).find_parts(contact.point, kThere, parts);
  if (parts.size() != 1) return contact.velocity;
  const GroundPart& part = *parts.front();
  const Vec3 going_round = body.state.velocity - part.pose.velocity;
  const Quat half_way = rotation_from_vector(0.5 * dt * part.pose.angular_velocity);
  return part.velocity_at(contact.point) + half_way * going_round - going_round;
}

// Two bodies were moved since ODE found it: what they have parted by is a gap. What nothing moves takes along
// what lies on it, for as long as ODE finds the contact again. None where the caller has put one elsewhere.
std::optional<FullContact> full_contact_of(const Levels& levels, const Neighborhood& neighborhood,
                                           std::int32_t first, std::int32_t second,
                                           const Neighborhood::Seen& seen, double dt) {
  const OdeContact& contact = seen.contact;
  const FullNeighbor& body = neighborhood.bodies[std::size_t(first)];
  FullContact full{first, second, contact.point, contact.normal, -contact.depth};
  if (second < 0) {
    full.velocity = velocity_of_ground(levels, body, contact, dt);
    full.ground_material = contact.second_material;
  }
  const auto place_on = [&](std::int32_t neighbor, const Vec3& arm) {
    const RigidState& state = neighborhood.bodies[std::size_t(neighbor)].state;
    return Vec3(state.position + state.orientation * arm);
  };
  const Vec3 on_second = second < 0 ? Vec3(contact.point + seen.age * dt * contact.velocity)
                                    : place_on(second, contact.second_arm),
             between = place_on(first, contact.first_arm) - on_second;
  const bool has_places = second < 0 || contact.second;
  if (has_places && between.norm() > body.shape->radius) return {};
  const auto is_kinematic = [&](std::int32_t neighbor) {
    return levels.bodies.properties(neighborhood.bodies[std::size_t(neighbor)].owner).kinematic;
  };
  const bool carries =
      second < 0 ? contact.moves : is_kinematic(first) || (contact.second && is_kinematic(second));
  // Where that point is now: what goes fast has gone on by centimetres since.
  const bool goes_along = second < 0 ? contact.moves : bool(contact.second);
  if (goes_along) {
    const Vec3 on_first = on_second + between;
    full.point = !carries                             ? Vec3(on_first - 0.5 * between)
                 : second >= 0 && is_kinematic(first) ? on_second
                                                      : on_first;
  }
  if (!carries || seen.age > 0) full.gap += std::max(0.0, contact.above + between.dot(contact.normal));
  return full;
}

// Of one that has just become full ODE may know no contact: none before its first step, and none where it lay
// a little deep and hops. By its hull, or what lies on it would fall with it.
void reckon_contacts_of(const Levels& levels, Neighborhood& neighborhood, std::int32_t index,
                        std::span<const std::int32_t> fresh) {
  const FullNeighbor& body = neighborhood.bodies[std::size_t(index)];
  const BodyProperties& own = levels.bodies.properties(body.owner);
  reckon_ground_contacts({levels.ground, own}, body, index, neighborhood.contacts);
  if (!body.shape->convex) return;
  std::vector<std::uint32_t> near;
  levels.find_near(body.owner, 1.0 + kTouchMargin, Level::full, near, false);
  std::ranges::sort(near);
  const auto& may_pair = levels.statistical_settings.pair_filter;
  for (const std::uint32_t owner : near) {
    const std::int32_t other = levels.full.index_of(levels.bodies[owner].ode);
    const bool is_theirs = other < index && std::ranges::binary_search(fresh, other);
    if (other < 0 || is_theirs || !levels.bodies.shape(owner)->convex ||
        !may_meet(own, levels.bodies.properties(owner)) || (may_pair && !may_pair(body.owner, owner)) ||
        are_joined(neighborhood.ode_bodies[std::size_t(index)], neighborhood.ode_bodies[std::size_t(other)]))
      continue;
    reckon_pair_contacts(neighborhood.bodies, index, other, neighborhood.contacts);
  }
}

void reckon_contacts_of_newcomers(const Levels& levels, Neighborhood& neighborhood) {
  const std::size_t own = levels.full.members().size();
  std::vector<std::int32_t> fresh;
  for (std::size_t i = 0; i < own; ++i) {
    const std::uint32_t owner = neighborhood.bodies[i].owner;
    if (!neighborhood.bodies[i].asleep && !levels.bodies.properties(owner).kinematic)
      fresh.push_back(std::int32_t(i));
  }
  if (fresh.empty()) return;
  std::vector<bool> touches(neighborhood.bodies.size(), false);
  for (const FullContact& contact : neighborhood.contacts)
    for (const std::int32_t end : {contact.first, contact.second})
      if (end >= 0) touches[std::size_t(end)] = true;
  std::erase_if(fresh, [&](std::int32_t i) { return bool(touches[std::size_t(i)]); });
  const std::size_t before = neighborhood.contacts.size();
  for (const std::int32_t i : fresh) reckon_contacts_of(levels, neighborhood, i, fresh);
  for (FullContact& contact : std::span(neighborhood.contacts).subspan(before))
    contact.friction = friction_between(levels, neighborhood, contact);
}

void gather_contacts(const Levels& levels, Neighborhood& neighborhood, double dt) {
  update_seen(levels.full.world()->contacts(), neighborhood.seen);
  const NumberOfBody callers = number_callers(levels, neighborhood);
  for (const Neighborhood::Seen& seen : neighborhood.seen) {
    const OdeContact& contact = seen.contact;
    const std::int32_t first = levels.full.index_of(contact.first);
    const std::optional<std::int32_t> second = second_of(levels, callers, contact);
    if (first < 0 || !second) continue;
    std::optional<FullContact> full = full_contact_of(levels, neighborhood, first, *second, seen, dt);
    if (!full) continue;
    full->friction = friction_between(levels, neighborhood, *full);
    neighborhood.contacts.push_back(*full);
  }
  reckon_contacts_of_newcomers(levels, neighborhood);
}

void put_to_sleep(OdeWorld& world, OdeBodyId body, const FullNeighbor& neighbor, double dt) {
  RigidState state = neighbor.state;
  state.velocity = state.angular_velocity = Vec3::Zero();
  world.set_state(body, state);
  world.hold(body, neighbor.push.linear / dt, neighbor.push.angular / dt);
  world.set_asleep(body, true);
}

void hand_over(Levels& levels, OdeBodyId body, const FullNeighbor& neighbor, double dt, int substeps) {
  if (neighbor.asleep) return;  // else, where it was asleep, a hit woke it
  OdeWorld& world = *levels.full.world();
  const bool stays_awake = neighbor.carried || neighbor.moved;
  if (world.asleep(body) || stays_awake) world.set_asleep(body, false);  // ODE's clock begins anew
  if (stays_awake) world.keep_awake(body);
  world.hold(body, neighbor.push.linear / dt, neighbor.push.angular / dt);
  const BodyProperties& own = levels.bodies.properties(neighbor.owner);
  if (own.kinematic || (!neighbor.is_touched() && neighbor.shift.isZero(0.0))) return;
  const Vec3 gravity = own.gravity ? levels.statistical_settings.gravity : Vec3(Vec3::Zero());
  world.set_state(body, find_start(neighbor, gravity, dt, substeps));
}

}  // namespace

void gather(const Levels& levels, Neighborhood& neighborhood, double dt) {
  neighborhood.bodies.clear();
  neighborhood.contacts.clear();
  neighborhood.ode_bodies.clear();
  for (const FullLevel::Member& member : levels.full.members()) {
    neighborhood.bodies.push_back(neighbor_of(levels, member));
    neighborhood.ode_bodies.push_back(levels.full.world()->ode_body(member.id));
  }
  const bool any_full = !neighborhood.bodies.empty();
  levels.callers.bodies.gather(levels.ground, levels.statistical_settings.gravity, neighborhood.bodies,
                               neighborhood.contacts);
  levels.callers.bodies.append_ode_bodies(neighborhood.ode_bodies);
  if (any_full) gather_contacts(levels, neighborhood, dt);
  add_joint_contacts(neighborhood.bodies, neighborhood.ode_bodies, neighborhood.contacts);
  for (const FullContact& contact : neighborhood.contacts)
    for (const std::int32_t end : {contact.first, contact.second})
      if (end >= 0) {
        FullNeighbor& body = neighborhood.bodies[std::size_t(end)];
        body.touches_full = true;
        body.on_motor |= contact.drive.has_value();
      }
}

void hand_over(Levels& levels, const Neighborhood& neighborhood, const std::vector<bool>& falls_asleep,
               double dt, int substeps) {
  const std::size_t own = levels.full.members().size();
  levels.callers.bodies.hand_over(std::span(neighborhood.bodies).subspan(own),
                                  levels.statistical_settings.gravity, dt, substeps);
  for (std::size_t i = 0; i < own; ++i) {
    const auto [owner, id] = levels.full.members()[i];
    const FullNeighbor& neighbor = neighborhood.bodies[i];
    if (falls_asleep[i])
      put_to_sleep(*levels.full.world(), id, neighbor, dt);
    else
      hand_over(levels, id, neighbor, dt, substeps);
  }
}

}  // namespace lodestone
