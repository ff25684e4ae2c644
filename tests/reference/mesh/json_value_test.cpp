#include "reference/mesh/json_value.h"

#include <gtest/gtest.h>

#include "reference/error.h"

namespace lodestone {
namespace {

TEST(JsonReader, ReadsEveryKindOfValue) {
  const JsonValue value =
      parse_json(R"( {"a": [1, -2.5e3, true, false, null, "text"], "b": {"c": {}}, "d": []} )");
  ASSERT_EQ(value.kind, JsonValue::Kind::object);
  const JsonValue* list = value.find("a");
  ASSERT_NE(list, nullptr);
  ASSERT_EQ(list->items.size(), 6U);
  EXPECT_EQ(list->items[0].number, 1.0);
  EXPECT_EQ(list->items[1].number, -2500.0);
  EXPECT_EQ(list->items[2].kind, JsonValue::Kind::boolean);
  EXPECT_EQ(list->items[2].number, 1.0);
  EXPECT_EQ(list->items[3].number, 0.0);
  EXPECT_EQ(list->items[4].kind, JsonValue::Kind::null);
  EXPECT_EQ(list->items[5].text, "text");
  ASSERT_NE(value.find("b"), nullptr);
  EXPECT_EQ(value.find("b")->find("c")->items.size(), 0U);
  EXPECT_EQ(value.find("c"), nullptr);
  EXPECT_EQ(list->find("a"), nullptr);
}

TEST(JsonReader, OfAKeyGivenTwiceTheFirstCounts) {
  EXPECT_EQ(parse_json(R"({"a": 1, "a": 2})").find("a")->number, 1.0);
}

TEST(JsonReader, NumbersAreThoseOfTheStandard) {
  for (const auto& [text, number] : {std::pair{"0", 0.0},
                                     {"-0", 0.0},
                                     {"10", 10.0},
                                     {"0.125", 0.125},
                                     {"1e2", 100.0},
                                     {"1E+2", 100.0},
                                     {"25e-1", 2.5}})
    EXPECT_EQ(parse_json(text).number, number) << text;
  for (const char* text :
       {"01", "+1", ".5", "1.", "1e", "1e+", "-", "0x10", "NaN", "Infinity", "1e999", "--1"})
    EXPECT_THROW(parse_json(text), InputError) << text;
}

TEST(JsonReader, WhatIsNoJsonIsRefused) {
  for (const char* text : {"",      " ",     "{",      "}",       "[",         "]",           "[1",
                           "[1,",   "[1,]",  "[,1]",   "[1 2]",   "{\"a\"}",   "{\"a\":}",    "{\"a\":1,}",
                           "{a:1}", "{1:1}", "\"open", "tru",     "nul",       "truely",      "1 2",
                           "[] []", "'a'",   "\"\t\"", "\"\\x\"", "\"\\u12\"", "\"\\u12g4\"", "/**/1"})
    EXPECT_THROW(parse_json(text), InputError) << text;
}

TEST(JsonReader, CutAnywhereItIsNoJson) {
  const std::string whole = R"({"a": [1.5, true, null, "\u00e9"], "b": {"c": -2e3}})";
  ASSERT_NO_THROW(parse_json(whole));
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_THROW(parse_json(std::string_view(whole).substr(0, length)), InputError) << length;
}

TEST(JsonReader, DepthAndNumberOfValuesAreBounded) {
  const auto nested = [](int depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_NO_THROW(parse_json(nested(10), {.depth = 10}));
  EXPECT_THROW(parse_json(nested(11), {.depth = 10}), InputError);
  EXPECT_THROW(parse_json(std::string(1'000'000, '[')), InputError);
  EXPECT_NO_THROW(parse_json("[1,2,3]", {.values = 4}));
  EXPECT_THROW(parse_json("[1,2,3,4]", {.values = 4}), InputError);
}

TEST(JsonReader, EscapesBecomeUtf8) {
  EXPECT_EQ(unescape_json(R"(a\"\\\/\b\f\n\r\tz)"), "a\"\\/\b\f\n\r\tz");
  EXPECT_EQ(unescape_json(R"(\u0041\u00e9\u20ac)"), "A\u00e9\u20ac");
  EXPECT_EQ(unescape_json(R"(\ud83d\uDE00)"), "\U0001f600");
  EXPECT_EQ(unescape_json("plain"), "plain");
  for (const char* lone : {R"(\ud83d)", R"(\ude00)", R"(\ud83dx)", R"(\ud83d\u0041)", R"(\ud83d\ud83d)"})
    EXPECT_THROW(unescape_json(lone), InputError) << lone;
}

}  // namespace
}  // namespace lodestone
