// A game's level as its programmer would write it with ODE alone: static boxes and crates in one space,
// dSpaceCollide, dWorldStep. What OdeWorld is compared with.
#pragma once

#include <memory>
#include <span>

#include "reference/geometry.h"

struct dxWorld;
struct dxSpace;

namespace lodestone {

enum class CallersSpace { simple, hash, sweep_and_prune, quadtree };

struct CallersLevelSettings {
  CallersSpace space = CallersSpace::hash;
  int boxes = 10'000;  ///< static, of 1 m, side by side in a square about the origin, their tops at z = 0
  double friction = 0.5, restitution = 0.3;
};

class CallersLevel {
 public:
  explicit CallersLevel(const CallersLevelSettings& settings);
  ~CallersLevel();
  CallersLevel(const CallersLevel&) = delete;
  CallersLevel& operator=(const CallersLevel&) = delete;

  /// ODE's boxes of `side` m and `mass` kg, with ODE's sleep as OdeSettings has it.
  void add_crates(std::span<const RigidState> states, double side, double mass);
  /// One dSpaceCollide and one dWorldStep of `dt` s.
  void step(double dt);
  /// Of the crates.
  int awake() const;

  dxWorld* world() const;
  dxSpace* space() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lodestone
