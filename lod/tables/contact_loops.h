// The arithmetic of contacts between spheres, many at a time: what each reads of its bodies is brought
// together first, and what it gives them is added after.
#pragma once

#include "lod/tables/sphere_contacts.h"

namespace lodestone {

/// Contacts that the loops take at a time: a run begins at a multiple, and they may read and write up to the
/// next one beyond its end.
inline constexpr std::size_t kContactChunk = 32;

/// Appends a run of those of the pairs that touch, or will within the step, without impulses.
ContactRun find_touching(const BallPairs& pairs, const Spheres& spheres, const SphereKinds& kinds,
                         const StepConstants& constants, float touching, Simd simd, ContactArrays& contacts);

struct SweepSettings {
  const SphereContactSettings& contact;
  std::span<const lane::Row> ground_velocities;  // m/s, by the planes' numbers
  bool one_law = false;                          // of all contacts of the run, and their bodies of one kind
  ContactLaw only_law;
  float bounce_velocity = 0.0f;  // m/s
  bool last = false;
  bool eased = false;  // some bodies are
};

/// A round of the contacts given.
SweepOutcome sweep_contacts(const SweepSettings& settings, const Spheres& spheres, const SphereKinds& kinds,
                            const StepConstants& constants, Simd simd, const ContactRun& contacts,
                            SphereStep& step);

/// Moves bodies out of overlaps deeper than SphereContactSettings::deep, but for those that are eased.
void move_apart(const SphereContactSettings& settings, const Spheres& spheres, const SphereKinds& kinds,
                const ContactRun& contacts, SphereStep& step);

}  // namespace lodestone
