// The contacts of one island by themselves: what a solver asks of all bodies of a crowd it asks of these
// alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lod/contact/crowd_lanes.h"

namespace lodestone {

class IslandContacts {
 public:
  /// Takes the manifolds `which` of `crowd`, with their bodies in the order in which they come.
  void take(const CrowdContacts& crowd, std::span<const std::uint32_t> which) {
    if (number_.size() < crowd.bodies.size()) number_.resize(crowd.bodies.size(), -1);
    bodies_.clear(), owners_.clear(), manifolds_.clear(), which_.clear();
    for (const std::uint32_t m : which) {
      CrowdManifold& own = manifolds_.emplace_back(crowd.manifolds[m]);
      own.first = number_of(own.first, crowd), own.second = number_of(own.second, crowd);
      which_.push_back(std::uint32_t(which_.size()));
    }
    for (const std::int32_t body : owners_) number_[std::size_t(body)] = -1;
  }
  /// The impulses at their points are those of the crowd.
  CrowdContacts contacts(const CrowdContacts& crowd) {
    return {bodies_, manifolds_, crowd.points, crowd.step, crowd.settings};
  }
  std::span<const std::uint32_t> which() const { return which_; }  ///< all of them
  /// Gives the crowd's bodies the velocities that these have now.
  void hand_out(const CrowdContacts& crowd) const {
    for (std::size_t i = 0; i < owners_.size(); ++i) {
      SolverBody& body = crowd.bodies[std::size_t(owners_[i])];
      body.velocity = bodies_[i].velocity, body.angular_velocity = bodies_[i].angular_velocity;
    }
  }

 private:
  std::int32_t number_of(std::int32_t body, const CrowdContacts& crowd) {
    if (body < 0) return body;
    std::int32_t& number = number_[std::size_t(body)];
    if (number < 0) {
      number = std::int32_t(owners_.size());
      owners_.push_back(body), bodies_.push_back(crowd.bodies[std::size_t(body)]);
    }
    return number;
  }

  std::vector<std::int32_t> number_, owners_;  // of each body of the crowd, −1: none; and back
  std::vector<SolverBody> bodies_;
  std::vector<CrowdManifold> manifolds_;
  std::vector<std::uint32_t> which_;
};

}  // namespace lodestone
