// A world of any method: bodies of one shape over planes, whichever engine moves them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "lod/ground/ground.h"
#include "tools/methods/method.h"

namespace lodestone {

/// What the bodies are in.
struct WorldSettings {
  std::vector<HalfSpace> planes = {};  ///< of the job's material
  GroundSolidsOfWorld solids = {};     ///< likewise; not in Bullet's world
  Vec3 gravity{0, 0, -9.81};           ///< m/s²
  std::uint64_t seed = 1;
  int threads = 1;       ///< of the statistical level
  bool sleeping = true;  ///< of the statistical level: what falls asleep stops, and its momentum is gone
};

class MethodWorld {
 public:
  /// A body of the job for each of `starts`; what follows depends on the arguments alone. `job` and `method`
  /// must outlive the world.
  MethodWorld(const DropJob& job, const Method& method, const WorldSettings& settings,
              std::span<const RigidState> starts);

  /// Other bodies in place of these, in the same surroundings, and `seed` for the manager's draws. ODE's
  /// world stays, with what it built of the shape and the seed that it had, and so does a manager with
  /// solids, which take long to make, unless its model draws; any other is made anew.
  void restart(std::uint64_t seed, std::span<const RigidState> starts);

  void step(double dt);
  int bodies() const;
  RigidState state(int body = 0) const;
  bool asleep(int body) const;
  int awake() const;  ///< bodies; all of them where a method is watched without its sleep

  /// The engine where it is that one, else null.
  const OdeWorld* ode() const;
  const Manager* manager() const;

 private:
  template <class World, class Id>
  struct Filled {
    World world;
    std::vector<Id> bodies;
  };
  using Ode = Filled<OdeWorld, OdeBodyId>;
  using Statistical = Filled<Manager, BodyId>;
  using Bullet = Filled<BulletWorld, int>;
  using World = std::variant<Ode, Statistical, Bullet>;
  World make_world() const;
  void fill(std::span<const RigidState> starts);
  bool empty();  ///< removes its bodies; false: it cannot

  const DropJob& job_;
  const Method& method_;
  WorldSettings settings_;
  std::unique_ptr<MaterialTable> materials_;  // outlives the ODE world, and stays where it is
  World world_;
};

/// With the signature of `method`, which is the only one that any body needs.
ManagerSettings manager_settings_of(const StatisticalMethod& method, std::uint64_t seed);

}  // namespace lodestone
