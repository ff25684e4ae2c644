#include "reference/hull/hull_overlap.h"

#include <ccd/ccd.h>

namespace lodestone {
namespace {

/// A shape in the world as libccd asks for it.
struct PlacedHull {
  const Shape* shape;
  RigidState state;
};

Vec3 to_vec3(const ccd_vec3_t& v) { return {v.v[0], v.v[1], v.v[2]}; }
void assign(ccd_vec3_t& to, const Vec3& v) { ccdVec3Set(&to, ccd_real_t(v.x()), ccd_real_t(v.y()), ccd_real_t(v.z())); }

/// The farthest point along `direction` (any length), relative to the centre of mass.
Vec3 support_offset(const Shape& shape, const Quat& orientation, const Vec3& direction) {
  if (shape.sphere_radius) return *shape.sphere_radius * direction.normalized();
  const Vec3 in_body = orientation.conjugate() * direction;
  return orientation * shape.hull.vertices[find_support(shape.hull, in_body, shape.support_map.find_start(in_body))];
}

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const auto& placed = *static_cast<const PlacedHull*>(object);
  assign(*point, placed.state.position + support_offset(*placed.shape, placed.state.orientation, to_vec3(*direction)));
}

void center(const void* object, ccd_vec3_t* point) { assign(*point, static_cast<const PlacedHull*>(object)->state.position); }

}  // namespace

double measure_hull_overlap(const Shape& first, const RigidState& first_state, const Shape& second,
                            const RigidState& second_state) {
  // Around the origin, so that nothing is lost far from it.
  PlacedHull a{&first, first_state}, b{&second, second_state};
  b.state.position -= a.state.position;
  a.state.position.setZero();

  ccd_t query;
  CCD_INIT(&query);
  query.support1 = query.support2 = support;
  query.center1 = query.center2 = center;
  query.max_iterations = 100;
  query.mpr_tolerance = ccd_real_t(1e-6 * std::min(first.radius, second.radius));
  ccd_real_t depth = 0;
  ccd_vec3_t direction, point;
  return ccdMPRPenetration(&a, &b, &query, &depth, &direction, &point) == 0 ? double(depth) : 0.0;
}

double measure_plane_overlap(const Shape& shape, const RigidState& state, const Vec3& normal, double offset) {
  return offset - normal.dot(state.position + support_offset(shape, state.orientation, -normal));
}

}  // namespace lodestone
