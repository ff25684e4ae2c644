// What of the paper's model can be chosen.
#pragma once

namespace lodestone {

/// Options of the rung `tables`: a body alone stands on its hull, except at edges; one among others is a
/// sphere that knows the heights of its hull. With `published` it is the paper's sphere everywhere. The other
/// options are the paper's, or matter for its model: who sets one asks for that model.
struct TablesOptions {
  bool interpolate = true;         ///< look-up between cells; else the nearest cell (3.3.1)
  bool draw_height = false;        ///< radius drawn from (μ, σ) at each contact instead of the mean
  int radius_update_interval = 1;  ///< steps, ≥ 1, between updates of the sphere's radius (3.3.1)
  /// Bodies turn into rest poses (3.4); else they lie as they last came down, on the sphere that they had
  /// then: the paper's figure 7.
  bool rest_poses = true;
  /// Rest in the pose that needs the smallest rotation (3.4); else in the one that the body tips into.
  bool nearest_rest_pose = false;
  bool paper_pair_rule = false;  ///< each body responds as against an immovable plane (3.3.2); gains energy
  bool published = false;        ///< the paper's model: spheres of the mean height, drawn responses

  /// Whether the model is the paper's: it was asked for, or one of its options was.
  bool as_published() const {
    return published || !interpolate || draw_height || radius_update_interval > 1 || !rest_poses ||
           nearest_rest_pose || paper_pair_rule;
  }
};

}  // namespace lodestone
