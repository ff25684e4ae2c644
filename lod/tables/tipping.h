// What is pressed beside its centre of mass tips over: turns of bodies among others, whose contacts else act
// through their centres. A contact lies where both hulls are likely to be touched: each has, in the direction
// of the contact, a mean and a spread of its farthest points, wide along a face or an edge, none at a corner,
// and the two are joined as independent measurements of one point are. There the contact's impulse has its
// torque, of a compact body by what is left of its lever once pressure has gone towards the centre of mass as
// far as it can within the patch. The body gives way to it without inertia, so that turning takes potential
// energy away and leaves no motion: what knows its hull turns as it sinks till it lies on a face or is held.
#pragma once

#include <vector>

#include "lod/simd/row.h"
#include "lod/tables/sphere_contacts.h"
#include "lod/tables/sphere_ground.h"

namespace lodestone {

/// One row an awake body, and one for all that sleep.
struct TippingStep {
  std::vector<lane::Row> torque;  ///< xyz m²/s: of the impulses, over mass; w m/s: their sum, over mass
  std::vector<float> turned;      ///< rad
  void clear(std::size_t awake);
  std::size_t bytes() const {
    return torque.capacity() * sizeof(lane::Row) + turned.capacity() * sizeof(float);
  }
};

/// Of contacts after the last round.
void add_torques(const ContactRun& contacts, const Spheres& spheres, const SphereKinds& kinds,
                 float bounce_velocity, TippingStep& tipping);

/// Adds the torque of the ground that carries them, and turns the bodies at places [begin, end).
void tip(Spheres& spheres, const SphereKinds& kinds, const SphereGround& ground,
         const StepConstants& constants, const SphereStep& step, std::int64_t begin, std::int64_t end,
         TippingStep& tipping);

}  // namespace lodestone
