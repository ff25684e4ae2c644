// Which of a hull's vertices meet the ground in a contact step.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "lod/contact/ground_solver.h"
#include "lod/contact/hull_contacts.h"
#include "lod/statistical/step_world.h"
#include "lod/support/hull_impacts.h"

namespace lodestone {

/// A point of a body that may touch the ground.
struct TouchingPoint {
  static constexpr std::int32_t kNoVertex = -1;
  std::int32_t vertex = kNoVertex;  ///< of the hull; else it is where two faces or edges meet
  Vec3 arm = Vec3::Zero();          ///< m, from the centre of mass, body axes
  /// Whether it is the other, or so near that it takes its place. (Of a ball that rolls it is never the
  /// same.)
  bool stands_for(const TouchingPoint& other, const Shape& shape) const {
    if (vertex != kNoVertex || other.vertex != kNoVertex) return vertex == other.vertex;
    const double near = (shape.sphere_radius ? 0.5 : 0.03) * shape.radius;
    return (arm - other.arm).squaredNorm() < near * near;
  }
};

/// The contacts of a step: of each plane in reach the vertices that may meet it; of other ground the points
/// that may, each with the plane through what it meets there.
struct StepContacts {
  static constexpr std::size_t kCapacity = 6 * kMaxGroundContacts;
  std::array<GroundContact, kCapacity> contact;
  std::array<TouchingPoint, kCapacity> point;
  std::array<const HalfSpace*, kCapacity> plane;
  std::array<bool, kCapacity> due;       ///< it was to strike where the step begins
  std::array<bool, kCapacity> stood_on;  ///< it carried the body in the contact step before
  std::size_t count = 0;
  double deepest = 0.0;  ///< m, 0 or less
  const HalfSpace* deepest_plane = nullptr;
  bool uneven = false;           ///< some are of ground that is no plane
  double until = 0.0;            ///< s: nothing else is struck sooner
  std::vector<HalfSpace> local;  ///< planes of this step alone
  std::size_t under = 0;         ///< the first of them: under the whole body

  std::span<GroundContact> contacts() { return std::span(contact).first(count); }
  bool is_full() const { return count == kCapacity; }
  void add(const GroundContact& c, const TouchingPoint& of, const HalfSpace& with) {
    contact[count] = c;
    point[count] = of;
    due[count] = stood_on[count] = false;
    plane[count++] = &with;
  }
  /// Where there is no room any more its address would change.
  const HalfSpace* keep(const HalfSpace& plane_of_step) {
    if (local.size() == local.capacity()) return nullptr;
    return &local.emplace_back(plane_of_step);
  }
};

/// What held a point in the contact step before: where the solver begins in the next.
struct HeldPoints {
  std::array<std::pair<TouchingPoint, Vec3>, StepContacts::kCapacity> impulse;  ///< N s over mass
  int count = 0;
  bool rolls = false;   ///< onto a vertex that was none of these, in any contact step since the first
  bool wedged = false;  ///< between planes that look against each other
  Vec3 find(const TouchingPoint& point, const Shape& shape) const {
    for (int i = 0; i < count; ++i)
      if (impulse[std::size_t(i)].first.stands_for(point, shape)) return impulse[std::size_t(i)].second;
    return Vec3::Zero();
  }
};

/// Of a point with a plane. `rotation`: body axes to the world's.
GroundContact point_contact(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                            const Mat3& rotation, const TouchingPoint& point, const HalfSpace& plane);

/// Over R: of a body that does not touch a face yet, those vertices strike it first that are no farther from
/// it than so beyond the nearest. Of all that may strike within a step only the outermost are looked at,
/// which may leave out one of two in front: the other alone would tilt the body.
inline constexpr double kFront = 1e-3;

/// Calls `visit(contact, normal in body axes)` for the vertices of `body` that may meet `plane` within `time`
/// seconds, and those that are nearer to it than `least_margin` m; where none is as near, for those in front.
/// Gravity has been given to it.
template <class Visit>
void visit_vertices_near(const HalfSpace& plane, StatisticalBody& body, const Shape& shape,
                         const OnGround& on, double time, double least_margin, const Visit& visit) {
  const double height = plane.height_of(body.position), drop = body.velocity.dot(plane.normal) * time;
  // What the ground gives one point may turn another down as fast as the body fell.
  const double fall = std::max(0.0, -drop), margin = least_margin + fall;
  const Vec3 normal = on.rotation.transpose() * plane.normal;
  const GapChange change{drop, normal.cross(on.motion.angular_velocity) * time};
  const double reach = margin + fall + change.of_arm.norm() * shape.radius;
  if (height > shape.radius + margin + fall) return;  // however it turns: see GroundSeeker::may_turn_into
  const double first =
      find_lowest_point(shape, body.orientation, plane.normal, height, body.support_hint).gap;
  const HullContacts low = first > least_margin
                               ? find_hull_contacts(shape, body.orientation, plane.normal, height,
                                                    first + kFront * shape.radius, body.support_hint)
                               : find_hull_contacts(shape, body.orientation, plane.normal, height, margin,
                                                    body.support_hint, change);
  for (const HullContact& contact : std::span(low.contact).first(std::size_t(low.count)))
    if (contact.gap <= reach) visit(contact, normal);
}

/// For a body that gravity has been given to.
void find_step_contacts(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                        const OnGround& on, double time, double least_margin, const HeldPoints& held,
                        StepContacts& found);

/// With what the contacts gave, `on` being the motion then: the vertex that has sunk in deepest by the step's
/// end, if it is none of those found, and those next to it on the hull that have, too. A round surface rolls
/// onto them: held as they are, they raise the body by its motion, where a lift out of the ground would add
/// energy. Returns how many.
int add_sinking(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world, const OnGround& on,
                double time, StepContacts& found);

}  // namespace lodestone
