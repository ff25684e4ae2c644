#include "reference/ode/sweep_ode.h"

#include <algorithm>
#include <numbers>

namespace lodestone::ode {
namespace {

// Of the thickness: how far from the axis of the way the ring of rays is, and how far before what they meet
// the centre stops. The ball inscribed in the body then reaches a little into it, so that the next collision
// detection finds a contact.
constexpr double kRing = 0.8, kLeadOfCenter = 0.9, kLeadOfRing = 0.5;
constexpr int kRingRays = 6;

Vec3 position_of(const Body& body) { return to_vec3(dBodyGetPosition(body.body)); }

bool is_fast(const Body& body) {
  if (!body.body || !dBodyIsEnabled(body.body) || dBodyIsKinematic(body.body)) return false;
  return (position_of(body) - body.before).squaredNorm() > body.thickness * body.thickness &&
         dBodyGetNumJoints(body.body) == 0;
}

/// Whether the segment comes within `reach` of `center`.
bool comes_near(const Vec3& from, const Vec3& direction, double length, const Vec3& center, double reach) {
  const double along = std::clamp(direction.dot(center - from), 0.0, length);
  return (from + along * direction - center).squaredNorm() <= reach * reach;
}

bool is_convex(dGeomID geom) {
  const int kind = dGeomGetClass(geom);
  return kind == dBoxClass || kind == dSphereClass || kind == dCapsuleClass || kind == dCylinderClass ||
         kind == dConvexClass;
}

bool touch(std::span<const OdeContact> contacts, OdeBodyId a, OdeBodyId b) {
  return std::ranges::any_of(contacts, [&](const OdeContact& c) {
    return (c.first == a && c.second == b) || (c.first == b && c.second == a);
  });
}

}  // namespace

Sweep::Sweep()
    : ray_(dCreateRay(nullptr, 1.0)), mesh_(dCreateTriMesh(nullptr, nullptr, nullptr, nullptr, nullptr)) {
  dGeomRaySetClosestHit(ray_, 1);
  dGeomRaySetBackfaceCull(ray_, 1);
}

Sweep::~Sweep() {
  dGeomDestroy(ray_);
  dGeomDestroy(mesh_);
}

void Sweep::begin(Bodies& bodies) {
  for (Body& body : bodies.slots())
    if (body.body) body.before = position_of(body);
}

int Sweep::stop_passing(Bodies& bodies, BroadPhase& broad_phase, std::span<const OdeContact> contacts) {
  fast_.clear(), stopped_.clear();
  for (Body& body : bodies.slots())
    if (is_fast(body)) fast_.push_back(&body);
  if (fast_.empty()) return 0;
  sort_by_reach(bodies);
  for (Body* body : fast_)
    if (const double part = free_part(*body, broad_phase, contacts); part < 1.0)
      stopped_.emplace_back(body, part);
  // Only now: the others' ways were measured to where all of them would have gone.
  for (const auto& [body, part] : stopped_) {
    const Vec3 place = body->before + part * (position_of(*body) - body->before);
    dBodySetPosition(body->body, place.x(), place.y(), place.z());
    body->last_good.position = place;
  }
  return int(stopped_.size());
}

void Sweep::sort_by_reach(Bodies& bodies) {
  Eigen::AlignedBox3d places;
  for (const Body& body : bodies.slots())
    if (body.body) places.extend(position_of(body));
  places.sizes().maxCoeff(&axis_);
  reaches_.clear();
  longest_ = 0.0;
  for (Body& body : bodies.slots()) {
    if (!body.body) continue;
    reaches_.push_back(reach_of(body));
    longest_ = std::max(longest_, reaches_.back().to - reaches_.back().from);
  }
  std::ranges::sort(reaches_, {}, &Reach::from);
}

Sweep::Reach Sweep::reach_of(Body& body) const {
  const auto [from, to] = std::minmax({body.before[axis_], position_of(body)[axis_]});
  return {from - body.reach, to + body.reach, &body};
}

double Sweep::free_part(Body& body, BroadPhase& broad_phase, std::span<const OdeContact> contacts) {
  double part = 1.0;
  const Reach own = reach_of(body);
  for (auto it = std::ranges::lower_bound(reaches_, own.from - longest_, {}, &Reach::from);
       it != reaches_.end() && it->from <= own.to; ++it)
    if (it->body != &body && it->to >= own.from && broad_phase.lets_meet(body, *it->body))
      part = std::min(part, free_part(body, *it->body, contacts));

  const Vec3 end = position_of(body), whole = end - body.before;
  const Way way{body.before, whole.normalized(), whole.norm(), body.thickness, touch(contacts, body.id, {})};
  Eigen::AlignedBox3d swept(body.before.cwiseMin(end), body.before.cwiseMax(end));
  swept.extend(swept.min() - Vec3::Constant(way.thickness))
      .extend(swept.max() + Vec3::Constant(way.thickness));
  for (const dGeomID geom : broad_phase.find_others(swept, body.properties))
    part = std::min(part, free_part(way, geom));
  return part;
}

double Sweep::free_part(const Body& body, const Body& other, std::span<const OdeContact> contacts) {
  const Vec3 end = position_of(body), center = position_of(other),
             relative = (end - body.before) - (center - other.before);
  const double length = relative.norm();
  if (length <= body.thickness) return 1.0;
  const Vec3 from = end - relative, direction = relative / length;
  if (!comes_near(from, direction, length, center, other.reach + body.thickness)) return 1.0;
  const Way way{from, direction, length, body.thickness, touch(contacts, body.id, other.id)};
  double part = 1.0;
  for (dGeomID geom = dBodyGetFirstGeom(other.body); geom; geom = dBodyGetNextGeom(geom))
    part = std::min(part, free_part(way, geom));
  return part;
}

double Sweep::free_part(const Way& way, dGeomID geom) {
  const Vec3 side = way.direction.unitOrthogonal(), up = way.direction.cross(side);
  double free = way.length;
  const auto look = [&](const Vec3& offset, double lead) {
    const auto distance = distance_to(geom, way.from + offset, way);
    if (!distance) return;
    const double left = *distance - lead * way.thickness;
    // What is nearer without touching stands in a hollow of the body: were it held there, no contact would
    // ever let it go.
    if (left > 0.0 || way.touches) free = std::min(free, std::max(left, 0.0));
  };
  look(Vec3::Zero(), kLeadOfCenter);
  for (int i = 0; i < kRingRays; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / kRingRays;
    look(kRing * way.thickness * (std::cos(turn) * side + std::sin(turn) * up), kLeadOfRing);
  }
  return free / way.length;
}

// Out of a solid the way is free, through the back of a mesh, too, where no contact holds anybody: who got
// into it would else be held there, its speed growing.
std::optional<double> Sweep::distance_to(dGeomID geom, const Vec3& from, const Way& way) {
  if (dGeomGetClass(geom) == dTriMeshClass) return distance_to_mesh(geom, from, way);
  const auto distance = cast(geom, from, way.direction, way.length);
  return distance && is_behind(geom, from, way.direction) ? std::nullopt : distance;
}

// Of a convex one that a ray from `point` meets: then the ray begins within it.
bool Sweep::is_behind(dGeomID geom, const Vec3& point, const Vec3& direction) {
  if (!is_convex(geom)) return false;
  dReal box[6];
  dGeomGetAABB(geom, box);
  const double across = Vec3(box[1] - box[0], box[3] - box[2], box[5] - box[4]).norm();
  return cast(geom, point, -direction, across).has_value();
}

std::optional<double> Sweep::cast(dGeomID geom, const Vec3& from, const Vec3& direction, double length) {
  dGeomRaySetLength(ray_, length);
  dGeomRaySet(ray_, from.x(), from.y(), from.z(), direction.x(), direction.y(), direction.z());
  dContactGeom hit;
  return dCollide(ray_, geom, 1, &hit, sizeof hit) > 0 ? std::optional(hit.depth) : std::nullopt;
}

// OPCODE computes in float: about the start of the ray it is as precise far from the world's origin as near
// it.
std::optional<double> Sweep::distance_to_mesh(dGeomID mesh, const Vec3& from, const Way& way) {
  const Vec3 place = to_vec3(dGeomGetPosition(mesh)) - from;
  dGeomTriMeshSetData(mesh_, dGeomTriMeshGetData(mesh));
  dGeomSetPosition(mesh_, place.x(), place.y(), place.z());
  dGeomSetRotation(mesh_, dGeomGetRotation(mesh));
  const std::scoped_lock lock(trimesh_mutex());
  return cast(mesh_, Vec3::Zero(), way.direction, way.length);
}

}  // namespace lodestone::ode
