// What a saved trajectory shows besides motion: meshes, materials, the ground and the camera.
#pragma once

#include <array>
#include <compare>
#include <map>

#include "scenes/gltf_buffer.h"
#include "scenes/scene.h"

namespace lodestone {

/// What tells bodies apart besides their shape: each look has a material of its own.
struct BodyLook {
  Rung rung = Rung::support;
  bool asleep = false;
  auto operator<=>(const BodyLook&) const = default;
};

/// Adds to `model` under one root node, which turns the scene's z upwards into glTF's y upwards.
class GltfStage {
 public:
  GltfStage(tinygltf::Model& model, GltfBuffer& buffer);

  int add_node(tinygltf::Node node);  ///< under the root
  int add_child(int parent, tinygltf::Node node);
  /// Made once for each shape and look; the looks share their arrays.
  int body_mesh(const Shape& shape, BodyLook look);
  void add_ground(const SceneGround& ground, double extent_m);  ///< planes are drawn `extent_m` to each side
  int add_camera(const SceneViewpoint& viewpoint);              ///< returns its node

 private:
  struct Arrays {
    int positions = -1, normals = -1, indices = -1;
  };
  Arrays add_arrays(const Mesh& mesh, bool smooth);
  int add_mesh(const Arrays& arrays, int material, const std::string& name);
  int add_material(const std::string& name, std::array<double, 3> color);

  tinygltf::Model& model_;
  GltfBuffer& buffer_;
  std::map<const Shape*, Arrays> arrays_;
  std::map<std::pair<const Shape*, BodyLook>, int> meshes_;
  int ground_material_;
  std::map<BodyLook, int> materials_;
};

/// As glTF writes them: x, y, z and x, y, z, w.
std::vector<double> gltf_vector(const Vec3& v);
std::vector<double> gltf_rotation(const Quat& q);

}  // namespace lodestone
