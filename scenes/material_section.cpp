// The `materials:` and `contacts:` of a scene.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "scenes/scene_sections.h"

namespace lodestone {
namespace {

constexpr int kMaxMaterials = 256;  // the table of pairs is dense

Material load_material(const YamlCursor& place, Material material) {
  place.expect_keys({"restitution", "friction", "density_kg_per_m3"});
  if (auto key = place.find("restitution")) material.restitution = key->number(kFraction);
  if (auto key = place.find("friction")) material.friction = key->number(kNotNegative);
  if (auto key = place.find("density_kg_per_m3")) material.density = key->number(kPositive);
  return material;
}

using MaterialPairs = std::set<std::pair<MaterialId, MaterialId>>;

void load_contact(const YamlCursor& place, Scene& scene, MaterialPairs& known) {
  place.expect_keys({"between", "restitution", "friction"});
  const std::vector<YamlCursor> pair = place.at("between").items(2);
  const MaterialId a = int(pair[0].choice(scene.material_names)),
                   b = int(pair[1].choice(scene.material_names));
  if (!known.insert(std::minmax(a, b)).second)
    place.at("between").fail("a pair that has a law already", "each pair once");
  if (!place.has("restitution") && !place.has("friction"))
    place.fail("neither restitution nor friction", "one of them at least, of that pair's own");
  ContactLaw law = scene.materials.law(a, b);
  if (auto key = place.find("restitution")) law.restitution = key->number(kFraction);
  if (auto key = place.find("friction")) law.friction = key->number(kNotNegative);
  scene.materials.set_law(a, b, law);
}

}  // namespace

void load_materials(const YamlCursor& root, Scene& scene) {
  scene.material_names = {"default"};
  if (auto section = root.find("materials")) {
    if (auto key = section->find("default")) scene.materials.replace(0, load_material(*key, {}));
    for (const auto& [name, place] : section->entries()) {
      if (name == "default") continue;
      if (scene.materials.size() == kMaxMaterials)
        place.fail("one more material", fmt::format("at most {}", kMaxMaterials));
      scene.materials.add(load_material(place, scene.materials[0]));
      scene.material_names.push_back(name);
    }
  }
  MaterialPairs pairs;
  if (auto section = root.find("contacts"))
    for (const YamlCursor& place : section->items()) load_contact(place, scene, pairs);
}

MaterialId load_material_id(const YamlCursor& place, const Scene& scene, MaterialId otherwise) {
  const auto key = place.find("material");
  return key ? int(key->choice(scene.material_names)) : otherwise;
}

}  // namespace lodestone
