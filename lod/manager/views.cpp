#include "lod/manager/views.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

double squared_to_segment(const Vec3& point, const Vec3& from, const Vec3& along) {
  const double length = along.squaredNorm(),
               t = length > 0.0 ? std::clamp((point - from).dot(along) / length, 0.0, 1.0) : 0.0;
  return (point - from - t * along).squaredNorm();
}

}  // namespace

Views::Views(std::span<const Vec3> positions) {
  for (const Vec3& position : positions) views_.push_back(view_of({.position = position}));
  if (!views_.empty()) most_weight_ = views_.front().weight;
}

Views::Views(std::span<const Viewpoint> viewpoints) {
  for (const Viewpoint& viewpoint : viewpoints) {
    views_.push_back(view_of(viewpoint));
    any_frustum_ |= !views_.back().all_around;
    most_weight_ = std::max(most_weight_, views_.back().weight);
  }
}

Views::View Views::view_of(const Viewpoint& viewpoint) {
  const double half_height = std::tan(0.5 * viewpoint.vertical_fov_rad);
  View view{.position = viewpoint.position,
            .weight = 2.0 * half_height / viewpoint.height_px,
            .all_around = !viewpoint.direction};
  if (view.all_around) return view;
  view.forward = viewpoint.direction->normalized();
  Vec3 right = view.forward.cross(viewpoint.up);
  if (right.squaredNorm() < 1e-12 * viewpoint.up.squaredNorm())
    right = view.forward.unitOrthogonal();  // it looks straight up or down
  right.normalize();
  const Vec3 up = right.cross(view.forward);
  const double half_width = viewpoint.aspect * half_height;
  const Vec3 sideways = half_width * view.forward, height = half_height * view.forward;
  view.inward = {(sideways - right).normalized(), (sideways + right).normalized(), (height - up).normalized(),
                 (height + up).normalized()};
  return view;
}

bool Views::turned_since(const Views& before) const {
  const auto same = [](View now, const View& then) { return now.position = then.position, now == then; };
  return !std::ranges::equal(views_, before.views_, same);
}

bool Views::zoomed_since(const Views& before) const {
  return !std::ranges::equal(views_, before.views_, {}, &View::weight, &View::weight);
}

double Views::squared(const Vec3& place, Measure measure) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const View& view : views_) {
    const double distance = (place - view.position).squaredNorm();
    nearest =
        std::min(nearest, measure == Measure::distance ? distance : distance * view.weight * view.weight);
  }
  return nearest;
}

double Views::squared(const Vec3& place, const Vec3& ahead, Measure measure) const {
  if (ahead.isZero(0.0)) return squared(place, measure);
  double nearest = std::numeric_limits<double>::infinity();
  for (const View& view : views_) {
    const double distance = squared_to_segment(view.position, place, ahead);
    nearest =
        std::min(nearest, measure == Measure::distance ? distance : distance * view.weight * view.weight);
  }
  return nearest;
}

// By the planes of its sides: a ball outside a corner counts as seen now and then.
bool Views::sees(const Vec3& center, double radius) const {
  return std::ranges::any_of(views_, [&](const View& view) {
    const Vec3 from = center - view.position;
    return view.all_around ||
           (from.dot(view.forward) > -radius &&
            std::ranges::all_of(view.inward, [&](const Vec3& inward) { return from.dot(inward) > -radius; }));
  });
}

}  // namespace lodestone
