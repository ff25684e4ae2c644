#include "lod/tables/sphere_kinds.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "lod/tables/tables_model.h"

namespace lodestone {
namespace {

// How far a hull reaches over how thick it is: what is nearly a ball, up to 1.3, rolls; a cube, 1.7, and a
// box of 2 : 3 : 4, 2.7, tip slowly; a regular tetrahedron, 3, a coin and a beam, 10, at full rate. Compact
// bodies that do not fill their hulls, such as a bunny, do not tip: they count as smaller, and heap up low
// enough.
struct Reach {
  float from, to;
};
constexpr Reach kRolls{1.3f, 1.55f}, kLong{2.75f, 3.0f};
constexpr float kCompactRate = 0.35f;  // over the full one
// In standard deviations of the corners that two patches have in common. To hold the upper of two equal faces
// as long as its centre of mass is over the lower takes .71; with no more heaps come to rest late. What is
// long or flat lands on its edges, and falls over those before its pressure is even.
constexpr float kPatchReach = 1.73f;
// Over R: the work that tipping has on credit, of what is compact and of what is long or flat.
constexpr float kCompactCredit = 0.25f, kLongCredit = 0.6f;

float share_of_reach(float reach, const Reach& of) {
  return std::clamp((reach - of.from) / (of.to - of.from), 0.0f, 1.0f);
}

}  // namespace

void SphereKinds::take(const Kinds& kinds, std::uint32_t number, double gravity) {
  if (size() < kinds.size()) resize(kinds.size());
  if (birth_[number] == kinds.birth(number)) return;
  birth_[number] = kinds.birth(number);
  const BodyKind& kind = kinds[number];
  Known& known = known_[number];
  const HullSamplesKey samples{kind.shape->content_hash, kind.shape->radius, kind.faces != nullptr};
  if (known.shape.lock() == kind.shape && known.signature.lock() == kind.signature &&
      known.material == kind.material && known.samples == samples)
    return set_blend_time(number, kind, gravity);
  if (known.samples != samples) {
    if (known.samples.radius > 0.0) samples_.keep(known.samples, samples_of(number));
    if (const HullSamples* kept = samples_.find(samples))
      set_samples(number, *kept);
    else
      set_samples(number, make_hull_samples(*kind.shape, kind.faces.get()));
  }
  known = {kind.shape, kind.signature, kind.material, samples};
  set(number, kind, gravity);
}

namespace {

// Of the maps of all kinds, that of one.
auto map_of(auto& maps, std::uint32_t k) {
  return std::span(maps).subspan(k * std::size_t(kHullHeights), kHullHeights);
}

}  // namespace

void SphereKinds::set_samples(std::uint32_t k, const HullSamples& samples) {
  std::ranges::copy(samples.height, map_of(hull_height, k).begin());
  std::ranges::copy(samples.pair_height, map_of(pair_height, k).begin());
  std::ranges::copy(samples.unsteady, map_of(unsteady, k).begin());
  std::ranges::copy(samples.patch, map_of(patch, k).begin());
  std::ranges::copy(samples.pair_face, map_of(pair_face, k).begin());
  const Mat3& levers = samples.rolling_levers;
  rxx[k] = float(levers(0, 0)), ryy[k] = float(levers(1, 1)), rzz[k] = float(levers(2, 2));
  rxy[k] = float(levers(0, 1)), rxz[k] = float(levers(0, 2)), ryz[k] = float(levers(1, 2));
}

HullSamples SphereKinds::samples_of(std::uint32_t k) const {
  const auto copy_of = [&](const auto& maps) {
    const auto map = map_of(maps, k);
    return std::vector(map.begin(), map.end());
  };
  Mat3 levers;
  levers << rxx[k], rxy[k], rxz[k], rxy[k], ryy[k], ryz[k], rxz[k], ryz[k], rzz[k];
  return {copy_of(hull_height), copy_of(pair_height), copy_of(unsteady),
          copy_of(patch),       copy_of(pair_face),   levers};
}

void SphereKinds::set_gravity(const Kinds& kinds, double gravity) {
  for (std::uint32_t k = 0; k < size(); ++k)
    if (birth_[k] != 0 && birth_[k] == kinds.birth(k) && kinds[k].shape) set_blend_time(k, kinds[k], gravity);
}

void SphereKinds::forget() { std::ranges::fill(birth_, 0); }

void SphereKinds::set_blend_time(std::uint32_t k, const BodyKind& kind, double gravity) {
  blend_time[k] =
      float(TablesSettings{}.blend_time * std::sqrt(kind.shape->radius / std::max(1e-9, gravity)));
}

void SphereKinds::take_friction(const Kinds& kinds, const MaterialTable& materials) {
  for (std::uint32_t k = 0; k < size(); ++k) {
    if (birth_[k] == 0 || birth_[k] != kinds.birth(k)) continue;
    const MaterialId own = kinds[k].material;
    own_friction[k] = float(materials.law(own, own).friction);
  }
}

void SphereKinds::resize(std::size_t size) {
  for (auto* array : {&radius,      &ixx, &iyy, &izz, &ixy, &ixz, &iyz,
                      &jxx,         &jyy, &jzz, &jxy, &jxz, &jyz, &softest,
                      &gxx,         &gyy, &gzz, &gxy, &gxz, &gyz, &farthest_reach,
                      &rxx,         &ryy, &rzz, &rxy, &rxz, &ryz, &blend_time,
                      &own_friction})
    array->resize(size, 1.0f);
  tips.resize(size, 0.0f), tipping_work.resize(size), patch_reach.resize(size), thickness.resize(size);
  height.resize(size * (kHeightSamples + 1));
  pair_height.resize(size * std::size_t(kHullHeights));
  pair_face.resize(size * std::size_t(kHullHeights));
  unsteady.resize(size * std::size_t(kHullHeights));
  patch.resize(size * std::size_t(kHullHeights));
  hull_height.resize(size * std::size_t(kHullHeights));
  material.resize(size), first_pose.resize(size), birth_.resize(size), pose_room_.resize(size),
      known_.resize(size), is_slender_.resize(size), is_ball_.resize(size);
}

void SphereKinds::set(std::uint32_t k, const BodyKind& kind, double gravity) {
  const Shape& shape = *kind.shape;
  const Mat3& inverse = shape.inverse_inertia_per_mass;
  const Mat3& inertia = shape.inertia_per_mass;
  slender_ -= is_slender_[k];
  is_slender_[k] = is_slender(kind);
  slender_ += is_slender_[k];
  balls_ -= is_ball_[k];
  is_ball_[k] = kind.shape->sphere_radius.has_value();
  balls_ += is_ball_[k];
  material[k] = kind.material;
  radius[k] = float(shape.radius);
  ixx[k] = float(inverse(0, 0)), iyy[k] = float(inverse(1, 1)), izz[k] = float(inverse(2, 2));
  ixy[k] = float(inverse(0, 1)), ixz[k] = float(inverse(0, 2)), iyz[k] = float(inverse(1, 2));
  jxx[k] = float(inertia(0, 0)), jyy[k] = float(inertia(1, 1)), jzz[k] = float(inertia(2, 2));
  jxy[k] = float(inertia(0, 1)), jxz[k] = float(inertia(0, 2)), jyz[k] = float(inertia(1, 2));
  softest[k] = float(find_principal_moments(inverse).maxCoeff());
  const auto height_at = [&](int sample) {
    if (!kind.signature || kind.signature->collision_heights.mean.empty()) return 1.0;
    const double alpha = std::numbers::pi / 2 * std::min(sample, kHeightSamples - 1) / (kHeightSamples - 1);
    return find_collision_height(kind.signature->collision_heights, alpha).mean;
  };
  for (int i = 0; i <= kHeightSamples; ++i)
    height[k * std::size_t(kHeightSamples + 1) + std::size_t(i)] = float(height_at(i) * shape.radius);
  const Mat3 give = Eigen::SelfAdjointEigenSolver<Mat3>(3.0 * inertia).operatorInverseSqrt();
  gxx[k] = float(give(0, 0)), gyy[k] = float(give(1, 1)), gzz[k] = float(give(2, 2));
  gxy[k] = float(give(0, 1)), gxz[k] = float(give(0, 2)), gyz[k] = float(give(1, 2));
  const auto [thin, far] = std::ranges::minmax(map_of(hull_height, k));
  tipping_ -= tips[k] > 0.0f;
  const float reach = far / thin;
  const float length = share_of_reach(reach, kLong);
  const float convex_rate = share_of_reach(reach, kRolls) * std::lerp(kCompactRate, 1.0f, length);
  tips[k] = shape.sphere_radius ? 0.0f : shape.convex ? convex_rate : length;
  tipping_work[k] = std::lerp(kCompactCredit, kLongCredit, length) * radius[k];
  patch_reach[k] = kPatchReach * (1.0f - length);
  thickness[k] = thin / far;
  tipping_ += tips[k] > 0.0f;
  farthest_reach[k] = std::ranges::max(map_of(pair_height, k));
  most_reach = std::max({most_reach, farthest_reach[k], radius[k]});
  set_blend_time(k, kind, gravity);
  set_poses(k, kind);
}

// Where the poses of the number's last kind were, if they fit there.
void SphereKinds::set_poses(std::uint32_t k, const BodyKind& kind) {
  const std::vector<RestPose> none = {{.normal = Vec3::UnitZ(), .height = 1.0}};
  const auto& poses =
      kind.signature && !kind.signature->rest_poses.empty() ? kind.signature->rest_poses : none;
  const auto count = std::int32_t(poses.size());
  if (count > pose_room_[k]) {
    first_pose[k] = std::int32_t(pose_height.size());
    pose_room_[k] = count;
    for (auto* array : {&pose_height, &pose_x, &pose_y, &pose_z}) array->resize(array->size() + poses.size());
  }
  auto at = std::size_t(first_pose[k]);
  for (const RestPose& pose : poses) {
    pose_height[at] = float(pose.height * kind.shape->radius);
    pose_x[at] = float(pose.normal.x()), pose_y[at] = float(pose.normal.y()),
    pose_z[at] = float(pose.normal.z());
    ++at;
  }
}

}  // namespace lodestone
