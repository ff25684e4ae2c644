// One body against the ground, in contact steps: each gives it gravity, holds every vertex near the ground,
// and moves it. A step ends early where a vertex strikes, and the next one begins with that impact.
//
// Positions and velocities are half a step apart, as in the leapfrog rule. In between, contacts are held
// along the chords of the arc on which a vertex moves, by impulses along its arms where the step begins
// (GroundSolver): so a body that turns about an edge keeps its energy, however long the steps (SHAKE;
// Ryckaert, Ciccotti and Berendsen, 1977). Before an impact and at the end the velocities catch up with the
// positions, as far as what holds the body lets them (RATTLE; Andersen, 1983).
//
// Its files: contact_steps.cpp has the sequence of steps; contact_strikes.cpp what strikes, and when;
// known_contacts.cpp the contacts that one step hands on to the next.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "lod/contact/ground_solver.h"
#include "lod/statistical/step_world.h"
#include "lod/support/energy_bound.h"
#include "lod/support/hull_impacts.h"
#include "lod/support/step_contacts.h"
#include "lod/support/support_settings.h"

namespace lodestone {

/// m/s, of the contact's point towards the ground.
inline double approach_of(const GroundMotion& motion, const GroundContact& c) {
  return -motion.velocity_at(c.arm).dot(c.normal);
}

class ContactStepper {
 public:
  /// All that is given must outlive it.
  ContactStepper(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
                 const SupportSettings& settings, ContactTally& tally);

  /// Moves the body by `time` seconds.
  void run(double time);
  /// What held the body in the last contact step.
  const HeldPoints& held() const { return held_; }

 private:
  /// Contacts by the point of the body and the plane: what they are known by from step to step.
  struct PointOnPlane {
    TouchingPoint point;
    HalfSpace plane;
  };
  struct PointsOnPlanes {
    std::array<PointOnPlane, StepContacts::kCapacity> all;
    std::size_t count = 0;
    void add(const TouchingPoint& point, const HalfSpace& plane) { all[count++] = {point, plane}; }
    std::span<const PointOnPlane> get() const { return std::span(all).first(count); }
  };
  /// Contacts put together for one solve, with the plane of each.
  struct ContactList {
    std::span<GroundContact> contact = kept_list();
    std::array<const HalfSpace*, StepContacts::kCapacity> plane;
    std::size_t count = 0;
    void add(const GroundContact& c, const HalfSpace* of) { plane[count] = of, contact[count++] = c; }
    std::span<GroundContact> get() const { return contact.first(count); }
  };

  // The sequence of steps.
  double step(double time, bool divided);
  void begin_bound();
  void keep_bound();
  void kick_to(double time);
  void note_touched(const HalfSpace& plane);
  void push_out(double time);
  double hold(OnGround& on, double time, bool divided);
  void note_held(const OnGround& on, const GroundMotion& unkicked);
  void catch_up();
  GroundMotion unkicked(const Mat3& rotation, const GroundMotion& kicked) const;
  ContactSolverSettings solver(const Mat3& rotation, double time, bool divided) const;
  std::optional<Vec3> frictionless_normal() const;
  void log(const OnGround& on, std::span<const GroundContact> contacts,
           std::span<const HalfSpace* const> planes, const GroundMotion& before) const;

  // What strikes, and when.
  bool strikes_now(std::size_t contact, const GroundMotion& unkicked) const;
  bool is_struck(const GroundMotion& unkicked) const;
  std::size_t gather_struck(const GroundMotion& lagging, ContactList& together) const;
  void strike(const OnGround& lagging);
  double time_to_strike(const GroundContact& c, const GroundMotion& unkicked, const GroundMotion& held,
                        double within) const;
  double find_strike(const Mat3& rotation, const GroundMotion& kicked, int sinks, double time);

  // Contacts that are known from the step before.
  void find_contacts(const OnGround& on, double time);
  void add_due(const OnGround& on);
  void add_stood_on(const OnGround& on);
  const HalfSpace* plane_of(const HalfSpace& plane);
  bool ends_somewhere(const HalfSpace& plane) const;
  std::size_t find_moved(const TouchingPoint& point, const OnGround& on) const;

  // Kept from body to body, since to make all of them takes longer than to solve a few.
  static StepContacts& kept_contacts() {
    thread_local StepContacts contacts;
    return contacts;
  }
  static std::span<GroundContact> kept_list() {
    thread_local std::array<GroundContact, StepContacts::kCapacity> contacts;
    return contacts;
  }

  StatisticalBody& body_;
  const BodyKind& kind_;
  const Shape& shape_;
  const StepWorld& world_;
  const SupportSettings& settings_;
  ContactTally& tally_;
  StepContacts& found_ = kept_contacts();
  double fall_time_;     // s, √(R/g)
  double touching_;      // m: what is no farther from the ground touches it
  bool has_many_;        // corners, over which it may roll
  double slowest_;       // m/s: what approaches more slowly ends no step by striking
  double behind_ = 0.0;  // s: how much older the velocity is than the position
  double kicked_ = 0.0;  // s: for how long gravity has acted on the velocity in this step
  HeldPoints held_;
  std::optional<EnergyBound>
      bound_;                // since run() began, on planes since the last strike; none under torques
  bool rolled_ = false;      // onto a vertex that did not carry it, since bound_ began
  PointsOnPlanes due_;       // what strikes where this step ends
  PointsOnPlanes stood_on_;  // vertices that carried the body in the step before
};

}  // namespace lodestone
