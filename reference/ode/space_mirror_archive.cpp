// Of SpaceMirror: how a snapshot's reader finds the geoms again that were there when it was written.
#include <algorithm>

#include "reference/ode/geometry_ode.h"
#include "reference/ode/space_mirror_ode.h"
#include "reference/state_archive.h"

namespace lodestone {

using namespace ode;

namespace {

constexpr double kPutBack = 1e-9;  // m: a caller puts his geoms back to within this

}  // namespace

GeomPlace SpaceMirror::place_of(std::uint32_t slot) const {
  const MirroredGeom& geom = impl_->geoms[slot];
  return {geom.position, geom.bounds.min(), geom.bounds.max(), geom.body != nullptr};
}

std::optional<std::uint32_t> SpaceMirror::find_at(const GeomPlace& place,
                                                  std::span<const std::uint32_t> but) const {
  const auto alike = [](const Vec3& a, const Vec3& b) {  // to rounding, and where both are without end
    return (a.array() == b.array() || (a - b).array().abs() <= kPutBack).all();
  };
  for (std::uint32_t slot = 0; slot < impl_->geoms.size(); ++slot) {
    const MirroredGeom& geom = impl_->geoms[slot];
    if (geom.geom && (geom.body != nullptr) == place.has_body && alike(geom.position, place.position) &&
        alike(geom.bounds.min(), place.low) && alike(geom.bounds.max(), place.high) &&
        std::ranges::find(but, slot) == but.end())
      return slot;
  }
  return std::nullopt;
}

void SpaceMirror::archive(StateArchive& a) {
  struct Course {
    GeomPlace at, from;
    Quat turned_from = Quat::Identity();
  };
  std::vector<Course> courses;
  std::vector<Sighting> sightings;
  std::vector<MirroredGeom>& geoms = impl_->geoms;
  if (!a.reading()) sightings = impl_->find_sightings(*this);
  for (const std::uint32_t slot : impl_->moved) {
    const MirroredGeom& geom = geoms[slot];
    if (!geom.body)
      courses.push_back({place_of(slot),
                         {geom.previous_position, geom.previous_bounds.min(), geom.previous_bounds.max()},
                         geom.previous_orientation});
  }
  a(courses, sightings);
  if (!a.reading()) return;
  impl_->moved.clear();
  for (const Course& course : courses) {
    const std::optional<std::uint32_t> slot = find_at(course.at, impl_->moved);
    if (!slot) continue;
    impl_->moved.push_back(*slot);
    geoms[*slot].previous_position = course.from.position,
    geoms[*slot].previous_orientation = course.turned_from,
    geoms[*slot].previous_bounds = {course.from.low, course.from.high};
  }
  std::vector<std::uint32_t> taken;
  for (const Sighting& sighting : sightings)
    if (const std::optional<std::uint32_t> slot = find_at(sighting.now, taken)) {
      taken.push_back(*slot);
      impl_->take(sighting, *slot);
    }
  std::ranges::sort(impl_->moved);
}

// Of those that the space has still: of the others the caller may have destroyed any.
std::vector<Sighting> SpaceMirror::Impl::find_sightings(const SpaceMirror& self) const {
  std::vector<std::uint32_t> there;
  self.find_bodied_now(there);
  std::vector<Sighting> found;
  for (const std::uint32_t slot : there) {
    const MirroredGeom& geom = geoms[slot];
    const std::size_t place = place_in_bodied(slot);
    const GeomPose now = geom_pose_of(geom.geom, true);
    const bool has_moved = std::ranges::binary_search(moved, slot);
    if (!has_moved && now == known[slot].pose) continue;
    const Eigen::AlignedBox3d bounds = bounding_box_of(now.bounds);
    found.push_back({.now = {to_vec3(now.position.data()), bounds.min(), bounds.max(), true},
                     .pose = known[slot].pose,
                     .orientation = geom.orientation,
                     .from = {geom.previous_position, geom.previous_bounds.min(), geom.previous_bounds.max()},
                     .turned_from = geom.previous_orientation,
                     .last_way = geom.last_way,
                     .followed = {Vec3::Zero(), followed[place].min(), followed[place].max()},
                     .has_moved = has_moved});
  }
  return found;
}

// The next refresh is to find it moved from there.
void SpaceMirror::Impl::take(const Sighting& sighting, std::uint32_t slot) {
  MirroredGeom& geom = geoms[slot];
  known[slot].pose = sighting.pose;
  ++order[last_seen[slot].place].print;
  geom.position = to_vec3(sighting.pose.position.data()), geom.orientation = sighting.orientation,
  geom.bounds = bounding_box_of(sighting.pose.bounds);
  geom.previous_position = sighting.from.position, geom.previous_orientation = sighting.turned_from,
  geom.previous_bounds = {sighting.from.low, sighting.from.high};
  geom.last_way = sighting.last_way;
  followed[place_in_bodied(slot)] = {sighting.followed.low, sighting.followed.high};
  if (sighting.has_moved) moved.push_back(slot);
}

}  // namespace lodestone
