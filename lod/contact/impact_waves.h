// Blows that go on through bodies that touch: a row of balls is struck at one end and the last one leaves it.
// Contacts that carry nothing, and only begin to close in as the one before them is answered, have
// restitution from the approach that they meet then (sequential impacts: Newton's law for each, round by
// round), as bodies a hair apart have it in ODE. Solved together with the blow they would hold like one heavy
// body, off which the striker bounces. What carries a weight is left to the solvers, which answer it together
// with the blow, as dWorldStep does.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/contact_solver.h"
#include "lod/contact/crowd_manifold.h"

namespace lodestone {

class ImpactWaves {
 public:
  /// Of the least that bounces: a contact that carries less carries nothing.
  static constexpr double kUnloaded = 0.1;

  /// Gives the bodies the velocities that blows leave them which others pass on. What closes in then no
  /// faster than `settings.bounce_velocity` is left to the solvers, and so are blows that nothing passes on.
  /// Marks the points that bounced. `step` in s.
  void pass_on(std::span<SolverBody> bodies, std::span<const CrowdManifold> manifolds,
               std::span<CrowdPoint> points, double step, const ContactSolverSettings& settings);
  /// The last call's impulses, added to those of the points.
  void add_impulses(std::span<CrowdPoint> points) const;
  /// Of the last call: manifolds that have passed on something, or were struck first.
  std::span<const std::uint32_t> struck() const { return struck_; }

 private:
  struct Scene;
  /// A point of a manifold that is answered in this round.
  struct Answer {
    std::uint32_t manifold, point;
    double target, effective_mass;  // m/s; kg
    double impulse;                 // N s, along the normal
    Vec3 friction;                  // N s
  };

  /// How a manifold strikes.
  struct Blow {
    double time = kUnbounded;  // s, from the step's beginning
    double speed = 0.0;        // m/s, of the fastest point; 0: it does not
  };

  void find_blows(const Scene& scene);
  void link(const Scene& scene);
  bool is_passed_on(const Scene& scene, std::uint32_t manifold);
  void answer(const Scene& scene, std::span<const std::uint32_t> manifolds);
  void find_next(const Scene& scene);
  void find_foremost(const Scene& scene);

  std::vector<std::uint32_t> blows_, active_, foremost_, struck_;
  std::vector<std::uint8_t> state_, in_heap_;  // of each manifold; of each body
  std::vector<std::int32_t> first_of_;         // of each body, its link of those that are open
  std::vector<std::int32_t> next_;             // of each manifold's two links
  std::vector<Blow> blow_on_, blow_sizes_;  // the first and the fastest on each body; of each that is active
  std::vector<Answer> answers_;
  struct Given {
    std::uint32_t point;
    Vec3 impulse;  // N s, on the first body
  };
  std::vector<Given> given_;
};

}  // namespace lodestone
