// Spheres that touch: found, and answered all at once. Each contact looks at the velocities as they were before any of them, with each body's mass split
// among its contacts (Tonge, Benevolenski and Voroshilov, Mass splitting for jitter-free parallel rigid body simulation, 2012): the order of contacts does not matter,
// impulses are equal and opposite, and no energy is added. What a contact gave in the last step it gives at once in this one, so that piles stand.
#pragma once

#include <array>
#include <vector>

#include "lod/jobs.h"
#include "lod/tables/cell_grid.h"
#include "lod/tables/sphere_motion.h"

namespace lodestone {

struct SphereContact {
  std::uint32_t first = 0, second = 0;   // places; beyond those awake: asleep, does not move
  float nx = 0.0f, ny = 0.0f, nz = 0.0f; // from the second to the first
  float gap = 0.0f;                      // m, negative: overlap
  float closing = 0.0f;                  // m/s at the start of the step, negative: nearing
  float impulse = 0.0f;                  // N s
};

/// One of a body's contacts of the last step.
struct KnownContact {
  std::uint32_t owner = 0;               // the other's
  float force = 0.0f;                    // N
};

struct SphereContactSettings {
  int sweeps = 2;
  float touching = 0.01f;                // m over R: gaps up to it are contacts
  float slop = 0.002f, push_out = 0.5f;  // overlap that stays, over R; part of the rest that is undone in a step
};

class SphereContacts {
 public:
  /// Between awake bodies.
  void find(const Spheres& spheres, const SphereKinds& kinds, const CellGrid& grid, const StepConstants& constants, const JobRunner& jobs);
  /// One more, if the two touch: of an awake body with any other.
  void add(const Spheres& spheres, const SphereKinds& kinds, std::uint32_t first, std::uint32_t second, const StepConstants& constants);

  /// Counts each body's contacts and gives the impulses known from the last step.
  void begin(const Spheres& spheres, const SphereKinds& kinds, float bounce_velocity, SphereStep& step, const JobRunner& jobs);
  /// One round of all contacts; the last one has friction and moves bodies out of overlaps.
  void sweep(const Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials, float bounce_velocity, const StepConstants& constants, bool last,
             SphereStep& step, const JobRunner& jobs);
  /// For the next step.
  void remember(Spheres& spheres, float bounce_velocity, const StepConstants& constants);
  void forget() { known_.clear(); }

  const SphereContactSettings& settings() const { return settings_; }
  std::int64_t count() const;
  template <class Visit>
  void each(const Visit& visit) const {
    for (const auto& part : parts_)
      for (const SphereContact& contact : part.contacts) visit(contact);
  }
  void clear();

 private:
  struct Part {
    int colour = 0;
    std::vector<SphereContact> contacts;
  };
  template <bool OneKind, bool Last>
  void sweep_part(Part& part, const Spheres& spheres, const SphereKinds& kinds, const MaterialTable& materials, float bounce_velocity,
                  const StepConstants& constants, SphereStep& step) const;
  template <class Task>
  void run_by_colour(const JobRunner& jobs, const Task& task);
  void add_to(Part& part, const Spheres& spheres, const SphereKinds& kinds, std::uint32_t first, std::uint32_t second, const StepConstants& constants) const;
  float known_impulse(const Spheres& spheres, std::uint32_t first, std::uint32_t second, float time) const;

  SphereContactSettings settings_;
  std::vector<Part> parts_;       // the grid's, and one for contacts that were added
  std::size_t used_parts_ = 0;
  std::array<std::vector<std::uint32_t>, CellGrid::kColours + 1> of_colour_;
  std::vector<KnownContact> known_;
};

}  // namespace lodestone
