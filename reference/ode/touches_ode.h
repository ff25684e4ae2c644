// What touched what in a whole step, and how hard: from what ODE says of the forces of its contact joints.
#pragma once

#include <deque>
#include <map>
#include <tuple>
#include <vector>

#include "reference/ode/joints_ode.h"

namespace lodestone::ode {

class Touches {
 public:
  void begin_step();
  /// Or begins it again: what was watched in one that is taken back has not happened.
  void begin_substep() { watched_.clear(); }
  /// A contact of the substep to come; the joint must live until end_substep.
  void watch(dJointID joint, const ContactSide& first, const ContactSide& second, const ContactPoint& point,
             double approach);
  /// `h`: the substep that ended, s.
  void end_substep(double h);

  /// By pair, in the order in which they were first met.
  std::span<const OdeTouch> all() const { return touches_; }

 private:
  struct Watched {
    OdeTouch contact;  // one, which has given nothing yet
    dJointFeedback feedback;
  };
  using Pair = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, dGeomID>;

  std::size_t place_of(const OdeTouch& contact);

  std::vector<OdeTouch> touches_;
  std::vector<double> hardest_;  // N s, of a single contact of each
  std::map<Pair, std::size_t> index_;
  std::deque<Watched> watched_;  // whose addresses ODE keeps
};

}  // namespace lodestone::ode
