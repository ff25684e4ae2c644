#include "scenes/step_csv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == at)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

TEST(StepCsv, HasARowAStepUnderTheNamesOfItsColumns) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.at("steps.csv");
  StepReport report;
  report.step = 7, report.full = 3, report.statistical = 5, report.support = 4, report.tables = 1;
  report.asleep = 2, report.promotions = 6, report.demotions = 8, report.contacts = 9;
  report.times.total_ms = 1.5, report.times.crowd_ms = 0.25;
  {
    StepCsv csv(file);
    csv.add(report, 0.125, -12.5, 0.001);
    csv.add({}, 1e6, 0.0, 0.0);
    csv.close();
  }
  const std::vector<std::string> lines = split(testing::bytes_of(file), '\n');
  ASSERT_EQ(lines.size(), 4U);  // the last is empty
  const std::vector<std::string> names = split(lines[0], ','), cells = split(lines[1], ',');
  ASSERT_EQ(names.size(), cells.size());
  ASSERT_EQ(names.size(), split(lines[2], ',').size());
  const auto cell = [&](const std::string& name) {
    const auto at = std::ranges::find(names, name);
    return at == names.end() ? -1e9 : std::stod(cells[std::size_t(at - names.begin())]);
  };
  for (const auto& [name, value] : {std::pair{"step", 7.0},
                                    {"time_s", 0.125},
                                    {"total_ms", 1.5},
                                    {"crowd_ms", 0.25},
                                    {"full", 3.0},
                                    {"statistical", 5.0},
                                    {"support", 4.0},
                                    {"tables", 1.0},
                                    {"asleep", 2.0},
                                    {"promotions", 6.0},
                                    {"demotions", 8.0},
                                    {"contacts", 9.0},
                                    {"energy_j", -12.5},
                                    {"penetration_m", 0.001}})
    EXPECT_DOUBLE_EQ(cell(name), value) << name;
}

}  // namespace
}  // namespace lodestone
