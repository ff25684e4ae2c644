// How many bytes a step of the tables model moves between the processor and memory, counted from its arrays:
// what a machine's bandwidth is to be compared with.
#pragma once

#include "lod/broad_phase/cell_grid.h"
#include "lod/tables/sphere_contacts.h"
#include "lod/tables/sphere_motion.h"
#include "lod/tables/spheres.h"

namespace lodestone {

/// What a step went over.
struct TablesTraffic {
  const Spheres& spheres;
  const SphereStep& step;
  const SphereContacts& contacts;
  bool pair_phase = false, ground = false, rest = false;
  int sweeps = 0;  // of the contacts
};

/// Each loop over all bodies, or all contacts, reads and writes each of its arrays once; loops that follow
/// each other block by block count together, as a block stays in the cache. What is looked up across, the
/// bodies of a contact, is counted once a body and loop. So it is the least that a level whose arrays exceed
/// the cache can move, where it lies in memory as it lies in space.
double count_bytes_moved(const TablesTraffic& traffic);

}  // namespace lodestone
