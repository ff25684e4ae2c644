#include "reference/ode/plane_phase_ode.h"

#include <algorithm>
#include <limits>
#include <mutex>

#include "reference/ode/contact_filter.h"

namespace lodestone::ode {
namespace {

constexpr int kAll = std::numeric_limits<int>::max();

double height_of(const Body& body, const Plane& plane) {
  return plane.normal.dot(to_vec3(dBodyGetPosition(body.body))) - plane.offset;
}

/// Against the plane's normal, m/s.
double approach_of(const Body& body, const Vec3& arm, const Vec3& normal) {
  return -normal.dot(to_vec3(dBodyGetLinearVel(body.body)) +
                     to_vec3(dBodyGetAngularVel(body.body)).cross(arm));
}

/// m/s², by gravity and by what else acts on it in the substep.
Vec3 acceleration_of(const Body& body, const Vec3& gravity) {
  dMass mass;
  dBodyGetMass(body.body, &mass);
  const double pull = dBodyGetGravityMode(body.body) ? 1.0 : 0.0;
  return pull * gravity + to_vec3(dBodyGetForce(body.body)) / mass.mass;
}

Mat3 rotation_of(const Body& body) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(dBodyGetRotation(body.body))
      .leftCols<3>();
}

}  // namespace

void PlanePhase::find(Body& body, const Plane& plane, const ContactLaw& law, const PlaneStep& step,
                      std::vector<ContactPoint>& points) {
  const bool by_hull = settings_.plane_contacts_from_hull;
  if (by_hull && height_of(body, plane) > body.reach + nearing(body, plane, step)) return;
  if (!by_hull)
    find_mesh_points(body, plane, points);
  else if (body.spheres.empty())
    find_hull_points(body, plane, law, step, points);
  else
    find_sphere_points(body, plane, law, step, points);
  keep_widest(body, points);
}

// How far below the plane vertices are of interest, m: what may come down to it within the step, where
// contacts are made early.
double PlanePhase::nearing(const Body& body, const Plane& plane, const PlaneStep& step) const {
  const bool timed = is_timed(body, step);
  if (!timed && settings_.plane_depth_max > 1.0) return 0.0;
  const double fall =
      timed ? std::max(0.0, -plane.normal.dot(acceleration_of(body, step.gravity))) * step.duration : 0.0;
  const double approach = approach_of(body, Vec3::Zero(), plane.normal) +
                          to_vec3(dBodyGetAngularVel(body.body)).norm() * body.reach;
  return (std::max(0.0, approach) + fall) * step.duration;
}

bool PlanePhase::is_timed(const Body& body, const PlaneStep& step) const {
  const bool fits =
      step.duration > settings_.timed_contacts_above && step.duration <= settings_.timed_contacts_up_to;
  return fits && !body.in_company && !body.impact;
}

void PlanePhase::find_hull_points(Body& body, const Plane& plane, const ContactLaw& law,
                                  const PlaneStep& step, std::vector<ContactPoint>& points) {
  const bool timed = is_timed(body, step);
  const double margin = nearing(body, plane, step);
  const Mat3 rotation = rotation_of(body);
  std::int64_t dropped = 0;
  near_.clear();
  for (const PlaneContact& contact : plane_contacts_.find(
           body.shape->hull, rotation.transpose() * plane.normal, margin - height_of(body, plane),
           timed || body.in_company ? kAll : settings_.max_contacts_per_pair, body.last_support, &dropped))
    near_.push_back({rotation * body.shape->hull.vertices[contact.vertex], contact.depth - margin});
  dropped_ += dropped;
  if (timed)
    append_timed(body, plane, law, step, points);
  else
    append_early_and_deep(body, plane, step, points);
}

void PlanePhase::append_timed(Body& body, const Plane& plane, const ContactLaw& law, const PlaneStep& step,
                              std::vector<ContactPoint>& points) const {
  body.impact = append_timed_contacts(near_,
                                      {.body = state_of(body.body),
                                       .normal = plane.normal,
                                       .acceleration = acceleration_of(body, step.gravity),
                                       .duration = step.duration,
                                       .restitution = law.restitution,
                                       .bounce_velocity = settings_.bounce_velocity,
                                       .turns = body.spheres.empty()},
                                      points);
}

void PlanePhase::append_early_and_deep(const Body& body, const Plane& plane, const PlaneStep& step,
                                       std::vector<ContactPoint>& points) const {
  const Vec3 position = to_vec3(dBodyGetPosition(body.body));
  const double most = settings_.plane_depth_max * body.shape->size;
  for (const NearPoint& near : near_)
    if (near.depth > 0.0 || near.depth + approach_of(body, near.arm, plane.normal) * step.duration > most)
      points.push_back(
          {position + near.arm, plane.normal, std::max(near.depth, 0.0), 0.0, std::max(-near.depth, 0.0)});
}

// A ball is met as hulls are: at its own time within the step, and before it would be far inside. Spheres
// that stand for a mesh (Body::spheres) are what a user of ODE would have.
void PlanePhase::find_sphere_points(Body& body, const Plane& plane, const ContactLaw& law,
                                    const PlaneStep& step, std::vector<ContactPoint>& points) {
  const Vec3 position = to_vec3(dBodyGetPosition(body.body));
  const Quat orientation = to_quat(dBodyGetQuaternion(body.body));
  const bool is_ball = body.shape->sphere_radius.has_value();
  const bool timed = is_ball && is_timed(body, step);
  const double margin = is_ball ? nearing(body, plane, step) : 0.0;
  near_.clear();
  for (const Sphere& sphere : body.spheres) {
    const Vec3 center = orientation * sphere.center;
    const double depth = sphere.radius - height_of(body, plane) - plane.normal.dot(center);
    if (depth > -margin) near_.push_back({center - sphere.radius * plane.normal, depth});
  }
  if (timed) return append_timed(body, plane, law, step, points);
  if (is_ball) return append_early_and_deep(body, plane, step, points);
  for (const NearPoint& near : near_) points.push_back({position + near.arm, plane.normal, near.depth});
}

// As plain ODE does it: wherever the body is, for a plane's box has no end; and the first contacts that it
// finds, whatever their depth.
void PlanePhase::find_mesh_points(const Body& body, const Plane& plane,
                                  std::vector<ContactPoint>& points) const {
  std::vector<dContactGeom> found(settings_.max_contacts_per_pair);
  const std::scoped_lock lock(trimesh_mutex());
  for (dGeomID geom = dBodyGetFirstGeom(body.body); geom; geom = dBodyGetNextGeom(geom)) {
    const int count = dCollide(geom, plane.geom, int(found.size()), found.data(), sizeof(dContactGeom));
    for (const dContactGeom& contact : std::span(found).first(count))
      points.push_back({to_vec3(contact.pos), to_vec3(contact.normal), contact.depth});
  }
}

// The deepest and those farthest apart: the deepest alone may all be on one side of a face of many corners,
// which then rocks for ever.
void PlanePhase::keep_widest(const Body& body, std::vector<ContactPoint>& points) {
  std::ranges::stable_sort(points, std::ranges::greater{}, &ContactPoint::depth);
  if (int(points.size()) <= settings_.max_contacts_per_pair) return;
  const int kept = reduce_contacts(points, settings_.max_contacts_per_pair, body.shape->size);
  dropped_ += std::int64_t(points.size()) - kept;
  points.resize(std::size_t(kept));
}

}  // namespace lodestone::ode
