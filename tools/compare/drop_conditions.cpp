#include "tools/compare/drop_conditions.h"

#include <fmt/format.h>

#include <functional>
#include <numbers>

namespace lodestone {
namespace {

struct Condition {
  std::string name;
  std::function<void(DropJob&)> set;
};

std::vector<Condition> make_conditions() {
  std::vector<Condition> list = {{"usual", [](DropJob&) {}}};
  const auto add = [&](const std::string& what, std::initializer_list<double> values,
                       void (*set)(DropJob&, double)) {
    for (const double value : values)
      list.push_back({fmt::format("{}={:g}", what, value), [=](DropJob& job) { set(job, value); }});
  };
  add("restitution", {0.0, 0.2, 0.6, 0.8, 0.9}, [](DropJob& job, double e) { job.material.restitution = e; });
  add("friction", {0.0, 0.2, 0.8, 1.0}, [](DropJob& job, double mu) { job.material.friction = mu; });
  add("speed_scale", {3.0}, [](DropJob& job, double factor) { job.conditions.speed_scale *= factor; });
  add("slope_deg", {10.0, 20.0, 30.0, 40.0},
      [](DropJob& job, double degrees) { job.conditions.slope = degrees * std::numbers::pi / 180.0; });
  add("size_m", {0.001, 0.01, 0.1, 1.0, 10.0}, [](DropJob& job, double size) {
    job.shape = std::make_shared<const Shape>(scale_shape(*job.shape, size / job.shape->size));
  });
  return list;
}

}  // namespace

std::vector<std::string> condition_names() {
  std::vector<std::string> names;
  for (const Condition& condition : make_conditions()) names.push_back(condition.name);
  return names;
}

std::vector<DropCase> make_condition_cases(const DropJob& usual) {
  std::vector<DropCase> cases;
  for (const Condition& condition : make_conditions()) {
    cases.push_back({condition.name, usual});
    condition.set(cases.back().job);
  }
  return cases;
}

}  // namespace lodestone
