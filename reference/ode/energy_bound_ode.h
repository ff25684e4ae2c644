// No contact gives energy, but what pushes overlaps apart and surfaces that move: a substep that leaves
// bodies which hang together with much more has met contacts that contradict each other, as of a leg that is
// pushed out of a plate on both of its sides, which ODE's solver answers without bound.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reference/disjoint_sets.h"
#include "reference/ode/bodies_ode.h"
#include "reference/ode/joints_ode.h"

namespace lodestone::ode {

class EnergyBound {
 public:
  /// Before contacts are known. What hangs on joints may gain any energy, by their motors.
  void begin(const Bodies& bodies);
  /// Before ODE's solver runs: `bodies` as they are, with the forces that act on them, and their contacts, in
  /// a step of `h` s.
  void note(const Bodies& bodies, std::span<const OdeContact> contacts, const Vec3& gravity,
            const Pushing& pushing, double h);
  /// Whether they have no more energy now than they may. A body that touches nothing but what stands still is
  /// not asked, unless that pushes it out of itself from sides that face each other.
  bool is_kept(const Bodies& bodies);
  /// Of those that have more: takes so much of how they move against each other, or all alike, that they have
  /// what there was, and lets them go on so from where they were.
  void keep(Bodies& bodies);

 private:
  /// Of bodies that touch, directly or through others.
  struct Island {
    double energy = 0.0;  ///< J, with what gravity gives
    double driven = 0.0;  ///< J: at most, from surfaces that move
    double forced = 0.0;  ///< J: what forces would give, were nothing in the way
    double work = 0.0;    ///< J: what they have given, after the step
    double mass = 0.0;    ///< kg
    /// m/s and m²/s², the sums of what pushes two apart; of a body by itself the greatest.
    double pushes = 0.0, squared_pushes = 0.0;
    int bodies = 0;
    bool jointed = false;
    bool moved = false;       ///< by what moves, or was moved
    bool squeezed = false;    ///< a body by itself, deep in what stands still, by contacts against each other
    Vec3 out = Vec3::Zero();  ///< the first of these that is deep
    double given() const;
    double most() const;
    /// What a body does by itself is the truth's own.
    bool is_asked() const { return !jointed && (bodies > 1 || moved || squeezed); }
  };
  Island& island_of(std::size_t slot) { return islands_[std::size_t(sets_.root_of(std::int32_t(slot)))]; }
  /// How one began, and what acts on it.
  struct Pulled {
    Vec3 velocity, angular_velocity;  ///< m/s, rad/s
    Vec3 force, torque;               ///< N, N m, without gravity's
  };
  void count_bodies(const Bodies& bodies);
  void sum_up(const Bodies& bodies);
  void slow_down(Bodies& bodies, std::size_t root);
  Island* island_of(const Bodies& bodies, const OdeContact& contact);
  void note_contact(const Bodies& bodies, const OdeContact& contact);
  void note_push(const Bodies& bodies, const OdeContact& contact, double speed);

  std::vector<bool> noted_;       // by slot: those that were awake
  std::vector<bool> jointed_;     // by slot
  std::vector<bool> asked_;       // by slot: of those, who is in an island that is asked
  DisjointSets sets_;             // of slots
  std::vector<Island> islands_;   // by root
  std::vector<Pulled> pulled_;    // by slot
  std::vector<double> energies_;  // J, after the step, by root
  double time_ = 0.0;             // s, of the step
};

}  // namespace lodestone::ode
