// Why a body has its rung, as a structure and as a sentence.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "lod/body.h"

namespace lodestone {

/// What decided.
enum class Rule : std::uint8_t {
  forced,             ///< the caller's LevelChoice
  near,               ///< a viewpoint, or large in its picture
  far,                ///< from every viewpoint, or small in its picture
  within_hysteresis,  ///< only just past the limit
  dwell,              ///< the policy wants another rung, and it changed too recently
  queued,             ///< … and others go first: as many as may in a step, or for a place
  over_budget,        ///< nearer bodies, or those that gain more, use up the budget
  in_budget,          ///< it is among those that fit the budget
  most_reached,       ///< most_full or most_support
  overlap_put_off,    ///< it wants to be full, and overlaps another body
  signature_pending,  ///< its signature is still being measured
  rung_range,         ///< the caller left one rung
  out_of_view,        ///< in no viewpoint's picture
  look_ahead,         ///< it is about to hit a full body
  joined,             ///< joints of the caller's on its ODE body
  carries_full,       ///< it is kinematic and touches full bodies
};
std::string_view text_of(Rule rule);

struct Why {
  Rung rung = Rung::support;
  Rule rule = Rule::forced;
  /// False: it was added since the last step, which gives it a rung; rung and rule say nothing yet.
  bool placed = false;
  /// From the nearest viewpoint to its bounding sphere; infinite without viewpoints.
  double distance_m = std::numeric_limits<double>::infinity();
  /// Diameter of its bounding sphere in the picture where it is largest, as if it were in view; 0 without
  /// viewpoints.
  double pixels = 0.0;
  bool in_view = true;
  double predicted_error = 0.0;  ///< score of its rung for its shape (see RungErrors); 0 while it sleeps
  /// How far it drifts in a second (RungError::drift, among others with RungOverlaps) × pixels; over
  /// out_of_view_factor where it is not in view; 0 while it sleeps.
  double predicted_error_pixels = 0.0;
  /// What it costs in a step on its rung as it is now, in work units (RungCost::work), without pairs of full
  /// bodies.
  double cost_work = 0.0;
  double cost_ms = 0.0;  ///< the same as learnt from measured steps; 0 unless the budget is in milliseconds
  int dwell_left_frames = 0;  ///< until it may change again
  GroupId group = {};         ///< that it is a member of; null: of none
};

/// "support: near a viewpoint"
std::string text_of(const Why& why);

}  // namespace lodestone
