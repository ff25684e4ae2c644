#include "reference/ode/broad_phase_ode.h"

#include <algorithm>
#include <tuple>

namespace lodestone::ode {
namespace {

constexpr std::uint64_t kGroundOrder = 1ull << 60, kForeignOrder = 2ull << 60;

std::uint32_t part_of(dGeomID geom) { return std::uint32_t(reinterpret_cast<std::uintptr_t>(dGeomGetData(geom))); }

bool awake(dBodyID body) { return body && dBodyIsEnabled(body); }

bool may_touch(dGeomID a, dGeomID b) {
  const dBodyID first = dGeomGetBody(a), second = dGeomGetBody(b);
  if (first == second || !(awake(first) || awake(second))) return false;
  return !(first && second && dAreConnectedExcluding(first, second, dJointTypeContact));
}

auto order_of(const Candidate& c) { return std::tie(c.first_order, c.second_order, c.first_part, c.second_part); }

/// Whether our geoms, which are of every category, may collide with it.
bool has_surface(dGeomID geom) {
  const int kind = dGeomGetClass(geom);
  return kind != dPlaneClass && kind != dRayClass && dGeomIsEnabled(geom) && (dGeomGetCategoryBits(geom) | dGeomGetCollideBits(geom)) != 0;
}

// A space nobody else's collision detection looks into: dSpaceCollide passes over a geom without categories.
dSpaceID make_hidden(dSpaceID space) {
  const dGeomID geom = reinterpret_cast<dGeomID>(space);
  dGeomSetCategoryBits(geom, 0);
  dGeomSetCollideBits(geom, 0);
  return space;
}

}  // namespace

BroadPhase::BroadPhase(dSpaceID around, bool hash_space)
    : around_(around),
      bodies_space_(make_hidden(hash_space ? dHashSpaceCreate(around) : dSweepAndPruneSpaceCreate(around, dSAP_AXES_XYZ))),
      ground_space_(make_hidden(dSimpleSpaceCreate(around))) {}

BroadPhase::~BroadPhase() {
  dSpaceDestroy(bodies_space_);
  dSpaceDestroy(ground_space_);
}

std::span<const Candidate> BroadPhase::find(Bodies& bodies) {
  candidates_.clear();
  bodies_ = &bodies;
  const auto ours = reinterpret_cast<dGeomID>(bodies_space_);
  if (bodies.count() > 1) dSpaceCollide(bodies_space_, this, meet);
  if (dSpaceGetNumGeoms(ground_space_) > 0) dSpaceCollide2(ours, reinterpret_cast<dGeomID>(ground_space_), this, meet);
  if (around_) dSpaceCollide2(ours, reinterpret_cast<dGeomID>(around_), this, meet);
  std::ranges::stable_sort(candidates_, {}, order_of);
  return candidates_;
}

void BroadPhase::meet(void* self, dGeomID a, dGeomID b) {
  if (dGeomIsSpace(a) || dGeomIsSpace(b))
    dSpaceCollide2(a, b, self, meet);  // a space within the caller's
  else if (may_touch(a, b))
    static_cast<BroadPhase*>(self)->add(a, b);
}

void BroadPhase::add(dGeomID a, dGeomID b) {
  const auto place_of = [&](dGeomID geom) -> std::uint64_t {
    if (const Body* body = bodies_->owner(geom)) return body - bodies_->slots().data();
    return dGeomGetSpace(geom) == ground_space_ ? kGroundOrder + part_of(geom) : kForeignOrder + candidates_.size();
  };
  Candidate found{a, b, place_of(a), place_of(b), part_of(a), part_of(b)};
  if (found.second_order < found.first_order) found = {b, a, found.second_order, found.first_order, found.second_part, found.first_part};
  candidates_.push_back(found);
}

std::span<const dGeomID> BroadPhase::find_others(const Eigen::AlignedBox3d& box) {
  others_.clear();
  collect(around_ ? around_ : ground_space_, box);
  return others_;
}

void BroadPhase::collect(dSpaceID space, const Eigen::AlignedBox3d& box) {
  if (space == bodies_space_) return;
  for (int i = 0; i < dSpaceGetNumGeoms(space); ++i) {
    const dGeomID geom = dSpaceGetGeom(space, i);
    if (dGeomIsSpace(geom)) {
      collect(reinterpret_cast<dSpaceID>(geom), box);
    } else if (has_surface(geom)) {
      dReal b[6];
      dGeomGetAABB(geom, b);
      if (box.intersects(Eigen::AlignedBox3d(Vec3(b[0], b[2], b[4]), Vec3(b[1], b[3], b[5])))) others_.push_back(geom);
    }
  }
}

void BroadPhase::wake_around(dGeomID geom) {
  const auto wake = [](void* center, dGeomID a, dGeomID b) {
    const dGeomID other = a == center ? b : a;
    if (const dBodyID body = dGeomGetBody(other)) dBodyEnable(body);
  };
  dSpaceCollide2(geom, reinterpret_cast<dGeomID>(bodies_space_), geom, wake);
  if (around_) dSpaceCollide2(geom, reinterpret_cast<dGeomID>(around_), geom, wake);
}

}  // namespace lodestone::ode
