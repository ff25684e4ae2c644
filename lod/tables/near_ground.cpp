#include "lod/tables/near_ground.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "lod/contact/hull_contacts.h"

namespace lodestone {
namespace {

// Who is over a wall's near side is not within the wall, though its far side be nearer than a solid that is
// let into it is deep.
void drop_far_sides(std::vector<GroundNear>& near) {
  constexpr double kAgainst = -0.7;  // cosine
  const auto is_far_side = [&](const GroundNear& far) {
    return far.height < 0.0 && std::ranges::any_of(near, [&](const GroundNear& side) {
             return !side.at_edge && side.part == far.part && side.height >= 0.0 &&
                    side.height < -far.height && side.normal.dot(far.normal) < kAgainst;
           });
  };
  if (std::ranges::none_of(near, [](const GroundNear& n) { return n.height < 0.0; })) return;
  thread_local std::vector<GroundNear> kept;
  kept.clear();
  std::ranges::remove_copy_if(near, std::back_inserter(kept), is_far_side);
  near.assign(kept.begin(), kept.end());
}

}  // namespace

void NearGround::begin_step() {
  planes_.clear(kinds_.size());
  for (const HalfSpace& plane : ground_.planes()) planes_.add(plane, materials_, kinds_, settings_.gravity);
  faces_.clear(), near_.clear(), cornered_.clear(), carried_.clear();
}

void NearGround::find_near(std::int64_t begin, std::int64_t end, Simd simd) {
  for (std::size_t p = 0; p < ground_.planes().size(); ++p)
    find_near_ground(spheres_, kinds_, planes_, ground_.planes()[p], std::int32_t(p), constants_, simd, begin,
                     end, step_);
  const auto first = std::ranges::lower_bound(near_, begin, {}, &Near::place);
  for (auto near = first; near != near_.end() && near->place < end; ++near)
    for (std::int32_t face = near->begin; face < near->end; ++face)
      find_near_ground(spheres_, kinds_, planes_, faces_[std::size_t(face)],
                       std::int32_t(ground_.planes().size()) + face, constants_, Simd::portable, near->place,
                       near->place + 1, step_);
}

double NearGround::reach_of(std::int64_t place, double speed) const {
  constexpr double kMargin = 1.01;
  const double time = constants_.wide_time;
  return kMargin * double(kinds_.radius[spheres_.kind[std::size_t(place)]]) + speed * time +
         0.5 * settings_.gravity.norm() * time * time;
}

void NearGround::find_faces(std::int64_t begin, std::int64_t end, const JobRunner& jobs) {
  if (!ground_.has_parts()) return;
  const std::int64_t count = end - begin;
  find_on_ground(ground_, jobs, make_ground(begin, end), count, looks_,
                 [&](std::int64_t i, Look& found) { look_below(begin + i, found); });
  for (std::int64_t first = 0; first < count; first += kBodiesOfAPiece)
    take(looks_[std::size_t(first / kBodiesOfAPiece)]);
}

// All that the spheres may come near, as they look for it. Whether some of it is known by rays.
bool NearGround::make_ground(std::int64_t begin, std::int64_t end) const {
  constexpr double kMost = 2.0;  // over what one looks for
  bool by_rays = false;
  for (std::int64_t i = begin; i < end; ++i)
    by_rays |= ground_.make_near(spheres_.position(i), kMost * reach_of(i, farthest_speed(i)));
  return by_rays;
}

// m/s, of any of its points.
double NearGround::farthest_speed(std::int64_t place) const {
  const Shape& shape = *scene_.kind_of(place).shape;
  return spheres_.velocity(place).norm() +
         shape.radius * angular_velocity(spheres_.orientation(place), spheres_.spin(place), shape).norm();
}

void NearGround::look_below(std::int64_t place, Look& found) const {
  thread_local std::vector<GroundNear> near;
  near.clear();
  const double reach = reach_of(place, spheres_.velocity(place).norm());
  const Vec3 center = spheres_.position(place);
  const std::size_t first = found.faces.size();
  const bool alone = scene_.is_alone(place), only_planes = alone && find_planes_of(place, found.faces);
  const PairBody hull{scene_.kind_of(place).shape.get(), center, spheres_.orientation(place)};
  if (!only_planes) find_ground_near(ground_, center, reach, 0.0, near, constants_.hulls ? &hull : nullptr);
  drop_far_sides(near);
  const bool bridges = !alone && find_bridged_plane(place, near, found.faces);
  if (bridges) near.clear();
  for (const GroundNear& n : near) found.faces.push_back(n.plane(center));
  const bool by_hull = alone && !only_planes;
  if (found.faces.size() == first && !by_hull) return;
  for (std::size_t face = first; face < found.faces.size(); ++face)
    found.parts.push_back(only_planes || bridges ? nullptr : near[face - first].part);
  const double margin = reach - double(kinds_.radius[spheres_.kind[std::size_t(place)]]);
  const bool cornered = by_hull || (!bridges && is_in_corner(place, near, margin));
  const bool above = std::ranges::none_of(near, [](const GroundNear& n) { return n.part->moves(); }) &&
                     std::all_of(found.faces.begin() + std::ptrdiff_t(first), found.faces.end(),
                                 [&](const HalfSpace& face) { return face.height_of(center) >= 0.0; });
  found.near.push_back(
      {place, std::int32_t(first), std::int32_t(found.faces.size()), only_planes, cornered, above});
  const auto mover = std::ranges::find_if(near, [&](const GroundNear& n) {
    return n.part->moves() && n.height < double(spheres_.radius[std::size_t(place)]) + margin;
  });
  if (mover != near.end())
    found.carried.push_back({place, mover->part->carrying_velocity(center, constants_.wide_time),
                             mover->part->pose.angular_velocity});
}

void NearGround::take(const Look& found) {
  const auto before = std::int32_t(faces_.size());
  for (const Near& near : found.near) {
    near_.push_back(near);
    near_.back().begin += before, near_.back().end += before;
    if (near.cornered) cornered_.push_back(spheres_.slot[std::size_t(near.place)]);
    const Vec3 center = spheres_.position(near.place);
    for (auto face = std::size_t(near.begin); face < std::size_t(near.end); ++face) {
      const GroundPart* part = found.parts[face];
      planes_.add(found.faces[face], materials_, kinds_, settings_.gravity,
                  part ? part->carrying_velocity(center, constants_.wide_time) : Vec3(Vec3::Zero()),
                  part ? part->pose.angular_velocity : Vec3(Vec3::Zero()));
    }
  }
  faces_.insert(faces_.end(), found.faces.begin(), found.faces.end());
  carried_.insert(carried_.end(), found.carried.begin(), found.carried.end());
}

// Where nothing is straight below a body, but parts of the ground on different sides of it are under its
// hull, as under a plank on two blocks, the plane that they hold it by. False: there is none.
bool NearGround::find_bridged_plane(std::int64_t place, std::span<const GroundNear> near,
                                    std::vector<HalfSpace>& faces) const {
  constexpr double kUpright = 0.98;  // cosine, of what holds it
  constexpr double kFlat = 0.3;  // over R: what reaches down so far is not looked at, since that takes long
  const BodyKind& kind = scene_.kind_of(place);
  const double strength = settings_.gravity.norm();
  if (!constants_.hulls || strength == 0.0 || kind.shape->sphere_radius) return false;
  const Vec3 up = -settings_.gravity / strength, u = up.unitOrthogonal(), v = up.cross(u);
  const auto is_below = [&](const GroundNear& n) { return !n.at_edge && n.normal.dot(up) > kUpright; };
  if (std::ranges::any_of(near, is_below)) return false;
  if (double(scene_.ground_height(place, -up)) > kFlat * kind.shape->radius) return false;
  const StatisticalBody body = spheres_.body(place);
  thread_local std::vector<SolidContact> contacts;
  contacts.clear();
  const std::size_t before = faces.size();
  find_solid_contacts(body, kind, spheres_.slot[std::size_t(place)], ground_, 0.0, constants_.wide_time,
                      contacts, faces, SolidSearch::all);
  faces.resize(before);
  std::erase_if(contacts, [&](const SolidContact& c) {
    return c.part->moves() || c.contact.normal.dot(up) < kUpright;
  });
  thread_local std::vector<double> ways;  // rad, to where it is held
  ways.clear();
  double gap = 1e300;  // m
  Vec3 normal = Vec3::Zero();
  for (const SolidContact& c : contacts) {
    gap = std::min(gap, c.contact.gap), normal += c.contact.normal;
    for (const ManifoldPoint& p :
         std::span(c.contact.manifold.points).first(std::size_t(c.contact.manifold.count)))
      ways.push_back(std::atan2((p.point - body.position).dot(v), (p.point - body.position).dot(u)));
  }
  std::ranges::sort(ways);
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double next = i + 1 < ways.size() ? ways[i + 1] : ways[0] + 2.0 * std::numbers::pi;
    if (next - ways[i] >= std::numbers::pi) return false;  // its middle is beyond all of these
  }
  if (ways.size() < 3) return false;
  normal.normalize();
  // Over it the map of its heights, which is coarse, is to tell that gap.
  const double height = double(scene_.ground_height(place, -normal)) + gap;
  faces.push_back({normal, normal.dot(body.position) - height, contacts.front().part->material,
                   contacts.front().part->id});
  return true;
}

// Among others, of what is nearer than it reaches, `margin` m around. A published sphere meets one plane; one
// that knows its hull meets as many as there are, but over edges its hull tips as long as it moves, and what
// moves holds it.
bool NearGround::is_in_corner(std::int64_t place, std::span<const GroundNear> near, double margin) const {
  const auto is_held = [&] {
    return is_held_several_ways(near, ground_.planes(), spheres_.position(place),
                                double(spheres_.radius[std::size_t(place)]) + margin);
  };
  if (!constants_.hulls) return is_held();
  const auto is_over_edge = [&](const GroundNear& n) {
    return n.at_edge && n.height <= double(scene_.ground_height(place, -n.normal)) + margin;
  };
  if (std::ranges::any_of(near, is_over_edge) &&
      !scene_.is_nearly_still(spheres_.body(place), scene_.kind_of(place), true))
    return true;
  return std::ranges::any_of(near, [](const GroundNear& n) { return n.part->moves(); }) && is_held();
}

// Of one that may stand on its hull. Who stands does until an edge is near, who does not waits until it is
// farther away: else one at rest there would go on to change.
bool NearGround::find_planes_of(std::int64_t place, std::vector<HalfSpace>& faces) const {
  constexpr double kSlack = 0.1;  // over R
  const BodyKind& kind = scene_.kind_of(place);
  const double slack =
      spheres_.on_hull[std::size_t(place)] == HullStand::none ? kSlack * kind.shape->radius : 0.0;
  return find_planes_below(spheres_.body(place), kind, ground_, slack, constants_.wide_time, faces);
}

const NearGround::Near* NearGround::find(std::int64_t place) const {
  const auto near = std::ranges::lower_bound(near_, place, {}, &Near::place);
  return near == near_.end() || near->place != place ? nullptr : &*near;
}

std::span<const HalfSpace> NearGround::planes_of(std::int64_t place) const {
  const Near* near = find(place);
  if (!near) return join_planes(ground_.planes(), {});
  return join_planes(ground_.planes(), std::span(faces_).subspan(std::size_t(near->begin),
                                                                 std::size_t(near->end - near->begin)));
}

bool NearGround::is_even(std::int64_t place) const {
  const Near* near = find(place);
  return !near || near->even;
}

bool NearGround::is_cornered(std::int64_t place) const {
  const Near* near = find(place);
  return near && near->cornered;
}

const NearGround::Carried* NearGround::carrying(std::int64_t place) const {
  const auto carried = std::ranges::lower_bound(carried_, place, {}, &Carried::place);
  return carried == carried_.end() || carried->place != place ? nullptr : &*carried;
}

Vec3 NearGround::above_faces(std::int64_t place, const Vec3& way) const {
  const Vec3 center = spheres_.position(place);
  Vec3 out = way;
  for (const HalfSpace& plane : planes_of(place)) {
    const double height = plane.height_of(center);
    if (height < 0.0) continue;  // on its other side
    const double gap = height - double(scene_.ground_height(place, -plane.normal)),
                 into = -out.dot(plane.normal) - std::max(0.0, gap);
    if (into > 0.0) out += into * plane.normal;
  }
  return out;
}

std::int32_t NearGround::nearest_face(std::int64_t place) const {
  const Near& near = *find(place);
  const auto begin = faces_.begin() + near.begin, end = faces_.begin() + near.end;
  const Vec3 center = spheres_.position(place);
  const auto nearest =
      std::ranges::min_element(begin, end, {}, [&](const HalfSpace& face) { return face.height_of(center); });
  return std::int32_t(ground_.planes().size()) + std::int32_t(nearest - faces_.begin());
}

// Who follows one that strikes the ground learns of it a step later, and presses it in by up to a step's way:
// out of a half-space it would come back slowly, beyond the middle of a slab it would leave by the other
// side.
void NearGround::lift_out(std::int64_t place, const HalfSpace& plane, double lift) {
  const auto i = std::size_t(place);
  const Vec3 out = lift * plane.normal;
  Vec3 velocity = spheres_.velocity(place);
  velocity += std::max(0.0, -velocity.dot(plane.normal)) * plane.normal;
  // What that lifts it by it pays for, as far as it can.
  const double squared = velocity.squaredNorm(), price = -2.0 * settings_.gravity.dot(out);
  if (price > 0.0 && squared > 0.0) velocity *= std::sqrt(std::max(0.0, 1.0 - price / squared));
  spheres_.x[i] += out.x(), spheres_.y[i] += out.y(), spheres_.z[i] += out.z();
  spheres_.vx[i] = velocity.x(), spheres_.vy[i] = velocity.y(), spheres_.vz[i] = velocity.z();
}

// Its hull, but for what contacts undo themselves. What somebody brought from another rung goes slowly.
void NearGround::keep_above_planes(std::int64_t begin, std::int64_t end) {
  constexpr double kDeepest = 0.1;  // over R
  if (!constants_.hulls) return;
  for (const HalfSpace& plane : ground_.planes())
    for (std::int64_t i = begin; i < end; ++i) {
      if (!step_.touches(i) || spheres_.eased[std::size_t(i)] != 0) continue;
      const double radius = double(kinds_.radius[spheres_.kind[std::size_t(i)]]),
                   height = plane.height_of(spheres_.position(i));
      if (height >= (1.0 - kDeepest) * radius) continue;
      const double least = std::max(least_height(*scene_.kind_of(i).shape),
                                    double(scene_.ground_height(i, -plane.normal)) - kDeepest * radius);
      if (height < least) lift_out(i, plane, least - height);
    }
}

void NearGround::keep_above_faces() {
  for (const Near& near : near_) {
    if (!near.above || near.place >= spheres_.awake || !step_.touches(near.place)) continue;
    const double least = least_height(*scene_.kind_of(near.place).shape);
    for (std::int32_t face = near.begin; face < near.end; ++face) {
      const HalfSpace& plane = faces_[std::size_t(face)];
      const double height = plane.height_of(spheres_.position(near.place));
      if (height < least) lift_out(near.place, plane, least - height);
    }
  }
}

}  // namespace lodestone
