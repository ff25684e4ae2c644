// One body above one plane, under any method.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "tools/compare/drop_method.h"

namespace lodestone {

/// A plane on which one body at a time falls.
class DropWorld {
 public:
  /// `job` and `method` must outlive the world.
  DropWorld(const DropJob& job, const DropMethod& method);

  /// Replaces the body by that of drop `trial`. What follows depends on (seed, trial) alone, not on earlier
  /// drops.
  void start(std::uint64_t seed, std::uint32_t trial);
  void step(double dt);
  RigidState state() const;
  /// Since start(): look-ups outside of what the signature was measured for; 0 for other methods than
  /// `statistical`.
  std::int64_t table_extrapolations() const;

 private:
  struct Ode {
    OdeWorld world;
    OdeBodyId body;
  };
  struct Statistical {
    Manager manager;
    BodyId body;
  };
  struct Bullet {
    BulletWorld world;
    int body;
  };
  void start_ode(const RigidState& state);
  void start_bullet(const RigidState& state);
  void start_statistical(const RigidState& state, std::uint64_t seed, std::uint32_t trial);

  const DropJob& job_;
  const DropMethod& method_;
  std::unique_ptr<MaterialTable> materials_;  // outlives the ODE world, and stays where it is
  std::optional<Ode> ode_;
  std::optional<Bullet> bullet_;
  std::optional<Statistical> statistical_;
};

/// Drops 0 … bodies − 1 in one manager, too far apart to meet.
Manager make_many_drops(const DropJob& job, const StatisticalMethod& method, std::uint64_t seed, int bodies);

}  // namespace lodestone
