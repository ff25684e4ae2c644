// Many bodies of one shape in a bin, or floating free, under any method.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lod/ground/ground.h"
#include "tools/compare/drop_method.h"

namespace lodestone {

/// What bodies fall into: planes and gravity.
struct PileSurroundings {
  std::vector<HalfSpace> planes = {};
  Vec3 gravity{0, 0, -9.81};  ///< m/s²
  bool sleeping = true;       ///< of the statistical level: what falls asleep stops, and its momentum is gone
};

/// A floor at z = 0 and four walls without end, `side` m apart about the origin.
PileSurroundings make_bin(double side);

/// No ground and no gravity.
PileSurroundings make_empty_space();

class PileWorld {
 public:
  /// `job` and `method` must outlive the world. What follows depends on the arguments alone.
  PileWorld(const DropJob& job, const DropMethod& method, const PileSurroundings& surroundings,
            std::span<const RigidState> starts, std::uint64_t seed);

  void step(double dt);
  int bodies() const;
  RigidState state(int body) const;
  int awake() const;  ///< bodies; all of them where a method is watched without its sleep

 private:
  struct Ode {
    OdeWorld world;
    std::vector<OdeBodyId> bodies;
  };
  struct Statistical {
    Manager manager;
    std::vector<BodyId> bodies;
  };
  struct Bullet {
    BulletWorld world;
    std::vector<int> bodies;
  };
  void fill_ode(const DropJob& job, const OdeMethod& way, const PileSurroundings& surroundings,
                std::span<const RigidState> starts, std::uint64_t seed);
  void fill_statistical(const DropJob& job, const StatisticalMethod& way,
                        const PileSurroundings& surroundings, std::span<const RigidState> starts,
                        std::uint64_t seed);
  void fill_bullet(const DropJob& job, const BulletMethod& way, const PileSurroundings& surroundings,
                   std::span<const RigidState> starts);

  int substeps_;
  std::unique_ptr<MaterialTable> materials_;  // outlives the ODE world, and stays where it is
  std::optional<Ode> ode_;
  std::optional<Statistical> statistical_;
  std::optional<Bullet> bullet_;
};

}  // namespace lodestone
