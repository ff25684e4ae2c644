// The bodies of a manager and the rungs that they are on: what is the same to do with a body whatever its rung.
#pragma once

#include <memory>
#include <vector>

#include "lod/full/full_level.h"
#include "lod/manager/body_table.h"
#include "lod/manager/full_pairs.h"
#include "lod/manager/signature_store.h"
#include "lod/rungs/statistical_level.h"

namespace lodestone {

struct Levels {
  Levels(const StatisticalSettings& statistical_level, const FullSettings& full_level, SignatureStore store)
      : full(full_level, materials), statistical_settings(statistical_level), signatures(std::move(store)) {}
  Levels(dxWorld* world, dxSpace* space, const StatisticalSettings& statistical_level, const FullSettings& full_level,
         SignatureStore store)
      : full(world, space, full_level, materials), statistical_settings(statistical_level), signatures(std::move(store)) {}
  Levels(const Levels&) = delete;  // the levels point at materials and ground
  Levels& operator=(const Levels&) = delete;

  MaterialTable materials;
  StaticGround ground;
  BodyTable bodies;
  FullLevel full;
  std::unique_ptr<StatisticalLevel> statistical;  ///< null until a first body is statistical
  StatisticalSettings statistical_settings;
  SignatureStore signatures;
  std::int64_t now = 0;                           ///< steps so far

  /// The law between a body and the ground that it most likely meets: the first plane, else ground of the default material.
  ContactLaw ground_law(MaterialId material) const;

  RigidState state(std::uint32_t body) const;
  bool asleep(std::uint32_t body) const;
  /// Wakes the body and what was near it.
  void set_state(std::uint32_t body, const RigidState& state);
  void wake(std::uint32_t body);
  /// Wakes every other body of `level` whose bounding sphere meets that of `body`.
  void wake_near(std::uint32_t body, Level level);
  /// Adds the other bodies of `level`, or those of them that sleep, whose bounding sphere meets that of `body`, both `factor` times as large.
  void find_near(std::uint32_t body, double factor, Level level, std::vector<std::uint32_t>& near, bool asleep_only) const;
  /// That the full bodies make as they are.
  PairWeights full_pairs() const;
  /// Gives bodies the forces that are held for them, over the next step of their level.
  void give_forces();
};

}  // namespace lodestone
