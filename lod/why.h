// Why a body has its rung: as figures and as a sentence.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "lod/body.h"

namespace lodestone {

/// The rule that decided a body's rung.
enum class Rule : std::uint8_t {
  forced,             ///< the caller's LevelChoice, or no other rung is open to it
  near,               ///< it is near a viewpoint, or large in its picture
  far,                ///< it is far from every viewpoint, or small in its picture
  within_hysteresis,  ///< it is only just past the limit, and keeps its rung
  dwell,              ///< the policy wants another rung, but the last change was too recent
  queued,             ///< the policy wants another rung, but others change first, or have the place
  over_budget,        ///< nearer bodies, or those that gain more by it, use up the budget
  in_budget,          ///< it is among those that fit the budget
  most_reached,       ///< others have all the places of most_full or most_support
  overlap_put_off,    ///< its promotion waits because it overlaps another body or the ground
  signature_pending,  ///< its signature is still being measured
  rung_range,         ///< its rung range leaves it only this rung
  out_of_view,        ///< it is in no viewpoint's picture
  look_ahead,         ///< it is about to hit a full body
  joined,             ///< joints of the caller's on its ODE body keep it full
  carries_full,       ///< it is kinematic and touches full bodies
  paused,             ///< it would go up, but the budget has just sent some back who had gone up
};
std::string_view text_of(Rule rule);  ///< in words, as "near a viewpoint"

/// What Manager::explain says of a body.
struct Why {
  Rung rung = Rung::support;
  Rule rule = Rule::forced;
  /// False for a body that still waits for the step that gives it a rung; `rung` and `rule` say nothing then.
  bool placed = false;
  /// From the nearest viewpoint to its bounding sphere, ≥ 0; infinite without viewpoints.
  double distance_m = std::numeric_limits<double>::infinity();
  /// Diameter of its bounding sphere in the picture where it is largest, as if it were in view, at most 1e4;
  /// 0 without viewpoints.
  double pixels = 0.0;
  bool in_view = true;           ///< in any viewpoint's picture, or by PolicySettings::visible
  double predicted_error = 0.0;  ///< score of its rung for its shape (RungErrors); 0 while it sleeps
  /// How far it is expected to drift in a second, as seen: RungError::drift (with RungOverlaps while it
  /// touches others) times `pixels`, divided by out_of_view_factor if it is not in view; 0 while it sleeps.
  double predicted_error_pixels = 0.0;
  /// Cost of a step on its rung, doing what it does now, in work units (RungCost::work); without pairs of
  /// full bodies.
  double cost_work = 0.0;
  double cost_ms = 0.0;  ///< the same as learnt from measured steps; 0 unless the budget is in milliseconds
  int dwell_left_frames = 0;  ///< steps until the policy may change its rung again
  GroupId group = {};         ///< the group that it is a member of; null: none
};

/// One sentence, as "support: near a viewpoint".
std::string text_of(const Why& why);

}  // namespace lodestone
