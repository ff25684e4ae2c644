#include "reference/ode/contact_graph.h"

namespace lodestone::ode {

void ContactGraph::clear() { number_.clear(); }

void ContactGraph::add(dBodyID first, dBodyID second, int joints) {
  if (first) add_to(first, second, joints);
  if (second) add_to(second, first, joints);
}

void ContactGraph::add_to(dBodyID body, dBodyID other, int joints) {
  const auto [known, is_new] = number_.try_emplace(body, number_.size());
  if (known->second == nodes_.size()) nodes_.emplace_back();
  Node& node = nodes_[known->second];
  if (is_new) node.joints = 0, node.met.clear();
  node.joints += joints;
  if (other) node.met.push_back(other);
}

const ContactGraph::Node& ContactGraph::node_of(dBodyID body) const {
  static const Node kNone;
  const auto known = number_.find(body);
  return known == number_.end() ? kNone : nodes_[known->second];
}

std::span<const dBodyID> ContactGraph::met_by(dBodyID body) const { return node_of(body).met; }

}  // namespace lodestone::ode
