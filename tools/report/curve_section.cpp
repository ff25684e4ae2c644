#include <array>

#include "tools/report/sections.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

constexpr std::string_view kUsualMaterial = "restitution 0.4, friction 0.5";  // of `compare drop`
constexpr double kCurveFrame = 1.0 / 60.0;                                    // s

struct ShapeBaseline {
  std::string_view file, name, title;
};
constexpr std::array kBaselines = {
    ShapeBaseline{"scores_box.csv", "box", "box .2 × .3 × .4 m"},
    ShapeBaseline{"scores_l.csv", "L", "L of .3 × .2 m"},
    ShapeBaseline{"scores_bunny.csv", "bunny", "bunny of .2 m, 4,698 faces"},
};

// What a body costs in 1/60 s, whatever the step: methods at different steps compare by it.
ordered_json ns_per_frame(const ordered_json& row) {
  if (row["ns_per_body_step"].is_null()) return nullptr;
  return row["ns_per_body_step"].get<double>() * kCurveFrame / row["dt_s"].get<double>();
}

ordered_json shape_of(std::string_view name, std::string_view title, std::string_view material,
                      const ReportTable& table) {
  ordered_json shape = {{"name", name},
                        {"title", title},
                        {"material", material},
                        {"made", json_of(table.made)},
                        {"trials", table.rows.front()["trials"]},
                        {"floor", table.rows.front()},
                        {"rows", ordered_json::array()}};
  for (std::size_t i = 1; i < table.rows.size(); ++i) {
    ordered_json row = table.rows[i];
    row["ns_per_frame"] = ns_per_frame(row);
    shape["rows"].push_back(std::move(row));
  }
  return shape;
}

}  // namespace

ordered_json curve_section(const std::optional<FreshResults>& fresh) {
  ordered_json shapes = ordered_json::array();
  for (const auto& [file, name, title] : kBaselines)
    shapes.push_back(shape_of(name, title, kUsualMaterial, load_baseline(file)));
  if (fresh && !fresh->scores.rows.empty()) {
    const std::string shape = fresh->scores.rows.front()["shape"];
    shapes.push_back(shape_of(shape + ", now", shape + ", measured now", fresh->material, fresh->scores));
  }
  return {{"shapes", shapes}};
}

}  // namespace lodestone
