// What is seen of a scene's changes of rung as its camera flies: moves in pixels of the picture, overlap
// where a body becomes full, energy.
#pragma once

#include "scenes/runner.h"

namespace lodestone {

/// Of bodies in the picture of the scene's first viewpoint, in one step: how far each is from where any
/// velocity between those before and after the step would have taken it (distance_beyond), and its angular
/// velocity's turn likewise times the radius of its bounding sphere: the sum, pixels.
struct MovesBeyondMotion {
  std::int64_t moves = 0;
  double p50_px = 0, p99_px = 0, max_px = 0;
  double within_pixel = 1;  ///< part of them that are at most 1 px
};

/// Over the body's size, where it became full, as it was then.
struct OverlapsAtPromotion {
  std::int64_t promotions = 0;
  double p50 = 0, p99 = 0, max = 0;
};

struct TransitionFigures {
  std::int64_t changes = 0;         ///< of rung, of bodies that had one
  MovesBeyondMotion changed;        ///< in the step of the change
  MovesBeyondMotion others;         ///< of bodies awake, full or at `support`, that did not change
  OverlapsAtPromotion with_bodies;  ///< hulls, or convex pieces where a body has them
  /// Planes and boxes; of meshes, vertices of the hull below the highest surface there.
  OverlapsAtPromotion with_ground;
  // Kinetic and potential energy, after the step of the change beyond that before, of changed bodies together
  // with what they may have met.
  double gained_j = 0;  ///< where there was more
  double net_j = 0;     ///< of all
  double scene_j = 0;   ///< that the scene loses over the run
};

inline constexpr double kMostOverlap = 0.05, kMostGain = 1e-3;  // over the size; over the scene's energy

/// 99 % of the changes within a pixel, no promotion in an overlap above kMostOverlap, gained_j at most
/// kMostGain of scene_j.
bool is_unseen(const TransitionFigures& figures);

/// Runs `scene` and looks at each step that begins at `from_s` or later. Throws InputError where the scene
/// has no viewpoint, or as run_scene does.
TransitionFigures bench_transitions(const Scene& scene, RunSettings settings, double from_s);

}  // namespace lodestone
