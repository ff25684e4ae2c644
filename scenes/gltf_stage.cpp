#include "scenes/gltf_stage.h"

#include <fmt/format.h>

#include <numbers>

#include "scenes/camera.h"

namespace lodestone {
namespace {

using Color = std::array<double, 3>;  // linear
constexpr Color kGroundColor{0.72, 0.72, 0.70};
// Orange while full, blue at `support`, a dark green at `tables`: apart for the colour-blind too, by their
// lightness.
constexpr std::array<Color, kRungs> kRungColors{{{0.10, 0.27, 0.20}, {0.35, 0.55, 0.85}, {0.95, 0.50, 0.12}}};
constexpr double kAsleepShade = 0.45;
constexpr std::size_t kSmoothFaces = 200;  // coarser meshes have real edges and stay flat

/// Normals of vertices: the sum of their faces' normals, weighted by area.
std::vector<std::array<float, 3>> smooth_normals(const Mesh& mesh) {
  std::vector<Vec3> sums(mesh.vertices.size(), Vec3::Zero());
  for (const std::array<int, 3>& face : mesh.faces) {
    const Vec3 &a = mesh.vertices[std::size_t(face[0])], &b = mesh.vertices[std::size_t(face[1])],
               &c = mesh.vertices[std::size_t(face[2])];
    for (int corner : face) sums[std::size_t(corner)] += (b - a).cross(c - a);
  }
  std::vector<std::array<float, 3>> normals;
  for (const Vec3& sum : sums) {
    const Vec3 n = sum.norm() > 0 ? Vec3(sum.normalized()) : Vec3::UnitZ();
    normals.push_back({float(n.x()), float(n.y()), float(n.z())});
  }
  return normals;
}

std::string name_of(BodyLook look) {
  return fmt::format("{}{}", lodestone::name_of(look.rung), look.asleep ? " asleep" : "");
}

Mesh square(double half_side) {
  const double s = half_side;
  return {{{-s, -s, 0}, {s, -s, 0}, {s, s, 0}, {-s, s, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace

std::vector<double> gltf_vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
std::vector<double> gltf_rotation(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }

GltfStage::GltfStage(tinygltf::Model& model, GltfBuffer& buffer) : model_(model), buffer_(buffer) {
  tinygltf::Node root;
  root.name = "world";
  root.rotation = gltf_rotation(Quat(Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vec3::UnitX())));
  model_.nodes.push_back(std::move(root));
  model_.scenes.resize(1);
  model_.scenes[0].nodes = {0};
  model_.defaultScene = 0;
  ground_material_ = add_material("ground", kGroundColor);
  for (const Rung rung : {Rung::full, Rung::support, Rung::tables})
    for (const bool asleep : {false, true}) {
      Color color = kRungColors[std::size_t(rung)];
      for (double& part : color) part *= asleep ? kAsleepShade : 1.0;
      materials_[{rung, asleep}] = add_material(name_of(BodyLook{rung, asleep}), color);
    }
}

int GltfStage::add_node(tinygltf::Node node) { return add_child(0, std::move(node)); }

int GltfStage::add_child(int parent, tinygltf::Node node) {
  const int index = int(model_.nodes.size());
  model_.nodes.push_back(std::move(node));
  model_.nodes[std::size_t(parent)].children.push_back(index);
  return index;
}

int GltfStage::add_material(const std::string& name, std::array<double, 3> color) {
  tinygltf::Material material;
  material.name = name;
  material.pbrMetallicRoughness.baseColorFactor = {color[0], color[1], color[2], 1.0};
  material.pbrMetallicRoughness.metallicFactor = 0.0;
  material.pbrMetallicRoughness.roughnessFactor = 0.8;
  material.doubleSided = name == "ground";
  model_.materials.push_back(std::move(material));
  return int(model_.materials.size()) - 1;
}

GltfStage::Arrays GltfStage::add_arrays(const Mesh& mesh, bool smooth) {
  std::vector<std::array<float, 3>> positions;
  for (const Vec3& v : mesh.vertices) positions.push_back({float(v.x()), float(v.y()), float(v.z())});
  std::vector<std::uint32_t> indices;
  for (const std::array<int, 3>& face : mesh.faces)
    for (int corner : face) indices.push_back(std::uint32_t(corner));
  Arrays arrays;
  arrays.positions = buffer_.add_vectors(positions, TINYGLTF_TARGET_ARRAY_BUFFER);
  if (smooth) arrays.normals = buffer_.add_vectors(smooth_normals(mesh), TINYGLTF_TARGET_ARRAY_BUFFER);
  arrays.indices = buffer_.add_indices(indices);
  return arrays;
}

int GltfStage::add_mesh(const Arrays& arrays, int material, const std::string& name) {
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = arrays.positions;
  if (arrays.normals >= 0) primitive.attributes["NORMAL"] = arrays.normals;
  primitive.indices = arrays.indices;
  primitive.material = material;
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(std::move(primitive));
  model_.meshes.push_back(std::move(mesh));
  return int(model_.meshes.size()) - 1;
}

int GltfStage::body_mesh(const Shape& shape, BodyLook look) {
  const auto known = meshes_.find({&shape, look});
  if (known != meshes_.end()) return known->second;
  const bool smooth = shape.sphere_radius || shape.mesh.faces.size() >= kSmoothFaces;
  if (!arrays_.contains(&shape)) arrays_[&shape] = add_arrays(shape.mesh, smooth);
  const int mesh = add_mesh(arrays_[&shape], materials_.at(look), shape.name + ' ' + name_of(look));
  return meshes_[{&shape, look}] = mesh;
}

void GltfStage::add_ground(const SceneGround& ground, double extent_m) {
  tinygltf::Node node;
  node.name = "ground";
  Mesh mesh;
  if (const auto* plane = std::get_if<GroundPlane>(&ground)) {
    mesh = square(extent_m);
    node.translation = gltf_vector(plane->offset_m * plane->normal);
    node.rotation = gltf_rotation(rotation_between(Vec3::UnitZ(), plane->normal));
  } else if (const auto* box = std::get_if<GroundBox>(&ground)) {
    mesh = make_box(box->sides_m);
    node.translation = gltf_vector(box->position_m);
    node.rotation = gltf_rotation(box->orientation);
  } else {
    mesh = std::get<GroundMesh>(ground).mesh;
  }
  node.mesh = add_mesh(add_arrays(mesh, false), ground_material_, "ground");
  add_node(std::move(node));
}

int GltfStage::add_camera(const SceneViewpoint& viewpoint) {
  tinygltf::Camera camera;
  camera.type = "perspective";
  camera.perspective.yfov = kFieldOfView;
  camera.perspective.znear = 0.02;
  camera.perspective.zfar = 1000.0;  // optional in glTF, but not to every reader
  camera.perspective.aspectRatio = kAspectRatio;
  model_.cameras.push_back(std::move(camera));
  tinygltf::Node node;
  node.name = "viewpoint";
  node.camera = int(model_.cameras.size()) - 1;
  const Vec3 position = viewpoint.position_at(0);
  node.translation = gltf_vector(position);
  node.rotation = gltf_rotation(camera_rotation(position, viewpoint.look_at_m));
  return add_node(std::move(node));
}

}  // namespace lodestone
