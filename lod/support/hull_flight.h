// A body's hull in free flight over planes: where it is at a time of the step, which of its points is lowest
// there, and how that point approaches.
#pragma once

#include "lod/statistical/flight.h"
#include "lod/statistical/step_world.h"

namespace lodestone {

/// Over R: a gap that is none.
inline constexpr double kTouching = 1e-4;

struct HullPose {
  Vec3 position;
  Quat orientation;
};

/// The lowest point over the plane that it is nearest to, or deepest in. Vectors are in body axes.
struct LowestPoint {
  int plane = -1;      ///< index; −1: no plane within reach
  double gap = 1e300;  ///< m
  Vec3 normal = Vec3::UnitZ();
  Vec3 arm = Vec3::Zero();  ///< m, from the centre of mass
};

/// How a gap changes: of a hull's vertex, or of a sphere.
struct GapMotion {
  double velocity = 0.0;      ///< m/s, negative: it closes
  double acceleration = 0.0;  ///< m/s²
};

/// When, within a step, a body strikes, and its lowest point then.
struct Impact {
  double time = 0.0;  ///< s from the step's start
  HullPose pose;
  LowestPoint lowest;
};

class HullFlight {
 public:
  /// Refers to its arguments. `body`: at the step's start; `longest`: s, of a step whose turn may be taken to
  /// second order where it is a small one, 0 for none.
  HullFlight(const StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double longest = 0.0)
      : body_(body), kind_(kind), world_(world) {
    constexpr double kSmall = 0.2;  // rad
    if (longest <= 0.0) return;
    turning_ = find_own_turning(body.orientation, body.spin, *kind.shape);
    turns_shortly_ = turning_.rate.squaredNorm() * longest * longest < kSmall * kSmall;
  }

  /// `time`: s from the step's start.
  Vec3 position_at(double time) const {
    return body_.position + (body_.velocity + world_.gravity * (0.5 * time)) * time;
  }
  HullPose pose_at(double time) const {
    HullPose pose{position_at(time), turns_shortly_
                                         ? turned_shortly(body_.orientation, turning_, time)
                                         : advance_orientation(body_.orientation, body_.spin, kind_, time)};
    // Renormalising without a square root: one Newton step is exact to rounding for a norm already within
    // 1e-8 of 1.
    pose.orientation.coeffs() *= 1.5 - 0.5 * pose.orientation.squaredNorm();
    return pose;
  }
  Vec3 velocity_at(double time) const { return body_.velocity + world_.gravity * time; }

  /// Planes out of reach are not looked at. The climb over the hull starts at `hint` and leaves the vertex
  /// that it found there.
  LowestPoint find_lowest(const HullPose& pose, std::int32_t& hint) const;

  /// Of the lowest point of `pose` at `time`, its body turning freely.
  GapMotion gap_motion(const HullPose& pose, const LowestPoint& lowest, double time) const;

  /// When the gap closes between the start, clear of the ground, and `end`, inside it: by the parabola that
  /// the lowest point's gap follows, again from where that leads, to `tolerance` m.
  Impact find_impact(const Impact& end, double tolerance, std::int32_t& hint) const;

 private:
  const StatisticalBody& body_;
  const BodyKind& kind_;
  const StepWorld& world_;
  OwnTurning turning_;
  bool turns_shortly_ = false;
};

}  // namespace lodestone
