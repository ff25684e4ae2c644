// What happens in the game: an ODE world and space of its own with hills, walls, stairs, a door on a hinge,
// and a manager attached to them with everything that falls.
#pragma once

#include <lodestone/lodestone.h>
#include <ode/ode.h>

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tools/game/camera.h"
#include "tools/game/terrain.h"

namespace game {

/// A box of the game's own, static or the door: the manager only meets it.
struct Block {
  dGeomID geom = nullptr;
  lodestone::Vec3 sides;  // m
};

enum class PolicyKind { distance, budget, error_budget, projected_size };

/// What the keys set. Each policy keeps its own figure.
struct PolicyChoice {
  PolicyKind kind = PolicyKind::budget;
  double full_within_m = 6.0, budget_ms = 8.0, full_above_px = 60.0;

  void turn(bool up);  ///< a quarter more or less of what the policy in use has
  std::string text() const;
  lodestone::PolicySettings settings() const;
  bool has_budget() const { return kind == PolicyKind::budget || kind == PolicyKind::error_budget; }
};

class GameWorld {
 public:
  GameWorld();
  ~GameWorld();
  GameWorld(const GameWorld&) = delete;
  GameWorld& operator=(const GameWorld&) = delete;

  /// One frame of 1/60 s as seen by `camera`, whose picture is so many pixels high. Returns the processor
  /// time of the manager's step, ms.
  double step(const Camera& camera, double height_px, double aspect);

  void set_policy(const PolicyChoice& choice);
  void throw_ball(const Camera& camera);
  void drop_ragdoll(const lodestone::Vec3& pelvis);

  const PolicyChoice& policy() const { return policy_; }
  lodestone::Manager& manager() { return *manager_; }
  const std::vector<lodestone::BodyId>& bodies() const { return bodies_; }
  const std::vector<Block>& blocks() const { return blocks_; }  ///< that do not move
  const Block& door() const { return door_; }

 private:
  void add_block(const lodestone::Vec3& sides, const lodestone::Vec3& position);
  void add_buildings();
  void add_door();
  void add_heap(double x, double y, double above);
  void remove_lost();

  dWorldID world_;
  dSpaceID space_;
  Terrain terrain_;
  std::vector<Block> blocks_;
  Block door_;
  dJointID door_hinge_ = nullptr;
  std::unique_ptr<lodestone::Manager> manager_;
  PolicyChoice policy_;
  lodestone::MaterialId cloth_ = 0;
  std::vector<std::shared_ptr<const lodestone::Shape>> shapes_;
  std::shared_ptr<const lodestone::Shape> ball_;
  std::vector<lodestone::BodyId> bodies_;
  std::mt19937 random_{1};
};

}  // namespace game
