// What bodies touch in, as the solvers of crowds take it.
#pragma once

#include <cstdint>

#include "lod/contact/contact_solver.h"
#include "reference/material.h"

namespace lodestone {

/// What two bodies, or a body and the ground, touch in: points with one normal.
struct CrowdManifold {
  std::int32_t first = 0, second = -1;  ///< indices of SolverBody; second −1: the ground
  Vec3 normal = Vec3::UnitZ();          ///< points into `first`
  ContactLaw law;
  std::uint32_t begin = 0, count = 0;  ///< its points
  bool known = false;                  ///< from the last step, which gives the guesses of its points
  bool to_forget = false;              ///< the next step knows nothing of it
  float pressed = 0.0f;  ///< m/s: what forces add to its approach in the step, beyond gravity: no impact
  float spared =
      0.0f;  ///< m/s along the normal: what its body falls less in the step than gravity has it fall
  double most_impulse = kUnbounded;  ///< N s, of each point along the normal; a bounded one is a
                                     ///< motor's, which closes or opens the gap, however wide, just within
                                     ///< the step
};

struct CrowdPoint {
  Vec3 arm_first = Vec3::Zero(),
       arm_second = Vec3::Zero();  ///< m, from each centre of mass to the shared point
  double gap = 0.0;                ///< m, negative where they overlap
  Vec3 guess = Vec3::Zero();       ///< N s, on `first`: what a resting contact starts from
  float frictionless = -1.0F;      ///< N s, normal impulse that there was without friction; below zero: not
                                   ///< known. Filled anew by the solver where friction is bounded by it
  // Filled by the solver:
  float blow = 0.0f;            ///< m/s at which one that bounces strikes
  Vec3 impulse = Vec3::Zero();  ///< N s, on `first`
  bool bounces = false;         ///< an impact, fast enough for restitution
  bool in_blow = false;  ///< of a few bodies one of whose contacts bounces: what it began with, not what it
                         ///< gave, is what it bears
  float impact_time = 0.0f;  ///< s, of one that bounces: when in the step its gap is closed
};

}  // namespace lodestone
