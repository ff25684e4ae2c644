#include "lod/contact/contact_solver.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "lod/contact/contact_impulse.h"
#include "lod/simd/lanes.h"

namespace lodestone {

using namespace lane;

namespace {

// What stands on the ground (second below zero) meets nothing that moves.
LODESTONE_INLINE Vec3 contact_velocity(std::span<const SolverBody> bodies, const SolverContact& c) {
  const SolverBody& a = bodies[c.first];
  const Vec3 of_first = a.velocity + a.angular_velocity.cross(c.arm_first);
  if (c.second < 0) return of_first;
  const SolverBody& b = bodies[c.second];
  return of_first - b.velocity - b.angular_velocity.cross(c.arm_second);
}

/// A body's velocities, and after all bodies those of the ground, as sweeps read and change them.
struct alignas(64) Motion {
  D4 velocity{}, angular{};
};

/// What of a contact acts along one axis: on the first body, and the other way on the second.
struct Row {
  D4 axis;                             // the last of each four is 0
  D4 turning_first, turning_second;    // arm × axis
  D4 response_first, response_second;  // rad/s per N s
};

/// A contact as sweeps read and change it. Of its four lanes the first three are along the normal and both
/// tangents.
struct alignas(64) Point {
  Row rows[3];
  D4 effective_mass, target, impulse;  // kg, m/s, N s
  double friction, bound;              // N s; negative: friction times the normal impulse as it is
  double most_impulse;                 // N s, along the normal
  double inverse_mass_first, inverse_mass_second;
  std::int32_t first, second;
};

/// Of a run in the round at hand.
struct Progress {
  std::uint32_t begin, count;          // points
  int sweeps;                          // left
  double change = 0.0, impulse = 0.0;  // N s, the greatest; the latter along a normal
};

struct Arrays {
  std::vector<Motion> motions, before;
  std::vector<Point> points;
  std::vector<Progress> progress;  // of the runs that are not done
};

enum class Round {
  guesses,       // gives what the impulses are
  frictionless,  // relaxes those along the normal
  relaxed,
};

LODESTONE_INLINE D4 lanes_of(const Vec3& v) { return D4{v.x(), v.y(), v.z(), 0.0}; }

// The normal velocity to reach: a bounce, or closing the gap just within the step.
double target_velocity(SolverContact& c, bool on_still, double approach, double step,
                       const ContactSolverSettings& s) {
  if (c.most_impulse < kUnbounded) return -c.gap / step;
  const double closing = std::min(0.0, -c.gap / step),
               fall = on_still ? std::min(0.0, s.fall.dot(c.normal)) : 0.0;
  c.bounces = approach < -s.bounce_velocity && c.gap + approach * step < 0.0;
  if (c.bounces) c.impact_time = std::max(0.0, c.gap) / -approach;
  return c.bounces ? std::max(bounce_in_fall(c.law.restitution, c.gap, approach, fall, step), closing)
                   : closing;
}

Point prepare(std::span<const SolverBody> bodies, SolverContact& c, double step,
              const ContactSolverSettings& s) {
  const Vec3 velocity = contact_velocity(bodies, c);
  const Mat3 frame = contact_frame(c.normal, velocity);
  c.tangent[0] = frame.col(1);
  c.tangent[1] = frame.col(2);
  const bool on_still = c.second < 0 || bodies[c.second].inverse_mass == 0.0;
  c.target = target_velocity(c, on_still, velocity.dot(c.normal), step, s);

  const SolverBody& a = bodies[c.first];
  Point p{};
  p.first = c.first, p.second = c.second < 0 ? std::int32_t(bodies.size()) : c.second;
  p.inverse_mass_first = a.inverse_mass;
  p.friction = c.law.friction, p.bound = -1.0, p.most_impulse = c.most_impulse;
  p.target = D4{c.target, 0.0, 0.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = frame.col(i), turning = c.arm_first.cross(axis), response = a.inverse_inertia * turning;
    Row& row = p.rows[i];
    row.axis = lanes_of(axis), row.turning_first = lanes_of(turning), row.response_first = lanes_of(response);
    double inverse = a.inverse_mass + turning.dot(response);
    if (c.second >= 0) {
      const SolverBody& b = bodies[c.second];
      const Vec3 turning_second = c.arm_second.cross(axis),
                 response_second = b.inverse_inertia * turning_second;
      row.turning_second = lanes_of(turning_second), row.response_second = lanes_of(response_second);
      p.inverse_mass_second = b.inverse_mass;
      inverse += b.inverse_mass + turning_second.dot(response_second);
    }
    p.effective_mass[i] = inverse > 0.0 ? 1.0 / inverse : 0.0;
  }
  return p;
}

LODESTONE_INLINE D4 sums_of(const D4& a, const D4& b, const D4& c) {
  const V4 columns = columns_of(a, b, c, D4{});
  return columns.x + columns.y + columns.z;
}

LODESTONE_INLINE D4 velocity_along(const Row& row, const D4& velocity, const D4& turns_first,
                                   const D4& turns_second) {
  return row.axis * velocity + row.turning_first * turns_first - row.turning_second * turns_second;
}

/// Changes a point's impulse and what it acts on.
LODESTONE_INLINE void answer(Round round, Point& p, Motion* motions, Progress& progress) {
  Motion &a = motions[p.first], &b = motions[p.second];
  const Row* rows = p.rows;
  if (round == Round::frictionless) {
    const D4 along = velocity_along(rows[0], a.velocity - b.velocity, a.angular, b.angular);
    const double speed = along[0] + along[1] + along[2], held = p.impulse[0],
                 asked = held + p.effective_mass[0] * (p.target[0] - speed),
                 now = std::min(p.most_impulse, std::max(0.0, asked)), change = now - held;
    p.impulse[0] = now;
    a.velocity += (p.inverse_mass_first * change) * rows[0].axis;
    a.angular += change * rows[0].response_first;
    progress.change = std::max(progress.change, std::abs(change));
    progress.impulse = std::max(progress.impulse, now);
    if (p.inverse_mass_second == 0.0) return;
    b.velocity -= (p.inverse_mass_second * change) * rows[0].axis;
    b.angular -= change * rows[0].response_second;
    return;
  }
  D4 change = p.impulse;
  if (round == Round::relaxed) {
    const D4 apart = a.velocity - b.velocity;
    const D4 speeds = sums_of(velocity_along(rows[0], apart, a.angular, b.angular),
                              velocity_along(rows[1], apart, a.angular, b.angular),
                              velocity_along(rows[2], apart, a.angular, b.angular));
    const D4 asked = p.impulse + p.effective_mass * (p.target - speeds);
    const double normal = std::min(p.most_impulse, std::max(0.0, asked[0])),
                 bound = p.bound >= 0.0 ? p.bound : p.friction * normal;
    const D4 now = most(D4{normal, -bound, -bound, 0.0}, least(asked, D4{normal, bound, bound, 0.0}));
    change = now - p.impulse;
    p.impulse = now;
    const D4 size = absolute(change);
    progress.change = std::max(progress.change, size[0] + size[1] + size[2]);
    progress.impulse = std::max(progress.impulse, normal);
  }
  const D4 impulse = change[0] * rows[0].axis + change[1] * rows[1].axis + change[2] * rows[2].axis;
  a.velocity += p.inverse_mass_first * impulse;
  a.angular += change[0] * rows[0].response_first + change[1] * rows[1].response_first +
               change[2] * rows[2].response_first;
  if (p.inverse_mass_second == 0.0) return;
  b.velocity -= p.inverse_mass_second * impulse;
  b.angular -= change[0] * rows[0].response_second + change[1] * rows[1].response_second +
               change[2] * rows[2].response_second;
}

// One round over runs [begin, end), which are in order of their lengths: the first point of each, then the
// second of each, and so on. Each point waits for the one before it in its run, but not for those of others.
struct RoundLoop {
  Arrays& arrays;
  Round round;

  LODESTONE_INLINE void operator()(std::int64_t begin, std::int64_t end) const {
    Progress* runs = arrays.progress.data();
    for (std::int64_t i = begin; i < end; ++i) runs[i].change = runs[i].impulse = 0.0;
    std::int64_t last = end;
    for (std::uint32_t k = 0;; ++k) {
      while (last > begin && runs[last - 1].count <= k) --last;
      if (last == begin) return;
      for (std::int64_t i = begin; i < last; ++i)
        answer(round, arrays.points[runs[i].begin + k], arrays.motions.data(), runs[i]);
    }
  }
};

void begin_rounds(Arrays& arrays, std::span<const IslandRun> runs) {
  arrays.progress.clear();
  for (const IslandRun& run : runs) arrays.progress.push_back({run.begin, run.count, run.sweeps});
  std::ranges::sort(arrays.progress, std::greater{},
                    &Progress::count);  // equal ones in any order: they share nothing
}

// Each run until nothing changes in it any more.
void sweep(Arrays& arrays, Round round, std::span<const IslandRun> runs, double tolerance, Simd simd) {
  begin_rounds(arrays, runs);
  while (!arrays.progress.empty()) {
    run_wide(simd, RoundLoop{arrays, round}, 0, std::int64_t(arrays.progress.size()));
    std::erase_if(arrays.progress,
                  [&](Progress& run) { return --run.sweeps <= 0 || run.change <= tolerance * run.impulse; });
  }
}

void give_guesses(Arrays& arrays, std::span<const IslandRun> runs, Simd simd) {
  begin_rounds(arrays, runs);
  run_wide(simd, RoundLoop{arrays, Round::guesses}, 0, std::int64_t(runs.size()));
}

// What the normal impulses are without friction bounds it.
void bound_friction(Arrays& arrays, std::span<SolverContact> contacts, std::span<const IslandRun> runs,
                    double tolerance, Simd simd) {
  arrays.before = arrays.motions;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const SolverContact& c = contacts[i];
    const double known = c.frictionless >= 0.0 ? c.frictionless : std::max(0.0, c.guess.dot(c.normal)),
                 guess = std::min(known, c.most_impulse);
    arrays.points[i].impulse = D4{c.bounces ? 0.0 : guess, 0.0, 0.0, 0.0};
  }
  give_guesses(arrays, runs, simd);
  sweep(arrays, Round::frictionless, runs, tolerance, simd);
  std::swap(arrays.motions, arrays.before);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Point& p = arrays.points[i];
    contacts[i].frictionless = p.impulse[0];
    p.bound = p.friction * p.impulse[0];
  }
}

void start_from_guess(const SolverContact& c, Point& p) {
  p.impulse = D4{};
  if (c.bounces) return;
  p.impulse[0] = std::min(c.most_impulse, std::max(0.0, c.guess.dot(c.normal)));
  const double bound = p.bound >= 0.0 ? p.bound : p.friction * p.impulse[0];
  for (int t = 0; t < 2; ++t) p.impulse[t + 1] = std::clamp(c.guess.dot(c.tangent[t]), -bound, bound);
}

}  // namespace

// With v₀ the velocity before the step's gravity a, the gap h is closed at vᵢ = −√(v₀² − 2 a h), after
// t = −2 h/(v₀ + vᵢ) (v is linear in time, so h is the mean velocity times t); then −e vᵢ, and a for what is
// left.
double bounce_in_fall(double restitution, double gap, double approach, double fall, double step) {
  const double before = approach - fall, acceleration = fall / step, way = std::max(0.0, gap);
  const double impact = -std::sqrt(std::max(0.0, before * before - 2.0 * acceleration * way));
  const double time = before + impact < 0.0 ? std::clamp(-2.0 * way / (before + impact), 0.0, step) : 0.0;
  return -restitution * impact + acceleration * (step - time);
}

void solve_contacts(std::span<SolverBody> bodies, std::span<SolverContact> contacts, double step,
                    const ContactSolverSettings& settings, Simd simd) {
  const IslandRun all{0, std::uint32_t(contacts.size()), settings.sweeps};
  solve_contacts(bodies, contacts, {&all, 1}, step, settings, simd);
}

void solve_contacts(std::span<SolverBody> bodies, std::span<SolverContact> contacts,
                    std::span<const IslandRun> runs, double step, const ContactSolverSettings& settings,
                    Simd simd) {
  thread_local Arrays arrays;
  arrays.motions.clear(), arrays.points.clear();
  for (const SolverBody& body : bodies)
    arrays.motions.push_back({lanes_of(body.velocity), lanes_of(body.angular_velocity)});
  arrays.motions.emplace_back();
  for (SolverContact& c : contacts) arrays.points.push_back(prepare(bodies, c, step, settings));
  if (settings.frictionless_bound) bound_friction(arrays, contacts, runs, settings.tolerance, simd);
  for (std::size_t i = 0; i < contacts.size(); ++i) start_from_guess(contacts[i], arrays.points[i]);
  give_guesses(arrays, runs, simd);
  sweep(arrays, Round::relaxed, runs, settings.tolerance, simd);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) contacts[i].impulse[axis] = arrays.points[i].impulse[axis];
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].inverse_mass == 0.0) continue;
    const auto& [v, w] = arrays.motions[i];
    bodies[i].velocity = {v[0], v[1], v[2]};
    bodies[i].angular_velocity = {w[0], w[1], w[2]};
  }
}

}  // namespace lodestone
