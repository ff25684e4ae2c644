// Contacts that one contact step hands on to the next: what is due to strike where the step begins, and what
// the body stood on.
#include <algorithm>

#include "lod/support/contact_stepper.h"

namespace lodestone {
namespace {

// Planes of the ground that hold a body alike: of one geom, and looking the same way.
bool is_same(const HalfSpace& a, const HalfSpace& b) {
  constexpr double kSameWay = 0.999;  // cosine
  return a.id == b.id && a.normal.dot(b.normal) > kSameWay;
}

}  // namespace

// Finds the contacts of this step, adds those that are due or were stood on (of many vertices near the ground
// these may not have been found), and marks both.
void ContactStepper::find_contacts(const OnGround& on, double time) {
  find_step_contacts(body_, kind_, world_, on, time, settings_.contact_margin * shape_.radius, held_, found_);
  add_due(on);
  add_stood_on(on);
}

void ContactStepper::add_due(const OnGround& on) {
  for (const PointOnPlane& due : due_.get()) {
    std::size_t i = 0;
    const auto is_it = [&](std::size_t k) {
      return found_.point[k].stands_for(due.point, shape_) && is_same(*found_.plane[k], due.plane);
    };
    while (i < found_.count && !is_it(i)) ++i;
    // What was to strike a face that ends somewhere may have passed its end.
    if (i == found_.count && ends_somewhere(due.plane)) {
      i = find_moved(due.point, on);
      if (i == found_.count) continue;
    }
    if (i == found_.count) {
      const HalfSpace* plane = found_.is_full() ? nullptr : plane_of(due.plane);
      if (!plane) break;
      found_.add(point_contact(body_, kind_, world_, on.rotation, due.point, *plane), due.point, *plane);
    }
    found_.due[i] = true;
  }
  due_.count = 0;
}

// Without the vertex that it turns about a body would fall until it strikes.
void ContactStepper::add_stood_on(const OnGround& on) {
  for (const PointOnPlane& vertex : stood_on_.get()) {
    std::size_t i = 0;
    while (i < found_.count &&
           !(found_.point[i].vertex == vertex.point.vertex && is_same(*found_.plane[i], vertex.plane)))
      ++i;
    if (i == found_.count) {
      if (ends_somewhere(vertex.plane)) continue;
      GroundContact contact = point_contact(body_, kind_, world_, on.rotation, vertex.point, vertex.plane);
      if (contact.gap > touching_) continue;
      const HalfSpace* plane = found_.is_full() ? nullptr : plane_of(vertex.plane);
      if (!plane) return;
      contact.guess = on.rotation.transpose() * held_.find(vertex.point, shape_);
      found_.add(contact, vertex.point, *plane);
    }
    found_.stood_on[i] = true;
  }
}

// The world's plane that is the same, or a copy that lasts as long as the step. Null: there is no room for
// it.
const HalfSpace* ContactStepper::plane_of(const HalfSpace& plane) {
  const auto known =
      std::ranges::find_if(world_.planes, [&](const HalfSpace& p) { return is_same(p, plane); });
  return known != world_.planes.end() ? &*known : found_.keep(plane);
}

// Whether the plane is that of a face which the body may leave: it is none of the world's planes, and not
// under the whole body.
bool ContactStepper::ends_somewhere(const HalfSpace& plane) const {
  const auto same = [&](const HalfSpace& p) { return is_same(p, plane); };
  return world_.solids && std::ranges::none_of(world_.planes, same) &&
         std::ranges::none_of(found_.local.begin(), found_.local.begin() + std::ptrdiff_t(found_.under),
                              same);
}

// The index of the contact that a point has now, over whichever face: of a vertex its own; of a crossing of
// features, which travels along the body as far as that has moved, the nearest in reach. The number of
// contacts: none.
std::size_t ContactStepper::find_moved(const TouchingPoint& point, const OnGround& on) const {
  constexpr double kSame = 1e-3;  // over R
  const double way = kSame * shape_.radius + 2.0 * behind_ * on.motion.velocity_at(point.arm).norm();
  std::size_t nearest = found_.count;
  double least = way * way;
  for (std::size_t i = 0; i < found_.count; ++i) {
    if (found_.point[i].vertex != point.vertex) continue;
    if (point.vertex >= 0) return i;
    if (const double square = (found_.point[i].arm - point.arm).squaredNorm(); square < least)
      least = square, nearest = i;
  }
  return nearest;
}

}  // namespace lodestone
