// What strikes the ground in contact steps, and when.
#include <algorithm>
#include <array>
#include <cmath>

#include "lod/support/contact_stepper.h"

namespace lodestone {

bool ContactStepper::strikes_now(std::size_t contact, const GroundMotion& unkicked) const {
  constexpr double kNear = 0.002;  // over R: what was expected to strike and is farther than this does not
  const GroundContact& c = found_.contact[contact];
  const double approach = approach_of(unkicked, c);
  if (found_.due[contact]) return c.gap <= kNear * shape_.radius && approach > 0.0;
  // A vertex that the body has just come to stand on bore none of the half step that the velocity lags
  // behind.
  const bool is_new = has_many_ && !world_.solids && behind_ > 0.0 && !found_.stood_on[contact];
  return c.gap <= touching_ && approach > (is_new ? slowest_ : world_.bounce_velocity);
}

bool ContactStepper::is_struck(const GroundMotion& unkicked) const {
  for (std::size_t i = 0; i < found_.count; ++i)
    if (strikes_now(i, unkicked)) return true;
  return false;
}

// Puts together what an impact acts on: first what touches and holds the body, then what is about to touch,
// last what strikes. Returns how many hold it.
std::size_t ContactStepper::gather_struck(const GroundMotion& lagging, ContactList& together) const {
  enum class Does { hold, come, strike };
  std::array<Does, StepContacts::kCapacity> does;
  double fastest = 0.0;
  for (std::size_t i = 0; i < found_.count; ++i) {
    const GroundContact& c = found_.contact[i];
    does[i] = strikes_now(i, lagging) ? Does::strike : c.gap <= touching_ ? Does::hold : Does::come;
    if (does[i] == Does::strike) fastest = std::max(fastest, approach_of(lagging, c));
  }
  const double margin = std::max(touching_, std::min(settings_.impact_lag * fall_time_ * fastest,
                                                     settings_.greatest_impact_margin * shape_.radius));
  std::size_t holding = 0;
  for (const Does which : {Does::hold, Does::come, Does::strike}) {
    for (std::size_t i = 0; i < found_.count; ++i) {
      const GroundContact& c = found_.contact[i];
      if (does[i] != which || (which == Does::come && c.gap > margin)) continue;
      together.add({.normal = c.normal, .arm = c.arm, .law = c.law}, found_.plane[i]);
    }
    if (which == Does::hold) holding = together.count;
  }
  return holding;
}

// What strikes now does so together with all else that touches, or is about to.
void ContactStepper::strike(const OnGround& lagging) {
  ContactList together;
  const std::size_t holding = gather_struck(lagging.motion, together);
  kick_to(behind_);
  OnGround on(body_, shape_);
  if (behind_ > 0.0 && holding > 0) {
    hold_together(body_, shape_, on, together.get().first(holding), settings_);
    log(on, together.get().first(holding), together.plane, lagging.motion);
  }
  behind_ = kicked_ = 0.0;
  if (!world_.solids) {
    keep_bound();
    on = OnGround(body_, shape_);
  }
  const GroundMotion before = on.motion;
  respond_together(body_, shape_, world_, on, together.get(), settings_, tally_);
  if (!world_.solids) begin_bound();
  log(on, together.get(), together.plane, before);
}

// In how many seconds the contact's point strikes; `within`: not so soon, or too slowly. It speeds up as it
// does while the other contacts hold the body (`held`, in the middle of the step), and is drawn towards the
// centre that it turns about. (The lowest point of a sphere is another one at every moment.)
double ContactStepper::time_to_strike(const GroundContact& c, const GroundMotion& unkicked,
                                      const GroundMotion& held, double within) const {
  const Vec3& omega = held.angular_velocity;
  const double most = 2.0 * world_.gravity_strength(), approach = approach_of(held, c);
  const double gained = std::clamp((approach - approach_of(unkicked, c)) / kicked_, -most, most),  // m/s²
      drawn = shape_.sphere_radius
                  ? 0.0
                  : omega.squaredNorm() * c.arm.dot(c.normal) - omega.dot(c.arm) * omega.dot(c.normal);
  // The fall through the gap: speeds (m/s) at the beginning and where it strikes.
  const double first = approach - 0.5 * within * gained,
               last_square = first * first + 2.0 * (gained + drawn) * c.gap;
  if (last_square <= slowest_ * slowest_) return within;
  const double both = first + std::sqrt(last_square);
  return both * within > 2.0 * c.gap ? 2.0 * c.gap / both : within;
}

// In how many seconds, `time` at most, the first vertex strikes of those that do not touch yet but would
// carry within the step, while the others hold the body. Notes those that strike then as due; they no longer
// hold it. `sinks`: how many of the last contacts were found to sink in.
double ContactStepper::find_strike(const Mat3& rotation, const GroundMotion& kicked, int sinks, double time) {
  const auto would_carry = [&](const GroundContact& c) {
    return c.gap > touching_ &&
           (c.rows[0].impulse > 0.0 || &c >= found_.contact.data() + found_.count - std::size_t(sinks));
  };
  if (std::ranges::none_of(found_.contacts(), would_carry)) return time;
  // Where triangles meet, one of two contacts that say the same carries all: neither is to hold the body.
  const auto may_strike = [&](const GroundContact& c) {
    return found_.uneven ? c.gap > touching_ : would_carry(c);
  };
  const auto holding = kept_list();
  const auto end = std::ranges::remove_copy_if(found_.contacts(), holding.begin(), may_strike).out;
  GroundMotion held = kicked;
  solve_ground_contacts(held, shape_.inverse_inertia_per_mass, {holding.begin(), end}, time,
                        solver(rotation, time, true));
  const GroundMotion before = unkicked(rotation, kicked);
  std::array<double, StepContacts::kCapacity> until;  // s
  double first = time;
  for (std::size_t i = 0; i < found_.count; ++i) {
    until[i] = may_strike(found_.contact[i]) ? time_to_strike(found_.contact[i], before, held, time) : time;
    first = std::min(first, until[i]);
  }
  constexpr double kTogether = 1.1;  // over the first one's time: what strikes by then strikes with it
  for (std::size_t i = 0; i < found_.count; ++i) {
    if (until[i] >= std::min(time, kTogether * first)) continue;
    due_.add(found_.point[i], *found_.plane[i]);
    found_.contact[i].gap = kUnbounded, found_.contact[i].guess = Vec3::Zero();
  }
  return first;
}

}  // namespace lodestone
