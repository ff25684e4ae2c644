#include "scenes/yaml_cursor.h"

#include <gtest/gtest.h>

#include "reference/error.h"
#include "tests/message_of.h"

namespace lodestone {
namespace {

// A text as the file s.yaml, and what is said of a value that does not fit.
struct YamlText {
  explicit YamlText(const std::string& text) : value(make_yaml(text, file)) {}
  YamlCursor root() const { return {value, file}; }
  std::string fault(const auto& read) const {
    return testing::message_of([&] { read(root()); });
  }
  std::string file = "s.yaml";
  YamlValue value;
};

TEST(YamlCursor, SaysWhereWhatAndWhatInstead) {
  const YamlText yaml("a: 1\nbodies:\n  - {mass: heavy}\n  - {}\n");
  EXPECT_EQ(yaml.fault([](YamlCursor c) { c.at("bodies").items()[0].at("mass").number(kMass); }),
            "s.yaml:3: bodies[0].mass: found heavy, expected a number in [1e-06, 1000000000000]");
  const std::string missing = yaml.fault([](YamlCursor c) { c.at("bodies").items()[1].at("mass"); });
  EXPECT_TRUE(missing.starts_with("s.yaml:4: bodies[1].mass: found no such key")) << missing;
  EXPECT_EQ(yaml.root().at("bodies").items()[1].key(), "bodies[1]");
}

TEST(YamlCursor, NumbersKeepTheirRanges) {
  const YamlText yaml(
      "{low: 0, high: 1, more: 1.0000001, less: -1e-9, huge: 1e9, nan: .nan, text: \"1\", e: 2.5e-3}");
  const auto fits = [&](const char* key, const NumberRange& range) {
    return yaml.fault([&](YamlCursor c) { c.at(key).number(range); }) == testing::kNothingThrown;
  };
  EXPECT_TRUE(fits("low", kFraction) && fits("high", kFraction) && fits("low", kNotNegative));
  EXPECT_FALSE(fits("more", kFraction) || fits("less", kFraction) || fits("low", kPositive));
  EXPECT_FALSE(fits("huge", {}) || fits("nan", {}) || fits("text", {}));
  EXPECT_EQ(yaml.root().at("e").number(), 0.0025);
}

TEST(YamlCursor, WholeNumbersAreWhole) {
  const YamlText yaml("{a: 7, b: 7.5, c: -1, d: 1e1, e: 99999999999999999999, f: true}");
  EXPECT_EQ(yaml.root().at("a").integer(0, 7), 7);
  EXPECT_EQ(yaml.root().at("c").integer(-1, 7), -1);
  for (const auto& [key, low, high] :
       {std::tuple{"a", 0, 6}, {"b", 0, 9}, {"c", 0, 9}, {"e", 0, 9}, {"f", 0, 9}})
    EXPECT_NE(yaml.fault([key = key, low = low, high = high](YamlCursor c) { c.at(key).integer(low, high); }),
              testing::kNothingThrown)
        << key;
}

TEST(YamlCursor, DirectionsAndRotationsAreOfLengthOne) {
  const YamlText yaml("{d: [0, 3, 4], q: [2, 0, 0, 0], zero: [0, 0, 0], none: [0, 0, 0, 0], short: [1, 2]}");
  EXPECT_LT((yaml.root().at("d").direction() - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_EQ(yaml.root().at("q").rotation().w(), 1.0);
  EXPECT_NE(yaml.fault([](YamlCursor c) { c.at("zero").direction(); }), testing::kNothingThrown);
  EXPECT_NE(yaml.fault([](YamlCursor c) { c.at("none").rotation(); }), testing::kNothingThrown);
  EXPECT_NE(yaml.fault([](YamlCursor c) { c.at("short").vector(); }), testing::kNothingThrown);
}

TEST(YamlCursor, TruthsAreTrueOrFalseAlone) {
  const YamlText yaml("{a: true, b: false, c: yes, d: 1, e: \"true\"}");
  EXPECT_TRUE(yaml.root().at("a").truth());
  EXPECT_FALSE(yaml.root().at("b").truth());
  for (const char* key : {"c", "d", "e"})
    EXPECT_NE(yaml.fault([&](YamlCursor c) { c.at(key).truth(); }), testing::kNothingThrown) << key;
}

TEST(YamlCursor, KeysThatAreUnknownAreMetWithTheNearest) {
  const YamlText yaml("gravty: 1\n");
  const std::string fault = yaml.fault([](YamlCursor c) { c.expect_keys({"gravity", "bodies"}); });
  EXPECT_NE(fault.find("s.yaml:1: gravty: found an unknown key, expected one of gravity, bodies"),
            std::string::npos)
      << fault;
  EXPECT_NE(fault.find("did you mean \"gravity\"?"), std::string::npos) << fault;
  const YamlText far("xyz: 1\n");
  EXPECT_EQ(far.fault([](YamlCursor c) { c.expect_keys({"gravity"}); }).find("did you mean"),
            std::string::npos);
  EXPECT_EQ(yaml.fault([](YamlCursor c) { c.expect_keys({"gravty"}); }), testing::kNothingThrown);
}

TEST(YamlCursor, OfSeveralChoicesOneIsToBeThere) {
  const YamlText yaml("{one: {box: 1}, two: {box: 1, mesh: 2}, none: {}}");
  const auto choose = [](const YamlCursor& c) { return c.one_key_of({"box", "mesh"}); };
  EXPECT_EQ(choose(yaml.root().at("one")), "box");
  EXPECT_NE(yaml.fault([&](YamlCursor c) { choose(c.at("two")); }).find("box and mesh"), std::string::npos);
  EXPECT_NE(yaml.fault([&](YamlCursor c) { choose(c.at("none")); }).find("found none"), std::string::npos);
}

TEST(YamlCursor, NamesAreTheirPlaceInTheList) {
  const std::vector<std::string> names = {"full", "support", "tables"};
  const YamlText yaml("{a: support, b: suport}");
  EXPECT_EQ(yaml.root().at("a").choice(names), 1U);
  EXPECT_NE(yaml.fault([&](YamlCursor c) { c.at("b").choice(names); }).find("did you mean \"support\"?"),
            std::string::npos);
}

TEST(YamlCursor, ListsAndMapsAreToldApart) {
  const YamlText yaml("{list: [1, 2], map: {a: 1, b: 2}}");
  EXPECT_EQ(yaml.root().at("list").items(2)[1].number(), 2.0);
  EXPECT_EQ(yaml.root().at("map").entries()[1].first, "b");
  EXPECT_EQ(yaml.root().at("map").entries()[1].second.key(), "map.b");
  EXPECT_NE(yaml.fault([](YamlCursor c) { c.at("list").items(3); }), testing::kNothingThrown);
  EXPECT_NE(yaml.fault([](YamlCursor c) { c.at("map").items(); }), testing::kNothingThrown);
  EXPECT_NE(yaml.fault([](YamlCursor c) { c.at("list").entries(); }), testing::kNothingThrown);
  EXPECT_NE(yaml.fault([](YamlCursor c) { c.at("list").find("a"); }), testing::kNothingThrown);
  EXPECT_FALSE(yaml.root().has("none"));
}

}  // namespace
}  // namespace lodestone
