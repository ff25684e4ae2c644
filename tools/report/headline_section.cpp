#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "tools/report/sections.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

constexpr double kHeadlineFrame = 1.0 / 60.0;  // s

ordered_json fact(std::string figure, std::string text) {
  return {{"figure", std::move(figure)}, {"text", std::move(text)}};
}

// 2.9, 38, 1,490.
std::string short_number(double value) {
  if (value < 9.95) return fmt::format("{:.1f}", value);
  const std::string digits = fmt::format("{:.0f}", value < 1000 ? value : std::round(value / 10) * 10);
  std::string grouped;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) grouped += ',';
    grouped += digits[i];
  }
  return grouped;
}

std::string factor(double ratio, const char* less, const char* more) {
  return fmt::format("{} × {}", short_number(ratio >= 1 ? ratio : 1 / ratio), ratio >= 1 ? less : more);
}

bool is_at_60_hz(const ordered_json& row) {
  return std::abs(row["dt_s"].get<double>() - kHeadlineFrame) < 1e-4;
}

// A number of the row of this method at 60 Hz; none where it was not measured.
std::optional<double> find_number(const ordered_json& shape, std::string_view method, std::string_view model,
                                  const char* key) {
  for (const ordered_json& row : shape["rows"])
    if (row["method"] == method && (model.empty() || row["model"] == model) && is_at_60_hz(row) &&
        row[key].is_number())
      return row[key].get<double>();
  return std::nullopt;
}

void add_error_fact(const ordered_json& shapes, ordered_json& facts) {
  double least = 1e300, greatest = 0.0;
  std::vector<std::string> names;
  for (const ordered_json& shape : shapes) {
    const auto ours = find_number(shape, "statistical", "support", "score"),
               ode = find_number(shape, "full_1", "", "score");
    if (shape["made"]["fresh"].get<bool>() || !ours || !ode) continue;
    names.push_back(shape["name"]);
    least = std::min(least, *ode / *ours), greatest = std::max(greatest, *ode / *ours);
  }
  if (names.empty()) return;
  const std::string bodies =
      fmt::format("bodies on support at 60 steps a second ({})", fmt::join(names, ", "));
  if (least >= 1)
    facts.push_back(fact(fmt::format("{} to {} × closer", short_number(least), short_number(greatest)),
                         "to converged ODE than ODE itself in single steps: " + bodies + "."));
  else
    facts.push_back(fact(fmt::format("{:.2f} to {:.2f} ×", 1 / greatest, 1 / least),
                         "the error of ODE in single steps have " + bodies + "."));
}

void add_cost_fact(const ordered_json& shapes, ordered_json& facts) {
  for (const ordered_json& shape : shapes) {
    const auto ours = find_number(shape, "statistical", "support", "ns_per_body_step"),
               ode = find_number(shape, "full_plain", "", "ns_per_body_step");
    if (shape["name"] != "bunny" || !ours || !ode) continue;
    facts.push_back(fact(
        factor(*ode / *ours, "cheaper", "dearer"),
        fmt::format(
            "than the same bunny as a mesh in ODE: {} instead of {} nanoseconds for a step of an awake body.",
            short_number(*ours), short_number(*ode))));
  }
}

std::optional<double> find_ms(const ordered_json& rows, std::string_view method, std::string_view model,
                              int bodies, const char* key = "step_ms") {
  for (const ordered_json& row : rows)
    if (row["method"] == method && (model.empty() || row["model"] == model) && row["bodies"] == bodies &&
        row[key].is_number())
      return row[key].get<double>();
  return std::nullopt;
}

void add_heap_facts(const ordered_json& rows, ordered_json& facts) {
  constexpr int kBodies = 1000;
  const auto support = find_ms(rows, "statistical", "support", kBodies),
             tables = find_ms(rows, "statistical", "tables_published", kBodies);
  if (const auto bullet = find_ms(rows, "bullet_hull", "", kBodies); bullet && support)
    facts.push_back(fact(factor(*bullet / *support, "faster", "slower"),
                         fmt::format("than Bullet with convex hulls where 1,000 bunnies heap up: support "
                                     "takes {:.1f} ms a step, Bullet {:.0f}.",
                                     *support, *bullet)));
  const auto meshes = find_ms(rows, "full_plain", "", kBodies),
             paper = find_ms(rows, "statistical", "tables_published", kBodies, "paper_step_ms"),
             paper_meshes = find_ms(rows, "full_plain", "", kBodies, "paper_step_ms");
  if (meshes && tables && paper && paper_meshes)
    facts.push_back(fact(factor(*meshes / *tables, "faster", "slower"),
                         fmt::format("than ODE's meshes in that heap with the paper's spheres, the "
                                     "own kind; the paper of 2009 had {} ×.",
                                     short_number(*paper_meshes / *paper))));
}

void add_budget_fact(const ordered_json& runs, ordered_json& facts) {
  std::vector<std::string> budgets, over;
  std::int64_t steps = 0, bodies = 0;
  std::string scene;
  for (const ordered_json& run : runs) {
    if (run["budget_ms"].is_null() || run["over"].is_null()) continue;
    scene = run["scene"].get<std::string>(), bodies = 0;
    for (const char* rung : {"full", "support", "tables"}) bodies += run[rung].front().get<std::int64_t>();
    budgets.push_back(fmt::format("{:g}", run["budget_ms"].get<double>()));
    over.push_back(fmt::format("{}", run["over"].get<int>()));
    steps = run["counted_steps"].get<std::int64_t>();
  }
  if (budgets.empty()) return;
  facts.push_back(
      fact(fmt::format("{} of {} steps", fmt::join(over, ", "), steps),
           fmt::format("took longer than allowed, where the {} bodies of {} were given {} ms a step.", bodies,
                       scene, fmt::join(budgets, ", "))));
}

}  // namespace

ordered_json headline_section(const ordered_json& data) {
  ordered_json facts = ordered_json::array();
  add_error_fact(data["curve"]["shapes"], facts);
  add_cost_fact(data["curve"]["shapes"], facts);
  add_heap_facts(data["table1"]["rows"], facts);
  add_budget_fact(data["budget"]["runs"], facts);
  const ordered_json& cases = data["hard_cases"];
  facts.push_back(fact(fmt::format("{} of {}", cases["kept"].get<int>(), cases["figures"].get<int>()),
                       fmt::format("figures of set-ups on which engines are known to fail keep their bound; "
                                   "{} fail as ODE itself does, {} by our own doing.",
                                   cases["odes_own"].get<int>(), cases["failed"].get<int>())));
  return facts;
}

}  // namespace lodestone
