#include "lod/callers/callers_bodies.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "lod/contact/reckoned_contacts.h"
#include "lod/ground/met_ground.h"
#include "reference/ode/body_joints.h"
#include "reference/ode/callers_bodies.h"

namespace lodestone {
namespace {

constexpr std::uint32_t kFirstOwner = 0x40000000;  // above every body of the manager's
constexpr std::size_t kMadeKept = 64;              // shapes, as BodyForms keeps forms
constexpr double kLeft = 0.02;  // over its longest side: a geom whose bounds move by more in a step has left
// Over R: so deep what is pressed onto ground begins ODE's step, lest this find no contact there in the next:
// its ERP leaves depths that rounding decides.
constexpr double kSunk = 1e-4;

Mat3 inverse_inertia_per_mass(dxBody* body) { return callers::inverse_inertia(body) * callers::mass(body); }

void set_inertia(Shape& shape, dxBody* body) {
  shape.inverse_inertia_per_mass = inverse_inertia_per_mass(body);
  shape.inertia_per_mass = shape.inverse_inertia_per_mass.inverse();
}

// For one without geoms: an octahedron as far from its middle as its mass is, which nobody meets.
std::shared_ptr<const Shape> make_tied_shape(dxBody* body) {
  const double reach =
      std::sqrt(callers::inverse_inertia(body).inverse().trace() / (2.0 * callers::mass(body)));
  std::vector<Vec3> corners;
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())})
    corners.push_back(reach * axis), corners.push_back(-reach * axis);
  Shape shape = make_contact_shape(corners, Vec3::Zero());
  set_inertia(shape, body);
  return std::make_shared<const Shape>(std::move(shape));
}

}  // namespace

void CallersBodies::note_places() {
  place_of_.clear(), of_number_.clear();
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    place_of_.emplace(bodies_[i].body, i), of_number_.emplace(bodies_[i].owner, bodies_[i].body);
}

CallersBodies::Entry& CallersBodies::add(dxBody* body) {
  place_of_.emplace(body, bodies_.size());
  Entry& entry = bodies_.emplace_back();
  entry.body = body;
  entry.owner = kFirstOwner + owners_++;
  return entry;
}

void CallersBodies::follow(const SpaceMirror& mirror,
                           const std::function<void(const Eigen::AlignedBox3d&)>& left,
                           const std::function<void(std::uint32_t, const GroundBits&)>& tell) {
  const std::span<const MirroredGeom> geoms = mirror.geoms();
  body_of_slot_.resize(geoms.size(), nullptr);
  for (const std::uint32_t slot : mirror.removed()) {
    if (!body_of_slot_[slot]) continue;
    Entry& entry = bodies_[place_of_.at(body_of_slot_[slot])];
    body_of_slot_[slot] = nullptr;
    std::erase(entry.slots, slot);
    entry.stale = true;
    left(geoms[slot].bounds);
    if (!entry.slots.empty()) continue;
    tell(entry.owner, {});
    place_of_.erase(entry.body);  // another may have its address
    entry.body = nullptr;
  }
  for (const std::uint32_t slot : mirror.added()) {
    if (!geoms[slot].dynamic) continue;
    const auto known = place_of_.find(geoms[slot].body);
    Entry& entry = known == place_of_.end() ? add(geoms[slot].body) : bodies_[known->second];
    body_of_slot_[slot] = geoms[slot].body;
    entry.slots.insert(std::ranges::lower_bound(entry.slots, slot), slot);
    entry.stale = true;
  }
  std::erase_if(bodies_, [](const Entry& entry) { return !entry.body; });
  for (const std::uint32_t slot : mirror.moved()) {
    const Eigen::AlignedBox3d &before = geoms[slot].previous_bounds, &now = geoms[slot].bounds;
    const double moved = std::max((now.min() - before.min()).cwiseAbs().maxCoeff(),
                                  (now.max() - before.max()).cwiseAbs().maxCoeff());
    if (body_of_slot_[slot] && moved > kLeft * now.sizes().maxCoeff()) left(before);
  }
  for (Entry& entry : bodies_) {
    if (entry.stale && entry.shape) {  // contacts, gaps and vertices of what it was are known by its number
      tell(entry.owner, {});
      entry.owner = kFirstOwner + owners_++;
    }
    if (entry.stale || entry.untold) {
      entry.bits = {0, 0};
      for (const std::uint32_t slot : entry.slots)
        entry.bits.category |= geoms[slot].category, entry.bits.collide |= geoms[slot].collide;
      tell(entry.owner, entry.bits);
      entry.untold = false;
    }
    if (!entry.stale) {
      if (!entry.is_tied()) follow_inertia(entry);  // those may be gone: follow_tied() knows
      continue;
    }
    entry.stale = false;
    entry.shape = nullptr;
    make_shape(mirror, entry);
  }
  if (!mirror.removed().empty() || !mirror.added().empty()) note_places();
}

// He may give it another mass at any time.
void CallersBodies::follow_inertia(Entry& entry) {
  if (!entry.shape || entry.shape->inverse_inertia_per_mass == inverse_inertia_per_mass(entry.body)) return;
  Shape shape = *entry.shape;
  set_inertia(shape, entry.body);
  entry.shape = std::make_shared<const Shape>(std::move(shape));
}

void CallersBodies::make_shape(const SpaceMirror& mirror, Entry& entry) {
  std::vector<PlacedGeom> geoms;
  for (const std::uint32_t slot : entry.slots) {  // not as it stands: the same wherever that is
    dxGeom* const geom = mirror.geoms()[slot].geom;
    geoms.push_back({read_geom(geom), callers::offset_position(geom), callers::offset_orientation(geom)});
  }
  BodyForm form = forms_.form_of(std::move(geoms));
  entry.solids = std::move(form.solids);
  if (!form.shape) return;
  const Mat3 inverse_inertia = inverse_inertia_per_mass(entry.body);
  const auto made = std::ranges::find_if(made_, [&](const MadeShape& one) {
    return one.form == form.shape && one.shape->inverse_inertia_per_mass == inverse_inertia;
  });
  if (made != made_.end()) {
    entry.shape = made->shape;
    return;
  }
  Shape shape = *form.shape;
  set_inertia(shape, entry.body);
  entry.shape = std::make_shared<const Shape>(std::move(shape));
  if (made_.size() == kMadeKept) made_.erase(made_.begin());
  made_.push_back({form.shape, entry.shape});
}

// In the order in which joints lead to them.
std::vector<dxBody*> CallersBodies::find_tied(std::span<dxBody* const> jointed) const {
  std::vector<dxBody*> waiting(jointed.begin(), jointed.end()), tied;
  for (const Entry& entry : bodies_)
    if (!entry.is_tied() && has_joints(entry.body)) waiting.push_back(entry.body);
  std::unordered_set<dxBody*> known(waiting.begin(), waiting.end());
  for (std::size_t i = 0; i < waiting.size(); ++i)
    for (dxBody* const other : joined_bodies(waiting[i]))
      if (other && !callers::is_kinematic(other) && known.insert(other).second)
        waiting.push_back(other), tied.push_back(other);
  return tied;
}

void CallersBodies::follow_tied(std::span<dxBody* const> jointed,
                                const std::function<void(std::uint32_t, const GroundBits&)>& tell) {
  const std::vector<dxBody*> tied = find_tied(jointed);
  const std::unordered_set<dxBody*> are_tied(tied.begin(), tied.end());
  const auto gone = std::erase_if(bodies_, [&](const Entry& entry) {
    const bool is_gone = entry.is_tied() && !are_tied.contains(entry.body);
    if (is_gone) tell(entry.owner, {});
    return is_gone;
  });
  if (gone > 0) note_places();
  for (dxBody* const body : tied) {
    if (const auto known = place_of_.find(body); known != place_of_.end()) {
      follow_inertia(bodies_[known->second]);
      continue;
    }
    Entry& entry = add(body);
    of_number_.emplace(entry.owner, body);
    entry.shape = make_tied_shape(body);
    entry.bits = {0, 0};
    entry.stale = entry.untold = false;
    tell(entry.owner, entry.bits);
  }
}

void CallersBodies::gather(const Ground& ground, const Vec3& gravity, std::vector<FullNeighbor>& neighbors,
                           std::vector<FullContact>& contacts) const {
  for (const Entry& entry : bodies_) {
    if (!entry.shape) continue;
    FullNeighbor neighbor;
    neighbor.owner = entry.owner;
    neighbor.shape = entry.shape.get();
    neighbor.mass = callers::mass(entry.body);
    neighbor.state = callers::state(entry.body);
    neighbor.force = callers::force(entry.body);
    neighbor.torque = callers::torque(entry.body);
    if (!callers::has_gravity(entry.body)) neighbor.force -= neighbor.mass * gravity;
    neighbor.asleep = !callers::is_enabled(entry.body);
    const auto index = std::int32_t(neighbors.size());
    neighbors.push_back(neighbor);
    if (neighbor.asleep || entry.is_tied()) continue;
    const std::size_t before = contacts.size();
    reckon_ground_contacts({ground, entry.bits}, neighbor, index, contacts);
    neighbors.back().on_ground = contacts.size() > before;
  }
}

void CallersBodies::append_ode_bodies(std::vector<dxBody*>& bodies) const {
  for (const Entry& entry : bodies_)
    if (entry.shape) bodies.push_back(entry.body);
}

void CallersBodies::hand_over(std::span<const FullNeighbor> neighbors, const Vec3& gravity, double dt,
                              int substeps) const {
  std::size_t next = 0;
  for (const Entry& entry : bodies_) {
    if (!entry.shape) continue;
    const FullNeighbor& neighbor = neighbors[next++];
    if (neighbor.asleep) continue;
    if (!callers::is_enabled(entry.body)) callers::set_enabled(entry.body, true);
    if (!neighbor.push.is_zero())
      callers::add_force(entry.body, neighbor.push.linear / dt, neighbor.push.angular / dt);
    if (!neighbor.is_touched() && neighbor.shift.isZero(0.0)) continue;
    RigidState start = find_start(neighbor, gravity, dt, substeps);
    if (neighbor.on_ground && !neighbor.push.is_zero() && !neighbor.backing.is_zero())
      start.position += kSunk * neighbor.shape->radius * gravity.normalized();
    callers::set_state(entry.body, start);
  }
}

// Those whose body is as the mirror saw it last: of the others the caller may have destroyed any.
std::vector<const CallersBodies::Entry*> CallersBodies::find_living(const SpaceMirror& mirror) const {
  std::vector<std::uint32_t> held;
  mirror.find_bodied_now(held);
  std::vector<const Entry*> living;
  for (const Entry& entry : bodies_)
    if (std::ranges::any_of(entry.slots,
                            [&](std::uint32_t slot) { return std::ranges::binary_search(held, slot); }))
      living.push_back(&entry);
  return living;
}

void CallersBodies::archive(StateArchive& a, const SpaceMirror* mirror) {
  struct Known {
    std::uint32_t owner;
    Vec3 position;
  };
  std::vector<Known> known;
  if (mirror)
    for (const Entry* entry : find_living(*mirror))
      known.push_back({entry->owner, callers::state(entry->body).position});
  std::uint32_t owners = owners_;
  a(known, owners);
  if (!a.reading()) return;
  for (Entry& entry : bodies_) entry.untold = true;
  std::stable_partition(bodies_.begin(), bodies_.end(), [](const Entry& entry) { return !entry.is_tied(); });
  const auto is_there = [](const Known& at) {
    return [&at](const Entry& entry) { return callers::state(entry.body).position == at.position; };
  };
  auto next = bodies_.begin();
  for (const Known& at : known) {
    auto same = std::find_if(next, bodies_.end(), is_there(at));
    if (same == bodies_.end()) same = next;
    if (same == bodies_.end()) break;
    same->owner = at.owner;
    std::rotate(next, same, same + 1);
    ++next;
  }
  owners_ = std::max(owners, owners_);
  for (; next != bodies_.end(); ++next) next->owner = kFirstOwner + owners_++;
  note_places();
}

std::vector<CallersBodies::Placed> CallersBodies::find_placed() const {
  std::vector<Placed> placed;
  for (const Entry& entry : bodies_)
    if (entry.shape)
      placed.push_back({entry.owner, entry.bits, entry.shape.get(), callers::state(entry.body)});
  return placed;
}

void CallersBodies::each_near(const Vec3& center, double radius, const BodyProperties& own,
                              const std::function<void(const Shape&, const RigidState&)>& visit) const {
  for (const Entry& entry : bodies_) {
    if (!entry.shape || !may_meet(own.category, own.collide, entry.bits.category, entry.bits.collide))
      continue;
    const RigidState state = callers::state(entry.body);
    const double reach = radius + entry.shape->radius;
    if ((state.position - center).squaredNorm() < reach * reach) visit(*entry.shape, state);
  }
}

std::vector<CallersPart> CallersBodies::find_parts(const SpaceMirror& mirror) const {
  std::vector<CallersPart> parts;
  if (bodies_.empty()) return parts;
  std::vector<std::uint32_t> held;
  mirror.find_bodied_now(held);
  for (const Entry& entry : bodies_)
    for (std::size_t i = 0; i < entry.slots.size(); ++i) {
      if (!entry.solids[i] || !std::ranges::binary_search(held, entry.slots[i])) continue;
      const MirroredGeom& geom = mirror.geoms()[entry.slots[i]];
      parts.push_back({entry.body, geom.geom, geom.category, entry.solids[i], callers::position(geom.geom),
                       callers::orientation(geom.geom)});
    }
  return parts;
}

dxBody* CallersBodies::body_of(std::uint32_t owner) const {
  const auto known = of_number_.find(owner);
  return known == of_number_.end() ? nullptr : known->second;
}

std::optional<RigidState> CallersBodies::state_of(std::uint32_t owner) const {
  dxBody* const body = body_of(owner);
  return body ? std::optional(callers::state(body)) : std::nullopt;
}

}  // namespace lodestone
