#include "reference/ode/broad_phase_ode.h"

#include <algorithm>
#include <tuple>

#include "reference/ode/body_joints.h"

namespace lodestone::ode {
namespace {

// Of a body's reach: bodies at rest on something are apart by less.
constexpr double kTouchMargin = 0.02;

std::uint32_t part_of(dGeomID geom) {
  return std::uint32_t(reinterpret_cast<std::uintptr_t>(dGeomGetData(geom)));
}

bool is_dynamic(dBodyID body) { return body && !dBodyIsKinematic(body); }

// Of two of which one moves; or `asleep`, of two of which none does.
bool may_touch(dBodyID first, dBodyID second, bool asleep = false) {
  const bool any_moves = is_moving(first) || is_moving(second);
  if (first == second || any_moves == asleep || !(is_dynamic(first) || is_dynamic(second))) return false;
  return !(first && second && are_joined(first, second));
}

bool bits_let_meet(const Body& first, const Body& second) {
  const BodyProperties &a = first.properties, &b = second.properties;
  return may_meet(a.category, a.collide, b.category, b.collide);
}

auto sorted_by(const Candidate& c) {
  return std::tie(c.first_order, c.second_order, c.first_part, c.second_part);
}

Eigen::AlignedBox3d widened(const Eigen::AlignedBox3d& box, double by) {
  return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)};
}

}  // namespace

Eigen::AlignedBox3d bounds_of(dGeomID geom) {
  dReal b[6];
  dGeomGetAABB(geom, b);
  return {Vec3(b[0], b[2], b[4]), Vec3(b[1], b[3], b[5])};
}

Eigen::AlignedBox3d bounds_of(const Body& body) {
  Eigen::AlignedBox3d bounds;
  for (dGeomID geom = dBodyGetFirstGeom(body.body); geom; geom = dBodyGetNextGeom(geom))
    bounds.extend(ode::bounds_of(geom));
  return bounds;
}

BroadPhase::BroadPhase(const SpaceMirror* callers, bool hash_space)
    : callers_(callers),
      bodies_space_(hash_space ? dHashSpaceCreate(nullptr)
                               : dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ)) {}

BroadPhase::~BroadPhase() { dSpaceDestroy(bodies_space_); }

void BroadPhase::add_ground(dGeomID geom) {
  const std::uint32_t number = part_of(geom);
  if (number >= ground_.size()) ground_.resize(number + 1);
  ground_[number] = geom;
  const BoxTree::Entry entry{number, bounds_of(geom)};
  ground_tree_.add({&entry, 1});
}

void BroadPhase::remove_ground(dGeomID geom) {
  ground_[part_of(geom)] = nullptr;
  ground_tree_.remove(part_of(geom));
}

void BroadPhase::follow_ground(dGeomID geom, const Eigen::AlignedBox3d& before) {
  ground_tree_.move(part_of(geom), before, bounds_of(geom));
}

std::span<const Candidate> BroadPhase::find(Bodies& bodies) {
  candidates_.clear();
  bodies_ = &bodies;
  const auto is_awake = [](const Body& body) { return body.body && dBodyIsEnabled(body.body); };
  if (bodies.count() > 1 && std::ranges::any_of(bodies.slots(), is_awake))
    dSpaceCollide(bodies_space_, this, meet_ours);
  drop_filtered(bodies);
  for (const Body& body : bodies.slots())
    if (is_awake(body)) find_around(body, std::uint64_t(&body - bodies.slots().data()));
  if (callers_) find_sleepers_met();
  std::ranges::stable_sort(candidates_, {}, sorted_by);
  return candidates_;
}

std::span<const Candidate> BroadPhase::find_of_sleeper(Bodies& bodies, const Body& body,
                                                       const std::function<bool(const Body&)>& wanted) {
  candidates_.clear();
  bodies_ = &bodies;
  of_sleepers_ = true;
  const Body* const slots = bodies.slots().data();
  found_.clear();
  sleepers_.find(bounds_of(body), found_);
  for (const std::uint32_t sleeper : found_) {
    const Body& other = slots[sleeper];
    if (&other == &body || other.is_awake() || !wanted(other)) continue;
    const bool is_first = &body < &other;
    const Body &first = is_first ? body : other, &second = is_first ? other : body;
    for (dGeomID a = dBodyGetFirstGeom(first.body); a; a = dBodyGetNextGeom(a))
      for (dGeomID b = dBodyGetFirstGeom(second.body); b; b = dBodyGetNextGeom(b))
        if (bits_let_meet(first, second))
          add({a, b, std::uint64_t(&first - slots), std::uint64_t(&second - slots), part_of(a), part_of(b)},
              ~0u, ~0u);
  }
  drop_filtered(bodies);
  find_around(body, std::uint64_t(&body - slots));
  of_sleepers_ = false;
  std::ranges::stable_sort(candidates_, {}, sorted_by);
  return candidates_;
}

void BroadPhase::meet_ours(void* data, dGeomID a, dGeomID b) {
  BroadPhase& self = *static_cast<BroadPhase*>(data);
  if (!may_touch(dGeomGetBody(a), dGeomGetBody(b))) return;
  const Body *first = self.bodies_->owner(a), *second = self.bodies_->owner(b);
  if (second < first) std::swap(first, second), std::swap(a, b);
  if (!bits_let_meet(*first, *second)) return;
  const Body* slots = self.bodies_->slots().data();
  self.candidates_.push_back(
      {a, b, std::uint64_t(first - slots), std::uint64_t(second - slots), part_of(a), part_of(b)});
}

bool BroadPhase::lets_meet(const Body& first, const Body& second) const {
  return bits_let_meet(first, second) && (!filter_ || filter_(first.id, second.id));
}

// Outside of ODE's call, which would leave its space locked where the filter throws.
void BroadPhase::drop_filtered(Bodies& bodies) {
  if (!filter_) return;
  const auto id_of = [&](std::uint64_t slot) { return bodies.slots()[slot].id; };
  std::erase_if(candidates_,
                [&](const Candidate& c) { return !filter_(id_of(c.first_order), id_of(c.second_order)); });
}

void BroadPhase::find_around(const Body& body, std::uint64_t order) {
  for (dGeomID geom = dBodyGetFirstGeom(body.body); geom; geom = dBodyGetNextGeom(geom)) {
    const Eigen::AlignedBox3d box = bounds_of(geom);
    found_.clear();
    ground_tree_.find(box, found_);
    for (const std::uint32_t number : found_)
      add({geom, ground_[number], order, Candidate::kGround + number, part_of(geom), 0}, ~0u, ~0u);
    if (!callers_) continue;
    found_.clear();
    callers_->find_followed(box, found_);
    for (const std::uint32_t slot : found_) {
      const MirroredGeom& other = callers_->geoms()[slot];
      add({geom, other.geom, order, Candidate::kCallers + slot, part_of(geom), 0}, other.category,
          other.collide);
    }
  }
}

/// Where their boxes overlap and bodies and bits let them.
void BroadPhase::add(const Candidate& pair, unsigned category, unsigned collide) {
  if (!may_meet(unsigned(dGeomGetCategoryBits(pair.first)), unsigned(dGeomGetCollideBits(pair.first)),
                category, collide))
    return;
  if (bounds_of(pair.first).intersects(bounds_of(pair.second)) &&
      may_touch(dGeomGetBody(pair.first), dGeomGetBody(pair.second), of_sleepers_))
    candidates_.push_back(pair);
}

// Piles flicker between sleep and waking: one that slept keeps its place in the tree until it has left it.
void BroadPhase::note_sleep(const Body& body) {
  const std::uint32_t slot = slot_of(body.id);
  if (slot >= slept_.size()) slept_.resize(slot + 1);
  if (dBodyIsEnabled(body.body)) {
    if (slept_[slot] == Slept::here) slept_[slot] = Slept::near_here;
  } else if (slept_[slot] != Slept::here) {
    const BoxTree::Entry entry{slot, bounds_of(body)};
    if (slept_[slot] == Slept::no)
      sleepers_.add({&entry, 1});
    else
      sleepers_.move(slot, entry.box, entry.box);
    slept_[slot] = Slept::here;
  }
}

void BroadPhase::find_sleepers_met() {
  for (const std::uint32_t slot : callers_->bodied()) {
    const MirroredGeom& geom = callers_->geoms()[slot];
    if (!is_moving(geom.body)) continue;
    found_.clear();
    sleepers_.find(bounds_of(geom.geom), found_);
    for (const std::uint32_t sleeper : found_) {
      const dBodyID body = bodies_->slots()[sleeper].body;
      if (dBodyIsEnabled(body)) continue;
      for (dGeomID own = dBodyGetFirstGeom(body); own; own = dBodyGetNextGeom(own))
        add({own, geom.geom, sleeper, Candidate::kCallers + slot, part_of(own), 0}, geom.category,
            geom.collide);
    }
  }
}

std::span<const dGeomID> BroadPhase::find_others(const Eigen::AlignedBox3d& box,
                                                 const BodyProperties& properties) {
  others_.clear();
  const auto add_where_it_is = [&](dGeomID geom) {
    if (bounds_of(geom).intersects(box)) others_.push_back(geom);
  };
  found_.clear();
  ground_tree_.find(box, found_);
  std::ranges::sort(found_);
  for (const std::uint32_t number : found_) add_where_it_is(ground_[number]);
  if (!callers_) return others_;
  found_.clear();
  callers_->find_followed(box, found_);
  std::ranges::sort(found_);
  for (const std::uint32_t slot : found_) {
    const MirroredGeom& other = callers_->geoms()[slot];
    if (may_meet(properties.category, properties.collide, other.category, other.collide))
      add_where_it_is(other.geom);
  }
  return others_;
}

// Who is awake may be about to sleep.
void BroadPhase::wake_ours(Bodies& bodies, const Eigen::AlignedBox3d& box) {
  found_.clear();
  sleepers_.find(widened(box, kTouchMargin * bodies.greatest_reach()), found_);
  for (const std::uint32_t sleeper : found_) {
    Body& body = bodies.slots()[sleeper];
    if (dBodyIsEnabled(body.body) || !widened(bounds_of(body), kTouchMargin * body.reach).intersects(box))
      continue;
    wake_jointed(bodies, body);
  }
  for (Body& body : bodies.slots()) {
    const double reach = (1.0 + kTouchMargin) * body.reach;
    if (body.body && dBodyIsEnabled(body.body))
      body.disturbed |= box.squaredExteriorDistance(to_vec3(dBodyGetPosition(body.body))) <= reach * reach;
  }
}

void BroadPhase::wake_callers(const Eigen::AlignedBox3d& box) {
  callers_->find_near(box, found_);
  for (const std::uint32_t slot : found_)
    if (const dBodyID body = callers_->geoms()[slot].body) dBodyEnable(body);
}

void BroadPhase::forget(const Body& body) {
  const std::uint32_t slot = slot_of(body.id);
  if (slot >= slept_.size() || slept_[slot] == Slept::no) return;
  sleepers_.remove(slot);
  slept_[slot] = Slept::no;
}

}  // namespace lodestone::ode
