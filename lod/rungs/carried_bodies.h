// Stage 3d: who is moved, directly or through others that it touches, by what nothing stops: a kinematic
// body, ground that moves, what a motor drives. None of them sleeps, however slowly it goes: a sleeper would
// stand in its way like ground.
#pragma once

#include <span>
#include <vector>

#include "lod/contact/contact_scene.h"
#include "lod/contact/crowd.h"
#include "lod/contact/solid_contacts.h"
#include "reference/disjoint_sets.h"

namespace lodestone {

class CarriedBodies {
 public:
  /// From the contacts of a substep, and those that full bodies had in ODE's last one.
  void find(const ContactScene& scene, std::span<const CrowdContact> contacts,
            std::span<const SolidContact> solid_contacts, std::span<const FullContact> full_contacts = {});
  bool none() const { return !any_; }
  /// Of one that has a contact of those given to find().
  bool contains(Participant p) { return any_ && sets_.root_of(node_of(p)) == sets_.root_of(0); }

 private:
  std::int32_t node_of(Participant p) const {
    return std::int32_t(1 + p.index() + (p.is_full() ? bodies_ : 0));
  }

  bool any_ = false;
  std::size_t bodies_ = 0;  // statistical ones
  DisjointSets sets_;       // node 0: what nothing stops
};

}  // namespace lodestone
