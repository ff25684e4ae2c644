#include "lod/support/contact_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "lod/contact/ground_solver.h"
#include "lod/support/energy_bound.h"
#include "lod/support/hull_impacts.h"
#include "lod/support/step_contacts.h"

namespace lodestone {
namespace {

// Gravity, every vertex near the ground held, then motion. A step ends where a vertex strikes, and the next
// begins with that impact. Between, velocities are half a step behind places, as in the leapfrog rule: held
// along the chords of its arc (GroundSolver) by impulses along its arms where each step begins, a body that
// turns about an edge keeps its energy (SHAKE; Ryckaert, Ciccotti and Berendsen, 1977), however long the
// steps. Before an impact and at the end they catch up, as far as what holds the body lets them (RATTLE;
// Andersen, 1983).
class ContactSteps {
 public:
  ContactSteps(StatisticalBody& body, const BodyKind& kind, const StepWorld& world,
               const SupportSettings& settings, ContactTally& tally)
      : body_(body),
        kind_(kind),
        shape_(*kind.shape),
        world_(world),
        settings_(settings),
        tally_(tally),
        fall_time_(std::sqrt(shape_.radius / std::max(1e-9, world.gravity_strength()))),
        touching_(kTouching * shape_.radius),
        has_many_(shape_.hull.vertices.size() > kFew),
        slowest_((has_many_ ? kSlow : 1.0) * world.bounce_velocity) {}

  void run(double time);
  const HeldPoints& held() const { return held_; }

 private:
  double step(double time, bool divided);
  void begin_bound();
  void keep_bound();
  void kick_to(double time);
  void note_touched(const HalfSpace& plane);
  void push_out(double time);
  const HalfSpace* plane_of(const HalfSpace& plane);
  GroundMotion unkicked(const Mat3& rotation, const GroundMotion& kicked) const;
  void find_contacts(const OnGround& on, double time);
  void add_due(const OnGround& on);
  void add_stood_on(const OnGround& on);
  bool ends_somewhere(const HalfSpace& plane) const;
  std::size_t find_moved(const TouchingPoint& point, const OnGround& on) const;
  bool strikes_now(std::size_t contact, const GroundMotion& unkicked) const;
  bool is_struck(const GroundMotion& unkicked) const;
  void strike(const OnGround& lagging);
  void catch_up();
  double time_to_strike(const GroundContact& c, const GroundMotion& unkicked, const GroundMotion& held,
                        double within) const;
  double find_strike(const Mat3& rotation, const GroundMotion& kicked, int sinks, double time);
  double hold(OnGround& on, double time, bool divided);
  void take_held(const OnGround& on, const GroundMotion& unkicked);
  void log(const OnGround& on, std::span<const GroundContact> contacts,
           std::span<const HalfSpace* const> planes, const GroundMotion& before) const;
  /// Of the ground, if it has no friction.
  std::optional<Vec3> frictionless_normal() const {
    return found_.count > 0 && found_.contact[0].law.friction == 0.0
               ? std::optional(found_.plane[found_.count - 1]->normal)
               : std::nullopt;
  }
  ContactSolverSettings solver(const Mat3& rotation, double time, bool divided) const;

  static constexpr double kShortest = 0.25;  // of a step that ends where an edge may be struck

  // What rolls over many corners would lose energy by each that stops it a little too soon, and by what the
  // solver leaves over of an edge that it turns about, which rocks it from end to end; on the few of a box,
  // slow ones save nothing that counts.
  static constexpr std::size_t kFew = 24;
  static constexpr double kSlow = 0.1;  // over bounce_velocity
  static constexpr int kSweepsOfMany = 20;
  static constexpr double kToleranceOfMany = 1e-3;

  // Kept from step to step, since to make all of them takes longer than to solve a few.
  static StepContacts& kept() {
    thread_local StepContacts contacts;
    return contacts;
  }
  static std::array<GroundContact, StepContacts::kCapacity>& some_kept() {
    thread_local std::array<GroundContact, StepContacts::kCapacity> contacts;
    return contacts;
  }

  StatisticalBody& body_;
  const BodyKind& kind_;
  const Shape& shape_;
  const StepWorld& world_;
  const SupportSettings& settings_;
  ContactTally& tally_;
  StepContacts& found_ = kept();
  double fall_time_;     // s, √(R/g)
  double touching_;      // m: no farther from the ground
  bool has_many_;        // corners
  double slowest_;       // m/s: what ends a step by striking
  double behind_ = 0.0;  // s: how much older than the place the velocity is
  double kicked_ = 0.0;  // s: how much of gravity it has been given in this step
  HeldPoints held_;
  std::optional<EnergyBound> bound_;  // since the frame's time began, on planes since the last strike
  bool rolled_ = false;               // since then
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
  PointsOnPlanes due_;       // what strikes where this step ends
  PointsOnPlanes stood_on_;  // vertices that carried the body in the step before
};

bool is_same(const HalfSpace& a, const HalfSpace& b) {
  constexpr double kSameWay = 0.999;  // cosine
  return a.id == b.id && a.normal.dot(b.normal) > kSameWay;
}

// m/s, against the ground.
double approach_of(const GroundMotion& motion, const GroundContact& c) {
  return -motion.velocity_at(c.arm).dot(c.normal);
}

void ContactSteps::run(double time) {
  constexpr int kMostSteps = 32;
  const double longest = (world_.solids ? settings_.uneven_step : settings_.contact_step) * fall_time_;
  const int steps = std::clamp(int(std::ceil(time / longest)), 1, kMostSteps);
  const double usual = time / steps;
  int divisions = 4 * steps;
  begin_bound();
  for (double left = time; left > 1e-6 * time;)
    left -= step(left / std::ceil(left / usual - 1e-9), divisions-- > 0);
  catch_up();
  keep_bound();
}

// Of steps some gain what others lose: all of them together, on planes from one strike to the next, gain
// nothing but a torque's work. Over ground that is no plane each of them is bounded, too.
void ContactSteps::begin_bound() {
  bound_.reset(), rolled_ = false;
  if (world_.turning.isZero(0.0)) bound_.emplace(body_, shape_, world_.gravity, settings_.energy_bounded);
}

void ContactSteps::keep_bound() {
  if (!bound_) return;
  if (world_.solids) return bound_->keep();
  if (rolled_) bound_->keep(frictionless_normal());
}

// Returns how long it was, s: if it is divided until something strikes, else `time`, what strikes bouncing at
// once.
double ContactSteps::step(double time, bool divided) {
  const bool is_bounded = world_.solids || !bound_;
  std::optional<EnergyBound> energy;
  const auto begin = [&] {
    if (is_bounded) energy.emplace(body_, shape_, world_.gravity, settings_.energy_bounded);
  };
  begin();
  kick_to(behind_ + 0.5 * time);
  OnGround on(body_, shape_);
  find_contacts(on, time);
  if (divided && found_.until < time) {
    time = std::max(found_.until, kShortest * time);
    kick_to(behind_ + 0.5 * time);
    on = OnGround(body_, shape_);
  }
  if (found_.count > 0) {
    note_touched(*found_.plane[found_.count - 1]);
    if (divided && is_struck(unkicked(on.rotation, on.motion))) {
      kick_to(0.0);
      strike(OnGround(body_, shape_));
      begin();
      kick_to(0.5 * time);
      on = OnGround(body_, shape_);
    }
    time = hold(on, time, divided);
  }
  behind_ = 0.5 * time;
  kicked_ = 0.0;
  held_.count = int(found_.count);
  held_.wedged = false;
  for (std::size_t k = 1; k < found_.count; ++k)
    held_.wedged |= found_.contact[k].normal.dot(found_.contact[0].normal) < 0.0;
  body_.position += body_.velocity * time;
  rolled_ |= held_.rolls;
  if (held_.rolls && energy) energy->keep(frictionless_normal());
  push_out(time);
  body_.orientation = advance_orientation(body_.orientation, body_.spin, kind_, time).normalized();
  return time;
}

void ContactSteps::kick_to(double time) {
  body_.velocity += world_.gravity * (time - kicked_);
  body_.spin += world_.turning * (time - kicked_);
  kicked_ = time;
}

// The last plane of the world's that was.
void ContactSteps::note_touched(const HalfSpace& plane) {
  const auto& planes = world_.planes;
  if (!planes.empty() && &plane >= planes.data() && &plane < planes.data() + planes.size())
    tally_.touched_plane = int(&plane - planes.data());
}

void ContactSteps::push_out(double time) {
  if (found_.deepest >= 0.0 || (body_.eased > 0.0f && !found_.uneven)) return;
  body_.position += std::min(push_out_overlap(found_.deepest, shape_.radius),
                             lift_of(body_, shape_, world_.gravity_strength(), time)) *
                    found_.deepest_plane->normal;
}

// Null: there is no room for it.
const HalfSpace* ContactSteps::plane_of(const HalfSpace& plane) {
  const auto known =
      std::ranges::find_if(world_.planes, [&](const HalfSpace& p) { return is_same(p, plane); });
  return known != world_.planes.end() ? &*known : found_.keep(plane);
}

// The motion before the kick.
GroundMotion ContactSteps::unkicked(const Mat3& rotation, const GroundMotion& kicked) const {
  return {kicked.velocity - rotation.transpose() * (kicked_ * world_.gravity),
          kicked.angular_velocity -
              shape_.inverse_inertia_per_mass * (rotation.transpose() * (kicked_ * world_.turning))};
}

// With the vertices that strike now and those that the body stood on, which of many near the ground may be
// none of those found.
void ContactSteps::find_contacts(const OnGround& on, double time) {
  find_step_contacts(body_, kind_, world_, on, time, settings_.contact_margin * shape_.radius, held_, found_);
  add_due(on);
  add_stood_on(on);
}

// Who was to strike what ends somewhere may have passed its end.
void ContactSteps::add_due(const OnGround& on) {
  for (const PointOnPlane& due : due_.get()) {
    std::size_t i = 0;
    const auto is_it = [&](std::size_t k) {
      return found_.point[k].stands_for(due.point, shape_) && is_same(*found_.plane[k], due.plane);
    };
    while (i < found_.count && !is_it(i)) ++i;
    if (i == found_.count && ends_somewhere(due.plane)) {
      i = find_moved(due.point, on);
      if (i == found_.count) continue;
    }
    if (i == found_.count) {
      const HalfSpace* plane = found_.is_full() ? nullptr : plane_of(due.plane);
      if (!plane) break;
      found_.add(point_contact(body_, kind_, world_, on.rotation, due.point, *plane), due.point, *plane);
    }
    found_.due[i] = true;
  }
  due_.count = 0;
}

// Without what it turns about a body falls until it strikes.
void ContactSteps::add_stood_on(const OnGround& on) {
  for (const PointOnPlane& vertex : stood_on_.get()) {
    std::size_t i = 0;
    while (i < found_.count &&
           !(found_.point[i].vertex == vertex.point.vertex && is_same(*found_.plane[i], vertex.plane)))
      ++i;
    if (i == found_.count) {
      if (ends_somewhere(vertex.plane)) continue;
      GroundContact contact = point_contact(body_, kind_, world_, on.rotation, vertex.point, vertex.plane);
      if (contact.gap > touching_) continue;
      const HalfSpace* plane = found_.is_full() ? nullptr : plane_of(vertex.plane);
      if (!plane) return;
      contact.guess = on.rotation.transpose() * held_.find(vertex.point, shape_);
      found_.add(contact, vertex.point, *plane);
    }
    found_.stood_on[i] = true;
  }
}

// Unless it is under the whole body.
bool ContactSteps::ends_somewhere(const HalfSpace& plane) const {
  const auto same = [&](const HalfSpace& p) { return is_same(p, plane); };
  return world_.solids && std::ranges::none_of(world_.planes, same) &&
         std::ranges::none_of(found_.local.begin(), found_.local.begin() + std::ptrdiff_t(found_.under),
                              same);
}

// Over whichever face it is now: a vertex, or where features cross, which goes along the body as far as that
// has moved. The number of those found: none.
std::size_t ContactSteps::find_moved(const TouchingPoint& point, const OnGround& on) const {
  constexpr double kSame = 1e-3;  // over R
  const double way = kSame * shape_.radius + 2.0 * behind_ * on.motion.velocity_at(point.arm).norm();
  std::size_t nearest = found_.count;
  double least = way * way;
  for (std::size_t i = 0; i < found_.count; ++i) {
    if (found_.point[i].vertex != point.vertex) continue;
    if (point.vertex >= 0) return i;
    if (const double square = (found_.point[i].arm - point.arm).squaredNorm(); square < least)
      least = square, nearest = i;
  }
  return nearest;
}

bool ContactSteps::strikes_now(std::size_t contact, const GroundMotion& unkicked) const {
  constexpr double kNear = 0.002;  // over R: what was to strike and is no nearer does not
  const GroundContact& c = found_.contact[contact];
  const double approach = approach_of(unkicked, c);
  if (found_.due[contact]) return c.gap <= kNear * shape_.radius && approach > 0.0;
  // What the body came to stand on anew bore nothing of the half step that its velocity is behind.
  const bool is_new = has_many_ && !world_.solids && behind_ > 0.0 && !found_.stood_on[contact];
  return c.gap <= touching_ && approach > (is_new ? slowest_ : world_.bounce_velocity);
}

bool ContactSteps::is_struck(const GroundMotion& unkicked) const {
  for (std::size_t i = 0; i < found_.count; ++i)
    if (strikes_now(i, unkicked)) return true;
  return false;
}

// What strikes now does so with all else that touches, or is about to.
void ContactSteps::strike(const OnGround& lagging) {
  double fastest = 0.0;
  for (std::size_t i = 0; i < found_.count; ++i)
    if (strikes_now(i, lagging.motion))
      fastest = std::max(fastest, approach_of(lagging.motion, found_.contact[i]));
  const double margin = std::max(touching_, std::min(settings_.impact_lag * fall_time_ * fastest,
                                                     settings_.greatest_impact_margin * shape_.radius));
  auto& contact = some_kept();
  std::array<const HalfSpace*, StepContacts::kCapacity> plane;
  std::size_t count = 0, holding = 0;
  enum class Does { hold, come, strike };
  const auto does = [&](std::size_t i) {
    if (strikes_now(i, lagging.motion)) return Does::strike;
    return found_.contact[i].gap <= touching_ ? Does::hold : Does::come;
  };
  for (const Does which : {Does::hold, Does::come, Does::strike}) {
    for (std::size_t i = 0; i < found_.count; ++i) {
      const GroundContact& c = found_.contact[i];
      if (does(i) != which || (which == Does::come && c.gap > margin)) continue;
      plane[count] = found_.plane[i];
      contact[count++] = {.normal = c.normal, .arm = c.arm, .law = c.law};
    }
    if (which == Does::hold) holding = count;
  }
  const auto contacts = std::span(contact).first(count);
  kick_to(behind_);
  OnGround on(body_, shape_);
  if (behind_ > 0.0 && holding > 0) {
    hold_together(body_, shape_, on, contacts.first(holding), settings_);
    log(on, contacts.first(holding), plane, lagging.motion);
  }
  behind_ = kicked_ = 0.0;
  if (!world_.solids) {
    keep_bound();
    on = OnGround(body_, shape_);
  }
  const GroundMotion before = on.motion;
  respond_together(body_, shape_, world_, on, contacts, settings_, tally_);
  if (!world_.solids) begin_bound();
  log(on, contacts, plane, before);
}

// By what has held the body last.
void ContactSteps::catch_up() {
  const GroundMotion lagging = OnGround(body_, shape_).motion;
  kick_to(behind_);
  OnGround on(body_, shape_);
  auto& contact = some_kept();
  std::array<const HalfSpace*, StepContacts::kCapacity> plane;
  std::size_t count = 0;
  for (std::size_t i = 0; i < found_.count; ++i) {
    const GroundContact& c = found_.contact[i];
    if (c.rows[0].impulse <= 0.0) continue;
    plane[count] = found_.plane[i];
    const Vec3 normal = on.rotation.transpose() * plane[count]->normal;
    contact[count++] = {.normal = normal,
                        .arm = shape_.sphere_radius ? Vec3(-*shape_.sphere_radius * normal) : c.arm,
                        .law = c.law,
                        .guess = 0.5 * c.impulse()};
  }
  if (count == 0) return;
  const auto contacts = std::span(contact).first(count);
  hold_together(body_, shape_, on, contacts, settings_);
  log(on, contacts, plane, lagging);
}

// What each has carried.
void ContactSteps::log(const OnGround& on, std::span<const GroundContact> contacts,
                       std::span<const HalfSpace* const> planes, const GroundMotion& before) const {
  for (std::size_t i = 0; world_.log && i < contacts.size(); ++i)
    if (const GroundContact& c = contacts[i]; c.rows[0].impulse > 0.0)
      write_touch(body_, world_, *planes[i], on.rotation * c.arm, approach_of(before, c), c.rows[0].impulse);
}

// s; `within`: not so soon, or too slowly. The point gains speed as it does while the others hold the body,
// in the middle of the step, and is drawn towards the centre that it turns about. (Of a sphere it is another
// point in each moment.)
double ContactSteps::time_to_strike(const GroundContact& c, const GroundMotion& unkicked,
                                    const GroundMotion& held, double within) const {
  const Vec3& omega = held.angular_velocity;
  const double most = 2.0 * world_.gravity_strength(), approach = approach_of(held, c);
  const double gained = std::clamp((approach - approach_of(unkicked, c)) / kicked_, -most, most),  // m/s²
      drawn = shape_.sphere_radius
                  ? 0.0
                  : omega.squaredNorm() * c.arm.dot(c.normal) - omega.dot(c.arm) * omega.dot(c.normal);
  const double first = approach - 0.5 * within * gained,
               last_square = first * first + 2.0 * (gained + drawn) * c.gap;
  if (last_square <= slowest_ * slowest_) return within;
  const double both = first + std::sqrt(last_square);
  return both * within > 2.0 * c.gap ? 2.0 * c.gap / both : within;
}

// s, `time` at most: when the first of the vertices strikes that do not touch yet but would carry within the
// step, while the others hold the body. Those that strike then no longer hold it. `sinks`: how many of the
// last do.
double ContactSteps::find_strike(const Mat3& rotation, const GroundMotion& kicked, int sinks, double time) {
  const auto would_carry = [&](const GroundContact& c) {
    return c.gap > touching_ &&
           (c.rows[0].impulse > 0.0 || &c >= found_.contact.data() + found_.count - std::size_t(sinks));
  };
  if (std::ranges::none_of(found_.contacts(), would_carry)) return time;
  // Of two that say the same, as where triangles meet, one carries all: neither is to hold the body.
  const auto may_strike = [&](const GroundContact& c) {
    return found_.uneven ? c.gap > touching_ : would_carry(c);
  };
  auto& holding = some_kept();
  const auto end = std::ranges::remove_copy_if(found_.contacts(), holding.begin(), may_strike).out;
  GroundMotion held = kicked;
  solve_ground_contacts(held, shape_.inverse_inertia_per_mass, {holding.begin(), end}, time,
                        solver(rotation, time, true));
  const GroundMotion before = unkicked(rotation, kicked);
  std::array<double, StepContacts::kCapacity> until;
  double first = time;
  for (std::size_t i = 0; i < found_.count; ++i) {
    until[i] = may_strike(found_.contact[i]) ? time_to_strike(found_.contact[i], before, held, time) : time;
    first = std::min(first, until[i]);
  }
  constexpr double kTogether = 1.1;
  for (std::size_t i = 0; i < found_.count; ++i) {
    if (until[i] >= std::min(time, kTogether * first)) continue;
    due_.add(found_.point[i], *found_.plane[i]);
    found_.contact[i].gap = kUnbounded, found_.contact[i].guess = Vec3::Zero();
  }
  return first;
}

// In a step that is divided at strikes nothing bounces; else what strikes within it leaves as fast as at its
// own time.
ContactSolverSettings ContactSteps::solver(const Mat3& rotation, double time, bool divided) const {
  ContactSolverSettings solver = settings_.solver;
  if (has_many_) solver.sweeps = kSweepsOfMany, solver.tolerance = kToleranceOfMany;
  solver.along_chords = !shape_.sphere_radius;  // whose lowest point is never the same
  solver.sliding_speed = settings_.sliding_speed * shape_.radius / fall_time_;
  solver.driven = world_.turning.isZero(0.0) ? 0.0 : kicked_ * world_.gravity_strength();
  if (divided) {
    solver.bounce_velocity = kUnbounded;
    return solver;
  }
  // What gravity adds in a step is no impact.
  solver.bounce_velocity = world_.bounce_velocity + world_.gravity_strength() * time;
  solver.fall = rotation.transpose() * (kicked_ * world_.gravity);
  solver.turned = shape_.inverse_inertia_per_mass * (rotation.transpose() * (kicked_ * world_.turning));
  return solver;
}

// The contacts give what keeps the body out of the ground for `time` seconds, or until one strikes. Returns
// which, s.
double ContactSteps::hold(OnGround& on, double time, bool divided) {
  GroundMotion kicked = on.motion;
  const auto solve = [&] {
    on.motion = kicked;
    solve_ground_contacts(on.motion, shape_.inverse_inertia_per_mass, found_.contacts(), time,
                          solver(on.rotation, time, divided));
  };
  solve();
  int sinks = add_sinking(body_, kind_, world_, on, time, found_);
  if (divided) {
    if (const double until = find_strike(on.rotation, kicked, sinks, time); until < time) {
      time = until;
      kick_to(behind_ + 0.5 * time);
      kicked = OnGround(body_, shape_).motion;
      solve();
      sinks = add_sinking(body_, kind_, world_, on, time, found_);
    }
  }
  if (sinks > 0) {
    held_.rolls = true;
    solve();
  }
  take_held(on, unkicked(on.rotation, kicked));
  return time;
}

void ContactSteps::take_held(const OnGround& on, const GroundMotion& unkicked) {
  const Vec3 velocity = body_.velocity, spin = body_.spin;
  take_impulses(body_, on, found_.contacts());
  stood_on_.count = 0;
  for (std::size_t k = 0; k < found_.count; ++k) {
    const GroundContact& c = found_.contact[k];
    if (c.rows[0].impulse > 0.0 && found_.point[k].vertex != TouchingPoint::kNoVertex)
      stood_on_.add(found_.point[k], *found_.plane[k]);
    held_.impulse[k] = {found_.point[k], c.bounces ? Vec3(Vec3::Zero()) : Vec3(on.rotation * c.impulse())};
  }
  log(on, found_.contacts(), found_.plane, unkicked);
  if (std::ranges::any_of(found_.contacts(), &GroundContact::bounces))
    clamp_energy(velocity, spin, body_, shape_, tally_);
  tally_.contacts += std::int64_t(found_.count);
}

// The ground has the last word.
void lift_off(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, const HalfSpace& plane,
              double time, bool rolls, const SupportSettings& settings) {
  const Shape& shape = *kind.shape;
  EnergyBound energy(body, shape, world.gravity, settings.energy_bounded && rolls);
  lift_out(body, shape, plane, world.gravity, lift_of(body, shape, world.gravity_strength(), time));
  energy.keep(world.law(kind, plane).friction == 0.0 ? std::optional(plane.normal) : std::nullopt);
}

}  // namespace

void move_on_ground(StatisticalBody& body, const BodyKind& kind, const StepWorld& world, double time,
                    const SupportSettings& settings, ContactTally& tally) {
  ContactSteps steps(body, kind, world, settings, tally);
  steps.run(time);
  // Off one of two walls that lean against each other it would be lifted into the other.
  if (tally.touched_plane >= 0 && !steps.held().wedged)
    lift_off(body, kind, world, world.planes[tally.touched_plane], time, steps.held().rolls, settings);
}

}  // namespace lodestone
