// The `joints:` of a scene.
#include <fmt/format.h>

#include <map>

#include "scenes/scene_sections.h"

namespace lodestone {
namespace {

/// Bodies by name; −1 for a name that several have.
using Names = std::map<std::string, int>;

Names names_of(const Scene& scene) {
  Names names;
  for (int i = 0; i < int(scene.bodies.size()); ++i) {
    const std::string& name = scene.bodies[std::size_t(i)].name;
    if (name.empty()) continue;
    const auto [known, is_new] = names.emplace(name, i);
    if (!is_new) known->second = -1;
  }
  return names;
}

int find_body(const YamlCursor& key, const Names& names) {
  const auto known = names.find(key.text());
  if (known == names.end()) {
    std::vector<std::string> all;
    for (const auto& [name, index] : names) all.push_back(name);
    key.fail(key.text(), "the name of a body" + suggestion(key.text(), all));
  }
  if (known->second < 0) key.fail(key.text() + ", which several bodies are called", "a name of one body");
  return known->second;
}

void make_full(const YamlCursor& key, SceneBody& body) {
  LevelChoice& level = body.definition.level;
  if (level != LevelChoice::automatic && level != LevelChoice::full)
    key.fail(fmt::format("{}, whose level is {}", body.name, name_of(level)),
             "a body that may be full, as joints need it");
  if (const Rung greatest = body.definition.greatest_rung; greatest != Rung::full)
    key.fail(fmt::format("{}, whose greatest_rung is {}", body.name, name_of(greatest)),
             "a body that may be full, as joints need it");
  level = LevelChoice::full;
}

SceneJoint load_joint(const YamlCursor& place, Scene& scene, const Names& names) {
  place.expect_keys({"ball", "hinge", "at_m", "axis"});
  const std::string_view kind = place.one_key_of({"ball", "hinge"});
  SceneJoint joint{.kind = kind == "ball" ? JointKind::ball : JointKind::hinge};
  const YamlCursor key = place.at(kind);
  const std::vector<YamlCursor> bodies = key.items();
  if (bodies.empty() || bodies.size() > 2)
    key.fail(key.found(), "the names of two bodies, or of one that is joined to the world");
  joint.first = find_body(bodies[0], names);
  if (bodies.size() == 2) joint.second = find_body(bodies[1], names);
  if (joint.first == joint.second) bodies[1].fail(bodies[1].text() + " a second time", "another body");
  make_full(bodies[0], scene.bodies[std::size_t(joint.first)]);
  if (bodies.size() == 2) make_full(bodies[1], scene.bodies[std::size_t(joint.second)]);
  joint.anchor_m = place.at("at_m").vector();
  if (joint.kind == JointKind::hinge)
    joint.axis = place.at("axis").direction();
  else if (auto axis = place.find("axis"))
    axis->fail("the axis of a ball joint", "none");
  return joint;
}

}  // namespace

void load_joints(const YamlCursor& root, Scene& scene) {
  const auto section = root.find("joints");
  if (!section) return;
  const Names names = names_of(scene);
  for (const YamlCursor& place : section->items()) scene.joints.push_back(load_joint(place, scene, names));
}

}  // namespace lodestone
