// The `ragdolls:` of a scene: figures of six boxes on joints.
#include <fmt/format.h>

#include <array>

#include "scenes/scene_sections.h"
#include "scenes/shape_source.h"

namespace lodestone {
namespace {

// A figure that stands at the origin, looks along x and is 1.54 m high; m.
constexpr double kHeight = 1.54;
struct Limb {
  const char* name;
  std::array<double, 3> sides, middle;
};
constexpr std::array<Limb, 6> kLimbs{{{"torso", {0.20, 0.38, 0.54}, {0, 0, 1.03}},
                                      {"head", {0.18, 0.16, 0.22}, {0, 0, 1.43}},
                                      {"left arm", {0.10, 0.10, 0.60}, {0, 0.26, 0.98}},
                                      {"right arm", {0.10, 0.10, 0.60}, {0, -0.26, 0.98}},
                                      {"left leg", {0.14, 0.14, 0.74}, {0, 0.10, 0.37}},
                                      {"right leg", {0.14, 0.14, 0.74}, {0, -0.10, 0.37}}}};
// Of the torso with each of the others; hinges turn about y.
struct Link {
  int limb;
  JointKind kind;
  std::array<double, 3> anchor;
};
constexpr std::array<Link, 5> kLinks{{{1, JointKind::ball, {0, 0, 1.31}},
                                      {2, JointKind::ball, {0, 0.20, 1.25}},
                                      {3, JointKind::ball, {0, -0.20, 1.25}},
                                      {4, JointKind::hinge, {0, 0.10, 0.75}},
                                      {5, JointKind::hinge, {0, -0.10, 0.75}}}};

Vec3 vector_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

struct Ragdoll {
  std::string name;
  RigidState state;  ///< of the point between its feet
  double scale = 1;
  MaterialId material = 0;
  Vec3 place(const std::array<double, 3>& of) const {
    return state.position + state.orientation * (scale * vector_of(of));
  }
};

Ragdoll load_ragdoll(const YamlCursor& place, int index, const Scene& scene) {
  place.expect_keys({"position_m", "orientation", "velocity_m_per_s", "height_m", "material", "name"});
  Ragdoll ragdoll{
      .name = fmt::format("ragdoll[{}]", index), .state = {}, .material = load_material_id(place, scene)};
  ragdoll.state.position = place.at("position_m").vector();
  if (auto key = place.find("orientation")) ragdoll.state.orientation = key->rotation();
  if (auto key = place.find("velocity_m_per_s")) ragdoll.state.velocity = key->vector({-1e6, 1e6});
  if (auto key = place.find("height_m")) ragdoll.scale = key->number({0.1, 100}) / kHeight;
  if (auto key = place.find("name")) ragdoll.name = key->text();
  return ragdoll;
}

/// Made once for ragdolls of a size.
std::shared_ptr<const Shape> limb_shape(const Limb& limb, double scale, Scene& scene) {
  const Vec3 sides = scale * vector_of(limb.sides);
  std::shared_ptr<const Shape>& shape =
      scene.shapes[fmt::format("ragdoll {:g} {:g} {:g}", sides.x(), sides.y(), sides.z())];
  if (!shape) {
    Shape made = make_solid(SolidKind::box, std::array{sides.x(), sides.y(), sides.z()}, {});
    made.name = fmt::format("ragdoll {}", limb.name);
    shape = std::make_shared<const Shape>(std::move(made));
  }
  return shape;
}

void add_ragdoll(const YamlCursor& place, const Ragdoll& ragdoll, Scene& scene) {
  const int torso = int(scene.bodies.size());
  std::vector<int>& group = scene.groups.emplace_back();
  for (const Limb& limb : kLimbs) {
    SceneBody body{.name = fmt::format("{} {}", ragdoll.name, limb.name), .definition = {}};
    body.definition = {.shape = limb_shape(limb, ragdoll.scale, scene),
                       .state = ragdoll.state,
                       .material = ragdoll.material,
                       .level = LevelChoice::full};
    body.definition.state.position = ragdoll.place(limb.middle);
    check_mass_at(place, body.definition, scene);
    group.push_back(int(scene.bodies.size()));
    scene.bodies.push_back(std::move(body));
  }
  for (const Link& link : kLinks)
    scene.joints.push_back({.kind = link.kind,
                            .first = torso,
                            .second = torso + link.limb,
                            .anchor_m = ragdoll.place(link.anchor),
                            .axis = ragdoll.state.orientation * Vec3::UnitY()});
}

}  // namespace

void load_ragdolls(const YamlCursor& root, Scene& scene) {
  const auto section = root.find("ragdolls");
  if (!section) return;
  int index = 0;
  for (const YamlCursor& place : section->items())
    add_ragdoll(place, load_ragdoll(place, index++, scene), scene);
}

}  // namespace lodestone
