// Which bodies the contact joints of a substep join. ODE gives out a body's joints by their numbers in a list
// that it walks from its beginning each time: to go through those of a raft with a thousand crates on it
// takes sixteen million steps.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "reference/ode/runtime_ode.h"

namespace lodestone::ode {

class ContactGraph {
 public:
  void clear();
  /// `joints` of them were attached between the two; null: to the world. No other joints are attached
  /// meanwhile.
  void add(dBodyID first, dBodyID second, int joints);
  /// Whom `body` meets.
  std::span<const dBodyID> met_by(dBodyID body) const;
  /// Whether the predicate holds for any joint of `body` but these, which come before all that were attached
  /// earlier.
  template <class Predicate>
  bool any_other_joint(dBodyID body, const Predicate& predicate) const {
    const int count = dBodyGetNumJoints(body);
    for (int i = node_of(body).joints; i < count; ++i)
      if (predicate(dBodyGetJoint(body, i))) return true;
    return false;
  }

 private:
  struct Node {
    int joints = 0;
    std::vector<dBodyID> met;
  };
  const Node& node_of(dBodyID body) const;
  void add_to(dBodyID body, dBodyID other, int joints);

  std::unordered_map<dBodyID, std::size_t> number_;  // of those that have any
  std::vector<Node> nodes_;                          // by number; those behind keep their room
};

}  // namespace lodestone::ode
