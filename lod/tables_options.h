// Options of the rung `tables`: which of its two models, and variants of the paper's. Numbers in parentheses
// are sections of the paper.
#pragma once

namespace lodestone {

/// By default a body that touches no other stands on its hull, except at edges, and one among others is a
/// sphere that knows the heights of its hull. In the published model it is the paper's sphere everywhere.
/// Any option that is not as here chooses the published model.
struct TablesOptions {
  bool interpolate = true;         ///< whether tables are interpolated; false: the nearest cell (3.3.1)
  bool draw_height = false;        ///< whether the radius is drawn from (μ, σ); false: it is the mean
  int radius_update_interval = 1;  ///< steps, ≥ 1, between updates of the sphere's radius (3.3.1)
  /// Whether bodies turn into rest poses (3.4). False: they lie as they last came down, on the sphere that
  /// they had then, as in the paper's figure 7.
  bool rest_poses = true;
  /// True: a body comes to rest in the pose that needs the smallest rotation (3.4). False: in the one that it
  /// tips into.
  bool nearest_rest_pose = false;
  /// Whether each of two bodies responds as against an immovable plane (3.3.2), which adds energy.
  bool paper_pair_rule = false;
  bool published = false;  ///< the published model: spheres of the mean height, responses drawn from tables

  /// Whether the model is the published one: `published` is set, or an option that asks for it.
  bool as_published() const {
    return published || !interpolate || draw_height || radius_update_interval > 1 || !rest_poses ||
           nearest_rest_pose || paper_pair_rule;
  }
};

}  // namespace lodestone
