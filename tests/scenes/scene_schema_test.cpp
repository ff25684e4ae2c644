// The JSON Schema of scenes beside the loader, which is what counts.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <random>
#include <regex>

#include "tests/scenes/json_schema.h"
#include "tests/scenes/scene_fixture.h"

namespace lodestone {
namespace {

using nlohmann::json;

json load_schema() {
  std::ifstream in(LODESTONE_SOURCE_DIR "/scenes/scene.schema.json");
  return json::parse(in);
}

// With nearly every key that there is.
json full_scene() {
  return json::parse(R"({
    "version": 1,
    "step": {"dt_s": 0.01, "steps": 100, "full_substeps": 4, "gravity_m_per_s2": [0, 0, -9.81], "seed": 7},
    "materials": {"default": {"restitution": 0.4, "friction": 0.5, "density_kg_per_m3": 900}, "ice": {"friction": 0.05}},
    "contacts": [{"between": ["ice", "default"], "restitution": 0.6, "friction": 0.1}],
    "shapes": {
      "crate": {"box_m": [0.2, 0.3, 0.4], "material": "ice", "mass_kg": 3, "inertia": [0.1, 0.1, 0.1], "center_of_mass_m": [0, 0, 0.01]},
      "ball": {"sphere_m": 0.1}, "angle": {"l_m": [0.3, 0.2, 0.05, 0.1]}, "plate": {"plate_m": [0.4, 0.3, 0.02]}, "needle": {"needle_m": [0.4, 0.01]},
      "rock": {"mesh": "rock.obj", "size_m": 0.3, "faces": 4, "obtain": "draw it"}},
    "ground": [
      {"plane": {"normal": [0, 0, 1], "offset_m": 0}, "material": "ice"},
      {"box": {"sides_m": [1, 2, 0.1], "position_m": [5, 0, 0], "orientation": [1, 0, 0, 0]}},
      {"mesh": "rock.obj", "size_m": 2, "position_m": [9, 9, 0], "material": "ice"},
      {"terrain": {"cells": [2, 3], "size_m": [4, 6], "position_m": [20, 0, 0], "hills": [{"height_m": 1, "length_m": [3, 4], "crest_m": [0, 1]}]}},
      {"terrain": {"cells": [1, 1], "size_m": [4, 6], "heights_m": [[0, 0], [0, -0.1]], "position_m": [-20, 0, 0]}},
      {"stairs": {"steps": 3, "rise_m": 0.2, "run_m": 0.3, "width_m": 1, "position_m": [-5, 0, 0], "turn_deg": 30}}],
    "bodies": [
      {"shape": "crate", "position_m": [0, 0, 1], "orientation": [1, 0, 0, 0], "velocity_m_per_s": [1, 0, 0], "angular_velocity_rad_per_s": [0, 1, 0], "level": "full",
       "name": "one", "material": "default", "mass_kg": 2, "importance": 2, "asleep": false, "least_rung": "tables", "greatest_rung": "full"},
      {"shape": "ball", "position_m": [2, 0, 1], "name": "two"},
      {"shape": "ball", "scatter": {"count": 3, "box_m": [[-1, 3, 1], [1, 5, 3]], "seed": 3, "spacing_m": 0.3}},
      {"shape": "rock", "scatter": {"count": 2, "cylinder": {"base_m": [0, -4, 2], "radius_m": 1, "height_m": 1}, "on_ground": false, "lying": false}}],
    "ragdolls": [{"position_m": [8, 0, 0.1], "orientation": [1, 0, 0, 0], "velocity_m_per_s": [0, 0, 0], "height_m": 1.8, "material": "ice", "name": "doll"}],
    "joints": [{"ball": ["one", "two"], "at_m": [1, 0, 1]}, {"hinge": ["one"], "at_m": [0, 0, 1], "axis": [0, 1, 0]}],
    "viewpoints": [{"position_m": [0, -6, 2], "look_at_m": [0, 0, 0], "height_px": 720}, {"path": [{"time_s": 0, "position_m": [0, 0, 1]}, {"time_s": 2, "position_m": [1, 0, 1]}]}],
    "lod": {"policy": "distance", "full_within_m": 2, "support_within_m": 8, "most_full": 10, "most_support": 20, "hysteresis": 0.1, "min_dwell_frames": 30, "max_transitions_per_frame": 4,
      "out_of_view_factor": 2, "look_ahead_s": 0.5, "contact_groups_together": true, "audit_ms": 0, "model": "auto",
      "tables": {"published": true, "interpolate": true, "draw_height": false, "radius_update_interval": 2, "rest_poses": true, "nearest_rest_pose": true, "paper_pair_rule": false}},
    "output": {"trajectory": "run.glb", "every_n_steps": 2},
    "check": {"max_penetration_m": 0.02, "max_tables_penetration_m": 0.2, "all_asleep_by_s": 10}})");
}

void collect_places(const json& value, const json::json_pointer& place,
                    std::vector<json::json_pointer>& places) {
  if (!place.empty()) places.push_back(place);
  if (value.is_object())
    for (const auto& [key, inner] : value.items()) collect_places(inner, place / key, places);
  if (value.is_array())
    for (std::size_t i = 0; i < value.size(); ++i) collect_places(value[i], place / i, places);
}

// One change of `scene` somewhere, which may or may not leave it valid.
json change(json scene, std::mt19937& random) {
  std::vector<json::json_pointer> places;
  collect_places(scene, json::json_pointer(), places);
  const auto draw = [&](std::size_t count) { return std::size_t(random() % count); };
  const json::json_pointer place = places[draw(places.size())], parent = place.parent_pointer();
  static const std::vector<json> kValues = {"a word",
                                            true,
                                            nullptr,
                                            json::array(),
                                            json::object(),
                                            json::array({1, 2}),
                                            1e300,
                                            -1e300,
                                            -1,
                                            0,
                                            0.5,
                                            3,
                                            1e9,
                                            2.5,
                                            ""};
  switch (draw(6)) {
    case 0:  // leave it out
      if (scene[parent].is_object())
        scene[parent].erase(place.back());
      else
        scene[parent].erase(std::stoul(place.back()));
      break;
    case 1:  // a key that nobody knows
      if (scene[place].is_object())
        scene[place]["colour"] = 1;
      else if (scene[parent].is_object())
        scene[parent]["colour"] = 1;
      break;
    case 2:  // one too many
      if (scene[place].is_array()) scene[place].push_back(1);
      break;
    case 3:  // another spelling
      if (scene[parent].is_object()) {
        scene[parent][place.back() + "x"] = scene[place];
        scene[parent].erase(place.back());
      }
      break;
    default:
      scene[place] = kValues[draw(kValues.size())];
  }
  return scene;
}

// What depends on more than one place of a scene, or on more than a number's range: no schema says it. By the
// loader's message.
bool is_beyond_a_schema(const std::string& message) {
  static const std::regex kPhrases(
      "a direction of any length|a quaternion w, x, y, z|a second corner below|found room without overlap|no "
      "ground below the region|at "
      "least full_within_m|at least least_rung|an impossible inertia|"
      "the name of a body|a name of one body|a second time|joints need it|a bar width W|lying beside "
      "on_ground|a mesh file|mesh that bounds|a list of [0-9]+|no volume|extent|the corners|unused|"
      "from least_rung to greatest_rung|moves and is asleep");
  // Names of shapes and materials; times of a path in order.
  static const std::regex kReferences("^[^:]*:[0-9]+: [^:]*(shape|material|between\\[[01]\\]|time_s): ");
  return std::regex_search(message, kPhrases) || std::regex_search(message, kReferences);
}

class SceneSchema : public SceneFixture {
 protected:
  SceneSchema() {
    write("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", "rock.obj");
  }
  const json schema_ = load_schema();
};

TEST_F(SceneSchema, HoldsForEveryShippedScene) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(LODESTONE_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    ++scenes;
    EXPECT_EQ(find_schema_fault(schema_, json_of(load_yaml(entry.path()))), "") << entry.path();
  }
  EXPECT_GE(scenes, 13);
}

TEST_F(SceneSchema, KnowsEveryKeyThatTheLoaderKnows) {
  const json scene = full_scene();
  EXPECT_EQ(find_schema_fault(schema_, scene), "");
  EXPECT_EQ(error_of(scene.dump(1)), "no error");
}

// What the schema refuses the loader refuses, with key and line; what the loader refuses the schema does, but
// for what no schema can say.
TEST_F(SceneSchema, AgreesWithTheLoaderOn300Scenes) {
  static const std::regex kMessage("^s\\.yaml:[0-9]+: [^ ].*: found .*, expected .*");
  std::mt19937 random(17);  // whose numbers the standard fixes
  int accepted = 0, refused = 0, beyond = 0;
  for (int i = 0; i < 300; ++i) {
    const json scene = change(full_scene(), random);
    const std::string fault = find_schema_fault(schema_, scene), error = error_of(scene.dump(1));
    const bool loads = error == "no error";
    EXPECT_TRUE(loads || std::regex_search(error, kMessage)) << error;
    if (!fault.empty()) {
      ++refused;
      EXPECT_FALSE(loads) << fault;
    } else if (loads) {
      ++accepted;
    } else {
      ++beyond;
      EXPECT_TRUE(is_beyond_a_schema(error)) << error;
    }
  }
  EXPECT_GE(accepted, 60);
  EXPECT_GE(refused, 120);
  EXPECT_LE(beyond, 60);
}

}  // namespace
}  // namespace lodestone
