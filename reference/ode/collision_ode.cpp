#include "reference/ode/collision_ode.h"

#include <algorithm>
#include <tuple>

#include "reference/error.h"
#include "reference/hull/hull_manifold.h"
#include "reference/mesh/inside.h"

namespace lodestone::ode {
namespace {

ContactSide side_of(const Body& body) { return {body.body, body.material, body.id}; }

bool same_pair(const Candidate& a, const Candidate& b) {
  return a.first_order == b.first_order && a.second_order == b.second_order;
}

bool is_awake(const Body& body) { return body.body && dBodyIsEnabled(body.body); }

Plane plane_of(dGeomID geom) {
  dVector4 p;
  dGeomPlaneGetParams(geom, p);
  return {to_vec3(p), p[3], 0, geom};
}

/// Whether two meshes whose surfaces do not cross are one inside the other.
bool is_inside_other(const Body& first, const Body& second) {
  const auto& [inner, outer] = first.reach < second.reach ? std::tie(first, second) : std::tie(second, first);
  if (!inner.spheres.empty() || !outer.spheres.empty()) return false;
  const RigidState within = state_of(inner.body), around = state_of(outer.body);
  const Vec3 point = around.orientation.conjugate() * (within.position + within.orientation * inner.shape->mesh.vertices[0] - around.position);
  return point.norm() < outer.reach && winding_number(outer.shape->mesh, point) > 0;
}

}  // namespace

Collision::Collision(dSpaceID around, const OdeSettings& settings)
    : settings_(settings),
      broad_phase_(around),
      narrow_phase_(settings.mesh_contacts != MeshContacts::plain),
      plane_phase_(settings),
      attached_(around != nullptr) {}

Collision::~Collision() {
  for (const Plane& plane : planes_) dGeomDestroy(plane.geom);
}

void Collision::add_plane(const Vec3& normal, double offset, MaterialId material) {
  check_that(std::abs(normal.norm() - 1.0) < 1e-6 && std::isfinite(offset), "a plane's normal has unit length, its offset is finite");
  planes_.push_back({normal, offset, material, dCreatePlane(nullptr, normal.x(), normal.y(), normal.z(), offset)});
}

void Collision::add_box(const Vec3& sides, const Vec3& position, const Quat& orientation, MaterialId material) {
  check_that(sides.allFinite() && sides.minCoeff() > 0.0, "a box's sides are positive");
  check_that(is_sound({position, orientation, Vec3::Zero(), Vec3::Zero()}), "a box's pose is finite, below 1e8 m");
  const dGeomID box = dCreateBox(broad_phase_.ground_space(), sides.x(), sides.y(), sides.z());
  dGeomSetPosition(box, position.x(), position.y(), position.z());
  const dQuaternion q = {orientation.w(), orientation.x(), orientation.y(), orientation.z()};
  dGeomSetQuaternion(box, q);
  add_ground(box, {material, std::make_shared<const Shape>(make_shape("static box", make_box(sides))), {position, orientation, Vec3::Zero(), Vec3::Zero()}});
}

void Collision::add_mesh(const Mesh& mesh, MaterialId material) {
  ground_meshes_.push_back(std::make_unique<TrimeshData>(mesh.vertices, mesh.faces));
  add_ground(dCreateTriMesh(broad_phase_.ground_space(), ground_meshes_.back()->id(), nullptr, nullptr, nullptr), {material});
}

void Collision::add_ground(dGeomID geom, Ground ground) {
  dGeomSetData(geom, reinterpret_cast<void*>(ground_.size()));
  ground_.push_back(std::move(ground));
}

void Collision::collide(Bodies& bodies, ContactJoints& joints, double h) {
  step_ = {h, joints.gravity()};
  const bool any_awake = std::ranges::any_of(bodies.slots(), is_awake);
  // One body over planes needs no broad phase, nor do sleepers, except from a caller's bodies.
  std::span<const Candidate> candidates;
  if (attached_ || (any_awake && (bodies.count() > 1 || !ground_.empty()))) candidates = broad_phase_.find(bodies);
  mark_company(bodies, candidates);
  for (Body& body : bodies.slots())
    if (is_awake(body))
      for (const Plane& plane : planes_) collide_plane(body, plane, joints);
  collide_candidates(bodies, candidates, joints);
}

// Those that may touch more than planes, or hang on a joint.
void Collision::mark_company(Bodies& bodies, std::span<const Candidate> candidates) {
  for (Body& body : bodies.slots()) {
    body.impact_time.reset();
    body.in_company = body.body && dBodyGetNumJoints(body.body) > 0;
  }
  for (const Candidate& candidate : candidates) {
    if (dGeomGetClass(candidate.second) == dPlaneClass) continue;
    for (const dGeomID geom : {candidate.first, candidate.second})
      if (Body* body = bodies.owner(geom)) body->in_company = true;
  }
}

void Collision::collide_plane(Body& body, const Plane& plane, ContactJoints& joints) {
  points_.clear();
  plane_phase_.find(body, plane, joints.law(body.material, plane.material), step_, points_);
  if (!points_.empty()) joints.add(ode::side_of(body), {nullptr, plane.material, {}}, points_);
}

void Collision::collide_candidates(Bodies& bodies, std::span<const Candidate> candidates, ContactJoints& joints) {
  for (std::size_t i = 0, next; i < candidates.size(); i = next) {
    points_.clear();
    Body& body = *bodies.owner(candidates[i].first);
    const Body* other = bodies.owner(candidates[i].second);
    if (dGeomGetClass(candidates[i].second) == dPlaneClass) {
      const Plane plane = plane_of(candidates[i].second);
      plane_phase_.find(body, plane, joints.law(body.material, plane.material), step_, points_);
      next = i + 1;
    } else {
      for (next = i; next < candidates.size() && same_pair(candidates[i], candidates[next]); ++next) {}
      find_pair_points(body, other, candidates.subspan(i, next - i));
    }
    if (!points_.empty()) joints.add(ode::side_of(body), side_of(bodies, candidates[i].second), points_);
  }
}

void Collision::find_pair_points(const Body& body, const Body* other, std::span<const Candidate> parts) {
  const double size = other ? std::min(body.reach, other->reach) : body.reach;
  const bool exact = settings_.mesh_contacts == MeshContacts::exact && body.convex;
  const Ground* ground = other ? nullptr : ground_of(parts[0].second);
  if (exact && other && other->convex)
    find_hull_points(*body.shape, state_of(body.body), *other->shape, state_of(other->body));
  else if (exact && ground && ground->hull)
    find_hull_points(*body.shape, state_of(body.body), *ground->hull, ground->state);
  else
    for (const Candidate& part : parts) narrow_phase_.find(part.first, part.second, size, points_);
  // Surfaces that do not cross make no contact, wherever they are.
  if (points_.empty() && other && is_inside_other(body, *other)) {
    ++swallowed_;
    find_hull_points(*body.shape, state_of(body.body), *other->shape, state_of(other->body));
  }
  drop_beyond(reduce_contacts(points_, settings_.max_contacts_per_pair, size));
}

void Collision::find_hull_points(const Shape& first, const RigidState& first_state, const Shape& second, const RigidState& second_state) {
  const auto overlap = find_hull_overlap(first, first_state, second, second_state);
  if (!overlap) return;
  find_hull_manifold(first, first_state, second, second_state, *overlap, points_);
  const double resting = kRestingDepth * std::min(first.radius, second.radius);
  for (ContactPoint& point : points_) point.depth = std::max(0.0, point.depth - resting);
}

void Collision::drop_beyond(int kept) {
  // Fewer than the cap: those left out say what others say.
  if (kept == settings_.max_contacts_per_pair) dropped_ += std::int64_t(points_.size()) - kept;
  points_.resize(kept);
}

ContactSide Collision::side_of(Bodies& bodies, dGeomID geom) const {
  if (const Body* body = bodies.owner(geom)) return ode::side_of(*body);
  const Ground* ground = ground_of(geom);
  return ground ? ContactSide{nullptr, ground->material, {}} : ContactSide{dGeomGetBody(geom), 0, {}};
}

/// Null where `geom` is not of this world's ground.
const Ground* Collision::ground_of(dGeomID geom) const {
  if (dGeomGetSpace(geom) != broad_phase_.ground_space()) return nullptr;
  return &ground_[reinterpret_cast<std::uintptr_t>(dGeomGetData(geom))];
}

}  // namespace lodestone::ode
