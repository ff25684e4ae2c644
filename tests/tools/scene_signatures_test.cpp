#include "tools/scene_signatures.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/scenes/scene_fixture.h"

namespace lodestone::scene_signatures_test {
namespace {

using SceneSignatures = SceneFixture;

constexpr const char* kScene = R"(version: 1
materials: {default: {restitution: 0.4, friction: 0.5}, ice: {restitution: 0.3, friction: 0.02}}
shapes: {crate: {box_m: [1, 1, 1]}, ball: {sphere_m: 0.5}, slab: {box_m: [2, 2, 1]}}
ground: [{box: {sides_m: [1, 1, 1], position_m: [9, 9, 9]}, material: default}, {plane: {}, material: ice}, {plane: {offset_m: -5}}]
bodies:
  - {shape: crate, position_m: [0, 0, 2]}
  - {shape: crate, position_m: [0, 0, 4]}
  - {shape: crate, position_m: [0, 0, 6], material: ice}
  - {shape: ball, position_m: [0, 0, 8], level: tables}
  - {shape: slab, position_m: [0, 0, 12], level: full}
  - {shape: slab, position_m: [0, 0, 14], least_rung: full}
)";

// What was asked for: friction of each question, by shape.
std::multimap<std::string, double> asked_for(const Scene& scene, RunSettings settings = {}) {
  std::multimap<std::string, double> asked;
  settings.signatures = [&](const Shape& shape, const ContactLaw& law) {
    asked.emplace(shape.name, law.friction);
    EXPECT_EQ(law.restitution, 0.3);  // the lower one, the ice's
    return std::shared_ptr<const Signature>();
  };
  fetch_signatures(scene, settings);
  return asked;
}

// Under the law of the first plane, whatever other ground there is.
TEST_F(SceneSignatures, EachKindOfBodyThatIsNotFullForGoodIsAskedForOnce) {
  const auto asked = asked_for(load(kScene));
  ASSERT_EQ(asked.size(), 3U);
  EXPECT_EQ(asked.count("crate"), 2U);
  EXPECT_EQ(asked.count("ball"), 1U);
  EXPECT_DOUBLE_EQ(asked.find("ball")->second, 0.1);  // √(.5 × .02)
  EXPECT_DOUBLE_EQ(asked.equal_range("crate").first->second + std::next(asked.find("crate"))->second, 0.12);
}

TEST_F(SceneSignatures, ARunsOwnLevelCounts) {
  EXPECT_TRUE(asked_for(load(kScene), {.level = LevelChoice::full}).empty());
  EXPECT_EQ(asked_for(load(kScene), {.level = LevelChoice::statistical}).count("slab"), 1U);
}

}  // namespace
}  // namespace lodestone::scene_signatures_test
