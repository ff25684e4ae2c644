#include <gtest/gtest.h>

#include "tests/scenes/scene_sections.h"

namespace lodestone {
namespace {

class MaterialSection : public SceneFixture {
 protected:
  Scene with(const std::string& sections) const { return load(testing::scene_of(sections)); }
  std::string fault(const std::string& sections) const { return error_of(testing::scene_of(sections)); }
};

TEST_F(MaterialSection, WithoutItThereIsTheDefaultAlone) {
  const Scene scene = with("");
  EXPECT_EQ(scene.materials.size(), 1);
  EXPECT_EQ(scene.material_names, std::vector<std::string>{"default"});
  EXPECT_EQ(scene.materials.law(0, 0), ContactLaw{});
}

// What a material does not say it has from the default, wherever that stands.
TEST_F(MaterialSection, TheDefaultFillsWhatIsNotSaid) {
  const Scene scene =
      with("materials: {ice: {friction: 0.02}, default: {restitution: 0.1, density_kg_per_m3: 300}}\n");
  EXPECT_EQ(scene.materials[1].friction, 0.02);
  EXPECT_EQ(scene.materials[1].restitution, 0.1);
  EXPECT_EQ(scene.materials[1].density, 300.0);
  EXPECT_EQ(scene.materials[0].friction, 0.5);
}

TEST_F(MaterialSection, APairHasOneLaw) {
  EXPECT_NE(
      fault("materials: {ice: {}}\n"
            "contacts: [{between: [ice, default], friction: 0}, {between: [default, ice], friction: 1}]\n")
          .find("contacts[1].between: found a pair that has a law already, expected each pair once"),
      std::string::npos);
}

// Of a pair the lower restitution and the root of the product of frictions, either way round, but for those
// that are listed.
TEST_F(MaterialSection, PairsFollowTheirRuleUnlessTheyAreListed) {
  const Scene scene = with(
      "materials: {a: {restitution: 0.2, friction: 0.5}, b: {restitution: 0.6, friction: 0.8}, c: {friction: "
      "0}}\n"
      "contacts: [{between: [a, c], friction: 0.3}, {between: [b, b], restitution: 0.9}]\n");
  EXPECT_EQ(scene.materials.law(1, 2).restitution, 0.2);
  EXPECT_NEAR(scene.materials.law(1, 2).friction, std::sqrt(0.4), 1e-12);
  for (const auto& [x, y] : {std::pair(1, 3), std::pair(3, 1)}) {
    EXPECT_EQ(scene.materials.law(x, y).friction, 0.3);
    EXPECT_EQ(scene.materials.law(x, y).restitution, 0.2);  // as it was
  }
  EXPECT_EQ(scene.materials.law(2, 2).restitution, 0.9);
  EXPECT_EQ(scene.materials.law(2, 3).friction, 0.0);
}

TEST_F(MaterialSection, WhatIsOutOfRangeIsSaidWithItsPlace) {
  EXPECT_TRUE(
      fault("materials: {ice: {restitution: 1.5}}\n")
          .starts_with("s.yaml:2: materials.ice.restitution: found 1.5, expected a number in [0, 1]"));
  EXPECT_TRUE(fault("materials:\n  ice:\n    friction: -1\n")
                  .starts_with("s.yaml:4: materials.ice.friction: found -1, expected"));
  EXPECT_TRUE(fault("materials: {ice: {density_kg_per_m3: 0}}\n")
                  .starts_with("s.yaml:2: materials.ice.density_kg_per_m3: found 0, expected"));
  EXPECT_NE(fault("materials: {ice: {fricton: 0}}\n").find("did you mean \"friction\"?"), std::string::npos);
  EXPECT_NE(fault("materials: {ice: {}, wood: {}}\ncontacts: [{between: [ice, wod]}]\n")
                .find("did you mean \"wood\"?"),
            std::string::npos);
  EXPECT_NE(fault("materials: {ice: {}}\ncontacts: [{between: [ice]}]\n"), testing::kNothingThrown);
}

TEST_F(MaterialSection, ThereAreNoMoreThan256) {
  const auto many = [](int count) {
    std::string text = "materials:\n";
    for (int i = 0; i < count; ++i) text += "  m" + std::to_string(i) + ": {}\n";
    return text;
  };
  EXPECT_EQ(with(many(255)).materials.size(), 256);
  EXPECT_NE(fault(many(256)).find("materials.m255: found one more material, expected at most 256"),
            std::string::npos);
}

}  // namespace
}  // namespace lodestone
