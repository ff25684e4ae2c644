#include "reference/ode/collision_ode.h"

#include <algorithm>
#include <tuple>

#include "reference/hull/hull_manifold.h"
#include "reference/mesh/inside.h"
#include "reference/ode/exact_solid.h"
#include "reference/ode/piece_contacts.h"

namespace lodestone::ode {
namespace {

ContactSide side_of_ours(const Body& body) { return ode::side_of(body.body, body.material, body.id); }

bool same_pair(const Candidate& a, const Candidate& b) {
  return a.first_order == b.first_order && a.second_order == b.second_order;
}

Pieces pieces_of(const Body& body) { return {body.pieces, state_of(body.body)}; }

/// Whether a mesh holds a point of the world's.
bool is_inside(const Body& mesh, const Vec3& point) {
  const RigidState state = state_of(mesh.body);
  const Vec3 own = state.orientation.conjugate() * (point - state.position);
  return own.norm() < mesh.reach && winding_number(mesh.shape->mesh, own) > 0;
}

/// Whether two meshes whose surfaces do not cross are one inside the other.
bool is_inside_other(const Body& first, const Body& second) {
  const auto& [inner, outer] = first.reach < second.reach ? std::tie(first, second) : std::tie(second, first);
  const RigidState within = state_of(inner.body);
  return is_inside(outer, within.position + within.orientation * inner.shape->mesh.vertices[0]);
}

/// A contact deeper than the hulls' overlap has a false direction. Where there are no others, the hulls' way
/// out is taken.
void limit_depths(std::vector<ContactPoint>& contacts, const HullOverlap& overlap) {
  const auto is_false = [&](const ContactPoint& contact) { return contact.depth > overlap.depth; };
  if (contacts.empty() || std::ranges::none_of(contacts, is_false)) return;
  if (!std::ranges::all_of(contacts, is_false)) return void(std::erase_if(contacts, is_false));
  for (ContactPoint& contact : contacts) contact = {contact.point, overlap.direction, overlap.depth};
}

/// A body deep in another (pitfall 4) is let out one way: contacts that oppose the deepest would squeeze it
/// like a stone from a cherry.
void drop_opposing(std::vector<ContactPoint>& contacts, double size) {
  constexpr double kDeep = 0.1;  // × size
  if (contacts.empty()) return;
  const ContactPoint deepest = std::ranges::max(contacts, {}, &ContactPoint::depth);
  if (deepest.depth > kDeep * size)
    std::erase_if(contacts,
                  [&](const ContactPoint& contact) { return contact.normal.dot(deepest.normal) < 0.0; });
}

bool is_mesh(const Body& body) { return dGeomGetClass(dBodyGetFirstGeom(body.body)) == dTriMeshClass; }

}  // namespace

Collision::Collision(const SpaceMirror* callers, TrimeshCache& trimeshes, const OdeSettings& settings)
    : settings_(settings),
      broad_phase_(callers, settings.hash_space),
      narrow_phase_(settings.mesh_contacts != MeshContacts::plain, settings.most_mesh_measures),
      plane_phase_(settings),
      callers_(callers),
      trimeshes_(trimeshes) {}

Collision::~Collision() {
  for (const Plane& plane : planes_) dGeomDestroy(plane.geom);
  for (const Ground& ground : ground_)
    if (ground.id) dGeomDestroy(ground.geom);
}

void Collision::collide(Bodies& bodies, ContactJoints& joints, double h) {
  step_ = {h, joints.gravity()};
  const bool any_awake = std::ranges::any_of(bodies.slots(), &Body::is_awake);
  // One body over planes needs no broad phase, nor do sleepers, except from a caller's bodies.
  std::span<const Candidate> candidates;
  if (callers_ || (any_awake && (bodies.count() > 1 || !ground_.empty())))
    candidates = broad_phase_.find(bodies);
  mark_company(bodies, candidates);
  if (callers_) note_callers_planes();
  for (Body& body : bodies.slots()) {
    if (!body.is_awake() || dBodyIsKinematic(body.body)) continue;
    for (const Plane& plane : planes_) collide_plane(body, plane, joints);
    for (const Plane& plane : callers_planes_) collide_plane(body, plane, joints);
  }
  woken_.clear(), waking_.assign(bodies.slots().size(), Waking::no);
  for (const Body& body : bodies.slots())
    if (body.is_awake()) note_joined(bodies, body, joints.graph());
  collide_candidates(bodies, candidates, joints);
  collide_woken(bodies, joints);
}

// ODE wakes who hangs together with one that is awake: without his own contacts he would fall in that
// substep.
void Collision::collide_woken(Bodies& bodies, ContactJoints& joints) {
  const auto is_left = [&](const Body& other) {
    return waking_[std::size_t(&other - bodies.slots().data())] != Waking::met;
  };
  for (std::size_t i = 0; i < woken_.size(); ++i) {
    Body& body = bodies.slots()[woken_[i]];
    body.in_company = true;
    waking_[woken_[i]] = Waking::met;
    for (const Plane& plane : planes_) collide_plane(body, plane, joints);
    for (const Plane& plane : callers_planes_) collide_plane(body, plane, joints);
    collide_candidates(bodies, broad_phase_.find_of_sleeper(bodies, body, is_left), joints);
    note_joined(bodies, body, joints.graph());
  }
}

// Those whom it meets are known as such already.
void Collision::note_joined(Bodies& bodies, const Body& body, const ContactGraph& contacts) {
  contacts.any_other_joint(body.body, [&](dJointID joint) {
    for (const int end : {0, 1})
      if (const dBodyID other = dJointGetBody(joint, end)) note_woken(bodies, bodies.owner(other));
    return false;
  });
}

void Collision::note_woken(Bodies& bodies, const Body* body) {
  if (!body || body->is_awake() || dBodyIsKinematic(body->body)) return;
  const auto slot = std::size_t(body - bodies.slots().data());
  if (waking_[slot] != Waking::no) return;
  waking_[slot] = Waking::to_meet;
  woken_.push_back(slot);
}

void Collision::note_changes(Bodies& bodies) {
  callers_shapes_.forget(*callers_);
  for (const Eigen::AlignedBox3d& box : callers_->disturbed()) broad_phase_.wake_ours(bodies, box);
}

void Collision::note_callers_planes() {
  callers_planes_.clear();
  for (const std::uint32_t slot : callers_->planes()) {
    const MirroredGeom& plane = callers_->geoms()[slot];
    callers_planes_.push_back({plane.normal, plane.offset, 0, plane.geom, plane.category, plane.collide, {}});
  }
}

// Those that may touch more than planes, or hang on a joint.
void Collision::mark_company(Bodies& bodies, std::span<const Candidate> candidates) {
  for (Body& body : bodies.slots()) {
    body.impact.reset();
    body.in_company = body.body && dBodyGetNumJoints(body.body) > 0;
  }
  for (const Candidate& candidate : candidates) {
    for (const dGeomID geom : {candidate.first, candidate.second})
      if (Body* body = bodies.owner(geom)) body->in_company = true;
  }
}

void Collision::collide_plane(Body& body, const Plane& plane, ContactJoints& joints) {
  if (!may_meet(body.properties.category, body.properties.collide, plane.category, plane.collide)) return;
  points_.clear();
  plane_phase_.find(body, plane, joints.law(body.material, plane.material), step_, points_);
  if (!points_.empty())
    joints.add(side_of_ours(body),
               {nullptr, plane.material, {}, {}, false, plane.id ? nullptr : plane.geom, plane.id}, points_);
}

void Collision::collide_candidates(Bodies& bodies, std::span<const Candidate> candidates,
                                   ContactJoints& joints) {
  for (std::size_t i = 0, next; i < candidates.size(); i = next) {
    points_.clear();
    const Body& body = *bodies.owner(candidates[i].first);
    const Body* other = bodies.owner(candidates[i].second);
    for (next = i; next < candidates.size() && same_pair(candidates[i], candidates[next]); ++next) {
    }
    find_pair_points(body, other, candidates.subspan(i, next - i));
    if (points_.empty()) continue;
    note_woken(bodies, &body), note_woken(bodies, other);  // before a surface that moves wakes them
    joints.add(side_of_ours(body), side_of(candidates[i], other), points_);
  }
}

void Collision::find_pair_points(const Body& body, const Body* other, std::span<const Candidate> parts) {
  const double size = other ? std::min(body.reach, other->reach) : body.reach;
  if (!other && settings_.mesh_contacts != MeshContacts::plain &&
      dGeomGetClass(parts[0].second) == dHeightfieldClass) {
    height_field_contacts_.find(body, parts[0].second, points_);
    return drop_beyond(reduce_contacts(points_, settings_.max_contacts_per_pair, size));
  }
  const bool exact = settings_.mesh_contacts == MeshContacts::exact;
  const Pieces first = pieces_of(body),
               second = exact && !first.empty() ? pieces_of_other(parts[0], other) : Pieces{};
  if (exact && !first.empty() && !second.empty())
    find_contacts_of_pieces(first, second, points_);
  else if (exact && other && is_mesh(body) && is_mesh(*other))
    find_filtered_points(body, *other, parts[0], size);
  else
    for (const Candidate& part : parts) {
      if (dGeomGetClass(part.second) == dConvexClass && dGeomGetClass(part.first) == dTriMeshClass)
        trimeshes_.prepare_for_convexes(*body.shape, dGeomTriMeshGetData(part.first));
      narrow_phase_.find(part.first, part.second, size, points_);
    }
  if (exact && other && points_.empty()) find_swallowed_ball(body, *other);
  if (exact) points_.resize(std::size_t(drop_inner_contacts(points_, size)));
  drop_beyond(reduce_contacts(points_, settings_.max_contacts_per_pair, size));
}

/// Bodies are clear of each other once their hulls are.
void Collision::find_filtered_points(const Body& body, const Body& other, const Candidate& pair,
                                     double size) {
  const RigidState first = state_of(body.body), second = state_of(other.body);
  if (!may_hulls_overlap(*body.shape, first, *other.shape, second)) return;
  narrow_phase_.find(pair.first, pair.second, size, points_);
  // Surfaces that do not cross make no contact, wherever they are.
  const bool swallowed = points_.empty() && is_inside_other(body, other);
  if (points_.empty() && !swallowed) return;
  const auto overlap = find_hull_overlap(*body.shape, first, *other.shape, second);
  if (!overlap) return points_.clear();
  if (swallowed) {
    ++swallowed_;
    find_hull_manifold(*body.shape, first, *other.shape, second, *overlap, points_);
  }
  limit_depths(points_, *overlap);
  drop_opposing(points_, size);
}

/// A ball meets no face of a mesh behind which its centre is.
void Collision::find_swallowed_ball(const Body& body, const Body& other) {
  const auto& [ball, mesh] = is_mesh(other) ? std::tie(body, other) : std::tie(other, body);
  if (!ball.shape->sphere_radius || !is_mesh(mesh)) return;
  constexpr double kNearly = 0.9;  // of the radius: less deep is no centre
  const RigidState first = state_of(body.body), second = state_of(other.body);
  const auto overlap = find_hull_overlap(*body.shape, first, *other.shape, second);
  const Vec3 center = to_vec3(dBodyGetPosition(ball.body));
  if (!overlap || overlap->depth < kNearly * *ball.shape->sphere_radius || !is_inside(mesh, center)) return;
  ++swallowed_;
  points_.push_back({center, overlap->direction, overlap->depth});
}

void Collision::drop_beyond(int kept) {
  // Fewer than the cap: those left out say what others say.
  if (kept == settings_.max_contacts_per_pair) dropped_ += std::int64_t(points_.size()) - kept;
  points_.resize(kept);
}

Pieces Collision::pieces_of_other(const Candidate& candidate, const Body* other) {
  if (other) return pieces_of(*other);
  if (candidate.with_ground()) {
    Ground& ground = ground_[candidate.second_number()];
    const Shape* solid = solid_of(ground);
    return solid ? Pieces{pieces_in_mesh(*solid), ground.state} : Pieces{};
  }
  const Shape* shape = callers_shapes_.find(*callers_, candidate.second_number());
  if (!shape) return {};
  dQuaternion q;
  dGeomGetQuaternion(candidate.second, q);
  return {pieces_in_mesh(*shape),
          {to_vec3(dGeomGetPosition(candidate.second)), to_quat(q), Vec3::Zero(), Vec3::Zero()}};
}

ContactSide Collision::side_of(const Candidate& candidate, const Body* other) const {
  if (other) return side_of_ours(*other);
  if (candidate.with_ground()) {
    const Ground& ground = ground_[candidate.second_number()];
    ContactSide side{nullptr, ground.material, {}, {}, ground.moved || ground.moves, nullptr, ground.id};
    if (ground.moves)
      side.motion =
          SurfaceMotion{ground.state.position, ground.state.velocity, ground.state.angular_velocity};
    else
      side.way_on = std::min(ground.way(), ground.last_way);
    return side;
  }
  const MirroredGeom& geom = callers_->geoms()[candidate.second_number()];
  ContactSide side = ode::side_of(geom.body, 0, {}, geom.geom);
  if (side.body) side.callers_slot = std::int32_t(candidate.second_number());
  if (side.body || side.motion) return side;
  side.moves |= std::ranges::binary_search(callers_->moved(), candidate.second_number());
  side.way_on = callers_->way_on(candidate.second_number());
  return side;
}

}  // namespace lodestone::ode
