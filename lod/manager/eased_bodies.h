// Bodies that lay among others on a statistical rung, on hulls or spheres, and are full now: their meshes
// leave gaps there. Once they are awake they sink into these no faster than bodies part that overlap
// (parting.h), for as long, and until then they need not touch what they lie on. What falls farther than such
// a gap reaches has lost what it lay on and is let go, and so is what is moved on purpose, or hit.
#pragma once

#include <cstdint>
#include <vector>

#include "reference/ode/ode_world.h"
#include "reference/state_archive.h"

namespace lodestone {

struct Levels;

class EasedBodies {
 public:
  /// `body`: the manager's index; it has just become full, of `radius` m, and may sink by `deepest` m.
  void add(std::uint32_t body, OdeBodyId ode, const Vec3& position, double radius, double deepest);
  /// Wakes those that sleep and lie at `box` (m, world) or nearly so: what moves there does not touch them.
  void wake_in(Levels& levels, const Eigen::AlignedBox3d& box) const;
  /// Somebody moves it on purpose.
  void forget(std::uint32_t body) {
    std::erase_if(bodies_, [body](const Eased& eased) { return eased.body == body; });
  }
  /// Holds those back that sink, by forces over the full level's step of `dt` seconds, which is to follow.
  void hold_back(Levels& levels, double dt);
  void archive(StateArchive& a) { a(bodies_); }

 private:
  struct Eased {
    std::uint32_t body;
    OdeBodyId ode;   // another once it has left the full level
    Vec3 begin;      // m, where it lay
    double radius;   // m
    double deepest;  // m that it may move from there
    double left_s;   // awake
  };
  std::vector<Eased> bodies_;
};

}  // namespace lodestone
