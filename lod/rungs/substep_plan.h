// Stage 3: in how many substeps those bodies move that may touch another. A pile needs them: contacts found
// once in 1/60 s miss what a body that falls into it at several m/s meets on its way, and ten sweeps over a
// pile of many layers leave it sinking into itself (a bin of 100 boxes: time to sleep three times ODE's, a
// third too low). After Macklin et al., Small steps in physics simulation, 2019.
#pragma once

#include <vector>

#include "lod/contact/contact_scene.h"
#include "lod/contact/solid_contacts.h"
#include "lod/rungs/near_marks.h"
#include "lod/rungs/near_pairs.h"

namespace lodestone {

class SubstepPlan {
 public:
  /// How many of them, for a step of `dt` seconds; 0 where none may touch another. Marks those that may.
  int make(const ContactScene& scene, const NearPairs& pairs, std::span<const SolidContact> solid_contacts,
           double dt, NearMarks& near);

 private:
  double mark_followers(const ContactScene& scene, double dt, NearMarks& near);

  std::vector<const FoundPair*> following_;  // of which neither gains on the other
};

}  // namespace lodestone
