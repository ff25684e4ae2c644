// The part of JSON Schema (draft 2020-12) that the schema of scenes uses, for tests.
#pragma once

#include <algorithm>
#include <cctype>
#include <charconv>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string>

#include "scenes/yaml_value.h"

namespace lodestone {
using nlohmann::json;

class SchemaValidator {
 public:
  explicit SchemaValidator(const json& root) : root_(root) {}

  std::string find_fault(const json& schema, const json& value, const std::string& place) const {
    if (schema.is_boolean()) return schema.get<bool>() ? "" : place + ": found something, expected nothing";
    for (const auto& [keyword, rule] : schema.items())
      if (std::string fault = find_fault(schema, keyword, rule, value, place); !fault.empty()) return fault;
    return "";
  }

 private:
  std::string find_fault(const json& schema, const std::string& keyword, const json& rule, const json& value,
                         const std::string& place) const {
    const auto fault_unless = [&](bool holds) {
      return holds ? ""
                   : place + ": found " + value.dump().substr(0, 60) + ", expected " + keyword + " " +
                         rule.dump().substr(0, 100);
    };
    if (keyword == "$ref")
      return find_fault(root_.at(json::json_pointer(rule.get<std::string>().substr(1))), value, place);
    if (keyword == "type") return fault_unless(is_of_type(rule, value));
    if (keyword == "enum") return fault_unless(std::ranges::find(rule, value) != rule.end());
    if (keyword == "const") return fault_unless(value == rule);
    if (keyword == "minimum")
      return fault_unless(!value.is_number() || value.get<double>() >= rule.get<double>());
    if (keyword == "exclusiveMinimum")
      return fault_unless(!value.is_number() || value.get<double>() > rule.get<double>());
    if (keyword == "maximum")
      return fault_unless(!value.is_number() || value.get<double>() <= rule.get<double>());
    if (keyword == "minLength")
      return fault_unless(!value.is_string() || value.get<std::string>().size() >= rule.get<std::size_t>());
    if (keyword == "pattern")
      return fault_unless(!value.is_string() ||
                          std::regex_search(value.get<std::string>(), std::regex(rule.get<std::string>())));
    if (keyword == "minItems")
      return fault_unless(!value.is_array() || value.size() >= rule.get<std::size_t>());
    if (keyword == "maxItems")
      return fault_unless(!value.is_array() || value.size() <= rule.get<std::size_t>());
    if (keyword == "required")
      return fault_unless(!value.is_object() || std::ranges::all_of(rule, [&](const json& key) {
        return value.contains(key.get<std::string>());
      }));
    if (keyword == "items") return find_item_fault(rule, value, place);
    if (keyword == "properties") return find_property_fault(rule, value, place);
    if (keyword == "additionalProperties") return find_other_fault(schema, rule, value, place);
    if (keyword == "dependentRequired") return fault_unless(has_dependents(rule, value));
    if (keyword == "oneOf") return fault_unless(count_valid(rule, value, place) == 1);
    if (keyword == "anyOf") return fault_unless(count_valid(rule, value, place) > 0);
    if (keyword == "$schema" || keyword == "$defs" || keyword == "title" || keyword == "description")
      return "";
    throw std::invalid_argument("a keyword that this validator does not know: " + keyword);
  }

  static bool is_of_type(const json& types, const json& value) {
    if (types.is_array())
      return std::ranges::any_of(types, [&](const json& type) { return is_of_type(type, value); });
    const auto type = types.get<std::string>();
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    throw std::invalid_argument("a type that this validator does not know: " + type);
  }

  std::string find_item_fault(const json& schema, const json& value, const std::string& place) const {
    if (!value.is_array()) return "";
    for (std::size_t i = 0; i < value.size(); ++i)
      if (std::string fault = find_fault(schema, value[i], place + "/" + std::to_string(i)); !fault.empty())
        return fault;
    return "";
  }

  std::string find_property_fault(const json& properties, const json& value, const std::string& place) const {
    if (!value.is_object()) return "";
    for (const auto& [key, schema] : properties.items())
      if (value.contains(key))
        if (std::string fault = find_fault(schema, value[key], place + "/" + key); !fault.empty())
          return fault;
    return "";
  }

  // Of those that `properties` beside it does not name.
  std::string find_other_fault(const json& schema, const json& others, const json& value,
                               const std::string& place) const {
    if (!value.is_object()) return "";
    for (const auto& [key, inner] : value.items())
      if (!schema.contains("properties") || !schema["properties"].contains(key))
        if (std::string fault = find_fault(others, inner, place + "/" + key); !fault.empty()) return fault;
    return "";
  }

  static bool has_dependents(const json& rule, const json& value) {
    return !value.is_object() || std::ranges::all_of(rule.items(), [&](const auto& entry) {
      return !value.contains(entry.key()) || std::ranges::all_of(entry.value(), [&](const json& key) {
        return value.contains(key.template get<std::string>());
      });
    });
  }

  std::ptrdiff_t count_valid(const json& schemas, const json& value, const std::string& place) const {
    return std::ranges::count_if(
        schemas, [&](const json& schema) { return find_fault(schema, value, place).empty(); });
  }

  const json& root_;
};

template <class Number>
bool parse_scalar(const std::string& text, Number& number) {
  const char *begin = text.data() + (text.starts_with('+') ? 1 : 0), *end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, number);
  return error == std::errc() && stop == end && begin != end;
}

inline json json_of_scalar(const YamlValue& value) {
  std::int64_t integer = 0;
  double real = 0;
  if (value.quoted) return value.text;
  if (value.text == "true" || value.text == "false") return value.text == "true";
  if (parse_scalar(value.text, integer)) return integer;
  if (std::isalpha(static_cast<unsigned char>(value.text.back())) == 0 && parse_scalar(value.text, real))
    return real;  // `inf` and `nan` are words
  return value.text;
}

/// Empty where `value` is as `schema` says, else the first fault: "/bodies/0/level: …". A keyword that is not
/// known here is a fault of the test: it throws std::invalid_argument.
inline std::string find_schema_fault(const json& schema, const json& value) {
  return SchemaValidator(schema).find_fault(schema, value, "");
}

/// As YAML's core schema reads it: words without quotes that are numbers, true or false are those.
inline json json_of(const YamlValue& value) {
  switch (value.kind) {
    case YamlValue::Kind::null:
      return nullptr;
    case YamlValue::Kind::scalar:
      return value.text.empty() ? json("") : json_of_scalar(value);
    case YamlValue::Kind::sequence: {
      json list = json::array();
      for (const YamlValue& item : value.items) list.push_back(json_of(item));
      return list;
    }
    case YamlValue::Kind::map:
      break;
  }
  json map = json::object();
  for (const YamlEntry& entry : value.entries) map[entry.key] = json_of(entry.value);
  return map;
}

}  // namespace lodestone
