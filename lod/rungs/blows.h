// Stage 3d: who sleeps, of the hulls that touch, but is set in motion by a blow through others.
#pragma once

#include <cstdint>
#include <vector>

#include "lod/contact/contact_scene.h"
#include "lod/rungs/near_pairs.h"
#include "lod/statistical/blow_reach.h"
#include "lod/statistical/rest_law.h"

namespace lodestone {

class Blows {
 public:
  /// From the contacts that `pairs` has found for a substep; each once.
  void find(const ContactScene& scene, const NearPairs& pairs, const RestLaw& law,
            std::vector<Participant>& struck);

 private:
  std::int32_t number_of(const ContactScene& scene, const RestLaw& law, Participant p);

  BlowReach reach_;
  std::vector<Participant> participants_;                          // by their numbers in it
  std::vector<std::int32_t> number_of_body_, number_of_neighbor_;  // −1: none
};

}  // namespace lodestone
