#include "reference/ode/energy_bound_ode.h"

#include <algorithm>
#include <cmath>

namespace lodestone::ode {
namespace {

// Over what there is and what contacts may give. ODE's law of friction and restitution gains up to half of a
// body's energy in a single hit at a restitution of 1; of more than two bodies it is not one hit that does.
constexpr double kMost = 1.5, kMostOfMany = 1.1;
constexpr double kDeep = 0.02;      // over R: in what stands still no body comes to be so by itself
constexpr double kUnsteady = 1e-3;  // of what forces would give: what they do not hold quite still

// Of which nothing is asked: a kinematic body is a surface that moves.
bool is_free(const Body& body) { return body.is_awake() && !dBodyIsKinematic(body.body); }

// J, of what moves and turns so, m/s and rad/s.
double energy_of(const Body& body, const Vec3& velocity, const Vec3& angular_velocity) {
  const Vec3 turning = state_of(body.body).orientation.conjugate() * angular_velocity;
  return 0.5 * body.mass() * (velocity.squaredNorm() + turning.dot(body.shape->inertia_per_mass * turning));
}

// J, with what it is pulled by, m/s² and N m, would give it in `h` s.
double energy_with(const Body& body, const Vec3& acceleration, const Vec3& torque, double h) {
  const RigidState state = state_of(body.body);
  const Vec3 turning = state.orientation * (body.shape->inverse_inertia_per_mass *
                                            (state.orientation.conjugate() * torque) / body.mass());
  return energy_of(body, state.velocity + h * acceleration, state.angular_velocity + h * turning);
}

Vec3 velocity_at(const Body& body, const Vec3& point) {
  const RigidState state = state_of(body.body);
  return state.velocity + state.angular_velocity.cross(point - state.position);
}

}  // namespace

// What pushes apart a column adds up from the lowest to the topmost: of a chain of n that push alike the mean
// square is n² / 3. No more than as far as one of twelve goes.
double EnergyBound::Island::given() const {
  return energy + driven + 0.5 * mass * std::min(pushes * pushes, 4.0 * squared_pushes);
}

// A force that presses gives what it moves its body by: a light one under a great load nearly nothing.
double EnergyBound::Island::most() const {
  return (bodies > 2 ? kMostOfMany : kMost) * given() + std::max(0.0, work) + kUnsteady * forced;
}

void EnergyBound::begin(const Bodies& bodies) {
  jointed_.clear();
  for (const Body& body : bodies.slots())
    jointed_.push_back(is_free(body) && dBodyGetNumJoints(body.body) > 0);
}

void EnergyBound::note(const Bodies& bodies, std::span<const OdeContact> contacts, const Vec3& gravity,
                       const Pushing& pushing, double h) {
  islands_.assign(bodies.slots().size(), {});
  sets_.set_all_apart(islands_.size());
  const auto is_pushed = [&](OdeBodyId id) { return id && !dBodyIsKinematic(bodies.find(id).body); };
  for (const OdeContact& contact : contacts)
    if (is_pushed(contact.first) && is_pushed(contact.second))
      sets_.join(std::int32_t(slot_of(contact.first)), std::int32_t(slot_of(contact.second)));
  count_bodies(bodies);
  // Those of the same two follow each other, and push them apart once.
  for (auto begin = contacts.begin(), end = begin; begin != contacts.end(); begin = end) {
    double fastest = 0.0;  // m/s
    for (; end != contacts.end() && end->first == begin->first && end->second == begin->second; ++end) {
      note_contact(bodies, *end);
      fastest = std::max(fastest, pushing.speed_of(*end));
    }
    note_push(bodies, *begin, fastest);
  }
  pulled_.resize(islands_.size());
  time_ = h;
  for (std::size_t slot = 0; slot < islands_.size(); ++slot) {
    asked_[slot] = noted_[slot] && island_of(slot).is_asked();
    if (!asked_[slot]) continue;
    const Body& body = bodies.slots()[slot];
    const RigidState state = state_of(body.body);
    const Pulled& pulled =
        pulled_[slot] = {state.velocity, state.angular_velocity, to_vec3(dBodyGetForce(body.body)),
                         to_vec3(dBodyGetTorque(body.body))};
    const Vec3 pull = dBodyGetGravityMode(body.body) ? gravity : Vec3::Zero();
    island_of(slot).energy += energy_with(body, pull, Vec3::Zero(), h);
    if (!pulled.force.isZero(0.0) || !pulled.torque.isZero(0.0))
      island_of(slot).forced += energy_with(body, pull + pulled.force / body.mass(), pulled.torque, h);
  }
}

void EnergyBound::count_bodies(const Bodies& bodies) {
  noted_.assign(islands_.size(), false);
  asked_.assign(islands_.size(), false);
  for (std::size_t slot = 0; slot < islands_.size(); ++slot) {
    const Body& body = bodies.slots()[slot];
    if (!is_free(body)) continue;
    noted_[slot] = true;
    Island& island = island_of(slot);
    island.mass += body.mass();
    ++island.bodies;
    if (jointed_[slot]) island.jointed = true;
  }
}

// Null: of none that can be pushed.
EnergyBound::Island* EnergyBound::island_of(const Bodies& bodies, const OdeContact& contact) {
  for (const OdeBodyId id : {contact.second, contact.first})
    if (id && !dBodyIsKinematic(bodies.find(id).body)) return &island_of(slot_of(id));
  return nullptr;
}

void EnergyBound::note_contact(const Bodies& bodies, const OdeContact& contact) {
  Island* island = island_of(bodies, contact);
  if (!island) return;
  Vec3 driven = contact.velocity;  // m/s, of what nothing pushes
  double mass = 0.0, size = 0.0;   // kg and m, of what is driven
  for (const OdeBodyId id : {contact.first, contact.second}) {
    if (!id) continue;
    const Body& body = bodies.find(id);
    if (dBodyIsKinematic(body.body))
      driven += velocity_at(body, contact.point);
    else
      mass = std::max(mass, body.mass()), size = body.shape->radius;
  }
  island->driven += 2.0 * mass * driven.squaredNorm();  // at twice its speed
  island->moved |= contact.moves || !driven.isZero(0.0);
  if (island->bodies > 1 || contact.depth < kDeep * size) return;
  const bool is_first = contact.first && !dBodyIsKinematic(bodies.find(contact.first).body);
  const Vec3 out = is_first ? contact.normal : Vec3(-contact.normal);
  if (island->out.isZero(0.0)) island->out = out;
  island->squeezed |= island->out.dot(out) < 0.0;
}

/// `speed`: m/s. Of a body by itself the fastest counts.
void EnergyBound::note_push(const Bodies& bodies, const OdeContact& contact, double speed) {
  Island* island = island_of(bodies, contact);
  if (!island) return;
  const bool is_alone = island->bodies == 1;
  island->pushes = is_alone ? std::max(island->pushes, speed) : island->pushes + speed;
  island->squared_pushes =
      is_alone ? std::max(island->squared_pushes, speed * speed) : island->squared_pushes + speed * speed;
}

void EnergyBound::sum_up(const Bodies& bodies) {
  energies_.assign(islands_.size(), 0.0);
  for (Island& island : islands_) island.work = 0.0;
  for (std::size_t slot = 0; slot < islands_.size(); ++slot) {
    if (!asked_[slot]) continue;
    const Body& body = bodies.slots()[slot];
    const RigidState state = state_of(body.body);
    const Pulled& pulled = pulled_[slot];
    energies_[std::size_t(sets_.root_of(std::int32_t(slot)))] +=
        energy_of(body, state.velocity, state.angular_velocity);
    island_of(slot).work += 0.5 * time_ *
                            (pulled.force.dot(pulled.velocity + state.velocity) +
                             pulled.torque.dot(pulled.angular_velocity + state.angular_velocity));
  }
}

bool EnergyBound::is_kept(const Bodies& bodies) {
  sum_up(bodies);
  for (std::size_t root = 0; root < islands_.size(); ++root)
    if (islands_[root].is_asked() && !(energies_[root] <= islands_[root].most()))
      return false;  // nor where ODE spoilt one
  return true;
}

void EnergyBound::keep(Bodies& bodies) {
  sum_up(bodies);
  for (std::size_t root = 0; root < islands_.size(); ++root)
    if (islands_[root].is_asked() && !(energies_[root] <= islands_[root].most())) slow_down(bodies, root);
}

// About their common velocity, so that momentum is kept; where that itself has too much, all of it.
void EnergyBound::slow_down(Bodies& bodies, std::size_t root) {
  std::vector<Body*> members;
  Vec3 momentum = Vec3::Zero();  // kg m/s
  for (std::size_t slot = 0; slot < islands_.size(); ++slot)
    if (asked_[slot] && std::size_t(sets_.root_of(std::int32_t(slot))) == root) {
      members.push_back(&bodies.slots()[slot]);
      momentum += members.back()->mass() * state_of(members.back()->body).velocity;
    }
  const Island& island = islands_[root];
  Vec3 common = momentum / island.mass;                              // m/s
  const double together = 0.5 * island.mass * common.squaredNorm();  // J
  double energy = energies_[root], left = island.given();            // J
  if (together < left)
    energy -= together, left -= together;
  else
    common.setZero();
  const double share = std::sqrt(left / energy);
  for (Body* body : members) {
    const RigidState after = state_of(body->body);
    RigidState state = body->last_good;
    if (is_sound(after) && std::isfinite(share)) {
      state.velocity = common + share * (after.velocity - common);
      state.angular_velocity = share * after.angular_velocity;
      state.position += time_ * state.velocity;
      state.orientation =
          (rotation_from_vector(time_ * state.angular_velocity) * state.orientation).normalized();
    }
    set_state(body->body, state);
    body->impact.reset();
  }
}

}  // namespace lodestone::ode
