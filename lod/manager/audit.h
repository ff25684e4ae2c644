// Bodies that went down from the full level, simulated on in full beside the world, off line: what the
// demotion cost in truth. Such as meet nothing but planes are compared, body by body, since both see the same
// ground alone. Nothing of the world depends on it.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "lod/manager/levels.h"
#include "lod/step_report.h"

namespace lodestone {

/// Mean and spread of what comes one by one.
class RunningMean {
 public:
  void add(double value);
  double mean() const { return mean_; }
  double deviation() const;       ///< of the values
  double standard_error() const;  ///< of the mean
  std::int64_t count() const { return count_; }

 private:
  std::int64_t count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

/// What is kept of one body's way to rest.
class WayToRest {
 public:
  WayToRest(const RigidState& start, double size)
      : start_(start.position), size_(size), a_second_on_(start.position) {}
  /// `asleep`: nothing more is to come.
  void sample(double time_s, const RigidState& state, double energy_per_mass, bool asleep);
  bool done() const { return done_; }
  double rest_time_s() const { return rest_time_; }
  double distance_m(const Vec3& up) const;
  double rest_height(const Vec3& up) const { return last_.dot(up) / size_; }
  const Vec3& a_second_on() const { return a_second_on_; }

 private:
  Vec3 start_;
  double size_;
  Vec3 a_second_on_, last_ = Vec3::Zero();
  double rest_time_ = 0.0;
  bool done_ = false;
};

class Audit {
 public:
  /// `audit_ms`: of each step; 0: none.
  Audit(Levels& levels, const FullSettings& full, double audit_ms)
      : levels_(levels), full_(full), audit_ms_(audit_ms) {}

  bool on() const { return audit_ms_ > 0.0; }
  /// A body that has just gone down, with the state that it had.
  void watch(std::uint32_t body, const RigidState& state);
  /// All bodies may be others, or elsewhere: those not yet compared are left out.
  void forget_watched();
  /// Before a step: what the caller pushed or moved is left out.
  void begin_step();
  /// After a step of `dt` seconds: looks at those watched, and goes on with the one that is simulated.
  void end_step(double dt, StepReport& report);

 private:
  struct Watched {
    std::uint32_t body = 0;
    std::uint64_t birth = 0;
    std::int64_t number = 0;  // of this going down: the body may do so again
    RigidState start, seen;   // at demotion; after the last step
    std::shared_ptr<const Shape> shape;
    double mass = 1.0;
    MaterialId material = 0;
    double time_s = 0.0;
    WayToRest demoted;
    std::optional<WayToRest> full = {};  // once it has been simulated
  };
  bool still_watched(const Watched& watched) const;
  void look_at(Watched& watched, double dt);
  void simulate(const Watched& watched, double dt);
  bool world_is_current() const;
  void begin(const Watched& watched);
  void compare(const Watched& watched);
  void fill(AuditReport& report) const;

  Levels& levels_;
  FullSettings full_;
  double audit_ms_;
  std::deque<Watched> watched_;
  std::optional<OdeWorld> world_;  // with the planes of the ground and one body
  std::vector<HalfSpace> planes_;  // that it has
  OdeBodyId simulated_ = {};
  std::int64_t numbers_ = 0;           // given
  std::int64_t simulated_number_ = 0;  // of the watched that it is
  double simulated_s_ = 0.0;
  std::optional<WayToRest> way_;
  RunningMean rest_time_full_, rest_time_, rest_time_difference_, distance_full_, distance_,
      distance_difference_, height_full_, height_, height_difference_, drift_;
  int left_out_ = 0;
  double spent_ms_ = 0.0;
};

}  // namespace lodestone
