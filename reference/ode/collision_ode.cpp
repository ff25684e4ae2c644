#include "reference/ode/collision_ode.h"

#include <algorithm>
#include <tuple>

#include "reference/error.h"
#include "reference/hull/hull_manifold.h"
#include "reference/mesh/inside.h"
#include "reference/ode/piece_contacts.h"

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

Pieces pieces_of(const Body& body) { return {body.pieces, state_of(body.body)}; }

Pieces pieces_of(const Ground* ground) {
  if (!ground || !ground->box) return {};
  return {{{ground->box.get()}}, ground->state};
}

/// Whether two meshes whose surfaces do not cross are one inside the other.
bool is_inside_other(const Body& first, const Body& second) {
  const auto& [inner, outer] = first.reach < second.reach ? std::tie(first, second) : std::tie(second, first);
  const RigidState within = state_of(inner.body), around = state_of(outer.body);
  const Vec3 point = around.orientation.conjugate() * (within.position + within.orientation * inner.shape->mesh.vertices[0] - around.position);
  return point.norm() < outer.reach && winding_number(outer.shape->mesh, point) > 0;
}

/// A contact deeper than the hulls' overlap has a false direction. Where there are no others, the hulls' way out is taken.
void limit_depths(std::vector<ContactPoint>& contacts, const HullOverlap& overlap) {
  const auto is_false = [&](const ContactPoint& contact) { return contact.depth > overlap.depth; };
  if (contacts.empty() || std::ranges::none_of(contacts, is_false)) return;
  if (!std::ranges::all_of(contacts, is_false)) return void(std::erase_if(contacts, is_false));
  for (ContactPoint& contact : contacts) contact = {contact.point, overlap.direction, overlap.depth};
}

/// A body deep in another (pitfall 4) is let out one way: contacts that oppose the deepest would squeeze it like a stone from a cherry.
void drop_opposing(std::vector<ContactPoint>& contacts, double size) {
  constexpr double kDeep = 0.1;  // × size
  if (contacts.empty()) return;
  const ContactPoint deepest = std::ranges::max(contacts, {}, &ContactPoint::depth);
  if (deepest.depth > kDeep * size) std::erase_if(contacts, [&](const ContactPoint& contact) { return contact.normal.dot(deepest.normal) < 0.0; });
}

bool is_mesh(const Body& body) { return dGeomGetClass(dBodyGetFirstGeom(body.body)) == dTriMeshClass; }

}  // namespace

Collision::Collision(dSpaceID around, const OdeSettings& settings)
    : settings_(settings),
      broad_phase_(around, settings.hash_space),
      narrow_phase_(settings.mesh_contacts != MeshContacts::plain, settings.most_mesh_measures),
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
  const bool exact = settings_.mesh_contacts == MeshContacts::exact;
  const Pieces first = pieces_of(body), second = other ? pieces_of(*other) : pieces_of(ground_of(parts[0].second));
  if (exact && !first.empty() && !second.empty())
    find_contacts_of_pieces(first, second, points_);
  else if (exact && other && is_mesh(body) && is_mesh(*other))
    find_filtered_points(body, *other, parts[0], size);
  else
    for (const Candidate& part : parts) narrow_phase_.find(part.first, part.second, size, points_);
  drop_beyond(reduce_contacts(points_, settings_.max_contacts_per_pair, size));
}

/// Bodies are clear of each other once their hulls are.
void Collision::find_filtered_points(const Body& body, const Body& other, const Candidate& pair, double size) {
  const RigidState first = state_of(body.body), second = state_of(other.body);
  const auto overlap = find_hull_overlap(*body.shape, first, *other.shape, second);
  if (!overlap) return;
  narrow_phase_.find(pair.first, pair.second, size, points_);
  if (points_.empty() && is_inside_other(body, other)) {  // surfaces that do not cross make no contact, wherever they are
    ++swallowed_;
    find_hull_manifold(*body.shape, first, *other.shape, second, *overlap, points_);
  }
  limit_depths(points_, *overlap);
  drop_opposing(points_, size);
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
