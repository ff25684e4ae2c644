// What bodies of a kind share, as floats in dense arrays for the loops over bodies.
#pragma once

#include <cmath>
#include <vector>

#include "lod/statistical/kinds.h"
#include "lod/tables/hull_samples.h"

namespace lodestone {

inline constexpr int kHeightSamples = 64;  // of the collision height over α, resampled evenly from 0 to π/2

struct SphereKinds {
  std::vector<MaterialId> material;
  std::vector<float> radius;                        // m
  std::vector<float> ixx, iyy, izz, ixy, ixz, iyz;  // inverse inertia over mass, body axes, 1/m²
  std::vector<float> jxx, jyy, jzz, jxy, jxz, jyz;  // inertia over mass, m²
  std::vector<float> softest;                       // its greatest eigenvalue, 1/m²
  std::vector<float> height;  // kHeightSamples + 1 a kind, m, one more to read beyond the end
  std::vector<float> hull_height, pair_height;      // kHullHeights a kind, m: HullMaps
  std::vector<lane::Row> pair_face;                 // as many
  std::vector<float> unsteady;                      // as many: 0 where it stands firmly on that face, else 1
  std::vector<SupportPatch> patch;                  // as many
  std::vector<float> tips;                          // 0 to 1: whether it tips over (tipping.h)
  std::vector<float> tipping_work;                  // m: of its weight, what tipping may take beyond its fall
  std::vector<float> patch_reach;                   // standard deviations: how far pressure goes in a patch
  std::vector<float> thickness;                     // over its reach, of the hull where it is thinnest
  std::vector<float> gxx, gyy, gzz, gxy, gxz, gyz;  // 1/m, body axes: one over how far it reaches beside an
                                                    // axis, as a rod with its inertia would
  std::vector<float> farthest_reach;                // m, of pair_height
  float most_reach = 0.0f;                          // m: no kind's was ever farther, nor its sphere's
  std::vector<float> own_friction;                  // coefficient, of two bodies of the kind, in this step
  std::vector<float> rxx, ryy, rzz, rxy, rxz, ryz;  // m², body axes: find_rolling_levers()
  std::vector<float> blend_time;                    // s, of the approach to a rest pose
  std::vector<std::int32_t> first_pose;             // of the kind's rest poses in the next ones
  std::vector<float> pose_height, pose_x, pose_y, pose_z;  // m; normal in body axes; at least one pose a kind

  /// Whether the midpoint rule would feed energy into its spin.
  static bool is_slender(const BodyKind& kind) {
    return kind.inverse_moments[2] > 20.0 * kind.inverse_moments[0];
  }
  /// Takes in a kind, unless it is known; m/s².
  void take(const Kinds& kinds, std::uint32_t kind, double gravity);
  /// m/s², of all that are known from now on.
  void set_gravity(const Kinds& kinds, double gravity);
  /// None is known any more. Those that are taken in anew as they were are taken in fast.
  void forget();
  /// Of each kind that a body has; materials may be changed between steps.
  void take_friction(const Kinds& kinds, const MaterialTable& materials);
  std::size_t size() const { return radius.size(); }
  /// Whether there are kinds that tip over.
  bool any_tips() const { return tipping_ > 0; }
  /// Whether there are balls, which are spheres to each other and in truth.
  bool any_balls() const { return balls_ > 0; }
  bool is_ball(std::uint32_t kind) const { return is_ball_[kind] != 0; }
  /// m, of rolling resistance about whatever axis.
  float mean_rolling_lever(std::uint32_t k) const { return std::sqrt((rxx[k] + ryy[k] + rzz[k]) / 3.0f); }
  /// Whether there are kinds whose free rotation takes more than the loops' midpoint rule.
  bool any_slender() const { return slender_ > 0; }

 private:
  void resize(std::size_t size);
  void set(std::uint32_t k, const BodyKind& kind, double gravity);
  void set_samples(std::uint32_t k, const HullSamples& samples);
  HullSamples samples_of(std::uint32_t k) const;
  void set_blend_time(std::uint32_t k, const BodyKind& kind, double gravity);
  void set_poses(std::uint32_t k, const BodyKind& kind);

  HullSampleStore samples_;  // of those whose numbers others have
  // As the number was taken in last.
  struct Known {
    std::weak_ptr<const Shape> shape;
    std::weak_ptr<const Signature> signature;
    MaterialId material = 0;
    HullSamplesKey samples;
  };
  std::vector<Known> known_;
  std::vector<std::uint64_t> birth_;     // of the kind that has the number; 0: of none yet
  std::vector<std::int32_t> pose_room_;  // poses that fit where its own are
  std::vector<std::uint8_t> is_slender_, is_ball_;
  std::size_t slender_ = 0, tipping_ = 0, balls_ = 0;
};

}  // namespace lodestone
