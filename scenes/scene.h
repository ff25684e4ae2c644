// A scene as a value: what a YAML file says, checked, in SI units (scene_file.h loads it, runner.h runs it).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lod/manager.h"
#include "reference/ode/body_joints.h"

namespace lodestone {

struct SceneStep {
  double dt_s = 1.0 / 60.0;
  int full_substeps = 4;
  Vec3 gravity_m_per_s2{0, 0, -9.81};
  std::uint64_t seed = 1;
};

struct GroundPlane {
  Vec3 normal = Vec3::UnitZ();
  double offset_m = 0;
  MaterialId material = 0;
};
struct GroundBox {
  Vec3 sides_m;
  Vec3 position_m;
  Quat orientation;
  MaterialId material = 0;
};
struct GroundMesh {
  Mesh mesh;
  MaterialId material = 0;
  std::filesystem::path file = {};  ///< that it is of; empty: terrain
};
using SceneGround = std::variant<GroundPlane, GroundBox, GroundMesh>;

struct SceneBody {
  std::string name;  ///< may be empty
  BodyDefinition definition;
  bool asleep = false;  ///< from the start, until something touches it
};

/// Between two bodies, or a body and the world. Those that it holds are full throughout.
struct SceneJoint {
  JointKind kind = JointKind::ball;
  int first = 0;  ///< of Scene::bodies
  int second = kWorld;
  Vec3 anchor_m = Vec3::Zero(), axis = Vec3::UnitZ();  ///< world, as the bodies start
  static constexpr int kWorld = -1;
};

/// A camera, standing or moving along `path` (piecewise linear in time).
struct SceneViewpoint {
  struct Key {
    double time_s;
    Vec3 position_m;
  };
  Vec3 position_m = Vec3::Zero();
  Vec3 look_at_m = Vec3::Zero();
  std::vector<Key> path;
  double height_px = 1080;  ///< of its picture
  Vec3 position_at(double time_s) const;
};

struct SceneOutput {
  std::string trajectory;  ///< .glb file, relative to the output folder; empty: none
  int every_n_steps = 2;
};

/// What the run must show; each absent unless given.
struct SceneChecks {
  std::optional<double> max_penetration_m;  ///< of all bodies, or where the next is given too, of all others
  /// Of those at `tables`, whose spheres sink in by their nature, and of those that came from there and were
  /// not awake for 30 steps since.
  std::optional<double> max_tables_penetration_m;
  std::optional<double> all_asleep_by_s;
};

struct Scene {
  std::filesystem::path file;
  SceneStep step;
  MaterialTable materials;
  std::vector<std::string> material_names;
  std::map<std::string, std::shared_ptr<const Shape>> shapes;
  std::vector<std::filesystem::path> mesh_files;  ///< of shapes and ground
  std::vector<SceneGround> ground;
  std::vector<SceneBody> bodies;  ///< those of ragdolls first, then the others, scatters expanded
  std::vector<SceneJoint> joints;
  std::vector<std::vector<int>> groups;  ///< of `bodies`, each a ragdoll
  std::vector<SceneViewpoint> viewpoints;
  PolicySettings lod;
  double audit_ms = 0;                    ///< of each step, for the audit
  std::optional<StatisticalModel> model;  ///< that all statistical bodies have; none: what the policy finds
  TablesOptions tables;
  SceneOutput output;
  SceneChecks checks;
  int default_steps = 600;  ///< `step: {steps: …}`
};

}  // namespace lodestone
