// The bodies of table 1 in a world of any method.
#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "tools/compare/drop_method.h"

namespace lodestone {

struct Table1WorldSettings {
  int bodies = 10;
  int threads = 1;  ///< of the statistical level
  bool sleeping = false;
  bool hash_space = false;  ///< of ODE's, instead of sweep and prune
  std::uint64_t seed = 1;
};

/// Of a step, ms: on one thread processor time, which other work on the machine does not lengthen (wall time
/// where that is less: reading its clock costs some .2 us); on several, wall time. The stages, in wall time,
/// only where the method tells them apart; they are not all of a step.
struct StepMs {
  double step = 0.0;
  double bytes_moved = 0.0;  ///< where the method counts them
  std::optional<double> collision = {}, response = {}, rest = {};
};

class Table1World {
 public:
  /// `job` and `method` must outlive the world.
  Table1World(const DropJob& job, const DropMethod& method, const Table1WorldSettings& settings);

  StepMs step(double dt);
  int awake() const;
  std::uint64_t state_hash() const;
  /// Of the heap, per body, that this world holds.
  double bytes_per_body() const;
  /// Of the statistical level's arrays alone; 0 where nobody counts them.
  double level_bytes_per_body() const;

 private:
  struct Ode {
    OdeWorld world;
    std::vector<OdeBodyId> bodies;
  };
  struct Statistical {
    Manager manager;
    std::vector<BodyId> bodies;
  };
  void make_ode(const DropJob& job, const OdeMethod& way);
  void make_bullet(const DropJob& job, const BulletMethod& way);
  void make_statistical(const DropJob& job, const StatisticalMethod& way);
  RigidState state(int body) const;
  bool asleep(int body) const;

  double heap_before_;
  Table1WorldSettings settings_;
  const DropMethod& method_;
  std::unique_ptr<MaterialTable> materials_;  // outlives the ODE world, and stays where it is
  std::optional<Ode> ode_;
  std::optional<BulletWorld> bullet_;
  std::optional<Statistical> statistical_;
};

}  // namespace lodestone
