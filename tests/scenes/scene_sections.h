// A small scene, one section of which a test writes itself.
#pragma once

#include "tests/scenes/scene_fixture.h"

namespace lodestone::testing {

inline const std::string kShapes = "shapes: {crate: {box_m: [1, 2, 3]}, ball: {sphere_m: 0.5}}\n";
inline const std::string kBodies = "bodies: [{shape: ball, position_m: [0, 0, 5]}]\n";

/// Of these sections, each with its end of line; those that are missing are the usual ones.
inline std::string scene_of(const std::string& sections) {
  std::string text = "version: 1\n" + sections;
  if (sections.find("shapes:") == std::string::npos) text += kShapes;
  if (sections.find("bodies:") == std::string::npos) text += kBodies;
  return text;
}

}  // namespace lodestone::testing
